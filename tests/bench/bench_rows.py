# SPDX-License-Identifier: GPL-3.0-or-later
"""What every subject of the benchmark measures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypedDict


class Row(TypedDict):
    case: str
    method: str
    metric: str
    error: float | None
    seconds: float
    bytes: int | None


def error_of(row: Row) -> float:
    """What most subjects measure. Raises ValueError where nothing did."""
    if row["error"] is None:
        raise ValueError(f"{row['case']}, {row['method']}: no error was measured")
    return row["error"]


def seconds_at_error(rows: Sequence[Row], error: float) -> float:
    """The time that a rival needs to reach `error`, from its measured rows, by interpolation of the logarithms.

    Beyond the finest row the error is taken to fall with the root of the time, as noise does; before the coarsest row
    nothing is gained, since there is nothing cheaper to run.
    """
    if not error > 0.0:
        raise ValueError(f"error must be positive, got {error}")
    rows = sorted(rows, key=error_of, reverse=True)
    if error >= error_of(rows[0]):
        return rows[0]["seconds"]
    for coarse, fine in zip(rows, rows[1:]):
        if error > error_of(fine):
            share = math.log(error_of(coarse) / error) / math.log(error_of(coarse) / error_of(fine))
            return coarse["seconds"] * math.pow(fine["seconds"] / coarse["seconds"], share)
    return rows[-1]["seconds"] * (error_of(rows[-1]) / error) ** 2


class RayRow(Row):
    """One way to store light rays: `seconds` to build a ray, or to build and read it where the two are not apart. The
    last three belong to the method, whatever the case."""

    look_up_seconds: float | None  # a receiver
    coefficients: int
    max_error: float
    violations: int  # receivers with T > 1.001, and steps to the next receiver that gain more than 1e-3
    swing: float  # of T over 32 translations
    growth: float  # RMS change of T when the map's depth bounds grow by 10 %
    outlier: float  # RMSE with one outlier among 48 particles, over that without


class AreaLightRow(Row):
    """One way to integrate a lobe over an area light; seconds are per edge of polygons, else per light."""

    max_error: float
    p95_relative: float  # 95th percentile of the relative error where L > .01


class AirlightRow(Row):
    """One way to a lamp's light in air: `seconds` a ray, of NumPy for the rivals; relative errors."""

    p95: float  # 95th percentile
    max_error: float


class LightRow(Row):
    """One render of the plume in one light. All three errors are relative RMSE over the picture."""

    noise: float  # of the golden
    true_error: float  # without the golden's noise, which is independent of the rival's


class BasisRow(Row):
    """A frame with light maps of one basis: `bytes` of them, `seconds` of one processor for the frame and its picture."""

    series_error: float  # against the same frame with many coefficients: the basis's own share
    frame_seconds: float  # without the picture: maps and lit smoke


class VersionRow(Row):
    """One lamp or material in one Blender: `error` is Sfumato's mean radiance over that of this Blender's Cycles, less 1."""

    cycles: float  # its radiance
    noise: float  # relative to that


class CostRow(Row):
    """Seconds of light map and lit cells."""

    voxels: int  # that hold smoke
    texels: int
    seconds_per_voxel: float


class HeavyRow(Row):
    """One way to a heavy scene's picture. `seconds` are of all processors, and of the first time a process sees the
    scene; `bytes` are the peak of the process above that with an empty scene."""

    again: float | None  # seconds of the same once more: the sample asks engines to keep what they have built


class TransparencyRow(Row):
    """One way to composite transparent fragments; `seconds` are of all pixels that were measured, and `bytes` are kept of
    a pixel's transmittance while its colours are added up."""

    bytes_peak: int  # of a pixel at any time, with sums in the precision in which they are added up
    bytes_colour: int  # of these, the sums of colours
    pixels: int  # that any fragment covers
    stride: int  # of a picture: every so many pixels and rows were measured
    covered: float  # the share of the picture that any fragment covers
    mean_fragments: float  # of a covered pixel
    most_fragments: int


class RampRow(Row):
    """One way through smoke under a ramp, seconds a ray; or to build a table, of which the error is the most of any entry."""

    step: float | None  # voxels
    samples: float | None  # of the smoke, a voxel


class ShaftRow(Row):
    """One way to a picture of light shafts."""

    p999: float  # 99.9th percentile
    max_error: float
    texels: float  # or bounds of some, looked at for a pixel


class ParticleRow(Row):
    """Light maps of particles, or whole pictures of them. `bytes` are the map's, or the peak of the process above that
    without particles."""

    coefficients: int | None
    texels: int  # along the map's longer edge, about
    map_seconds: float | None
    scene_seconds: float | None  # of a picture of 1680x1050 with that map, or of the row's own
    small_scene_seconds: float | None  # of 1280x800


class MeasuredRow(Row):
    """A picture, and what its frame says of its error: `error` is the true one."""

    reported: float
    low: float
    high: float
    pixels: int  # that were looked at
    measure_seconds: float
