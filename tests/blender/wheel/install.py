# SPDX-License-Identifier: GPL-3.0-or-later
"""The package in a Blender that is a Python module, as an artist has it: from a file, into Blender's own extensions.

    python install.py EXTENSION.zip

It is left installed. What needs no Blender window but an extension is asked by background/*.py, through start.py.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import harness

sys.path.insert(0, str(harness.ROOT / "packaging"))
import pack  # noqa: E402

EXTENSION = Path(sys.argv[1])
INSTALLED = Path(os.environ["BLENDER_USER_EXTENSIONS"]) / "user_default" / "sfumato"
OF_SCRIPTS = Path(os.environ["BLENDER_USER_SCRIPTS"]) / "addons" / "sfumato"
# What another Blender has to say, between marks, as its modules say things too.
SAY = "print('<<' + '|'.join({}) + '>>')"
PROBLEM = f"import sfumato.core as core; {SAY.format('[core.problem(), core.__file__]')}"


def install(package: Path = EXTENSION) -> None:
    bpy.ops.extensions.package_install_files(filepath=str(package), repo="user_default", enable_on_install=True)


def problem() -> str:
    return str(sys.modules[f"{harness.ADDON}.core"].problem())


def words(command: list[str]) -> list[str]:
    """What a Blender of its own says."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.split("<<")[1].split(">>")[0].split("|")


def another(script: str = PROBLEM, before: tuple[str, ...] = ()) -> list[str]:
    """What one says that begins with the installed extension; `before` starts it."""
    return words([*before, *harness.command(script)])


def newer(folder: Path) -> Path:
    """The package as a later version, with more in its module's interface, in which the modules know of it."""
    with zipfile.ZipFile(EXTENSION) as archive:
        archive.extractall(folder / "sfumato")
    stub = folder / "sfumato/_native/sfumato.pyi"
    before = stub.read_bytes()
    stub.write_bytes(before + b"\nadded: int\n")
    old, new = [hashlib.sha256(text).hexdigest().encode() for text in (before, stub.read_bytes())]
    for module in stub.parent.glob("*.so"):
        binary = module.read_bytes()
        assert binary.count(old) == 1
        module.write_bytes(binary.replace(old, new))
    manifest = folder / "sfumato/blender_manifest.toml"
    manifest.write_text(manifest.read_text().replace('\nversion = "', '\nversion = "9'))
    pack.write(folder / "newer.zip", pack.contents(folder / "sfumato"))
    return folder / "newer.zip"


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


def test_update_to_another_interface_asks_for_a_restart() -> None:
    """As the module of before stays in the process."""
    install()
    assert problem() == ""
    folder = Path(bpy.app.tempdir) / "newer"
    install(newer(folder))
    assert harness.ADDON in bpy.context.preferences.addons
    assert "restart it" in problem() and str(INSTALLED) in problem(), problem()
    bpy.context.scene.render.engine = "SFUMATO"
    assert another()[0] == ""
    install()
    assert problem() == "", problem()


def test_a_folder_that_cannot_be_written() -> None:
    # In a root of another Debian there is no mount at the top to be made private, and none has to be.
    read_only = """
        mount --make-rprivate / 2>/dev/null
        mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && ! touch "$0/written" 2>/dev/null && exec "$@"
    """
    apart = ("unshare", "--mount", "--propagation", "unchanged", "sh", "-c", read_only, str(INSTALLED))
    reason, file = another(before=apart)
    assert reason == "" and Path(file).is_relative_to(INSTALLED)


def test_a_folder_that_was_not_copied_whole() -> None:
    """The engine is there all the same, and the preferences say which file is not."""
    module = next((INSTALLED / "_native").glob(f"*-{sys.version_info.major}{sys.version_info.minor}-*"))
    whole = module.read_bytes()
    engines = "bpy.types.RenderEngine.__subclasses__()"
    script = f"import bpy, sfumato.core as core; {SAY.format(f'[core.problem(), str({engines})]')}"
    try:
        module.write_bytes(whole[: len(whole) // 2])
        reason, engines = another(script)
        assert f"{module} has {len(whole) // 2} bytes instead of {len(whole)}" in reason
        assert "SfumatoEngine" in engines
    finally:
        module.write_bytes(whole)


def test_two_side_by_side() -> None:
    """An archive for before 4.2 that settings of an older Blender brought along, and the extension: the first that is
    switched on works, the other says where that one is, and neither takes the other with it."""
    OF_SCRIPTS.parent.mkdir(parents=True, exist_ok=True)
    shutil.copytree(INSTALLED, OF_SCRIPTS)
    try:
        for first, second, kept in (
            (harness.ADDON, "sfumato", INSTALLED),
            ("sfumato", harness.ADDON, OF_SCRIPTS),
        ):
            script = (
                "import bpy, addon_utils; said = []; "
                f"one = addon_utils.enable('{first}', default_set=True); "
                f"two = addon_utils.enable('{second}', default_set=True, handle_error=lambda e: said.append(str(e))); "
                "bpy.context.scene.render.engine = 'SFUMATO'; "
                + SAY.format("[one.__file__, str(two), str(said), one.instruction_set]")
            )
            file, other, said, instructions = words([sys.executable, "-c", script])
            assert Path(file).parent == kept and other == "None" and instructions, (first, file, other)
            assert f"the one in {kept}" in said and "Remove one of them" in said, said
    finally:
        shutil.rmtree(OF_SCRIPTS)


def _repository() -> int:
    modules = [repository.module for repository in bpy.context.preferences.extensions.repos]
    return modules.index("user_default")


harness.main()
