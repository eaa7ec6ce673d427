# SPDX-License-Identifier: GPL-3.0-or-later
"""Start Blender with the add-on of the build tree and none of the user's own settings."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def environment(root: Path = ROOT) -> dict[str, str]:
    """This process's environment, but with all that Blender calls the user's folders inside the build tree of `root`.

    The build puts the add-on at build/blender/scripts/addons/sfumato, where `--addons sfumato` finds it.
    """
    resources = root / "build" / "blender"
    return os.environ | {
        "BLENDER_USER_RESOURCES": str(resources),
        "BLENDER_USER_CONFIG": str(resources / "config"),
        "BLENDER_USER_SCRIPTS": str(resources / "scripts"),
        "BLENDER_USER_DATAFILES": str(resources / "datafiles"),
        "BLENDER_USER_EXTENSIONS": str(resources / "extensions"),
    }


def run_script(blend: Path, script: Path, *arguments: str) -> str:
    """Run `script` in the background on `blend`, with the add-on, and return what Blender printed.

    Raises RuntimeError with Blender's output if the script raises an exception.
    """
    blender = shutil.which("blender")
    if blender is None:
        raise RuntimeError("blender is not on the PATH")
    command = [blender, "--background", str(blend), "--addons", "sfumato", "--python-exit-code", "3"]
    command += ["--python", str(script), "--", *arguments]
    done = subprocess.run(
        command, env=environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if done.returncode != 0:
        raise RuntimeError(f"{script.name} on {blend.name} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout
