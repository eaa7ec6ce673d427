# SPDX-License-Identifier: GPL-3.0-or-later
"""An add-on that cannot work says why, whatever is wrong with its files or with the process that it is in."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pack
import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "build" / "addon" / "sfumato"


def run(script: str, **environment: str) -> str:
    """What a Python of its own prints."""
    done = subprocess.run(
        [sys.executable, "-c", script], env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.strip()


def problem(addon: Path, **environment: str) -> str:
    return run("from sfumato import core; print(core.problem())", PYTHONPATH=str(addon.parent), **environment)


@pytest.fixture
def addon(tmp_path: Path) -> Path:
    """A copy of the built add-on, with the listing of an archive."""
    if not ADDON.exists():
        pytest.skip("the add-on is not built in build/")
    copy = tmp_path / "addons" / "sfumato"
    shutil.copytree(ADDON, copy)
    (copy / pack.LISTING).write_bytes(pack.contents(copy)[pack.LISTING])
    (copy / "LICENSE").write_bytes((ROOT / "LICENSE").read_bytes())
    return copy


def native(addon: Path) -> Path:
    (module,) = (addon / "_native").glob("*.so")
    return module


def test_a_whole_addon_has_no_problem(addon: Path) -> None:
    assert problem(addon) == ""


def test_a_folder_that_cannot_be_written_is_no_problem(addon: Path) -> None:
    for path in [*addon.rglob("*"), addon]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    try:
        assert problem(addon, PYTHONDONTWRITEBYTECODE="") == ""
    finally:
        for path in [addon, *addon.rglob("*")]:
            path.chmod(0o755)


def test_each_file_that_is_missing_or_cut_short_is_named(addon: Path) -> None:
    for victim in (
        addon / "engine.py",
        addon / "shaders" / "camera.glsl",
        native(addon),
        addon / "_native/sfumato.pyi",
    ):
        data = victim.read_bytes()
        victim.unlink()
        assert f"{victim} is not there" in problem(addon)
        if victim.suffix != ".pyi":
            victim.write_bytes(data[: len(data) // 2])
            said = problem(addon)
            assert f"{victim} has {len(data) // 2} bytes instead of {len(data)}" in said
            assert "README" in said
        victim.write_bytes(data)
    assert problem(addon) == ""


def test_a_module_that_is_no_module_is_named(addon: Path) -> None:
    """As a listing knows sizes only."""
    module = native(addon)
    module.write_bytes(bytes(module.stat().st_size))
    assert module.name in problem(addon)


@pytest.mark.parametrize(
    "name, made_for",
    [
        ("sfumato.cpython-27-x86_64-linux-gnu.so", "Python 2.7 on x86_64-linux-gnu"),
        ("sfumato.cpython-311-aarch64-linux-gnu.so", "Python 3.11 on aarch64-linux-gnu"),
        ("sfumato.cp311-win_amd64.pyd", "Python 3.11 on win_amd64"),
    ],
)
def test_an_archive_for_another_python_or_machine_says_for_which(addon: Path, name: str, made_for: str) -> None:
    (addon / pack.LISTING).unlink()
    native(addon).rename(addon / "_native" / name)
    said = problem(addon)
    here = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    assert made_for in said and f"this is {here}" in said


def test_a_folder_without_any_module_says_so(addon: Path) -> None:
    (addon / pack.LISTING).unlink()
    native(addon).unlink()
    assert f"there is none in {addon / '_native'}" in problem(addon)


def test_a_module_of_another_version_asks_for_a_restart(addon: Path) -> None:
    (addon / pack.LISTING).unlink()
    with (addon / "_native" / "sfumato.pyi").open("a", encoding="utf-8") as stub:
        stub.write("newer: int\n")
    assert "restart it" in problem(addon) and str(native(addon)) in problem(addon)


# What a process may hold of others: an Embree of another version, and one whose structures are not those that ours has.
STRANGERS: dict[str, Callable[[str], bool]] = {
    "long rtcGetDeviceProperty(void *device, int property) { return 99901; }": lambda said: "99901" in said,
    "void rtcIntersect1(void) {}": lambda said: "3.000000 m away at inf m" in said,
    "int TBB_runtime_interface_version(void) { return 11000; }": lambda said: "oneTBB answers as version 11000" in said,
}


@pytest.mark.parametrize("source", STRANGERS)
def test_the_library_of_another_is_noticed(addon: Path, tmp_path: Path, source: str) -> None:
    stranger = tmp_path / "stranger.so"
    subprocess.run(
        ["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", stranger], input=source.encode(), check=True, timeout=60
    )
    said = problem(addon, LD_PRELOAD=str(stranger))
    assert STRANGERS[source](said) and "pictures would be wrong" in said, said
