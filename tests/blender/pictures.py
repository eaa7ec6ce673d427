# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering a picture and reading it back."""

from __future__ import annotations

import functools
import json
import tempfile
import time
from pathlib import Path

import bpy
import harness
import numpy as np
from numpy.typing import NDArray


def read(path: Path) -> NDArray[np.float32]:
    """The pixels of a file, (height, width, 4), row 0 at the bottom, as they are stored."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    height, width = image.size[1], image.size[0]
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def render(size: tuple[int, int] | None = None, engine: str = "SFUMATO") -> NDArray[np.float32]:
    """The scene through an engine: scene-linear pixels."""
    settings = bpy.context.scene.render
    settings.engine = engine
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_mode = "RGBA"
    settings.image_settings.color_depth = "32"
    if size is not None:
        settings.resolution_x, settings.resolution_y = size
    with tempfile.TemporaryDirectory() as folder:
        settings.filepath = str(Path(folder) / "frame.exr")
        bpy.ops.render.render(write_still=True)
        return read(Path(settings.filepath))


def beside_cycles(case: str, size: tuple[int, int], samples: int) -> float:
    """The mean radiance of the scene in red, in light that nothing passes on, over that in the Cycles of this Blender;
    printed as a row for bench.py, too. Raises AssertionError where Cycles shows nothing, or its noise is above .5 %."""
    cycles = bpy.context.scene.cycles
    cycles.max_bounces, cycles.samples = 0, samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    started = time.perf_counter()
    ours = float(render(size)[..., 0].mean())
    seconds = time.perf_counter() - started
    theirs = []
    for cycles.seed in (1, 2):
        theirs.append(float(render(size, "CYCLES")[..., 0].mean()))
    mean = sum(theirs) / 2.0
    assert mean > 0.0, case
    noise = abs(theirs[0] - theirs[1]) / 2.0 / mean
    row = {"case": case, "method": bpy.app.version_string.split()[0], "error": ours / mean - 1.0}
    print("ROW", json.dumps({**row, "cycles": mean, "noise": noise, "seconds": seconds}), flush=True)
    assert noise < 0.005, (case, noise)
    return ours / mean


@functools.cache
def cycles_shows_smoke() -> bool:
    """Whether the Cycles of this Blender does: Debian's 5.2.2 was built without what it takes. Asked by a picture of a
    cloud alone, in a scene that takes the place of the open one."""
    thing = harness.volume(harness.ROOT / "blend_samples" / "frames" / "fire.vdb")
    harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume").inputs["Density"].default_value = 10.0
    scene, data = bpy.context.scene, bpy.data.cameras.new("Camera")
    scene.world = bpy.data.worlds.new("World")  # without one, Cycles 5.0.1 shows no smoke
    thing.data.grids.load()
    corners = np.array(thing.bound_box)
    low, high = corners.min(axis=0), corners.max(axis=0)
    data.type, data.ortho_scale = "ORTHO", float((high - low).max())
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.camera.location = (*((low + high) / 2.0)[:2], high[2] + 1.0)
    scene.collection.objects.link(scene.camera)
    scene.render.film_transparent, scene.render.resolution_percentage = True, 100
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    return bool(render((16, 16), "CYCLES")[..., 3].max() > 0.0)


def in_blocks(picture: NDArray[np.float32], side: int) -> NDArray[np.float64]:
    """The means of blocks of side x side pixels, which divide it, of the colours of a picture (height, width, 4)."""
    height, width = picture.shape[0] // side, picture.shape[1] // side
    return picture[..., :3].astype(np.float64).reshape(height, side, width, side, 3).mean(axis=(1, 3))


def error_beside_cycles(case: str, size: tuple[int, int], samples: int, side: int = 4, bounces: int = 0) -> float:
    """The root mean square by which blocks of the picture differ from those in the Cycles of this Blender, in light that
    nothing passes on, or surfaces so many times, over the latter's, with its noise taken off: from two renders whose random
    numbers differ."""
    cycles = bpy.context.scene.cycles
    cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.max_bounces = bounces + 1 if bounces else 0  # of what a mirror shows
    cycles.volume_bounces, cycles.samples, cycles.sample_clamp_indirect = 0, samples, 0.0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    ours = in_blocks(render(size), side)
    first, second = (in_blocks(render(size, "CYCLES"), side) for cycles.seed in (1, 2))
    theirs, noise = (first + second) / 2.0, float(((first - second) ** 2).mean()) / 4.0
    whole = float(np.sqrt((theirs**2).mean()))
    assert whole > 0.0, case
    error = float(np.sqrt(max(((ours - theirs) ** 2).mean() - noise, 0.0))) / whole
    print(
        f"  {case}: {error:.2%}, noise {np.sqrt(noise) / whole:.2%}, means {ours.mean() / theirs.mean():.4f}",
        flush=True,
    )
    return error
