# SPDX-License-Identifier: GPL-3.0-or-later
"""What light maps of particles cost and how far off they are, and a whole picture of them beside Cycles'."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import sfumato
from numpy.typing import NDArray

import particle_plume
import progress
from bench_rows import ParticleRow
from blender_run import ROOT, run_script
from peak_memory import peak_bytes

MAP_RUNS, RUNS = 7, 3
SIZES = (256, 512, 1024)
PLACES = 1000  # at which a map is judged
LARGE, SMALL = (1680, 1050), (1280, 800)  # the pictures of source A's tables 1 and 2
PICTURE = (640, 360)
MAP_ERROR = "RMSE of the transmittance at 1000 places in the plume, against the exact one; seconds: of the map alone"
PICTURE_ERROR = "none: seconds until a picture of 640x360 is there, from particles that are arrays"
FORMS: dict[str, dict[str, Any]] = {
    "fourier": {"basis": "fourier", "ranges": "shared", "coefficients": 7},
    "piecewise": {"basis": "piecewise", "ranges": "shared", "coefficients": 7},
    "sfumato": {},
}


def camera(width: int, height: int) -> sfumato.Camera:
    """At (0, -2.2, .9), 40 degrees wide, towards the plume's middle."""
    away = np.array([0.0, 2.2, -0.4])
    forward = away / np.linalg.norm(away)
    right = np.array([1.0, 0.0, 0.0])
    view = np.eye(4)
    view[:3, :3] = right, np.cross(right, forward), -forward
    view[:3, 3] = -view[:3, :3] @ np.array([0.0, -2.2, 0.9])
    near, far, focal = 0.1, 100.0, 1.0 / math.tan(math.radians(20.0))
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = focal, focal * width / height
    projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    projection[3, 2] = -1.0
    return sfumato.Camera(projection @ view)


def scene_of(count: int) -> sfumato.Scene:
    scene = sfumato.Scene()
    scene.add_particles(*particle_plume.plume(count))
    scene.add_sun(particle_plume.SUN, (4.0, 4.0, 4.0))
    return scene


def texels_per_cell(scene: sfumato.Scene, texels: int) -> float:
    """What gives a map whose longer edge has about so many texels."""
    rough = max(sfumato.Frame(scene, coefficients=1, texels_per_cell=0.5).light_map().coefficients.shape[:2])
    return 0.5 * (texels - 2) / (rough - 2)


def shortest(work: Any, runs: int = RUNS) -> tuple[float, Any]:
    """The least time of several runs, of what work() returns, and the last result."""
    times, result = [], None
    for _ in range(runs):
        seconds, result = work()
        times.append(seconds)
    return min(times), result


def map_row(scene: sfumato.Scene, case: str, method: str, texels: int, **form: Any) -> ParticleRow:
    progress.step(f"{case}, {method}, {texels}")
    form = FORMS[method] | form

    def build() -> tuple[float, sfumato.Frame]:
        frame = sfumato.Frame(scene, texels_per_cell=share, **form)
        return frame.stages["light maps"], frame

    share = texels_per_cell(scene, texels)
    seconds, frame = shortest(build, MAP_RUNS)
    return ParticleRow(
        case=case,
        method=method,
        metric=MAP_ERROR,
        error=map_error(frame),
        seconds=seconds,
        bytes=frame.light_map().bytes,
        coefficients=form.get("coefficients", 15),
        texels=texels,
        map_seconds=seconds,
        scene_seconds=None,
        small_scene_seconds=None,
    )


def map_error(frame: sfumato.Frame) -> float:
    points, radius, opacity = particle_plume.plume()
    random = np.random.default_rng(7)
    low, high = points.min(axis=0), points.max(axis=0)
    places = random.uniform(low, high, (PLACES, 3)).astype(np.float32).astype(np.float64)
    towards = -np.array(particle_plume.SUN) / np.linalg.norm(particle_plume.SUN)
    exact: NDArray[np.float64] = np.exp(-particle_plume.optical_depth(points, radius, opacity, places, towards))
    return float(np.sqrt(np.mean((frame.transmittance(places)[:, 0] - exact) ** 2)))


def with_pictures(row: ParticleRow, scene: sfumato.Scene) -> ParticleRow:
    """The row, and what pictures of tables 1 and 2 take with its map."""
    form = FORMS[row["method"]]
    frame = sfumato.Frame(scene, texels_per_cell=texels_per_cell(scene, row["texels"]), **form)

    def picture(width: int, height: int) -> float:
        def render() -> tuple[float, None]:
            start = time.perf_counter()
            frame.render(camera(width, height), width, height, edge_samples=1)
            return time.perf_counter() - start, None

        return shortest(render)[0]

    row["scene_seconds"] = picture(*LARGE)
    row["small_scene_seconds"] = picture(*SMALL)
    return row


