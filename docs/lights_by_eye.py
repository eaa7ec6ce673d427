# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/lights_by_eye.png: the plume in other lights, by Cycles (tests/goldens/lights), by Sfumato, and four times the
difference.

PATH=/usr/bin:$PATH blender -b blend_samples/plume.blend --addons sfumato --python docs/lights_by_eye.py
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "bench"))
from bench_in_blender import pixels  # noqa: E402
from light_cases import put_lights, small_picture  # noqa: E402

CASES = ("point", "square", "sun-10", "two")
OUT = ROOT / "docs" / "lights_by_eye.png"


def ours() -> NDArray[np.float64]:
    bpy.context.scene.render.engine = "SFUMATO"
    with tempfile.TemporaryDirectory() as folder:
        bpy.context.scene.render.filepath = str(Path(folder) / "part.exr")
        bpy.ops.render.render(write_still=True)
        return pixels(Path(bpy.context.scene.render.filepath))


def encoded(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """For the screen: sRGB."""
    clipped = np.clip(linear, 0.0, 1.0)
    return np.where(clipped < 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1.0 / 2.4) - 0.055)


def main() -> None:
    small_picture()
    rows = []
    for case in CASES:
        put_lights(case)
        golden, image = pixels(ROOT / "tests" / "goldens" / "lights" / f"{case}.exr"), ours()
        rows.append(np.concatenate([encoded(part) for part in (golden, image, 4.0 * np.abs(image - golden))], axis=1))
    picture = np.concatenate(rows)[::-1]  # Blender's rows begin at the bottom
    opaque = np.ones((*picture.shape[:2], 4), np.float32)
    opaque[..., :3] = picture
    out = bpy.data.images.new("lights", picture.shape[1], picture.shape[0])
    out.pixels.foreach_set(opaque.ravel())
    out.filepath_raw, out.file_format = str(OUT), "PNG"
    out.save()


if __name__ == "__main__":
    main()
