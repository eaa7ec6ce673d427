# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests inside Blender: a file of `test_*` functions that ends with `harness.main()`.

tests/run starts Blender once for each file: background/*.py without a window, interface/*.py with the real interface on
a virtual screen. By hand, after tests/run has built the add-on, one file is

    tests/blender/start background FILE        tests/blender/start interface FILE

tests/official runs background/*.py in the Blenders of PyPI, which are Python modules.

Tests run in the order of the file, each from Blender's factory scene. In the interface a test may be a generator: at
each `yield` Blender redraws every editor and handles its events before the test goes on; at `yield seconds` it does as
it likes for that long.
"""

from __future__ import annotations

import importlib
import os
import pkgutil
import sys
import time
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from types import GeneratorType
from typing import Any

import addon_utils
import bpy
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "blend_samples" / "plume.blend"
CACHE = ROOT / "blend_samples" / "plume_cache"

# Blender as a Python module has no file of its own, and no command line; there the add-on is an extension.
WHEEL = not bpy.app.binary_path
ADDON = "bl_ext.user_default.sfumato" if WHEEL else "sfumato"

# Before Blender 5.0 Mantaflow adds modules to a running Python, and from 3.12 on Python answers that with abort().
# Blender's own builds never pair the two; Debian 13 does. In a wheel Mantaflow cannot load its caches, and aborts at exit.
MANTAFLOW_ABORTS = WHEEL or (bpy.app.version < (5, 0) and sys.version_info >= (3, 12))

Test = Callable[[], "Generator[float | None, None, None] | None"]


class Skip(Exception):
    """Raised by a test that has nothing to test here; the message says why."""


def put(shader: Any, **values: Any) -> None:
    """Set inputs of a node, whose spaces are underscores here; a colour is three numbers."""
    for name, value in values.items():
        socket = shader.inputs[name.replace("_", " ")]
        socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value


def said() -> list[str]:
    """What of the scene is not shown as it is."""
    from sfumato.export import scene

    return list(scene.export(bpy.context.evaluated_depsgraph_get()).notices)


def black_world() -> bpy.types.World:
    """One that sends nothing. Since 5.0 new ones have a grey Background, whatever their colour; and without any world
    Cycles 5.0.1 shows no smoke."""
    world = bpy.data.worlds.new("Black")
    world.color = (0.0, 0.0, 0.0)
    if world.node_tree is not None:
        world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    return world


def main() -> None:
    """Run the tests of the calling file, print a line for each and the totals, and quit Blender."""
    tests = {name: value for name, value in vars(sys.modules["__main__"]).items() if name.startswith("test_")}
    steps = _run(tests)
    if bpy.app.background:
        for _ in steps:
            pass
    else:
        # persistent: tests open other files, which ends every other timer.
        bpy.app.timers.register(lambda: _step(steps), first_interval=0.5, persistent=True)


def drive(steps: Iterator[None]) -> None:
    """What a benchmark does: go on with it at every tick of Blender's timer, and quit when it ends."""

    def tick() -> float | None:
        if next(steps, "end") != "end":
            return 0.0
        _quit(failed=False)
        return None

    bpy.app.timers.register(tick, first_interval=0.5, persistent=True)


def enable() -> None:
    """Switch the add-on on, as after every reading of factory settings; its modules answer under `sfumato` in any case."""
    if addon_utils.enable(ADDON, default_set=True) is None:
        raise RuntimeError(f"{ADDON} cannot be enabled")
    for module in pkgutil.walk_packages(sys.modules[ADDON].__path__, f"{ADDON}."):
        sys.modules["sfumato" + module.name.removeprefix(ADDON)] = importlib.import_module(module.name)


def command(script: str | Path, blend: Path | None = None) -> list[str]:
    """What runs a script, a file or text that begins with `import`, in another process of this Blender."""
    if WHEEL:
        start = [sys.executable, str(Path(__file__).parent / "wheel" / "start.py"), str(script)]
        return start if blend is None else [*start, str(blend)]
    start = [bpy.app.binary_path, "-b", "--factory-startup", "--python-use-system-env", "--python-exit-code", "3"]
    file = [] if blend is None else [str(blend)]
    return [
        *start,
        *file,
        "--addons",
        "sfumato",
        "--python-expr" if str(script).startswith("import") else "--python",
        str(script),
    ]


def volume(path: Path | str = "") -> bpy.types.Object:
    """A Volume object of a file, alone in an empty scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    data = bpy.data.volumes.new("Smoke")
    data.filepath = str(path)
    thing = bpy.data.objects.new("Smoke", data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def shade(data: Any, kind: str, socket: str = "Surface") -> bpy.types.ShaderNode:
    """Give a mesh or a volume a new material of one shader node, which is the answer."""
    material = bpy.data.materials.new(data.name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs[socket])
    data.materials.append(material)
    return shader


def bake(folder: str, colours: Sequence[tuple[float, float, float]] = ((0.7, 0.7, 0.7),)) -> bpy.types.Object:
    """A few frames of smoke in the middle of an adaptive domain much larger than that: a puff of each colour."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    flows = []
    for number in range(len(colours)):
        bpy.ops.mesh.primitive_ico_sphere_add(radius=0.35, location=(0.1 + 0.5 * number, 0, 0.7))
        flows.append(bpy.context.object)
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1.4))
    domain = bpy.context.object
    for vertex in domain.data.vertices:
        vertex.co = (2.4 * vertex.co.x, 2.4 * vertex.co.y, 1.3 * vertex.co.z)
    settings = domain.modifiers.new("Fluid", "FLUID")
    settings.fluid_type = "DOMAIN"
    settings = settings.domain_settings
    settings.domain_type, settings.resolution_max, settings.use_adaptive_domain = "GAS", 32, True
    settings.cache_directory, settings.cache_type, settings.cache_frame_end = folder, "ALL", 4
    for thing, colour in zip(flows, colours):
        thing.hide_render = True
        flow = thing.modifiers.new("Fluid", "FLUID")
        flow.fluid_type = "FLOW"
        flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "SMOKE", "INFLOW"
        flow.flow_settings.smoke_color = colour
    for _ in range(2):
        try:
            bpy.context.view_layer.update()
        except SystemError:  # of Mantaflow's first evaluation
            continue
    with bpy.context.temp_override(object=domain, active_object=domain):
        bpy.ops.fluid.bake_all()
    scene.frame_set(4)
    return domain


def open_plume(frame: int = 25) -> bpy.types.Object:
    """Open the sample at a frame, and give back the object that is the smoke: its domain, or where Mantaflow aborts a
    Volume object that shows the same cache."""
    bpy.ops.wm.open_mainfile(filepath=str(plume_file()))
    bpy.context.scene.frame_set(frame)
    return bpy.context.scene.objects["Smoke Domain"]


def plume_file() -> Path:
    """The sample; where Mantaflow aborts, a copy in which a Volume object has the domain's place and name."""
    if not MANTAFLOW_ABORTS:
        return SAMPLE
    with bpy.data.libraries.load(str(SAMPLE)) as (_, wanted):
        wanted.scenes = ["Scene"]
    scene = wanted.scenes[0]
    domain = scene.objects["Smoke Domain"]
    for thing in scene.objects:
        thing.modifiers.clear()  # before anything evaluates the domain

    files = sorted((CACHE / "data").glob("fluid_data_*.vdb"))
    data = bpy.data.volumes.new("Smoke")
    data.filepath = str(files[0])
    if not data.grids.load():
        raise RuntimeError(f"{data.filepath}: {data.grids.error_message}")
    corner = domain.location + Vector(domain.bound_box[0])
    data.is_sequence = True
    data.frame_start, data.frame_duration = 1, len(files)
    data.materials.append(domain.active_material)
    bpy.data.objects.remove(domain)
    smoke = bpy.data.objects.new("Smoke Domain", data)
    smoke.location = corner
    smoke.display_type = "BOUNDS"  # Blender's own drawing of volumes jitters from redraw to redraw
    scene.collection.objects.link(smoke)

    path = Path(bpy.app.tempdir) / "plume_as_volume.blend"
    bpy.data.libraries.write(str(path), {scene})
    return path


def middle_of(smoke: bpy.types.Object) -> Vector:
    """The middle of what open_plume gave, in the world: a domain's own origin, but not a Volume object's."""
    return smoke.matrix_world @ (sum((Vector(corner) for corner in smoke.bound_box), Vector()) / 8.0)


def _step(steps: Iterator[float | None]) -> float | None:
    """One timer tick: go on with the tests, then ask for a redraw of everything."""
    said = next(steps, "end")
    if said == "end":
        return None
    if said is not None:
        return float(said)
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()
    return 0.0


def _run(tests: dict[str, Test]) -> Iterator[float | None]:
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for name, test in tests.items():
        started = time.perf_counter()
        reason = ""
        try:
            bpy.ops.wm.read_homefile(use_factory_startup=True)
            outcome = test()
            if isinstance(outcome, GeneratorType):
                yield from outcome
            result = "passed"
        except Skip as skip:
            result, reason = "skipped", f": {skip}"
        except Exception:  # whatever a test raises is its result
            traceback.print_exc()
            result = "failed"
        counts[result] += 1
        print(f"{result} {name} ({time.perf_counter() - started:.1f} s){reason}", flush=True)
    print(", ".join(f"{count} {result}" for result, count in counts.items()), flush=True)
    _quit(failed=counts["failed"] > 0)


def _quit(failed: bool) -> None:
    """Leave Blender; by its own way out unless that would lose the exit status."""
    sys.stdout.flush()
    sys.stderr.flush()
    if failed:
        os._exit(1)
    if not bpy.app.background:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.wm.quit_blender()