def finished(count: int) -> tuple[float, int]:
    """Seconds from arrays to a picture, in this process alone, and its peak of memory over what it had before."""
    before = peak_bytes()

    def picture() -> tuple[float, None]:
        arrays = particle_plume.plume(count)
        start = time.perf_counter()
        scene = sfumato.Scene()
        scene.add_particles(*arrays)
        scene.add_sun(particle_plume.SUN, (4.0, 4.0, 4.0))
        sfumato.Frame(scene).render(camera(*PICTURE), *PICTURE, edge_samples=1)
        return time.perf_counter() - start, None

    return shortest(picture)[0], peak_bytes() - before


def finished_row(case: str, count: int) -> ParticleRow:
    progress.step(f"{case}, sfumato, a picture")
    answer = subprocess.run(
        [sys.executable, __file__, str(count)], check=True, capture_output=True, text=True, timeout=600
    )
    seconds, peak = json.loads(answer.stdout)
    return picture_row(case, "sfumato", seconds, peak)


def picture_row(case: str, method: str, seconds: float, peak: int | None) -> ParticleRow:
    return ParticleRow(
        case=case,
        method=method,
        metric=PICTURE_ERROR,
        error=None,
        seconds=seconds,
        bytes=peak,
        coefficients=None,
        texels=512,
        map_seconds=None,
        scene_seconds=seconds,
        small_scene_seconds=None,
    )


def cycles_rows() -> list[ParticleRow]:
    """Both engines' pictures of the same plume in one Blender."""
    script = ROOT / "tests" / "bench" / "bench_particles_in_blender.py"
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "seconds.json"
        run_script(ROOT / "blend_samples" / "plume.blend", script, str(answer))
        seconds: dict[str, float] = json.loads(answer.read_text(encoding="utf-8"))
    return [picture_row("16k-512", f"{method}", seconds[method], None) for method in ("cycles-1", "sfumato-beside")]


def particles() -> tuple[list[ParticleRow], list[str]]:
    scene = scene_of(particle_plume.COUNT)
    tables = [
        with_pictures(map_row(scene, f"16k-{texels}", method, texels), scene)
        for texels in SIZES
        for method in ("fourier", "piecewise")
    ]
    million = map_row(scene_of(1_000_000), "1m-512", "fourier", 512)
    million["error"] = None  # the exact one takes minutes
    figure = [
        map_row(scene, "figure-4", "fourier", texels, coefficients=count)
        for texels in SIZES
        for count in (5, 7, 15, 31)
    ]
    own = map_row(scene, "16k-512", "sfumato", 512)
    whole = [finished_row("16k-512", particle_plume.COUNT), finished_row("1m-512", 1_000_000)]
    rivals = cycles_rows()
    rows = [*tables, own, million, *figure, *whole, *rivals]
    return rows, remarks(rows)


def remarks(rows: list[ParticleRow]) -> list[str]:
    """What the ratios say: the paper's is 1.5 for the build, growth is 1 where time is linear."""

    def seconds(case: str, method: str, metric: str) -> float:
        return next(
            row["seconds"] for row in rows if (row["case"], row["method"], row["metric"]) == (case, method, metric)
        )

    said = [
        f"{case}: fourier takes {seconds(case, 'fourier', MAP_ERROR) / seconds(case, 'piecewise', MAP_ERROR):.2f} times "
        "as long as piecewise to build"
        for case in ("16k-256", "16k-512", "16k-1024")
    ]
    each = seconds("16k-512", "fourier", MAP_ERROR) / (particle_plume.COUNT / 1000)
    said.append(f"16k-512: {1e3 * each:.3f} ms a thousand particles for the map")
    few, many = (seconds(case, "sfumato", PICTURE_ERROR) for case in ("16k-512", "1m-512"))
    said.append(f"1m-512: growth exponent {math.log(many / few) / math.log(1e6 / particle_plume.COUNT):.2f}")
    cycles, ours = (seconds("16k-512", method, PICTURE_ERROR) for method in ("cycles-1", "sfumato-beside"))
    said.append(f"16k-512: Cycles takes {cycles / ours:.1f} times as long to sync and trace one sample")
    return said


if __name__ == "__main__":
    print(json.dumps(finished(int(sys.argv[1]))))
