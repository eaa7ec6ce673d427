# SPDX-License-Identifier: GPL-3.0-or-later
"""What packaging/release made: it runs wherever Blender does, shares nothing with the process, and is whole."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pack
import pytest

ROOT = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "sfumato"
MOST_BYTES = 20e6
NEWEST_GLIBC = (2, 28)  # of the systems that Blender's own builds are made for
OF_EVERY_LINUX = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libgcc_s.so.1", "ld-linux-x86-64.so.2"}
INSIDE = (
    *("Embree", "oneTBB", "zlib", "LZ4", "xsimd", "GLM", "pybind11", "xxHash", "libstdc++"),
    *("OpenImageIO", "OpenEXR", "Imath", "libpng", "libjpeg-turbo", "libtiff", "robin-map", "fmt", "Boost"),
)
EXR = ROOT / "tests/goldens/plume_cycles.exr"
PNG = ROOT / "docs/cost.png"
LONGEST_IMPORT = 0.3  # seconds of processors
STARTS = 25


def extension() -> Path:
    """The archive for Blender 4.2 and later. Skips the test where none was made."""
    found = [path for path in (ROOT / "build/release").glob("sfumato-*.zip") if "before" not in path.name]
    if not found:
        pytest.skip("no release is in build/release; packaging/release makes one")
    return found[0]


def older() -> Path:
    return extension().with_name(extension().stem + "-before-4.2.zip")


@pytest.fixture(scope="module")
def addon(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The add-on, installed as before 4.2."""
    folder = tmp_path_factory.mktemp("addons")
    with zipfile.ZipFile(older()) as archive:
        archive.extractall(folder)
    return folder / "sfumato"


@pytest.fixture(params=["310", "311", "313"])
def module(addon: Path, request: pytest.FixtureRequest) -> Path:
    return addon / "_native" / f"sfumato.cpython-{request.param}-x86_64-linux-gnu.so"


def run(script: str, **environment: str) -> str:
    """What a Python of its own prints."""
    command = [sys.executable, "-c", script]
    done = subprocess.run(
        command, env=os.environ | environment, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    return done.stdout.strip()


def output(*command: str | Path) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_versions_agree() -> None:
    """In the manifest, in bl_info, and in the build."""
    manifest = re.search(r'^version = "(.+)"$', (ROOT / "addon/blender_manifest.toml").read_text(), re.MULTILINE)
    info = re.search(r'"version": \((\d+), (\d+), (\d+)\)', (ROOT / "addon/__init__.py").read_text())
    project = re.search(r"project\(sfumato VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
    assert manifest and info and project
    assert manifest[1] == ".".join(info.groups()) == project[1]


def test_both_archives_hold_the_same_and_are_small() -> None:
    with zipfile.ZipFile(extension()) as new, zipfile.ZipFile(older()) as old:
        assert [f"sfumato/{name}" for name in new.namelist()] == old.namelist()
        assert all(new.read(name) == old.read(f"sfumato/{name}") for name in new.namelist())
    assert extension().stat().st_size < MOST_BYTES


def test_packing_again_gives_the_same_bytes(addon: Path, tmp_path: Path) -> None:
    again = pack.pack(addon, tmp_path)
    assert [path.read_bytes() for path in again] == [extension().read_bytes(), older().read_bytes()]


def test_it_needs_what_every_linux_has(module: Path) -> None:
    needed = set(re.findall(r"NEEDED.*\[(.+)\]", output("readelf", "--dynamic", module)))
    assert needed and needed <= OF_EVERY_LINUX


def test_no_newer_glibc_is_needed_and_no_libstdcxx(module: Path) -> None:
    versions = set(re.findall(r"Name: (\S+)", output("readelf", "--version-info", module)))
    glibc = {tuple(map(int, version[6:].split("."))) for version in versions if version.startswith("GLIBC_")}
    assert glibc and max(glibc) <= NEWEST_GLIBC, sorted(glibc)
    assert {version for version in versions if not re.match(r"(GLIBC|GCC)_", version)} == set()


def test_one_name_can_be_seen(module: Path) -> None:
    """So none is taken from Blender's own Embree, or given to anybody; and there are no unique symbols, of which the
    dynamic linker would keep one for all libraries of a process."""
    shown = [line.split()[1:] for line in output("nm", "-D", "--defined-only", module).splitlines()]
    assert shown == [["T", "PyInit_sfumato"]]


def test_what_it_takes_is_of_python_and_of_glibc(module: Path) -> None:
    taken = re.findall(r"^ +[Uw] (\S+)$", output("nm", "-D", "--undefined-only", module), re.MULTILINE)
    strange = [name for name in taken if not re.match(r"_?Py|.*@(GLIBC|GCC)_|__gmon_start__|_ITM_", name)]
    assert taken and not strange


def test_no_path_of_the_machine_is_in_it(addon: Path) -> None:
    paths = [str(ROOT).encode(), str(CACHE).encode(), str(Path.home()).encode() + b"/"]
    found = [file.name for file in addon.rglob("*") if file.is_file() and any(p in file.read_bytes() for p in paths)]
    assert not found


def test_the_licences_of_all_that_is_inside_are_there(addon: Path) -> None:
    assert "GNU GENERAL PUBLIC LICENSE" in (addon / "LICENSE").read_text(encoding="utf-8")
    text = (addon / "licences.txt").read_text(encoding="utf-8")
    missing = [name for name in INSIDE if not re.search(rf"^=+\n{re.escape(name)}[ ,].*\n=+$", text, re.MULTILINE)]
    assert not missing
    assert "Apache License" in text and "GCC RUNTIME LIBRARY EXCEPTION" in text


# Embree and readers of pictures as another program may have them: what goes to them comes back as nonsense.
STRANGER = """
long rtcGetDeviceProperty(void *device, int property) { return 99901; }
void rtcIntersect1(void) {}
int TBB_runtime_interface_version(void) { return 11000; }
void *png_create_read_struct(void) { return 0; }
void *exr_start_read(void) { return 0; }
int inflate(void) { return -99; }
"""


@pytest.fixture
def loadable(addon: Path) -> Path:
    """The add-on, where this Python can load it."""
    if sys.version_info[:2] not in {(3, 11), (3, 13)}:
        pytest.skip("the tests run in another Python than Blender's")
    return addon


def test_the_libraries_of_the_process_do_not_reach_it(loadable: Path, tmp_path: Path) -> None:
    stranger = tmp_path / "stranger.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", stranger], input=STRANGER.encode(), check=True)
    script = (
        "import time; start = time.process_time(); from sfumato import core; problem = core.problem()\n"
        "seconds = time.process_time() - start\n"
        f"problem += ''.join(core.module().unreadable_picture(path) or '' for path in ({str(EXR)!r}, {str(PNG)!r}))\n"
        "print(seconds, problem)"
    )
    seconds, _, problem = run(script, PYTHONPATH=str(loadable.parent), LD_PRELOAD=str(stranger)).partition(" ")
    assert problem == ""
    assert float(seconds) < LONGEST_IMPORT


