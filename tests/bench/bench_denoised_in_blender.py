# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py denoised that runs inside an official Blender: the plume by Sfumato, and by Cycles without and
with OpenImageDenoise.

    tests/official --script tests/bench/bench_denoised_in_blender.py 5.0.1

A METHOD is `sfumato`, `cycles-SAMPLES` or `marching-SAMPLES`, which is Cycles that marches through smoke as before 5.0
(*Biased*); the last two may end in `-denoised`. The judge is this Blender's own Cycles, without steps; it is rendered
once, into build/denoised.
"""

from __future__ import annotations

import json
import math
import statistics
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
import harness
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import progress  # noqa: E402
from bench_in_blender import pixels, relative_rmse, seconds_of_render  # noqa: E402
from bench_rows import LightRow  # noqa: E402

SAMPLES = 1, 4, 16, 64
METHODS = ["sfumato"]
METHODS += [f"{way}-{n}{end}" for way in ("cycles", "marching") for end in ("", "-denoised") for n in SAMPLES]
PARTS = {7: 512, 8: 128}  # samples of the judge by their seed
MOST_RUNS, ENOUGH_SECONDS = 5, 5.0
FACTS = json.loads((harness.ROOT / "tests" / "goldens" / "plume_cycles.json").read_text(encoding="utf-8"))
ROOM = harness.ROOT / "build" / "denoised"
Crop = Callable[[np.ndarray], np.ndarray]


def choose(method: str) -> tuple[str, bool, bool]:
    """Make the next render one by `method`; what it returns changes where Cycles has to begin anew."""
    scene = bpy.context.scene
    way, _, setting = method.partition("-")
    samples, _, end = setting.partition("-")
    cycles = scene.cycles
    scene.render.engine = "SFUMATO" if way == "sfumato" else "CYCLES"
    if samples:
        cycles.samples = int(samples)
    cycles.volume_biased = way == "marching"
    cycles.use_denoising = end == "denoised"
    return scene.render.engine, cycles.volume_biased, cycles.use_denoising


def begin_anew() -> None:
    """Render by the chosen method so that nothing of another's settings is kept, then so that what can be kept is."""
    settings, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    samples, cycles.samples = cycles.samples, 1
    for settings.use_persistent_data in (False, True):
        bpy.ops.render.render()
    cycles.samples = samples


def picture() -> np.ndarray:
    """What the last render made: (height, width, 3), row 0 at the top."""
    path = Path(bpy.app.tempdir) / "picture.exr"
    bpy.data.images["Render Result"].save_render(str(path))
    return pixels(path)


def linear_exr() -> None:
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"


def is_older(picture: Path) -> bool:
    """Than the sample that is open, if one is."""
    sample = Path(bpy.data.filepath)
    return sample.parent == harness.SAMPLE.parent and picture.stat().st_mtime < sample.stat().st_mtime


def judge(name: str, samples_by_seed: dict[int, int], crop: Crop) -> tuple[np.ndarray, float]:
    """What `crop` leaves of the open scene's picture by many samples of Cycles, and its noise: of n and m samples with
    independent noise of variance v / n and v / m, the difference has v (n + m) / (n m) and their mean by samples
    v / (n + m)."""
    parts = []
    render = bpy.context.scene.render
    size = f"{render.resolution_x}x{render.resolution_y}"
    for seed, samples in samples_by_seed.items():
        path = ROOM / f"{name}_{bpy.app.version_string.split()[0]}_{size}_{samples}_{seed}.exr"
        if not path.exists() or is_older(path):
            progress.step(f"{samples} samples of the judge of {name}")
            choose(f"cycles-{samples}")
            bpy.context.scene.cycles.seed = seed
            bpy.ops.render.render()
            ROOM.mkdir(parents=True, exist_ok=True)
            part = path.with_suffix(".part.exr")  # which an interrupted benchmark leaves, and nobody reads
            bpy.data.images["Render Result"].save_render(str(part))
            part.replace(path)
            bpy.context.scene.cycles.seed = 0
        parts.append(crop(pixels(path)))
    n, m = samples_by_seed.values()
    golden = (n * parts[0] + m * parts[1]) / (n + m)
    share = math.sqrt(n * m) / (n + m)
    return golden, share * float(np.sqrt(np.mean((parts[0] - parts[1]) ** 2)) / np.mean(golden))


def inside(image: np.ndarray) -> np.ndarray:
    """The rectangle of smoke and shadow, of a picture of the resolution that it is told for, or of half of that."""
    (width, height), (x0, y0, x1, y1) = FACTS["resolution"], FACTS["rectangle"]
    for share in (1, 2):
        if (image.shape[1] * share, image.shape[0] * share) == (width, height):
            return image[y0 // share : y1 // share, x0 // share : x1 // share]
    raise RuntimeError(f"a render is {image.shape[1]} x {image.shape[0]}, the rectangle is of {width} x {height}")


def print_rows(case: str, methods: Sequence[str], samples_by_seed: dict[int, int], crop: Crop, where: str) -> None:
    """Of the open scene, as Blender prints them; `where` is what `crop` leaves, in words."""
    golden, noise = judge(case, samples_by_seed, crop)
    before = None
    for method in methods:
        progress.step(f"{case}: {method}")
        if before != (before := choose(method)):
            begin_anew()
        runs = [seconds_of_render()]
        while len(runs) < MOST_RUNS and sum(runs) < ENOUGH_SECONDS:
            runs.append(seconds_of_render())
        error = relative_rmse(crop(picture()), golden)
        total = sum(samples_by_seed.values())
        row = LightRow(
            case=case,
            method=method,
            metric=f"relative RMSE {where}, against {total} samples of Cycles {bpy.app.version_string}",
            error=error,
            seconds=statistics.median(runs),
            bytes=None,
            noise=noise,
            # The judge's noise knows nothing of the rival's error, so their squares add up.
            true_error=math.sqrt(max(error**2 - noise**2, 0.0)),
        )
        print("ROW", json.dumps(row), flush=True)


def main() -> None:
    harness.open_plume(FACTS["frame"])
    linear_exr()
    print_rows("plume", METHODS, PARTS, inside, "in the rectangle")
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
