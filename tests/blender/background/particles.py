# SPDX-License-Identifier: GPL-3.0-or-later
"""Particles that render as Halo, and point clouds: where Blender has them, as large, and as their materials say."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import bpy
import harness
import numpy as np
import pictures
import points
from numpy.typing import NDArray
from sfumato import core, log  # type: ignore[attr-defined]
from sfumato.export import particles
from sfumato.export import scene as export

Floats = NDArray[np.float64]
TINY = (16, 16)


@dataclass
class Added:
    """What Scene.add_particles was given."""

    points: Floats
    radius: Floats
    opacity: Floats
    albedo: Floats
    extinction: Floats
    anisotropy: float
    visibility: Any


@contextlib.contextmanager
def recorded() -> Iterator[list[Added]]:
    """What is added meanwhile, in the world's own space."""
    native = core.module().Scene
    before, place = native.add_particles, native.set_origin
    found: list[Added] = []
    origin = np.zeros(3)

    def set_origin(scene: Any, where: Floats) -> None:
        origin[:] = where
        place(scene, where)

    def add(scene: Any, points: Any, *rest: Any, visibility: Any = None) -> None:
        *arrays, anisotropy = rest
        radius, opacity, albedo, extinction = (np.array(values, dtype=np.float64) for values in arrays)
        found.append(Added(points + origin, radius, opacity, albedo, extinction, anisotropy, visibility))
        before(scene, points, *rest, visibility=visibility)

    native.add_particles, native.set_origin = add, set_origin
    try:
        yield found
    finally:
        native.add_particles, native.set_origin = before, place


def in_view() -> tuple[list[Added], list[str]]:
    """What a view is given, and told."""
    bpy.context.view_layer.update()
    with recorded() as found:
        return found, export.export(bpy.context.evaluated_depsgraph_get()).notices


def in_render() -> list[Added]:
    with recorded() as found:
        pictures.render(TINY)
    return found


def emitter(**values: Any) -> tuple[bpy.types.Object, bpy.types.ParticleSettings]:
    """The cube of an otherwise empty scene, which emits 200 particles in 40 frames, and its settings."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    harness.enable()
    cube = bpy.data.objects["Cube"]
    settings = cube.modifiers.new("Puff", "PARTICLE_SYSTEM").particle_system.settings
    settings.name = "Puff"
    settings.count, settings.frame_end, settings.lifetime, settings.size_random = 200, 40, 15, 0.5
    for name, value in values.items():
        setattr(settings, name, value)
    bpy.context.scene.render.resolution_percentage = 100
    return cube, settings


def play_to(frame: int) -> None:
    for number in range(1, frame + 1):
        bpy.context.scene.frame_set(number)


def as_objects(settings: bpy.types.ParticleSettings) -> Floats:
    """Places and sizes, (n, 4), that Blender gives objects in the particles' stead."""
    ball = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
    bpy.context.scene.collection.objects.link(ball)
    settings.instance_object, settings.render_type = ball, "OBJECT"
    found = []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance and instance.object.name == ball.name:
            found.append((*instance.matrix_world.translation, instance.matrix_world.to_scale()[0]))
    settings.render_type, settings.instance_object = "HALO", None
    bpy.data.objects.remove(ball)
    return np.array(found, dtype=np.float64).reshape(-1, 4)


def assert_same(added: Added, rows: Floats, factor: float) -> None:
    """That puffs are where others are, (n, 4) with their sizes, in whatever order."""
    ours = np.column_stack((added.points, added.radius / factor))
    assert len(ours) == len(rows), (len(ours), len(rows))
    ours, rows = (each[np.lexsort(each.round(3).T)] for each in (ours, rows))
    assert np.abs(ours - rows).max() < 1e-4, np.abs(ours - rows).max()


