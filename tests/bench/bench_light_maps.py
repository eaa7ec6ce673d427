# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py lightmaps: how well, in how many bytes, single light rays can be stored."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import progress
import rivals
import sfumato
from bench_rows import RayRow, error_of
from light_rays import FRAMES, ROOT, SEEDED, Rays, seeded, smoke_frame, translations, without_outlier

# What issue 3 asks of `auto`, RMSE of T x1000.
TARGETS = dict(zip(SEEDED, (15, 25, 2, 32, 11, 40, 15)))
SUN = (0.72, 0.02, -0.53)  # of the sample

Method = Callable[[Rays], np.ndarray]


# A way to store rays, made for those of a frame (which a learned basis learns from). Building and reading stand apart
# where they are timed apart.
@dataclass(frozen=True)
class Storage:
    build: Callable[[Rays], Any]
    read: Callable[[Any, Rays], np.ndarray]


@dataclass(frozen=True)
class Stored:
    storage: Callable[[Rays], Storage]
    coefficients: int
    bytes: int  # a texel, range included
    timed_apart: bool = True

    def method(self, rays: Rays) -> np.ndarray:
        """Light at the receivers."""
        storage = self.storage(rays)
        return storage.read(storage.build(rays), rays)


def series(basis: str, coefficients: int, kind: str) -> Callable[[Rays], Storage]:
    """Half floats as FOM packs them, clamped: Jansen and Bavoil (2010) where the range is whole."""

    def build(rays: Rays) -> Any:
        span = sfumato.depth_range(rays.depth, rays.optical_depth, kind, width=rays.width)
        c = sfumato.project(rays.depth, rays.optical_depth, coefficients, rays.width, basis, span)
        return c.astype(np.float16).astype(np.float32), span

    def read(stored: Any, rays: Rays) -> np.ndarray:
        c, span = stored
        return np.asarray(sfumato.transmittance(c, rays.receivers, basis, span))

    return lambda rays: Storage(build, read)


def eight_bits(basis: str, kind: str) -> Callable[[Rays], Storage]:
    """Fifteen coefficients in 20 bytes, and the monotone evaluator. A learned basis learns from a quarter of the rays
    of the frame that it serves."""

    def storage(rays: Rays) -> Storage:
        functions: Any = basis
        if basis == "learned":
            some = rays.every(4)
            span = sfumato.depth_range(some.depth, some.optical_depth, kind, width=some.width)
            functions = sfumato.learn_basis(some.depth, some.optical_depth, 15, span, some.width)

        def build(given: Rays) -> Any:
            span = sfumato.depth_range(given.depth, given.optical_depth, kind, width=given.width)
            return in_bytes(given, functions, span)

        def read(texels: Any, given: Rays) -> np.ndarray:
            c, span = sfumato.unpack(texels, functions)
            return np.asarray(sfumato.transmittance(c, given.receivers, functions, span, "monotone"))

        return Storage(build, read)

    return storage


def in_bytes(rays: Rays, functions: Any, span: np.ndarray) -> np.ndarray:
    c = sfumato.project(rays.depth, rays.optical_depth, 15, rays.width, functions, span)
    return np.asarray(sfumato.pack(c, functions, span))


def automatic(additive: bool) -> Callable[[Rays], Storage]:
    def storage(rays: Rays) -> Storage:
        choice = chosen(rays, additive)
        return Storage(
            lambda given: choice.store(given.depth, given.optical_depth, given.width),
            lambda texels, given: np.asarray(choice.transmittance(texels, given.receivers)),
        )

    return storage


def chosen(rays: Rays, additive: bool) -> sfumato.RayStorage:
    some = rays.every(4)
    return sfumato.choose_basis(some.depth, some.optical_depth, additive=additive, width=rays.width)


def published(transmittance: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]) -> Callable[[Rays], Storage]:
    return lambda rays: Storage(
        lambda given: transmittance(given.depth, given.optical_depth, given.receivers), lambda light, given: light
    )


METHODS = {
    "auto": Stored(automatic(additive=False), 14, 20),
    "auto-additive": Stored(automatic(additive=True), 15, 20),
    "fourier": Stored(series("fourier", 7, "whole"), 7, 16),
    "fourier-range": Stored(series("fourier", 7, "minmax"), 7, 20),
    "piecewise": Stored(series("piecewise", 7, "whole"), 7, 16),
    "cosine-range": Stored(eight_bits("cosine", "minmax"), 15, 20),
    "learned": Stored(eight_bits("learned", "whole"), 15, 20),
    "learned-range": Stored(eight_bits("learned", "minmax"), 15, 20),
    "moments-4": Stored(published(rivals.moments(4)), 5, 20, timed_apart=False),
    "moments-6": Stored(published(rivals.moments(6)), 7, 28, timed_apart=False),
    "haar": Stored(published(rivals.haar), 16, 32, timed_apart=False),
    "avsm-8": Stored(published(rivals.avsm), 16, 32, timed_apart=False),
    "deep-opacity": Stored(published(rivals.deep_opacity(7)), 8, 20, timed_apart=False),
}


