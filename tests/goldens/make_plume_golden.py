# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the judge of the plume: frame 25 by Cycles, into plume_cycles.exr, and what it is into plume_cycles.json.

Run with:  PATH=/usr/bin:$PATH blender -b blend_samples/plume.blend --python-exit-code 3 --python tests/goldens/make_plume_golden.py
"""

from __future__ import annotations

import json
import math
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
FRAME = 25
SAMPLES = 1024
SEEDS = (7, 8)
# Cycles marches through volumes, and its default step is too long for a judge: measured with 128 samples a pixel, the
# rectangle at a step rate of 1 is 0.37 % (relative RMSE, noise removed) off that at 0.1, 0.10 % at 0.5, 0.02 % at 0.25.
STEP_RATE = 0.25
THRESHOLD = 0.01
RULE = (
    f"smallest rectangle of pixels that holds every cell of density above {THRESHOLD} and that cell's shadow on the "
    "plane z = 0, clipped to the picture; x0 <= x < x1, y0 <= y < y1, row 0 at the top"
)


def dense_cells(depsgraph: bpy.types.Depsgraph) -> np.ndarray:
    """Centres, in world space, of the cells that hold smoke: (n, 3)."""
    domain = next(item for item in depsgraph.objects if item.name == "Smoke Domain")
    settings = domain.modifiers["Fluid"].domain_settings
    density = np.empty(len(settings.density_grid), np.float32)
    settings.density_grid.foreach_get(density)
    resolution = np.array(settings.domain_resolution)
    z, y, x = np.nonzero(density.reshape(resolution[::-1]) > THRESHOLD)
    if len(x) == 0:
        raise RuntimeError("the domain holds no smoke: is plume_cache beside plume.blend?")
    low, high = np.array(domain.bound_box).min(axis=0), np.array(domain.bound_box).max(axis=0)
    local = low + (np.stack([x, y, z], axis=1) + 0.5) / resolution * (high - low)
    world = np.array(domain.matrix_world)
    return local @ world[:3, :3].T + world[:3, 3]


def rectangle(depsgraph: bpy.types.Depsgraph) -> list[int]:
    """[x0, y0, x1, y1] in pixels, by RULE."""
    scene = depsgraph.scene
    points = dense_cells(depsgraph)
    sun = np.array(bpy.data.objects["Sun"].matrix_world.to_3x3() @ Vector((0.0, 0.0, -1.0)))
    shadow = points - points[:, 2:] / sun[2] * sun
    points = np.concatenate([points, shadow])
    width, height = scene.render.resolution_x, scene.render.resolution_y
    camera = scene.camera.evaluated_get(depsgraph)
    to_clip = np.array(
        camera.calc_matrix_camera(depsgraph, x=width, y=height) @ camera.matrix_world.normalized().inverted()
    )
    clip = points @ to_clip[:, :3].T + to_clip[:, 3]
    x = (0.5 + 0.5 * clip[:, 0] / clip[:, 3]) * width
    y = (0.5 - 0.5 * clip[:, 1] / clip[:, 3]) * height
    return [
        max(math.floor(x.min()), 0),
        max(math.floor(y.min()), 0),
        min(math.ceil(x.max()), width),
        min(math.ceil(y.max()), height),
    ]


def render(seed: int) -> np.ndarray:
    """Half of the golden's samples: (height, width, 4), row 0 at the top."""
    scene = bpy.context.scene
    scene.cycles.seed = seed
    bpy.ops.render.render()
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "half.exr")
        bpy.data.images["Render Result"].save_render(path)
        image = bpy.data.images.load(path)
        values = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)[::-1]


def save(values: np.ndarray, path: Path) -> None:
    """Half floats without alpha, and without the stamps that say who rendered where."""
    scene = bpy.context.scene
    scene.render.image_settings.color_depth = "16"
    image = bpy.data.images.new("Golden", values.shape[1], values.shape[0], float_buffer=True)
    image.pixels.foreach_set(values[::-1].ravel())
    image.save_render(str(path), scene=scene)


def main() -> None:
    scene = bpy.context.scene
    scene.frame_set(FRAME)
    scene.render.engine = "CYCLES"
    # Persistent data would keep the step length of an earlier render.
    scene.render.use_persistent_data = False
    scene.cycles.samples = SAMPLES // 2
    scene.cycles.volume_step_rate = STEP_RATE
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR"
    settings.color_mode = "RGB"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    start = time.perf_counter()
    halves = [render(seed) for seed in SEEDS]
    seconds = time.perf_counter() - start
    golden = np.mean(halves, axis=0)
    x0, y0, x1, y1 = rectangle(bpy.context.evaluated_depsgraph_get())
    inside = (slice(y0, y1), slice(x0, x1), slice(0, 3))
    # Both halves have the same noise, so their difference has twice that of their mean.
    noise = np.sqrt(np.mean((halves[0][inside] - halves[1][inside]) ** 2)) / 2.0 / np.mean(golden[inside])
    save(golden, HERE / "plume_cycles.exr")
    facts = {
        "frame": FRAME,
        "resolution": [golden.shape[1], golden.shape[0]],
        "rectangle": [x0, y0, x1, y1],
        "rule": RULE,
        "samples": SAMPLES,
        "seeds": SEEDS,
        "step_rate": STEP_RATE,
        "noise": round(float(noise), 6),
        "noise_metric": "relative RMSE in the rectangle, from the difference of the two halves of the samples",
        "blender": bpy.app.version_string,
        "seconds": round(seconds, 1),
    }
    (HERE / "plume_cycles.json").write_text(json.dumps(facts, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
