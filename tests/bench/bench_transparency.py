# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py oit: transparent fragments without sorting, against the exact composite.

`sfumato`, `fourier` and `weighted-blended` are the module's, rounded to what is kept; the rivals are NumPy, so that their
seconds tell nothing about them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import progress
import sfumato
import transparency_rivals as rivals
from bench_rows import TransparencyRow, error_of
from fragments import SCENES, Pixels, draws, random_fragments

# RMSE of colour x1000 that the default has to reach, in bytes that it must not exceed.
TARGETS = {"fragments-2": 0.8, "fragments-8": 6.5, "fragments-32": 12.5, "smoke-64": 1.2, "hair-40": 2.0}
MOST_BYTES = 22


@dataclass(frozen=True)
class Method:
    """`bytes` a pixel keeps of transmittance while colours are added up; `peak` is the most at any time, sums in single
    floats, colours included; `colour` the sums of colours."""

    composite: Callable[[Pixels], np.ndarray]
    bytes: int
    peak: int
    colour: int


def by(function: Callable[..., Any], *arguments: float) -> Callable[[Pixels], np.ndarray]:
    def composite(pixels: Pixels) -> np.ndarray:
        return np.asarray(function(pixels.depth, pixels.alpha, pixels.colour, *arguments))[..., :3]

    return composite


