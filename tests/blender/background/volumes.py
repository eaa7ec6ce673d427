# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume objects: what their files hold is taken once, and again where a file has changed."""

import shutil
import tempfile
from pathlib import Path

import bpy
import harness
import numpy as np
import pictures
from sfumato import compat, core  # type: ignore[attr-defined]
from sfumato.export import parts, smoke

FRAMES = harness.ROOT / "blend_samples" / "frames"


def exported(thing: bpy.types.Object, kept: parts.Parts) -> smoke.Medium:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = thing.evaluated_get(depsgraph)
    media = smoke.media_of(evaluated, np.array(thing.matrix_world, float), depsgraph, kept, [])
    assert media is not None and len(media) == 1
    kept.end_export()
    return media[0]


def test_a_file_is_read_where_the_array_of_it_lies() -> None:
    path = FRAMES / "fire.vdb"
    medium = exported(harness.volume(path), parts.Parts())
    density, grid_to_object = core.module().read_volume(str(path))
    grid_to_object[:3, 3] += grid_to_object[:3, :3] @ np.full(3, compat.sample_place())
    assert np.array_equal(medium.grid_to_world, grid_to_object)
    assert abs(medium.amount - density.sum()) < 1e-3 * density.sum()


def test_a_file_is_read_again_where_it_has_changed_alone() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "smoke.vdb"
        shutil.copy(FRAMES / "fire.vdb", path)
        thing, kept = harness.volume(path), parts.Parts()
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


def middle(engine: str, across: float) -> np.ndarray:
    """The middle of what shines in a picture that is `across` metres wide and high, in metres from its own middle."""
    light: np.ndarray = pictures.render((96, 96), engine)[..., 0].astype(np.float64)
    if light.max() == 0.0:
        raise harness.Skip(f"{engine} of this Blender shows no smoke")
    places = ((np.arange(96) + 0.5) / 96 - 0.5) * across
    return np.array([(light.sum(axis=0) * places).sum(), (light.sum(axis=1) * places).sum()]) / light.sum()


def test_samples_are_where_cycles_has_them() -> None:
    """Seen from above, in a sun from there. Cycles to 4.5 has each half a cell further on than from 5.0 on."""
    path = FRAMES / "fire.vdb"
    thing = harness.volume(path)
    shape, to_object = core.module().volume_header(str(path))
    cell = float(np.linalg.norm(to_object[:3, 0]))
    across = 1.2 * max(shape[1:]) * cell
    harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume")
    corner = to_object @ [shape[2] / 2.0, shape[1] / 2.0, shape[0] / 2.0, 1.0]
    scene, camera, sun = bpy.context.scene, bpy.data.cameras.new("Camera"), bpy.data.lights.new("Sun", "SUN")
    camera.type, camera.ortho_scale = "ORTHO", across
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (corner[0], corner[1], corner[2] + across)
    for made in (scene.camera, bpy.data.objects.new("Sun", sun)):
        scene.collection.objects.link(made)
    scene.world = bpy.data.worlds.new("Black")  # without one, Cycles 5.0.1 shows no smoke
    scene.world.color = (0.0, 0.0, 0.0)
    if scene.world.node_tree is not None:
        scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.render.resolution_percentage = 100
    cycles = scene.cycles
    cycles.samples, cycles.seed, cycles.max_bounces, cycles.volume_bounces = 64, 1, 0, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    theirs, ours = middle("CYCLES", across), middle("SFUMATO", across)
    print(f"  {(ours - theirs) / cell} cells")
    assert np.abs(ours - theirs).max() < 0.1 * cell, (ours / cell, theirs / cell)


harness.main()
