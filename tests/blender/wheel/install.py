# SPDX-License-Identifier: GPL-3.0-or-later
"""The package in a Blender that is a Python module, as an artist has it: from a file, into Blender's own extensions.

    python install.py EXTENSION.zip

It is left installed. What needs no Blender window but an extension is asked by background/*.py, through start.py.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy
import harness

EXTENSION = sys.argv[1]
INSTALLED = Path(os.environ["BLENDER_USER_EXTENSIONS"]) / "user_default" / "sfumato"


def install() -> None:
    bpy.ops.extensions.package_install_files(filepath=EXTENSION, repo="user_default", enable_on_install=True)


def test_installs_and_works() -> None:
    install()
    assert harness.ADDON in bpy.context.preferences.addons
    harness.enable()
    from sfumato import core  # type: ignore[attr-defined]

    assert Path(core.__file__).is_relative_to(INSTALLED)
    assert core.problem() == "", core.problem()
    bpy.context.scene.render.engine = "SFUMATO"  # refused where there is no such engine


def test_is_removed_and_installed_again() -> None:
    """A module that is loaded stays so; its file can go."""
    install()
    bpy.ops.extensions.package_uninstall(repo_index=_repository(), pkg_id="sfumato")
    assert not INSTALLED.exists()
    assert harness.ADDON not in bpy.context.preferences.addons
    install()
    assert harness.ADDON in bpy.context.preferences.addons


def test_is_updated_by_itself() -> None:
    install()
    install()
    assert harness.ADDON in bpy.context.preferences.addons


def _repository() -> int:
    modules = [repository.module for repository in bpy.context.preferences.extensions.repos]
    return modules.index("user_default")


harness.main()