def test_it_stands_beside_another_of_its_kind(loadable: Path) -> None:
    """That was made with the same pybind11, or nearly, and has types of the same names."""
    script = "import sfumato; from addons.sfumato import core; print(core.module() is not sfumato, core.problem())"
    (loadable.parent / "addons").symlink_to(loadable.parent)
    paths = f"{ROOT / 'build/python'}:{loadable.parent}"
    assert run(script, PYTHONPATH=paths) == "True"


def test_pictures_are_read_without_threads(loadable: Path, tmp_path: Path) -> None:
    """Of libraries within, that nobody here could end."""
    cut = tmp_path / "cut.exr"
    cut.write_bytes(EXR.read_bytes()[:9999])
    script = f"""if True:
        from sfumato import core
        import os
        read = core.module().unreadable_picture
        before = len(os.listdir("/proc/self/task"))
        print(read({str(EXR)!r}), read({str(PNG)!r}), len(os.listdir("/proc/self/task")) - before, read({str(cut)!r}))"""
    said = run(script, PYTHONPATH=str(loadable.parent))
    assert said.startswith(f"None None 0 '{cut}' cannot be read whole: "), said


def test_plugins_for_another_library_are_not_loaded(loadable: Path, tmp_path: Path) -> None:
    """That the environment names, as a farm's does for its own OpenImageIO."""
    plugin, mark = tmp_path / "plugins" / "pic.imageio.so", tmp_path / "loaded"
    plugin.parent.mkdir()
    source = f"""#include <stdio.h>
        __attribute__((constructor)) static void loaded(void) {{ fclose(fopen("{mark}", "w")); }}"""
    subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", plugin], input=source.encode(), check=True)
    text = tmp_path / "text.png"
    text.write_text("no picture")
    script = f"from sfumato import core; print(core.module().unreadable_picture({str(text)!r}))"
    assert "cannot be read" in run(script, PYTHONPATH=str(loadable.parent), OIIO_LIBRARY_PATH=str(plugin.parent))
    assert not mark.exists()


def test_it_is_used_by_python_3_10(addon: Path) -> None:
    """The one of Blender 3.4 to 4.0, none of which can be had here: by itself."""
    found = sorted(CACHE.glob("third-party-*/python3.10"))
    if not found:
        pytest.skip("no Python 3.10 is in ~/.cache/sfumato; packaging/release fetches one")
    script = f"from sfumato import core; print(core.problem(), core.module().unreadable_picture({str(PNG)!r}))"
    home = str(found[-1])
    paths = {"PYTHONHOME": home, "LD_LIBRARY_PATH": home, "PYTHONPATH": str(addon.parent)}
    command = [f"{home}/bin/python3.10", "-c", script]
    done = subprocess.run(command, env=os.environ | paths, capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout.strip()) == (0, "None"), done.stderr[-2000:]


USED = f"""
import numpy, sfumato
sfumato.unreadable_picture({str(EXR)!r})
scene = sfumato.Scene()
scene.add_medium(numpy.ones((24, 24, 24)), numpy.eye(4), scattering=(1, 1, 1), absorption=(1, 1, 1))
scene.add_instances(sfumato.Mesh([[0, 0, 0], [9, 0, 0], [0, 9, 0]], [[0, 1, 2]]), numpy.eye(4), albedo=[[1, 1, 1]])
scene.add_sun((0, 0, -1), (4, 4, 4))
sfumato.Frame(scene).render(sfumato.Camera(numpy.eye(4)), 64, 64)
"""


def test_processes_that_used_it_end(loadable: Path) -> None:
    """With its threads, which are inside it. `kept` still has some of them at the end."""
    for kept in ("", "kept = sfumato.Prepared(threads=2); sfumato.Frame(scene, prepared=kept)"):
        for _ in range(STARTS):
            run(USED + kept, PYTHONPATH=str(loadable.parent))


def test_blender_accepts_both() -> None:
    """By the tool of each Blender that is at hand, which is Python alone."""
    scripts = ("usr/share/blender", "bpy/*", "lib/python*/site-packages/bpy/*")
    tools = [
        path for place in scripts for path in CACHE.glob(f"*/{place}/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    ]
    if not tools:
        pytest.skip("no Blender 4.2 or later is in ~/.cache/sfumato")
    for tool in tools:
        for archive in (extension(), older()):
            output(sys.executable, tool, "validate", archive)
