# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py shafts that runs inside Blender: a sample with light shafts by Sfumato and by Cycles.

    blender -b SAMPLE.blend --python tests/bench/bench_shafts_in_blender.py -- ROWS.json

The room of shafts.blend has its air in the panel, which Cycles does not see, and has it in a mesh here. The judge is
Cycles in this process.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import progress  # noqa: E402
from bench_in_blender import choose, median_seconds, pixels, relative_rmse, seconds_of_render  # noqa: E402
from bench_rows import LightRow  # noqa: E402

METHODS = "sfumato-preview", "sfumato-draft", "cycles-1", "cycles-4", "cycles-16", "cycles-64"
PARTS = {7: 512, 8: 256}  # samples of the judge by their seed
PERCENT = 50  # 320 x 200
ROOM = (-2.2, -3.6, 0.0), (2.2, 4.4, 2.8)


def fill_the_room() -> None:
    """With what its air is, from wall to wall."""
    scene = bpy.context.scene
    air = scene.world.sfumato
    air.shown = False
    low, high = (np.array(corner) for corner in ROOM)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(low + high) / 2.0, scale=high - low + 0.1)
    made = bpy.data.materials.new("Air")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    scatter, output = nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeOutputMaterial")
    scatter.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scatter.inputs["Density"].default_value = -math.log(0.02) / air.visibility
    scatter.inputs["Anisotropy"].default_value = air.anisotropy
    made.node_tree.links.new(scatter.outputs["Volume"], output.inputs["Volume"])
    bpy.context.object.data.materials.append(made)


def picture(folder: Path) -> np.ndarray:
    """What the last render made, as bright as white at most: air at a lamp is a thousand times as bright, and its few
    pixels would be all that is measured. (height, width, 3), row 0 at the top."""
    path = folder / "picture.exr"
    bpy.data.images["Render Result"].save_render(str(path))
    return np.minimum(pixels(path), 1.0)


def judge(folder: Path) -> tuple[np.ndarray, float]:
    """The picture by many samples of Cycles, and its noise: two parts of n and m samples whose noise has variances v / n
    and v / m differ by v (n + m) / (n m), and their mean by samples has v / (n + m)."""
    parts = []
    for seed, samples in PARTS.items():
        progress.step(f"{samples} samples of the judge")
        choose(f"cycles-{samples}")
        bpy.context.scene.cycles.seed = seed
        bpy.ops.render.render()
        parts.append(picture(folder))
    bpy.context.scene.cycles.seed = 0
    n, m = PARTS.values()
    golden = (n * parts[0] + m * parts[1]) / (n + m)
    share = math.sqrt(n * m) / (n + m)
    return golden, share * float(np.sqrt(np.mean((parts[0] - parts[1]) ** 2)) / np.mean(golden))


def main(rows_path: Path) -> None:
    scene = bpy.context.scene
    case = f"{Path(bpy.data.filepath).stem}-blend"
    if scene.world is not None and scene.world.sfumato.shown:
        fill_the_room()
    scene.render.resolution_percentage = PERCENT
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        golden, noise = judge(folder)
        for method in METHODS:
            progress.step(f"{case}: {method}")
            engine = scene.render.engine
            choose(method)
            if scene.render.engine != engine:
                seconds_of_render()
            seconds = median_seconds()
            error = relative_rmse(picture(folder), golden)
            row = LightRow(
                case=case,
                method=method,
                metric=f"relative RMSE of the picture up to white, against {sum(PARTS.values())} samples of Cycles",
                error=error,
                seconds=seconds,
                bytes=None,
                noise=noise,
                # The judge's noise knows nothing of the rival's error, so their squares add up.
                true_error=math.sqrt(max(error**2 - noise**2, 0.0)),
            )
            print(row, flush=True)
            rows.append(row)
    rows_path.write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
