# SPDX-License-Identifier: GPL-3.0-or-later
"""Formatting and types, where the tools are installed; .ci/run installs them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ("addon", "blend_samples", "docs", "native", "packaging", "tests")
SHELL = (
    ".ci/run",
    "blend_samples/render",
    "packaging/release",
    "packaging/third_party",
    "tests/blender/start",
    "tests/matrix",
    "tests/run",
)


def tool(name: str) -> str:
    """The path of a program, Debian's own before any other; skips the test without it."""
    found = shutil.which(name, path="/usr/bin") or shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


def check(*command: str) -> None:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]


def test_cpp_is_formatted() -> None:
    files = [
        str(file) for folder in ("native", "packaging", "tests") for file in sorted((ROOT / folder).rglob("*.[ch]pp"))
    ]
    assert files
    check(tool("clang-format"), "--dry-run", "--Werror", *files)


def test_python_is_formatted() -> None:
    check(tool("black"), "--check", "--quiet", *PYTHON)


def test_python_is_typed() -> None:
    check(tool("mypy"), *PYTHON)


def test_shell_is_clean() -> None:
    check(tool("shellcheck"), "--external-sources", *SHELL)
