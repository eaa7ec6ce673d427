# SPDX-License-Identifier: GPL-3.0-or-later
"""What a Volume object's settings, material and modifiers make of its file: as in Blender, or named."""

import shutil
import tempfile
from pathlib import Path

import bpy
import harness
import numpy as np
from sfumato.export import parts, scene, smoke

FRAMES = harness.ROOT / "blend_samples" / "frames"


def exported(thing: bpy.types.Object, notices: list[str] | None = None) -> smoke.Medium | None:
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrix = np.array(thing.matrix_world, float)
    said = [] if notices is None else notices
    media = smoke.media_of(thing.evaluated_get(depsgraph), matrix, depsgraph, parts.Parts(), said)
    return media[0] if media else None


def refusal(thing: bpy.types.Object) -> str:
    try:
        exported(thing)
    except ValueError as error:
        return str(error)
    raise AssertionError("nothing was refused")


def test_a_sequence_shows_what_its_mode_says_and_names_a_missing_file() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for number, name in ((3, "fire"), (4, "wisp"), (6, "fire")):
            shutil.copy(FRAMES / f"{name}.vdb", Path(folder) / f"smoke_{number:04d}.vdb")
        thing = harness.volume(Path(folder) / "smoke_0003.vdb")
        data = thing.data
        data.is_sequence, data.frame_start, data.frame_offset, data.frame_duration = True, 10, 2, 4

        def at(frame: int) -> smoke.Medium | None:
            bpy.context.scene.frame_set(frame)
            return exported(thing)

        fire, wisp = at(10), at(11)
        assert fire is not None and wisp is not None and fire.amount != wisp.amount
        bpy.context.scene.frame_set(12)
        assert "smoke_0005.vdb" in refusal(thing)
        last = at(13)
        assert last is not None and last.amount == fire.amount, "a missing file is no matter once it is past"
        assert data.sequence_mode == "CLIP" and at(9) is None and at(14) is None
        data.sequence_mode = "EXTEND"
        before, after = at(9), at(14)
        assert before is not None and after is not None and before.amount == after.amount == fire.amount


def test_without_a_material_it_is_a_principled_volume_as_it_comes() -> None:
    thing = harness.volume(FRAMES / "fire.vdb")
    medium = exported(thing)
    assert medium is not None
    assert np.allclose(medium.scattering, 0.5) and np.allclose(medium.absorption, 0.5)
    shader = harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume")
    assert exported(thing) is not None
    shader.mute = True
    assert exported(thing) is None, "a muted shader shows nothing"
    thing.data.materials[0].node_tree.nodes.clear()
    assert exported(thing) is None, "a material without a volume shader shows nothing"


def test_the_material_says_which_grid_is_its_density() -> None:
    thing = harness.volume(harness.ROOT / "blend_samples" / "plume_cache" / "data" / "fluid_data_0025.vdb")
    shader = harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume")
    assert exported(thing) is not None
    shader.inputs["Density Attribute"].default_value = "flame"
    assert "holds no smoke" in refusal(thing), "the plume does not burn"
    shader.inputs["Density Attribute"].default_value = "soot"
    assert "'soot'" in refusal(thing) and "'density'" in refusal(thing)


def test_density_is_a_unit_of_the_objects_own_space() -> None:
    """The length of (1, 1, 1) / sqrt 3 there: Cycles' own measure, however uneven the scale, turned or not."""
    for scale in ((1.0, 1.0, 1.0), (1.0, 1.0, 4.0), (3.0, 1.0, 1.0), (1.0, 1.0, 0.25)):
        thing = harness.volume(FRAMES / "fire.vdb")
        thing.scale, thing.rotation_euler = scale, (0.3, 0.2, 0.7)
        medium = exported(thing)
        assert medium is not None
        assert np.allclose(medium.scattering, 0.5 / np.sqrt(np.mean(np.square(scale))), rtol=1e-5)
        thing.data.render.space = "WORLD"
        medium = exported(thing)
        assert medium is not None and np.allclose(medium.scattering, 0.5)


def test_voxels_that_modifiers_make_are_shown() -> None:
    thing = harness.volume()
    assert "choose an OpenVDB file" in refusal(thing)
    mesh = bpy.data.meshes.new("Box")
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], faces)
    box = bpy.data.objects.new("Box", mesh)
    bpy.context.scene.collection.objects.link(box)
    made = thing.modifiers.new("Mesh to Volume", "MESH_TO_VOLUME")
    made.object, made.density, made.resolution_mode, made.voxel_size = box, 2.0, "VOXEL_SIZE", 0.1
    medium = exported(thing)
    assert medium is not None
    cell = abs(np.linalg.det(medium.grid_to_world[:3, :3]))
    held = medium.amount * cell
    # A box of 8 cubic metres, and what its faces cross (21.3 in 3.4.1), or less what fades inside (11.8 in 5.0.1).
    assert 2.0 * 1.7**3 <= held <= 2.0 * 2.3**3, held
    made.density = 4.0
    denser = exported(thing)
    assert denser is not None and abs(denser.amount - 2.0 * medium.amount) < 1e-3 * denser.amount


def test_voxels_that_nodes_make_are_shown() -> None:
    """On a Volume object, and on a mesh, where they come as an instance without a file."""
    thing = harness.volume()
    mesh = bpy.data.objects.new("Mesh", bpy.data.meshes.new("Mesh"))
    bpy.context.scene.collection.objects.link(mesh)
    group = bpy.data.node_groups.new("Cube", "GeometryNodeTree")
    if hasattr(group, "interface"):  # 4.0
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        group.outputs.new("NodeSocketGeometry", "Geometry")
    cube, output = group.nodes.new("GeometryNodeVolumeCube"), group.nodes.new("NodeGroupOutput")
    cube.inputs["Density"].default_value = 2.0
    group.links.new(cube.outputs[0], output.inputs[0])
    for made_by in (thing, mesh):
        made_by.modifiers.new("Nodes", "NODES").node_group = group
        bpy.context.view_layer.update()
        frame = scene.frame_of(bpy.context.evaluated_depsgraph_get(), "test")
        (body,) = frame.media
        assert body.density.sum() == 2.0 * 32**3, (made_by.name, body.density.sum())
        made_by.modifiers.clear()


def test_a_modifier_on_a_file_is_followed() -> None:
    thing = harness.volume(FRAMES / "fire.vdb")
    plain = exported(thing)
    moved = thing.modifiers.new("Displace", "VOLUME_DISPLACE")
    texture = bpy.data.textures.new("Noise", "CLOUDS")
    texture.noise_scale = 0.1
    moved.texture, moved.strength = texture, 0.4
    displaced = exported(thing)
    assert plain is not None and displaced is not None
    assert displaced.grid.cells != plain.grid.cells
    assert abs(displaced.amount - plain.amount) < 0.05 * plain.amount, "it is moved, not made more"


def test_clipping_is_named() -> None:
    thing = harness.volume(FRAMES / "fire.vdb")
    notices: list[str] = []
    exported(thing, notices)
    assert not notices
    thing.data.render.clipping = 0.2
    exported(thing, notices)
    assert any("Clipping of 0.2" in notice for notice in notices)


harness.main()
