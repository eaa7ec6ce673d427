# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface draws, with the add-on in it."""

from collections.abc import Iterator

import bpy
import harness


def test_viewport_is_drawn() -> Iterator[None]:
    drawn = []
    space = bpy.types.SpaceView3D
    handler = space.draw_handler_add(lambda: drawn.append(bpy.context.region.width), (), "WINDOW", "POST_PIXEL")
    try:
        for _ in range(3):
            yield
    finally:
        space.draw_handler_remove(handler, "WINDOW")
    assert drawn and drawn[0] > 100, drawn


harness.main()