def test_they_are_where_blender_has_them_and_as_large() -> None:
    cases: tuple[dict[str, Any], ...] = (
        {},
        {"display_percentage": 30},
        {"show_unborn": True},
        {"use_dead": True},
        {"physics_type": "NO"},
        {"physics_type": "BOIDS"},
    )
    counts = set()
    for values in cases:
        _, settings = emitter(**values)
        factor = settings.sfumato.size
        play_to(30)
        rows = as_objects(settings)
        (added,), _ = in_view()
        assert_same(added, rows, factor)
        assert np.ptp(added.radius) > 0.2 * added.radius.max()
        counts.add(len(rows))
    assert len(counts) > 3, counts


def test_a_render_has_all_of_which_a_view_has_a_share() -> None:
    # Without physics: those that a view does not show Blender does not move in it, and a render takes them from there.
    _, settings = emitter(display_percentage=30, physics_type="NO")
    play_to(30)
    (some,), _ = in_view()
    (rendered,) = in_render()
    settings.display_percentage = 100
    play_to(30)
    (every,), _ = in_view()
    assert len(some.radius) < 0.6 * len(every.radius)
    assert_same(rendered, np.column_stack((every.points, every.radius)), 1.0)


def test_they_move_with_the_frame() -> None:
    _, settings = emitter(lifetime=100, frame_end=1)
    tops = []
    for frame in (5, 15):
        play_to(frame)
        (added,), _ = in_view()
        assert len(added.radius) == settings.count
        tops.append(added.points[:, 2].mean())
    assert tops[1] < tops[0] - 0.5, "they fall"


def test_instanced_and_parented_emitters() -> None:
    cube, settings = emitter(physics_type="NO", frame_end=1, lifetime=100)
    cube.scale = (1.5, 1.0, 0.5)
    group = bpy.data.collections.new("Group")
    bpy.context.scene.collection.children.link(group)
    cube.users_collection[0].objects.unlink(cube)
    group.objects.link(cube)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    cube.parent, parent.location = parent, (0.0, 0.0, 3.0)
    place = bpy.data.objects.new("Place", None)
    place.instance_type, place.instance_collection = "COLLECTION", group
    place.location, place.rotation_euler, place.scale = (7.0, 1.0, 0.0), (0.3, 0.4, 0.5), (2.0, 2.0, 2.0)
    bpy.context.scene.collection.objects.link(place)
    bpy.context.scene.frame_set(2)
    rows = as_objects(settings)
    assert len(rows) == 400
    (added,), notices = in_view()
    assert_same(added, rows, settings.sfumato.size)
    assert not any("scale" in line for line in notices), notices
    place.scale = (2.0, 1.0, 1.0)
    (added,), notices = in_view()
    assert len(added.radius) == 400
    assert sum("round" in line for line in notices) == 1, notices


def test_what_hides_an_emitter_hides_its_particles_as_in_blender() -> None:
    cube, settings = emitter(frame_end=1, lifetime=100)
    play_to(2)
    cube.show_instancer_for_viewport = False
    (added,), _ = in_view()
    assert len(added.radius) == 200, "the emitter alone is hidden"
    cube.modifiers["Puff"].show_viewport = False
    assert in_view()[0] == []
    cube.modifiers["Puff"].show_viewport = True
    settings.sfumato.shown = False
    assert in_view()[0] == []
    settings.sfumato.shown = True
    for kind in ("NONE", "LINE", "PATH"):
        settings.render_type = kind
        assert in_view()[0] == [], kind
    settings.render_type = "HALO"
    cube.hide_viewport = True
    assert in_view()[0] == []


def test_particles_that_render_as_objects_are_those_alone() -> None:
    _, settings = emitter(frame_end=1, lifetime=100)
    play_to(2)
    ball = bpy.data.objects.new("Ball", bpy.data.objects["Cube"].data.copy())
    bpy.context.scene.collection.objects.link(ball)
    ball.hide_viewport = False
    settings.instance_object, settings.render_type = ball, "OBJECT"
    native, places = core.module().Scene, []
    before = native.add_instances

    def add(scene: Any, mesh: Any, matrices: Any, *rest: Any, **named: Any) -> None:
        places.append(len(matrices))
        before(scene, mesh, matrices, *rest, **named)

    native.add_instances = add
    try:
        assert in_view()[0] == []
    finally:
        native.add_instances = before
    assert sorted(places) == [1, 201], "the emitter, and the ball with its instances"


