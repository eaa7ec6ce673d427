# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume objects: what their files hold is taken once, and again where a file has changed."""

import shutil
import tempfile
from pathlib import Path

import bpy
import harness
import numpy as np
from sfumato import core  # type: ignore[attr-defined]
from sfumato.export import parts, smoke

FRAMES = harness.ROOT / "blend_samples" / "frames"


def volume(path: Path) -> bpy.types.Object:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    data = bpy.data.volumes.new("Smoke")
    data.filepath = str(path)
    thing = bpy.data.objects.new("Smoke", data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def exported(thing: bpy.types.Object, kept: parts.Parts) -> smoke.Medium:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = thing.evaluated_get(depsgraph)
    medium = smoke.medium_of(evaluated, np.array(thing.matrix_world, float), depsgraph, kept, [])
    assert medium is not None
    kept.end_export()
    return medium


def test_a_file_is_read_where_the_array_of_it_lies() -> None:
    path = FRAMES / "fire.vdb"
    medium = exported(volume(path), parts.Parts())
    density, grid_to_object = core.module().read_volume(str(path))
    grid_to_object[:3, 3] += grid_to_object[:3, :3] @ np.full(3, 0.5)
    assert np.array_equal(medium.grid_to_world, grid_to_object)
    assert abs(medium.amount - density.sum()) < 1e-3 * density.sum()


def test_a_file_is_read_again_where_it_has_changed_alone() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "smoke.vdb"
        shutil.copy(FRAMES / "fire.vdb", path)
        thing, kept = volume(path), parts.Parts()
        first = exported(thing, kept)
        thing.location.x = 2.0
        bpy.context.view_layer.update()
        moved = exported(thing, kept)
        assert moved.grid is first.grid
        assert moved.grid_to_world[0, 3] == first.grid_to_world[0, 3] + 2.0
        shutil.copy(FRAMES / "wisp.vdb", path)
        changed = exported(thing, kept)
        assert changed.grid is not first.grid
        assert changed.amount != first.amount


harness.main()
