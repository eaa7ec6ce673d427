# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with identity, inside Blender: whatever is edited, the next export is what a fresh one would be.

Blender's own notes of what has changed are handed to Parts here as the interface's handlers do, so that a change which
Blender does not tell, or which we miss, shows as a wrong picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import harness
import numpy as np
import sfumato
from mathutils import Matrix
from sfumato import core  # type: ignore[attr-defined]
from sfumato.export import parts, scene

SIZE = 48, 32
Edit = Callable[[], None]


def camera() -> Any:
    """Sees all of the scene."""
    view = Matrix.LocRotScale((7.0, -6.5, 5.5), bpy.data.objects["Camera"].rotation_euler, None).inverted()
    projection = bpy.data.objects["Camera"].calc_matrix_camera(
        bpy.context.evaluated_depsgraph_get(), x=SIZE[0], y=SIZE[1]
    )
    return sfumato.Camera(np.array(projection @ view))


def picture(kept: parts.Parts | None) -> np.ndarray:
    exported = scene.export(bpy.context.evaluated_depsgraph_get(), kept).scene
    prepared = None if kept is None else kept.native
    frame = sfumato.Frame(exported, light_samples=1, prepared=prepared)
    return np.asarray(frame.render(camera(), *SIZE, edge_samples=1))


def mesh_object(name: str, mesh: bpy.types.Mesh, location: tuple[float, float, float]) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, mesh)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def prepare() -> None:
    """A floor, a cube with two materials and a modifier, linked copies, an instanced collection, a curve, lamps."""
    lamp = bpy.data.objects["Light"]
    lamp.data.energy = 500.0
    cube = bpy.data.objects["Cube"]
    cube.data.materials.append(bpy.data.materials.new("Second"))
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0.0, 0.0, -1.0))
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(-2.5, 0.0, 0.0))
    ball = bpy.context.object
    ball.name = "Ball"
    bevel = ball.modifiers.new("Smooth", "SUBSURF")
    bevel.levels = 1
    for number in range(3):
        mesh_object(f"Copy {number}", cube.data, (2.5, 2.0 * number - 2.0, 0.0)).scale = (0.4, 0.4, 0.4)
    group = bpy.data.collections.new("Group")
    inside = bpy.data.objects.new("Inside", ball.data)
    group.objects.link(inside)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", group
    instance.location = (0.0, 3.0, 0.5)
    bpy.context.scene.collection.objects.link(instance)
    bpy.ops.curve.primitive_bezier_circle_add(location=(0.0, -3.0, 0.0))
    bpy.context.object.name = "Ring"
    bpy.context.object.data.bevel_depth = 0.2
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (0.5, 0.2, 0.0)
    bpy.context.scene.collection.objects.link(sun)