def shaded(kind: str, socket: str = "Volume", **values: Any) -> bpy.types.Material:
    """A material of one shader node."""
    mesh = bpy.data.meshes.new(kind)
    shader = harness.shade(mesh, f"ShaderNode{kind}", socket)
    for name, value in values.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    return mesh.materials[0]


def only_look(kind: str = "", socket: str = "Volume", **values: Any) -> tuple[Added, list[str]]:
    """How 200 particles of radius .05 look with a material of one shader, or without any."""
    cube, settings = emitter(frame_end=1, lifetime=100, size_random=0.0)
    settings.sfumato.size, settings.sfumato.color = 1.0, (0.1, 0.2, 0.3)
    settings.sfumato.opacity, settings.sfumato.anisotropy = 0.25, 0.4
    cube.data.materials.clear()
    if kind:
        cube.data.materials.append(shaded(kind, socket, **values))
    bpy.context.scene.frame_set(2)
    found, notices = in_view()
    assert len(found) == 1, found
    assert np.allclose(found[0].radius, 0.05)
    return found[0], notices


def through(sigma: float, radius: float = 0.05) -> float:
    """What a puff takes through its middle, of the integral of 1 - (r / radius)^2 along that."""
    return 1.0 - math.exp(-sigma * sum(1.0 - (2.0 * (k + 0.5) / 1000 - 1.0) ** 2 for k in range(1000)) * radius / 500.0)


def test_a_material_without_a_say_leaves_it_to_the_panel() -> None:
    for kind in ("", "BsdfDiffuse"):
        added, notices = only_look(kind, "Surface")
        assert np.allclose(added.albedo, (0.1, 0.2, 0.3)) and np.allclose(added.opacity, 0.25)
        assert np.isclose(added.anisotropy, 0.4) and np.allclose(added.extinction, 1.0)
        assert not any(line.startswith("Cube: ") for line in notices), notices


def test_a_volume_says_how_puffs_look() -> None:
    grey: dict[str, Any] = {"Density": 30.0, "Anisotropy": 0.2}
    added, _ = only_look("VolumePrincipled", Color=(0.9, 0.9, 0.9, 1.0), **grey)
    # Principled Volume scatters its colour, and what that leaves of 1 it absorbs where Absorption Color is black.
    assert np.allclose(added.albedo, 0.9) and np.allclose(added.opacity, through(30.0), atol=1e-5)
    assert np.isclose(added.anisotropy, 0.2) and np.allclose(added.extinction, 1.0)
    added, _ = only_look("VolumeScatter", Color=(0.8, 0.4, 0.2, 1.0), **grey)
    assert np.allclose(added.albedo, 1.0) and np.allclose(added.extinction, (1.0, 0.5, 0.25))
    assert np.allclose(added.opacity, through(24.0), atol=1e-5)
    added, _ = only_look("VolumeAbsorption", Color=(0.5, 0.75, 1.0, 1.0), Density=30.0)
    assert np.allclose(added.albedo, 0.0) and np.allclose(added.extinction, (1.0, 0.5, 0.0))
    assert np.allclose(added.opacity, through(15.0), atol=1e-5)
    added, notices = only_look("VolumePrincipled", Density_Attribute="heat")
    assert sum("'heat'" in line for line in notices) == 1, notices


def test_a_surface_that_is_seen_through_says_how_puffs_look() -> None:
    """Through both sides of a sphere."""
    added, _ = only_look("BsdfPrincipled", "Surface", Alpha=0.4, Base_Color=(0.7, 0.5, 0.3, 1.0))
    assert np.allclose(added.opacity, 1.0 - 0.6**2) and np.allclose(added.albedo, (0.7, 0.5, 0.3))
    assert np.allclose(added.extinction, 1.0)
    added, _ = only_look("BsdfTransparent", "Surface", Color=(0.25, 0.5, 1.0, 1.0))
    assert np.allclose(added.opacity, 1.0 - 0.25**2) and np.allclose(added.albedo, 0.0)
    assert np.allclose(added.extinction, (1.0, 0.5, 0.0))
    cloud(lambda: shaded("BsdfPrincipled", "Surface", Alpha=0.4, Base_Color=(0.7, 0.5, 0.3, 1.0)), 3, 0.2)
    (added,), notices = in_view()
    assert np.allclose(added.opacity, 1.0 - 0.6**2) and np.allclose(added.albedo, (0.7, 0.5, 0.3))
    assert sum("seen through" in line for line in notices) == 1, notices


