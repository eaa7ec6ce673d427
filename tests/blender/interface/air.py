# SPDX-License-Identifier: GPL-3.0-or-later
"""Air in the viewport: in Rendered mode, over Solid and Material Preview, as it is changed and undone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import harness
import numpy as np
import screen
import sfumato
from mathutils import Quaternion
from sfumato import props, ui  # type: ignore[attr-defined]
from sfumato.export import scene


def lamp_in_air(shading: str) -> tuple[Any, Any]:
    """The factory's cube and lamp, with the lamp in sight: the viewport, and the settings of the air."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    harness.enable()
    lamp = bpy.data.objects["Light"]
    lamp.location, lamp.data.energy = (1.6, -0.4, 1.6), 300.0
    world = bpy.context.scene.world
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    space = screen.prepare(shading)
    view = space.region_3d
    view.view_perspective, view.view_distance, view.view_location = "PERSP", 8.0, (0.0, 0.0, 0.5)
    view.view_rotation = Quaternion((1.0, 0.0, 0.0), 1.3)
    own = props.of_air(world)
    own.visibility, own.anisotropy = 25.0, 0.2
    return space, own


def test_the_rendered_view_is_the_processors() -> Iterator[float | None]:
    _space, own = lamp_in_air("RENDERED")
    bpy.context.scene.render.engine = "SFUMATO"
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        clear = seen[-1][0]
        own.shown = True
        yield from screen.drawn(seen)
    expected = screen.processed()
    assert np.abs(seen[-1][0] - clear)[..., :3].mean() > 0.01, "it is seen as soon as it is there"
    screen.assert_same("air, rendered", seen[-1][0][..., :3], expected[..., :3])


def test_overlays_show_it_and_leave_no_trace() -> Iterator[float | None]:
    for shading in ("SOLID", "MATERIAL"):
        _space, own = lamp_in_air(shading)
        pictures = []
        with screen.watched() as seen:
            # Once with it first: by then Material Preview has compiled what it shows without it.
            for own.shown in (True, False, True, False):
                yield from screen.settled(seen)
                pictures.append(seen[-1][0][..., :3])
        lit, left = (pictures[2] - pictures[1]).max(axis=-1), np.abs(pictures[3] - pictures[1])
        print(f"  {shading}: up to {lit.max():.2f} brighter; {left.mean():.1e}, {left.max():.1e} left")
        assert lit.max() > 0.1, "around the lamp the air is bright"
        # What Material Preview draws is never quite the same twice.
        assert left.mean() < 1e-3 if shading == "MATERIAL" else left.max() < 0.02


def test_a_volume_that_material_preview_shows_by_itself_is_not_shown_twice() -> Iterator[float | None]:
    space, _own = lamp_in_air("MATERIAL")
    tree = bpy.context.scene.world.node_tree
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.1
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(scatter.outputs[0], output.inputs["Volume"])
    for theirs in (True, False):
        space.shading.use_scene_world = theirs
        with screen.watched() as seen:
            yield from screen.drawn(seen)
        out = scene.export(bpy.context.evaluated_depsgraph_get(), space=space, smoke_alone=True)
        assert sfumato.Frame(out.scene).air == (not theirs)


def test_a_change_can_be_undone() -> Iterator[float | None]:
    _space, own = lamp_in_air("SOLID")
    own.shown = True
    window, area, region = screen.viewport()
    with screen.watched() as seen:
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.ed.undo_push(message="before")
        yield from screen.drawn(seen)
        before = seen[-1][0]
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.sfumato.set_air(preset="CLEAR")
            bpy.ops.ed.undo_push(message="after")
        yield from screen.drawn(seen)
        clear = seen[-1][0]
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.ed.undo()
        yield from screen.drawn(seen)
    assert np.abs(clear - before).max() > 0.1
    assert np.isclose(props.of_air(bpy.context.scene.world).visibility, 25.0)
    assert np.abs(seen[-1][0] - before).max() < 2e-3


def test_its_panel_is_there_where_there_is_a_world() -> None:
    _space, own = lamp_in_air("SOLID")
    assert ui.SfumatoAirPanel.poll(bpy.context)
    assert (own.shown, own.directed) == (False, False)
    bpy.context.scene.world = None
    assert not ui.SfumatoAirPanel.poll(bpy.context)
    assert not bpy.ops.sfumato.set_air.poll()


harness.main()
