# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke that Solid mode draws by itself: gone where the overlay draws it, and there again without it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import harness
import numpy as np
import screen
from sfumato.export import smoke
from sfumato.view import overlay

# Blender draws volumes with a jitter that changes from redraw to redraw.
SAME, OTHER = 2e-3, 0.01


def thickness(name: str) -> tuple[Any, str, float]:
    """What the artist sets of an object's smoke in Solid mode, and its least."""
    thing = bpy.data.objects[name]
    domain = smoke.domain_settings(thing)
    return (thing.data.display, "density", 1e-5) if domain is None else (domain, "display_thickness", 0.001)


def set_thickness(name: str, value: float | None) -> None:
    """None: the least."""
    owner, attribute, least = thickness(name)
    setattr(owner, attribute, least if value is None else value)


def off(one: Any, other: Any) -> float:
    return float(np.abs(one - other).max())


def drawn(seen: list[Any]) -> Iterator[float | None]:
    """Twice: what is hidden after a first redraw is not seen in the second."""
    for _ in range(2):
        yield from screen.drawn(seen)


def check(name: str) -> Iterator[float | None]:
    """With the smoke of one object in view."""
    settings = bpy.context.scene.sfumato
    with screen.watched() as seen:
        set_thickness(name, None)
        yield from drawn(seen)
        ours = seen[-1][0]  # with nothing below
        settings.viewport_enabled = False
        yield from drawn(seen)
        nothing = seen[-1][0]
        set_thickness(name, 1.0)
        yield from drawn(seen)
        theirs = seen[-1][0]
        assert off(theirs, nothing) > OTHER, "this view must show Blender's own smoke"
        settings.viewport_enabled = True
        yield from drawn(seen)
        assert off(seen[-1][0], ours) < SAME
        owner, attribute, _ = thickness(name)
        assert getattr(owner, attribute) == 1.0, "what the artist set must stay"

        # Changes copy the object anew: no redraw may show both.
        thing = bpy.data.objects[name]
        for change in (lambda: thing.select_set(True), thing.update_tag):
            change()
            yield from screen.drawn(seen)
            assert all(off(one, ours) < SAME for one, _ in seen), "its own smoke was seen again"

        bpy.ops.ed.undo_push(message="before")
        bpy.data.objects[name].location.x += 1.0
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        yield from drawn(seen)
        assert off(seen[-1][0], ours) < SAME
        owner, attribute, _ = thickness(name)
        assert getattr(owner, attribute) == 1.0

        bpy.context.scene.sfumato.viewport_enabled = False
        yield from drawn(seen)
        assert off(seen[-1][0], theirs) < OTHER < off(seen[-1][0], nothing)
        bpy.context.scene.sfumato.viewport_enabled = True
        yield from drawn(seen)
        overlay.disable()
        yield from drawn(seen)
        assert off(seen[-1][0], theirs) < OTHER < off(seen[-1][0], nothing)
    overlay.enable()
    with screen.watched() as seen:  # after the overlay, as before
        yield from drawn(seen)
        assert off(seen[-1][0], ours) < SAME


def test_that_of_a_domain() -> Iterator[float | None]:
    if harness.MANTAFLOW_ABORTS:
        raise harness.Skip("Mantaflow aborts in this Blender")
    harness.open_plume(25)
    screen.prepare("SOLID").region_3d.view_perspective = "CAMERA"
    yield from check("Smoke Domain")


def test_that_of_a_volume() -> Iterator[float | None]:
    thing = harness.volume(sorted((harness.CACHE / "data").glob("fluid_data_*.vdb"))[-1])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    view = screen.prepare("SOLID").region_3d
    view.view_distance, view.view_location = 9.0, (2.0, 2.0, 2.0)
    yield from check(thing.name)


harness.main()