def cloud(
    material: Callable[[], bpy.types.Material] | None, count: int, radius: float, instances: bool = False
) -> bpy.types.Object:
    """Alone in a scene, a square of count x count points; or instances of it at the corners of a cube of 6 metres."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=count - 1, y_subdivisions=count - 1, size=2.0)
    thing = bpy.context.object
    thing.name = "Cloud"
    points.make_points_of(thing, radius, None if material is None else material(), 6.0 if instances else 0.0)
    return thing


def smoky() -> bpy.types.Material:
    return shaded("VolumePrincipled", Color=(0.9, 0.9, 0.9, 1.0), Density=10.0)


def test_a_cloud_with_a_volume_is_puffs() -> None:
    thing = cloud(smoky, 5, 0.2)
    thing.location, thing.scale = (1.0, 2.0, 3.0), (2.0, 2.0, 2.0)
    (added,), notices = in_view()
    corners = np.array([vertex.co for vertex in thing.data.vertices]) * 2.0 + (1.0, 2.0, 3.0)
    assert_same(added, np.column_stack((corners, np.full(25, 0.4))), 1.0)
    assert np.allclose(added.opacity, through(10.0, 0.4), atol=1e-5) and np.allclose(added.albedo, 0.9)
    assert not any(line.startswith("Cloud: ") for line in notices), notices


def test_instances_of_a_cloud_are_one_body() -> None:
    thing = cloud(smoky, 3, 0.1, instances=True)
    (added,), _ = in_view()
    corners = np.array([vertex.co for vertex in thing.data.vertices])
    every = [corners + np.array((x, y, z)) for x in (-3, 3) for y in (-3, 3) for z in (-3, 3)]
    assert_same(added, np.column_stack((np.concatenate(every), np.full(72, 0.1))), 1.0)


def light() -> None:
    """A sun from the side and above, and a camera that looks down on the middle of a cloud."""
    scene, sun, data = bpy.context.scene, bpy.data.lights.new("Sun", "SUN"), bpy.data.cameras.new("Camera")
    sun.energy, sun.angle = 3.0, 0.0
    data.type, data.ortho_scale = "ORTHO", 3.0
    for name, made, turned in (("Sun", sun, (0.5, 0.6, 0.0)), ("Camera", data, (0.4, 0.0, 0.0))):
        thing = bpy.data.objects.new(name, made)
        thing.rotation_euler = turned
        scene.collection.objects.link(thing)
    scene.camera = bpy.data.objects["Camera"]
    scene.camera.location = (0.0, -5.0 * math.sin(0.4), 5.0 * math.cos(0.4))
    scene.world = harness.black_world()
    scene.render.resolution_percentage = 100


def red() -> bpy.types.Material:
    return shaded("BsdfDiffuse", "Surface", Color=(0.7, 0.2, 0.1, 1.0))


def test_opaque_points_are_spheres_as_in_cycles() -> None:
    thing = cloud(red, 4, 0.25)
    thing.scale, thing.rotation_euler = (1.2, 1.2, 1.2), (0.1, 0.2, 0.3)
    light()
    assert in_view()[0] == []
    assert pictures.error_beside_cycles("opaque points", (64, 64), 64, side=2) < 0.03
    assert not log.notices(), log.notices()
    thing.scale = (1.0, 0.6, 1.4)
    _, notices = in_view()
    assert sum("uneven" in line for line in notices) == 1, notices


def test_more_opaque_points_than_there_are_spheres_for_are_puffs() -> None:
    cloud(red, 4, 0.25)
    most, particles.MOST_SPHERES = particles.MOST_SPHERES, 15
    try:
        (added,), notices = in_view()
    finally:
        particles.MOST_SPHERES = most
    assert np.allclose(added.albedo, (0.7, 0.2, 0.1)) and np.allclose(added.opacity, 1.0)
    assert sum("16 points" in line and "15" in line for line in notices) == 1, notices


def glowing() -> bpy.types.Material:
    return shaded("Emission", "Surface", Strength=2.0)


def test_points_that_glow_are_seen_but_light_nothing() -> None:
    cloud(glowing, 2, 0.25)
    light()
    bpy.data.objects["Sun"].hide_render = True
    assert np.isclose(pictures.render(TINY)[..., :3].max(), 2.0, rtol=1e-3)
    assert sum("light nothing" in line for line in log.notices()) == 1, log.notices()


def spoil(thing: bpy.types.Object, values: dict[int, tuple[str, Any]]) -> tuple[list[Added], list[str]]:
    """What a view is given where some of an emitter's particles have other values, and what it says of the emitter."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for index, (name, value) in values.items():
        setattr(thing.evaluated_get(depsgraph).particle_systems[0].particles[index], name, value)
    with recorded() as found:
        notices = export.export(depsgraph).notices
    return found, [line for line in notices if line.startswith(f"{thing.name}: ")]