def nearest(count: int, harmonics: int) -> Method:
    """The peak is that of addon/gpu/transparency.py: what is kept, a depth of each layer and of the range's two ends, the
    depth test's, and in single floats the layers' optical depths and the series, in targets of four."""
    kept = 4 * count + 4 + 2 * harmonics
    sums = 16 * (-(-count // 4) - (-(1 + 2 * harmonics) // 4))
    return Method(by(sfumato.composite_nearest, count, harmonics), kept, kept + 4 * (count + 3) + sums, 32)


def fourier(terms: int, sigma: float) -> Method:
    """Half floats in targets of four, and a colour with its weight in half floats too."""
    kept = 8 * ((2 * terms + 3) // 4)
    return Method(by(sfumato.composite_fourier, terms, sigma), kept, kept + 8, 8)


METHODS = {
    "sfumato": nearest(4, 1),
    "fourier": fourier(4, 1.0),
    "weighted-blended": Method(by(sfumato.composite_weighted), 4, 20, 16),
    "moments-4": Method(rivals.moments(4), 20, 36, 16),
    "moments-6": Method(rivals.moments(6), 28, 44, 16),
    "mlab-4": Method(rivals.mlab, 32, 32, 0),
    "nearest-tail": Method(rivals.nearest_tail, 20, 36, 16),
}
# Other ways to spend the bytes, and the published method without its sigma factors.
FRONTIER = {
    f"sfumato-{k}-{h}": nearest(k, h) for k, h in ((0, 4), (1, 3), (2, 2), (3, 1), (2, 5), (3, 3), (4, 0), (4, 3))
}
FRONTIER |= {"fourier-plain": fourier(4, 0.0)}


def rmse(error: Iterable[np.ndarray]) -> float:
    """Of differences that come in parts."""
    squares, count = 0.0, 0
    for part in error:
        squares += float((part**2).sum())
        count += part.size
    return float(np.sqrt(squares / count))


@dataclass(frozen=True)
class Case:
    """Pixels in groups; of a picture, every `stride`-th pixel of every `stride`-th row. `covered`: the share that any
    fragment covers."""

    name: str
    groups: list[Pixels]
    stride: int = 1
    covered: float = 1.0

    def row(self, name: str, method: Method, error: float, seconds: float, metric: str) -> TransparencyRow:
        counts = np.concatenate([(pixels.alpha > 0.0).sum(1) for pixels in self.groups])
        return TransparencyRow(
            case=self.name,
            method=name,
            metric=metric,
            error=error,
            seconds=seconds,
            bytes=method.bytes,
            bytes_peak=method.peak,
            bytes_colour=method.colour,
            pixels=len(counts),
            stride=self.stride,
            covered=self.covered,
            mean_fragments=float(counts.mean()),
            most_fragments=int(counts.max()),
        )

    def rows(self) -> list[TransparencyRow]:
        """All methods."""
        exact = [rivals.exact(pixels) for pixels in self.groups]
        out = []
        for name, method in ({"exact": self.lists()} | METHODS | FRONTIER).items():
            start = time.process_time()
            answers = [method.composite(pixels) for pixels in self.groups]
            seconds = time.process_time() - start
            error = rmse(answer - truth for answer, truth in zip(answers, exact))
            out.append(self.row(name, method, error, seconds, "RMSE of colour"))
        return out

    def lists(self) -> Method:
        """A node of a list has depth, opacity and colour in half floats, and where the next is."""
        counts = np.concatenate([(pixels.alpha > 0.0).sum(1) for pixels in self.groups])
        return Method(rivals.exact, round(16 * float(counts.mean())), 16 * int(counts.max()), 0)


def transmittance_errors(terms: int, sigma: float, pixels: Pixels) -> tuple[float, float]:
    """RMSE of transmittance by the series as published, at the fragments and midway between two of them (table 1 of Song
    counts the first alone)."""
    own = pixels.sorted()
    coefficients = sfumato.project(own.depth, -np.log1p(-own.alpha), 2 * terms - 1)
    averaged = sfumato.average_series(coefficients, sigma)
    exact = rivals.before(own.alpha)
    middle = 0.5 * (own.depth[:, :-1] + own.depth[:, 1:])
    return (
        rmse([sfumato.transmittance(averaged, own.depth) - exact[:, :-1]]),
        rmse([sfumato.transmittance(averaged, middle) - exact[:, 1:-1]]),
    )


def table_1() -> list[TransparencyRow]:
    pixels = random_fragments(8)
    case = Case("table-1", [pixels])
    rows = []
    for terms in (2, 4, 8, 16, 32):
        for sigma in (0.0, 1.0):
            method = fourier(terms, sigma)
            start = time.process_time()
            errors = transmittance_errors(terms, sigma, pixels)
            seconds = time.process_time() - start
            for place, error in zip(("at", "between"), errors):
                name = f"fourier-{terms}{'-sigma' if sigma else ''}-{place}"
                rows.append(case.row(name, method, error, seconds, "RMSE of transmittance at, or between, fragments"))
    return rows


def transparency() -> tuple[list[TransparencyRow], list[str]]:
    rows: list[TransparencyRow] = []
    for case, pixels in draws().items():
        progress.step(case)
        rows += Case(case, [pixels]).rows()
    for case, make in SCENES.items():
        progress.step(case)
        scene = make()
        groups = list(scene.pixels())
        rows += Case(case, groups, scene.stride, scene.covered(groups)).rows()
    progress.step("table 1")
    rows += table_1()
    return rows, remarks(rows)


def remarks(rows: list[TransparencyRow]) -> list[str]:
    error = {(row["case"], row["method"]): 1e3 * error_of(row) for row in rows}
    out = [
        f"sfumato, {case}: {error[case, 'sfumato']:.2f}e-3 in {METHODS['sfumato'].bytes} bytes, target {target}e-3"
        for case, target in TARGETS.items()
    ]
    for case in SCENES:
        others = [name for name in METHODS if name != "sfumato"]
        cheap = [name for name in others if METHODS[name].bytes <= MOST_BYTES]
        best, any_best = (min(some, key=lambda name: error[case, name]) for some in (cheap, others))
        own = error[case, "sfumato"]
        out.append(
            f"{case}: {own:.2f}e-3; the best rival in no more bytes is {best}, {error[case, best]:.2f}e-3, and of any "
            f"size {any_best}, {error[case, any_best]:.2f}e-3; weighted-blended has {error[case, 'weighted-blended']:.1f}e-3"
        )
    return [*out, "seconds of one processor: sfumato, fourier and weighted-blended in the module, all others in NumPy"]
