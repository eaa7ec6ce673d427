# SPDX-License-Identifier: GPL-3.0-or-later
"""Another commit of this repository, built once in the user's cache."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from blender_run import ROOT

PYTHON = "/usr/bin/python3"  # Debian's own, which is the one inside Debian's Blender


def command(*words: str) -> str:
    """What it printed. Raises RuntimeError with that where it fails."""
    done = subprocess.run(words, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout.strip()


def hash_of(commit: str) -> str:
    """The first letters of a commit's name, by which its folder is called."""
    try:
        return command("git", "-C", str(ROOT), "rev-parse", "--verify", "--short=12", f"{commit}^{{commit}}")
    except RuntimeError as error:
        raise ValueError(f"--against names '{commit}', which is no commit of {ROOT}") from error


def folder_of(name: str) -> Path:
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(cache) / "sfumato" / f"before-{name}"


def tree_of(commit: str) -> Path:
    """A built tree of `commit`. What an interrupted call left is finished by the next."""
    name = hash_of(commit)
    folder = folder_of(name)
    if not folder.exists():
        part = folder.with_suffix(f".{os.getpid()}")
        part.parent.mkdir(parents=True, exist_ok=True)
        command("git", "clone", "--quiet", "--no-checkout", str(ROOT), str(part))
        command("git", "-C", str(part), "checkout", "--quiet", "--detach", name)
        part.rename(folder)
    if not (folder / "build" / "build.ninja").exists():
        configure = ["cmake", "-S", str(folder), "-B", str(folder / "build"), "-G", "Ninja"]
        command(*configure, f"-DPython_EXECUTABLE={PYTHON}")
    command("cmake", "--build", str(folder / "build"), "--target", "addon")
    return folder