def rmse(method: Method, rays: Rays) -> float:
    return float(np.sqrt(np.mean((method(rays) - rays.exact) ** 2)))


def swing(method: Method) -> float:
    light = np.array([method(rays) for rays in translations()])
    return float(np.mean(light.max(0) - light.min(0)))


def growth(method: Method) -> float:
    (here,), (deeper,) = translations(1.0, 1), translations(1.1, 1)
    return float(np.sqrt(np.mean((method(here) - method(deeper)) ** 2)))


def least_seconds(work: Callable[[], object], runs: int = 5) -> float:
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def violations(light: np.ndarray) -> int:
    return int((light > 1.001).sum() + (np.diff(light, axis=1) > 1e-3).sum())


def light_rays() -> tuple[list[RayRow], list[str]]:
    cases = {case: seeded(case) for case in SEEDED} | {case: smoke_frame(case, SUN) for case in FRAMES}
    cases["plume-axis"] = smoke_frame("plume", (1.0, 0.0, 0.0))
    outlier = cases["outlier"]
    rows: list[RayRow] = []
    for name, stored in METHODS.items():
        progress.step(name)
        moved, grown = swing(stored.method), growth(stored.method)
        widened = rmse(stored.method, outlier) / rmse(stored.method, without_outlier(outlier))
        for case, rays in cases.items():
            storage, single = stored.storage(rays), rays.in_single_precision()
            texels = storage.build(single)
            light = storage.read(texels, rays)
            build = least_seconds(lambda: storage.build(single))
            read = least_seconds(lambda: storage.read(texels, single)) if stored.timed_apart else None
            error = light - rays.exact
            rows.append(
                RayRow(
                    case=case,
                    method=name,
                    metric="RMSE of transmittance",
                    error=float(np.sqrt(np.mean(error**2))),
                    seconds=build / len(rays.depth),
                    bytes=stored.bytes,
                    look_up_seconds=None if read is None else read / rays.receivers.size,
                    coefficients=stored.coefficients,
                    max_error=float(np.abs(error).max()),
                    violations=violations(light),
                    swing=moved,
                    growth=grown,
                    outlier=widened,
                )
            )
    return rows, remarks(rows, cases)


def remarks(rows: list[RayRow], cases: dict[str, Rays]) -> list[str]:
    error = {(row["method"], row["case"]): error_of(row) for row in rows}
    out = []
    for method, additive in (("auto", False), ("auto-additive", True)):
        out += [f"{method}, {case}: {chosen(rays, additive).reason}" for case, rays in cases.items()]
        for case, target in TARGETS.items():
            out.append(f"{method}, {case}: {1e3 * error[method, case]:.1f}e-3, target {target}e-3")
        for case in (*FRAMES, "plume-axis"):
            fourier, slices = (error[rival, case] / error[method, case] for rival in ("fourier", "piecewise"))
            out.append(f"{method}, {case}: 1/{fourier:.1f} of fourier (target 1/5), 1/{slices:.1f} of piecewise (1/6)")
    progress.step("ranges that texels share, and times on one thread")
    return out + [tile_remark(case) for case in FRAMES] + time_remarks()


def tile_remark(case: str, tile: int = 8) -> str:
    """What it costs that texels share a range, as filtering coefficients asks."""
    rays = smoke_frame(case, SUN, 96)
    whole = rays.on_map()
    shared = {
        side: sfumato.depth_ranges(*whole, side, width=rays.width).reshape(-1, 2)[rays.texel] for side in (0, tile)
    }
    own = sfumato.depth_range(rays.depth, rays.optical_depth, width=rays.width)
    storage = eight_bits("cosine", "minmax")(rays)
    error = [
        rmse(lambda given: storage.read(in_bytes(given, "cosine", span), given), rays)
        for span in (own, shared[tile], shared[0])
    ]
    return (
        f"cosine-range, {case}, {rays.side} x {rays.side} texels: {1e3 * error[0]:.1f}e-3 on their own ranges, "
        f"{1e3 * error[1]:.1f}e-3 on those of {tile} x {tile} tiles, {1e3 * error[2]:.1f}e-3 on one for the map"
    )


def time_remarks() -> list[str]:
    """In C++, on one thread: nanoseconds, and how many times those of seven slices or of seven Fourier coefficients."""
    program = ROOT / "build" / "tests" / "ray_times"
    rows = json.loads(subprocess.run([program], capture_output=True, check=True, text=True).stdout)
    out = []
    for row in rows:
        reading = row["what"] == "look-up"
        rival, named = ("fourier", "7 Fourier coefficients, target 1.1") if reading else ("piecewise", "7 slices")
        least = next(r["nanoseconds"] for r in rows if r == row | {"method": rival, "nanoseconds": r["nanoseconds"]})
        target = ", target 1.2" if row["method"] == "fourier" and not reading else ""
        out.append(
            f"{row['what']}, {row['method']}, {row['count']} {'receiver(s)' if reading else 'absorbers'} a ray: "
            f"{row['nanoseconds']:.1f} ns, {row['nanoseconds'] / least:.2f} of {named}{target}"
        )
    return out
