# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the judges of `bench.py lights` by Cycles: lights/CASE.exr, and what they are into lights/facts.json.

Run with, and with CASE ... after "--" for some of them:
    PATH=/usr/bin:$PATH blender -b blend_samples/plume.blend --python-exit-code 3 --python tests/goldens/make_light_goldens.py
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "bench")]
from light_cases import CASES, FRAME, RESOLUTION, put_lights, small_picture  # noqa: E402
from make_plume_golden import render, save  # noqa: E402

FOLDER = HERE / "lights"
SAMPLES = 256
# What takes Cycles longest gets half as many; facts.json says how much noise is left.
FEW = {"square", "ellipse", "two"}
SEEDS = (7, 8)
# Measured with 48 samples and the noise removed, the picture is off that at a rate of 0.25 by (relative RMSE): with a
# sphere 1.4 % at 1 and 0.44 % at 0.5, with a sun of 10 degrees 0.27 % and 0.06 %. The noise of the goldens is above that.
STEP_RATE = 0.5


def golden(case: str) -> dict[str, float]:
    """Write one golden; its noise, and the seconds that it took."""
    put_lights(case)
    samples = SAMPLES // 2 if case in FEW else SAMPLES
    bpy.context.scene.cycles.samples = samples // 2
    start = time.perf_counter()
    halves = [render(seed)[..., :3].astype(np.float64) for seed in SEEDS]
    seconds = time.perf_counter() - start
    mean = np.mean(halves, axis=0)
    bpy.context.scene.render.image_settings.color_depth = "16"
    save(np.concatenate([mean, np.ones_like(mean[..., :1])], axis=-1).astype(np.float32), FOLDER / f"{case}.exr")
    bpy.context.scene.render.image_settings.color_depth = "32"
    # Both halves have the same noise, so their difference has twice that of their mean.
    noise = np.sqrt(np.mean((halves[0] - halves[1]) ** 2)) / 2.0 / np.mean(mean)
    return {"samples": samples, "noise": round(float(noise), 6), "seconds": round(seconds, 1)}


def main(cases: list[str]) -> None:
    scene = bpy.context.scene
    small_picture()
    scene.render.engine = "CYCLES"
    # Persistent data would keep the step length of an earlier render.
    scene.render.use_persistent_data = False
    scene.render.image_settings.exr_codec = "ZIP"
    scene.cycles.volume_step_rate = STEP_RATE
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / "facts.json"
    facts = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"cases": {}}
    facts |= {
        "frame": FRAME,
        "resolution": RESOLUTION,
        "seeds": SEEDS,
        "step_rate": STEP_RATE,
        "noise_metric": "relative RMSE over the picture, from the difference of the two halves of the samples",
        "blender": bpy.app.version_string,
    }
    for case in cases or CASES:
        facts["cases"][case] = golden(case)
        path.write_text(json.dumps(facts, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