def edits() -> list[tuple[str, Edit]]:
    data, things = bpy.data, bpy.data.objects

    def raw_positions() -> None:
        """As a script that forgets update(): the next evaluation may or may not see it; both exports must agree."""
        mesh = things["Ball"].data
        values = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", values)
        mesh.vertices.foreach_set("co", values * 1.1)

    def new_mesh_in_place_of_a_deleted() -> None:
        """Its address may well be the deleted one's."""
        data.meshes.remove(data.meshes.new("Spare"))
        victim = things["Copy 0"]
        data.objects.remove(victim)
        mesh = data.meshes.new("New")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 1)], [], [(0, 1, 2)])
        mesh_object("New", mesh, (2.5, -2.0, 0.5))

    def swap_data() -> None:
        things["Copy 1"].data = things["Ball"].data

    def own_material() -> None:
        slot = things["Copy 2"].material_slots[0]
        slot.link = "OBJECT"
        slot.material = data.materials.new("Own")
        slot.material.diffuse_color = (0.9, 0.1, 0.1, 1.0)

    def shape_key() -> None:
        cube = things["Cube"]
        cube.shape_key_add(name="Basis")
        cube.shape_key_add(name="Wide").data[0].co.x = -3.0

    def key_value() -> None:
        things["Cube"].data.shape_keys.key_blocks["Wide"].value = 0.7

    def lattice() -> None:
        cage = data.objects.new("Cage", data.lattices.new("Cage"))
        bpy.context.scene.collection.objects.link(cage)
        things["Ball"].modifiers.new("Cage", "LATTICE").object = cage

    def nodes(colour: tuple[float, float, float]) -> Edit:
        def edit() -> None:
            things["Cube"].data.materials[0].node_tree.nodes["Principled BSDF"].inputs[0].default_value = (*colour, 1.0)

        return edit

    def set_on(owner: Callable[[], Any], name: str, value: Any) -> Edit:
        return lambda: setattr(owner(), name, value)

    def polygon(number: int, name: str, value: Any) -> Edit:
        def edit() -> None:
            mesh = things["Cube"].data
            setattr(mesh.polygons[number], name, value)
            mesh.update()

        return edit

    def layer_collection() -> Any:
        return bpy.context.view_layer.layer_collection.children[0]

    def override() -> None:
        bpy.context.view_layer.material_override = data.materials.new("Override")
        data.materials["Override"].diffuse_color = (0.2, 0.4, 0.1, 1.0)

    def vertex() -> None:
        things["Cube"].data.vertices[0].co.z = 2.0
        things["Cube"].data.update()

    return [
        ("nothing", lambda: None),
        ("a lamp turned", set_on(lambda: things["Sun"], "rotation_euler", (0.6, 0.2, 0.0))),
        ("a lamp's energy", set_on(lambda: things["Sun"].data, "energy", 2.0)),
        ("a lamp's angle", set_on(lambda: things["Sun"].data, "angle", 0.2)),
        ("a lamp's kind", set_on(lambda: things["Light"].data, "type", "SPOT")),
        ("an object moved", set_on(lambda: things["Cube"], "location", (0.3, 0.2, 0.4))),
        ("an object scaled", set_on(lambda: things["Ball"], "scale", (1.0, -0.5, 2.0))),
        ("an instance moved", set_on(lambda: things["Instance"], "location", (0.5, 3.0, 0.0))),
        ("a material's colour", nodes((0.9, 0.2, 0.1))),
        ("a vertex", vertex),
        ("a polygon's smoothness", polygon(0, "use_smooth", True)),
        ("a polygon's material", polygon(1, "material_index", 1)),
        ("a modifier's level", set_on(lambda: things["Ball"].modifiers[0], "levels", 2)),
        ("a modifier hidden", set_on(lambda: things["Ball"].modifiers[0], "show_viewport", False)),
        ("a modifier shown", set_on(lambda: things["Ball"].modifiers[0], "show_viewport", True)),
        ("a lattice", lattice),
        ("a lattice's point", lambda: setattr(things["Cage"].data.points[0], "co_deform", (-1.5, -0.5, -0.5))),
        ("a lattice moved", set_on(lambda: things["Cage"], "location", (0.2, 0.0, 0.0))),
        ("a curve's thickness", set_on(lambda: things["Ring"].data, "bevel_depth", 0.4)),
        ("a shape key", shape_key),
        ("a shape key's value", key_value),
        ("other data", swap_data),
        ("a material of its own", own_material),
        ("an object hidden", set_on(lambda: things["Ring"], "hide_viewport", True)),
        ("an object shown", set_on(lambda: things["Ring"], "hide_viewport", False)),
        ("a deleted object, another in its place", new_mesh_in_place_of_a_deleted),
        ("data transformed", lambda: things["Ball"].data.transform(Matrix.Rotation(0.5, 4, "X"))),
        ("positions written without a word", raw_positions),
        ("simplification", set_on(lambda: bpy.context.scene.render, "use_simplify", True)),
        ("its level", set_on(lambda: bpy.context.scene.render, "simplify_subdivision", 0)),
        ("not for the camera", set_on(lambda: things["Ball"], "visible_camera", False)),
        ("seen again", set_on(lambda: things["Ball"], "visible_camera", True)),
        ("no shadow", set_on(lambda: things["Ball"], "visible_shadow", False)),
        ("its shadow again", set_on(lambda: things["Ball"], "visible_shadow", True)),
        ("a holdout", set_on(lambda: things["Cube"], "is_holdout", True)),
        ("no holdout", set_on(lambda: things["Cube"], "is_holdout", False)),
        ("a shadow catcher", set_on(lambda: things["Plane"], "is_shadow_catcher", True)),
        ("no shadow catcher", set_on(lambda: things["Plane"], "is_shadow_catcher", False)),
        ("a collection held out", set_on(layer_collection, "holdout", True)),
        ("a collection shown", set_on(layer_collection, "holdout", False)),
        ("a collection unseen", set_on(layer_collection, "indirect_only", True)),
        ("a collection seen", set_on(layer_collection, "indirect_only", False)),
        ("a lamp not diffuse", set_on(lambda: things["Sun"], "visible_diffuse", False)),
        ("a lamp diffuse again", set_on(lambda: things["Sun"], "visible_diffuse", True)),
        ("another material for all", override),
        ("no surfaces", set_on(lambda: bpy.context.view_layer, "use_solid", False)),
        ("surfaces again", set_on(lambda: bpy.context.view_layer, "use_solid", True)),
        ("another frame", lambda: bpy.context.scene.frame_set(7)),
    ]


