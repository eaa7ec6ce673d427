# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds in the viewport: their light on smoke and solids, and the backdrop, in Rendered mode; as it is changed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import bpy
import harness
import numpy as np
import screen
from mathutils import Quaternion
from sfumato import log  # type: ignore[attr-defined]


def sunset() -> Any:
    """An environment texture, warm at one side, turned by the mapping that is returned."""
    v, u = np.mgrid[0:32, 0:64] / 32.0
    rgb = np.stack((0.2 + 0.6 * (np.cos(math.pi * u) > 0.3), 0.3 + 0.2 * v, 0.5 + 0.4 * v, np.ones_like(u)), axis=-1)
    image = bpy.data.images.new("Sunset", 64, 32, float_buffer=True)
    image.pixels.foreach_set(np.ascontiguousarray(rgb, np.float32).ravel())
    tree = bpy.context.scene.world.node_tree
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = image
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return mapping


def smoke_under(shading: str) -> Any:
    """The wisp, scattering forwards, before a cube: the viewport."""
    thing = harness.volume(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
    harness.put(harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume"), Density=20.0, Anisotropy=0.4)
    thing.data.grids.load()
    bounds = np.array(thing.bound_box)
    size = (bounds.max(axis=0) - bounds.min(axis=0)).max()
    thing.scale = (2.0 / size,) * 3
    thing.location = tuple(-2.0 / size * bounds.mean(axis=0))
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(0.6, 0.3, -0.6))
    if bpy.context.scene.world is None:
        bpy.context.scene.world = bpy.data.worlds.new("World")
    bpy.context.scene.world.use_nodes = True
    space = screen.prepare(shading)
    view = space.region_3d
    view.view_perspective, view.view_distance, view.view_location = "PERSP", 5.0, (0.0, 0.0, 0.0)
    view.view_rotation = Quaternion((1.0, 0.0, 0.0), 1.4)
    return space


def test_the_rendered_view_is_the_processors() -> Iterator[float | None]:
    smoke_under("RENDERED")
    bpy.context.scene.render.engine = "SFUMATO"
    background = bpy.context.scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.3, 0.4, 0.6, 1.0)
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        screen.assert_same("one color", seen[-1][0][..., :3], screen.processed()[..., :3])
        mapping = sunset()
        yield from screen.drawn(seen)
        first = seen[-1][0]
        screen.assert_same("image", first[..., :3], screen.processed()[..., :3])
        mapping.inputs["Rotation"].default_value = (0.0, 0.0, 2.0)
        yield from screen.drawn(seen)
        assert np.abs(seen[-1][0] - first)[..., :3].mean() > 0.01, "it turns as it is turned"
        screen.assert_same("image, turned", seen[-1][0][..., :3], screen.processed()[..., :3])


def test_more_lights_than_the_shader_has_room_for_are_named() -> Iterator[float | None]:
    """An image makes eight of them."""
    smoke_under("RENDERED")
    bpy.context.scene.render.engine = "SFUMATO"
    sunset()
    for number in range(9):
        lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        lamp.location = (number - 4.0, -3.0, 3.0)
        bpy.context.scene.collection.objects.link(lamp)
    with screen.watched() as seen:
        yield from screen.drawn(seen)
    assert any(line.startswith("17 lights: in the viewport only the first 16") for line in log.notices()), log.notices()


harness.main()
