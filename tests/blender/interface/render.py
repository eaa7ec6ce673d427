# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 in the real interface: the picture arrives, and Esc stops it."""

import time
from collections.abc import Generator

import bpy
import harness
import numpy as np
from sfumato import engine  # type: ignore[attr-defined]

Steps = Generator[None, None, None]


def press_f12() -> None:
    settings = bpy.context.scene.render
    settings.engine = "SFUMATO"
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        bpy.ops.render.render("INVOKE_DEFAULT")


def wait_for_render(seconds: float) -> Steps:
    deadline = time.monotonic() + seconds
    yield
    while bpy.app.is_job_running("RENDER"):
        assert time.monotonic() < deadline, "the render does not end"
        yield
        time.sleep(0.05)


def test_f12_renders() -> Steps:
    harness.open_plume()
    bpy.context.scene.render.resolution_percentage = 25
    done: list[bool] = []
    bpy.app.handlers.render_complete.append(lambda *_: done.append(True))
    yield
    press_f12()
    yield from wait_for_render(60.0)
    bpy.app.handlers.render_complete.clear()
    assert done, "the render was not completed"


def test_a_break_stops_a_long_render() -> Steps:
    """Esc reaches an engine as test_break(), which no event of Python's making sets: so its answer is given here."""
    harness.open_plume()
    settings = bpy.context.scene
    settings.sfumato.quality = "FINAL"
    settings.render.resolution_x, settings.render.resolution_y = 3840, 2160
    shares: list[float] = []

    go_on = engine.SfumatoEngine.go_on

    def watched(self: engine.SfumatoEngine, done: float) -> bool:
        shares.append(done)
        return go_on(self, done) and len(shares) < 3

    engine.SfumatoEngine.go_on = watched
    try:
        yield
        press_f12()
        yield from wait_for_render(60.0)
    finally:
        engine.SfumatoEngine.go_on = go_on
    assert len(shares) == 3 and max(shares) < 0.5, shares
    assert np.all(np.diff(shares) >= 0.0), shares


harness.main()
