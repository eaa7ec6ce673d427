# SPDX-License-Identifier: GPL-3.0-or-later
"""Start Blender with the add-on of the build tree and none of the user's own settings."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import progress

ROOT = Path(__file__).resolve().parents[2]


def environment(root: Path = ROOT) -> dict[str, str]:
    """This process's environment, but with all that Blender calls the user's folders inside the build tree of `root`,
    and with /usr/bin first: where another Python is first, Debian's Blender takes its folders, and finds no NumPy.

    tests/run puts the add-on at build/blender/scripts/addons/sfumato, where `--addons sfumato` finds it.
    """
    resources = root / "build" / "blender"
    return os.environ | {
        "PATH": f"/usr/bin:{os.environ['PATH']}",
        "BLENDER_USER_RESOURCES": str(resources),
        "BLENDER_USER_CONFIG": str(resources / "config"),
        "BLENDER_USER_SCRIPTS": str(resources / "scripts"),
        "BLENDER_USER_DATAFILES": str(resources / "datafiles"),
        "BLENDER_USER_EXTENSIONS": str(resources / "extensions"),
    }


def run_script(blend: Path, script: Path, *arguments: str) -> str:
    """Run `script` in the background on `blend`, with the add-on, and return what Blender printed; what the script says
    by progress.step is passed on at once. Blender ends before this returns or raises, whatever it is that ends it.

    Raises RuntimeError with Blender's output if the script raises an exception.
    """
    blender = shutil.which("blender")
    if blender is None:
        raise RuntimeError("blender is not on the PATH")
    command = [blender, "--background", str(blend), "--addons", "sfumato", "--python-exit-code", "3"]
    command += ["--python", str(script), "--", *arguments]
    printed = []
    with subprocess.Popen(
        command, env=environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                printed.append(line)
                if line.startswith(progress.MARK):
                    print(line, end="", file=sys.stderr, flush=True)
            process.wait()
        finally:
            process.kill()
    if process.returncode != 0:
        raise RuntimeError(f"{script.name} on {blend.name} ended with {process.returncode}:\n{''.join(printed)}")
    return "".join(printed)