def test_every_edit_is_followed() -> None:
    prepare()
    kept = parts.Parts(told=True)
    handlers = bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post

    def note(_scene: Any, depsgraph: Any) -> None:
        kept.note(depsgraph.updates)

    for handler in handlers:
        handler.append(note)
    try:
        last = picture(kept)
        assert last[..., :3].max() > 0.05
        changed = []
        for name, edit in edits():
            edit()
            bpy.context.view_layer.update()
            seen, fresh = picture(kept), picture(None)
            assert np.abs(seen - fresh).max() <= 1e-6, f"after {name} a kept part is out of date"
            if np.abs(fresh - last).max() > 1e-4:
                changed.append(name)
            last = fresh
        print(f"  {len(changed)} edits are seen")
        assert len(changed) >= 38, changed  # else the pictures prove nothing
    finally:
        for handler in handlers:
            handler.remove(note)


def test_unchanged_meshes_are_not_read() -> None:
    prepare()
    kept = parts.Parts(told=True)
    picture(kept)
    made = kept.native.made
    bpy.data.objects["Sun"].rotation_euler.x += math.radians(1.0)
    bpy.context.view_layer.update()
    calls: list[str] = []
    read = scene.meshes.triangles_of

    def counted(thing: Any, *rest: Any) -> Any:
        calls.append(thing.name)
        return read(thing, *rest)

    scene.meshes.triangles_of = counted
    try:
        picture(kept)
    finally:
        scene.meshes.triangles_of = read
    assert set(calls) == {"Ring"}, calls  # a mesh of a curve is new for each reader
    assert kept.native.made["meshes"] == made["meshes"] and kept.native.made["places"] == made["places"]


def test_copies_share_one_mesh() -> None:
    prepare()
    kept = parts.Parts()
    module = core.module()
    original, made = module.Mesh, []

    def counted(*arrays: Any) -> Any:
        made.append(original(*arrays))
        return made[-1]

    module.Mesh = counted
    try:
        picture(kept)
    finally:
        module.Mesh = original
    # The floor, the cube and its copies, the ball with its modifier, the ball in the collection without, the ring.
    assert len(made) == 5, made
    assert kept.native.made["meshes"] == 1, kept.native.made  # what stands in one place is no instance


def test_undo_is_followed() -> None:
    prepare()
    kept = parts.Parts(told=True)
    bpy.ops.ed.undo_push(message="before")
    before = picture(kept)
    bpy.data.objects["Ball"].data.transform(Matrix.Scale(2.0, 4))
    bpy.context.view_layer.update()
    kept.note(bpy.context.evaluated_depsgraph_get().updates)
    bpy.ops.ed.undo_push(message="after")
    after = picture(kept)
    assert np.abs(after - before).max() > 1e-3
    for step, expected in ((bpy.ops.ed.undo, before), (bpy.ops.ed.redo, after)):
        step()
        kept.forget_owners()  # as the handlers do
        seen = picture(kept)
        assert np.abs(seen - picture(None)).max() <= 1e-6 and np.abs(seen - expected).max() <= 1e-6


def test_renders_keep_their_parts_where_the_scene_keeps_its_data() -> None:
    render = bpy.context.scene.render
    render.use_persistent_data = False
    assert parts.of_render(bpy.context.scene) is not parts.of_render(bpy.context.scene)
    render.use_persistent_data = True
    kept = parts.of_render(bpy.context.scene)
    assert parts.of_render(bpy.context.scene) is kept
    render.threads_mode, render.threads = "FIXED", 1
    assert parts.of_render(bpy.context.scene).threads == 1
    parts.free()


harness.main()
