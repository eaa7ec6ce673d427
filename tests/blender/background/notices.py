# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of many is said once, where it matters, in an artist's words."""

from __future__ import annotations

import contextlib
import io

import bpy
import harness
from sfumato import log  # type: ignore[attr-defined]
from sfumato.export import scene


def test_lines_that_say_the_same_are_one_group() -> None:
    lines = ("Ball: glows", "World: shown as a backdrop", "Cube.001: glows", "No camera", "Cube.001: glows")
    groups = log.grouped(lines)
    assert [str(group) for group in groups] == ["2 objects: glows", "World: shown as a backdrop", "No camera"]
    assert [group.names for group in groups] == [("Ball", "Cube.001"), ("World",), ()]


def test_numbers_in_which_they_differ_become_a_range() -> None:
    lines = tuple(f"Cube.{value:03d}: Coat of {value / 8} is left out, above 0.1" for value in (2, 8, 4))
    (group,) = log.grouped(lines)
    assert str(group) == "3 objects: Coat of 0.25 to 1.0 is left out, above 0.1"
    assert str(log.grouped(lines[:1])[0]) == lines[0]
    # What is a part of a name is no number.
    assert len(log.grouped(("A: 'UV 1' is missing", "B: 'UV 2' is missing", "C: cloud_01.vdb", "D: cloud_02.vdb"))) == 4


def test_the_terminal_hears_of_each_group_once() -> None:
    log.clear()
    many = [f"Lamp {number}: is dark" for number in range(7)]
    for said, expected in (
        (many, "Sfumato: 7 objects: is dark (Lamp 0, Lamp 1, Lamp 2, Lamp 3, Lamp 4 and 2 more)\n"),
        ([*many, "Lamp 8: is dark"], "Sfumato: Lamp 8: is dark\n"),
        (many, ""),
    ):
        terminal = io.StringIO()
        with contextlib.redirect_stdout(terminal):
            log.replace("test", said)
        assert terminal.getvalue() == expected, terminal.getvalue()
    log.clear()


def glass(name: str) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add()
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.clear()
    harness.shade(thing.data, "ShaderNodeBsdfGlass")
    return thing


def test_a_view_of_smoke_and_shadows_hears_nothing_of_looks() -> None:
    """But of what a lamp lacks, which lights the smoke."""
    glass("Pane")
    bpy.data.objects["Light"].data.energy = -1.0
    depsgraph = bpy.context.evaluated_depsgraph_get()
    of_all = scene.export(depsgraph).notices
    of_smoke = scene.export(depsgraph, smoke_alone=True).notices
    assert any(line.startswith("Pane: ") for line in of_all)
    assert not any(line.startswith(("Pane: ", "World: ")) for line in of_smoke), of_smoke
    assert any(line.startswith("Light: ") for line in of_smoke)


def test_each_copy_that_shares_a_mesh_is_named() -> None:
    bpy.ops.mesh.primitive_cube_add()
    first = bpy.context.object
    copies = [first.copy() for _ in range(2)]
    for thing in copies:
        bpy.context.collection.objects.link(thing)
    if hasattr(first, "shadow_terminator_shading_offset"):  # 4.1
        copies[1].shadow_terminator_shading_offset = 0.5
    else:
        copies[1].cycles.shadow_terminator_offset = 0.5
    said = [line for line in scene.export(bpy.context.evaluated_depsgraph_get()).notices if "Shading Offset" in line]
    assert len(said) == 1 and said[0].startswith(f"{copies[1].name}: "), said


def test_a_lamp_that_lights_nothing_but_is_seen_is_named() -> None:
    lamp = bpy.data.objects["Light"]
    lamp.visible_camera = True
    for shows in (True, False):
        lamp.visible_diffuse = lamp.visible_glossy = lamp.visible_volume_scatter = shows
        said = scene.export(bpy.context.evaluated_depsgraph_get()).notices
        assert sum("the lamp itself is not seen" in line for line in said) == 1, (shows, said)
    lamp.data.energy = 0.0
    said = scene.export(bpy.context.evaluated_depsgraph_get()).notices
    assert not any("the lamp itself is not seen" in line for line in said), said


def test_a_render_hears_of_the_camera_that_it_looks_through() -> None:
    other = bpy.data.objects.new("Other", bpy.data.cameras.new("Other"))
    bpy.context.collection.objects.link(other)
    other.data.type = "PANO"
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert not any(line.startswith("Other: ") for line in scene.export(depsgraph).notices)
    assert any(line.startswith("Other: ") for line in scene.export(depsgraph, camera=other).notices)


def test_what_is_named_can_be_selected() -> None:
    panes = [glass("Pane"), glass("Window: left")]
    bpy.data.objects["Camera"].select_set(True)
    assert bpy.ops.sfumato.select_named(names="Pane\nWindow: left\nnowhere") == {"FINISHED"}
    assert set(bpy.context.selected_objects) == set(panes)
    assert bpy.ops.sfumato.select_named(names="nowhere") == {"CANCELLED"}


harness.main()
