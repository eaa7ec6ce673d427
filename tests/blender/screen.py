# SPDX-License-Identifier: GPL-3.0-or-later
"""What the 3D viewport shows, read back before Blender's view transform, and ways to make it draw."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np
import sfumato
from numpy.typing import NDArray
from sfumato import props  # type: ignore[attr-defined]
from sfumato.export import scene
from sfumato.view import refinement

Image = NDArray[np.float32]
# Of images whose mean is near one. What llvmpipe shows is the rounding of half floats: 3.5e-4 and 1e-3. The largest
# leaves room for hardware, which interpolates with weights of 8 bits.
TOLERANCE, LARGEST = 1e-3, 1e-2


def viewport() -> tuple[Any, Any, Any]:
    """The first 3D viewport: its window, its area and the region that it draws in."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                return window, area, next(region for region in area.regions if region.type == "WINDOW")
    raise LookupError("no 3D viewport on the screen")


def prepare(shading: str) -> Any:
    """A viewport whose picture depends on nothing but the scene: no lines, no antialiasing. Returns its space."""
    bpy.context.preferences.system.viewport_aa = "OFF"
    space = viewport()[1].spaces.active
    space.shading.type = shading
    space.overlay.show_overlays = False
    return space


def read(buffer: Any, slot: int, size: tuple[int, int]) -> Image:
    """The pixels of a framebuffer: (height, width, 4), row 0 at the bottom."""
    import gpu

    width, height = size
    pixels = np.empty((height, width, 4), np.float32)
    with buffer.bind():
        buffer.read_color(0, 0, width, height, 4, slot, "FLOAT", data=gpu.types.Buffer("FLOAT", pixels.shape, pixels))
    return pixels


@contextmanager
def watched() -> Iterator[list[tuple[Image, Image]]]:
    """What every redraw of a viewport within the block leaves: Blender's picture, scene-linear, and its overlays."""
    import gpu

    seen: list[tuple[Image, Image]] = []
    targets: list[Any] = []

    def before() -> None:
        targets[:] = [gpu.state.active_framebuffer_get()]

    def after() -> None:
        size = bpy.context.region.width, bpy.context.region.height
        seen.append((read(targets.pop(), 0, size), read(gpu.state.active_framebuffer_get(), 0, size)))

    space = bpy.types.SpaceView3D
    handles = [space.draw_handler_add(*args) for args in ((before, (), "WINDOW", "PRE_VIEW"),
                                                          (after, (), "WINDOW", "POST_VIEW"))]  # fmt: skip
    try:
        yield seen
    finally:
        for handle in handles:
            space.draw_handler_remove(handle, "WINDOW")


def drawn(seen: list[Any], views: int = 1) -> Iterator[float | None]:
    """Wait until that many views have been drawn with all that was changed before, for the second time: Blender
    spreads the first over several redraws. Then until they are refined, and drawn again."""
    for _ in range(2):
        seen.clear()
        while len(seen) < views:
            yield None
    yield from refined()
    seen.clear()
    while len(seen) < views:
        yield None


def settled(seen: list[Any]) -> Iterator[float | None]:
    """Until what is drawn is the same as before: Material Preview compiles, and says so, for as long as it takes."""
    deadline, before = time.monotonic() + 60.0, None
    while time.monotonic() < deadline:
        yield from drawn(seen)
        now = seen[-1][0][..., :3]
        if before is not None and (np.abs(now - before).max(axis=-1) > 0.02).mean() < 5e-4:
            return
        before = now
        yield 0.2


def refined() -> Iterator[float | None]:
    """Wait until no view has anything to refine any more."""
    deadline = time.monotonic() + 60.0
    while refinement.busy():
        assert time.monotonic() < deadline, "the views never come to rest"
        yield 0.02


def view_matrix() -> NDArray[np.float64]:
    """World to NDC, of the first 3D viewport."""
    return np.array(viewport()[1].spaces.active.region_3d.perspective_matrix, dtype=np.float64)


def processed() -> Any:
    """Our picture of the first 3D viewport, by the native module alone, (height, width, 4)."""
    out = scene.export(bpy.context.evaluated_depsgraph_get())
    quality = props.QUALITIES[bpy.context.scene.sfumato.quality]
    _window, _area, region = viewport()
    frame = sfumato.Frame(out.scene, **quality.frame)
    return frame.render(sfumato.Camera(view_matrix()), region.width, region.height, quality.edge_samples)


def assert_same(name: str, gpu: Any, cpu: Any) -> None:
    error = np.abs(gpu - cpu)
    rmse = float(np.sqrt(np.mean(error * error)))
    print(f"  {name}: RMSE {rmse:.2e}, largest {error.max():.2e}, mean of the image {cpu.mean():.3f}")
    assert rmse <= TOLERANCE and error.max() <= LARGEST