def test_bad_particles_alone_are_left_out_and_named() -> None:
    cube, _ = emitter(frame_end=1, lifetime=100)
    play_to(2)
    nan = (math.nan, 0.0, 0.0)
    (added,), said = spoil(cube, {3: ("location", nan), 5: ("location", (math.inf,) * 3), 7: ("size", -1.0)})
    assert len(added.radius) == 197 and np.isfinite(added.points).all(), len(added.radius)
    assert added.radius.min() > 0.0, added.radius.min()
    assert len(said) == 2 and "2 of 200 particles" in said[0] and "1 of 200" in said[1], said


def test_no_particles_are_named_and_harmless() -> None:
    for values, frame in (({"count": 0}, 2), ({"frame_end": 2, "lifetime": 3}, 20)):
        emitter(**values)
        play_to(frame)
        found, notices = in_view()
        assert found == []
        assert sum(f"no particle of 'Puff' is alive at frame {frame}" in line for line in notices) == 1, notices
        assert np.isfinite(pictures.render(TINY)).all()


def test_an_opacity_that_is_none_is_named() -> None:
    cube, settings = emitter(frame_end=1, lifetime=100)
    play_to(2)
    for value, shown in ((1.5, 1.0), (-0.5, 0.0), (math.nan, 0.0)):
        notices: list[str] = []
        with_value = SimpleNamespace(
            name="Puff", sfumato=SimpleNamespace(opacity=value, color=(1, 1, 1), anisotropy=0.0)
        )
        assert particles.panel_look(with_value, cube.name, notices).opacity == shown
        assert len(notices) == 1 and notices[0].startswith("Cube: ") and "'Puff'" in notices[0], notices
    assert settings.sfumato.bl_rna.properties["opacity"].hard_max == 1.0


def test_children_are_named() -> None:
    _, settings = emitter(frame_end=1, lifetime=100)
    settings.child_type = "SIMPLE"
    play_to(2)
    (added,), notices = in_view()
    assert len(added.radius) == 200 and sum("children" in line for line in notices) == 1, notices


def test_a_liquids_own_particles_are_named() -> None:
    if harness.MANTAFLOW_ABORTS:
        raise harness.Skip("Mantaflow domains cannot be used in this Blender")
    modifier = bpy.data.objects["Cube"].modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    modifier.domain_settings.domain_type = "LIQUID"
    assert any(other.type == "PARTICLE_SYSTEM" for other in bpy.data.objects["Cube"].modifiers)
    found, notices = in_view()
    assert found == [] and sum("the liquid's own" in line for line in notices) == 1, notices


harness.main()
