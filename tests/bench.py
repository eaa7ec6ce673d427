#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure one subject and print a table:  bench.py NAME [--json FILE]

Each step is a line on the standard error; Ctrl-C ends it, and what it started.
A subject returns flat rows that all have `case`, `method`, `metric`, `error`, `seconds` and `bytes` (None where nothing
measured them), and remarks to print below the table. Its rivals run in one process on the same input, so that a ratio
of two rows means something.
"""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

ROOM = Path(__file__).resolve().parent / "bench"
sys.path.insert(0, str(ROOM))

from bench_rows import BasisRow, CostRow, LightRow, Row, error_of, seconds_at_error
from blender_run import ROOT, run_script

Subject = Callable[..., tuple[Sequence[Row], list[str]]]


def against_cycles() -> tuple[list[Row], list[str]]:
    """Whole renders of the plume by Sfumato and by Cycles, judged by a Cycles render of far more samples."""
    methods = ["sfumato"] + [f"cycles-{samples}" for samples in (1, 4, 16, 64, 256)]
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "rows.json"
        golden = ROOT / "tests" / "goldens" / "plume_cycles.exr"
        script = ROOM / "bench_in_blender.py"
        run_script(ROOT / "blend_samples" / "plume.blend", script, str(golden), str(answer), *methods)
        rows: list[Row] = json.loads(answer.read_text(encoding="utf-8"))
    sfumato, *cycles = rows
    rival = seconds_at_error(cycles, error_of(sfumato))
    speed_up = rival / sfumato["seconds"]
    return rows, [f"Cycles needs {rival:.3g} s for sfumato's error: sfumato is {speed_up:.3g} times as fast"]


def bases() -> tuple[Sequence[Row], list[str]]:
    """A frame of the plume with light maps of every basis, over each ray's own range and over the map's."""
    series = ["fourier-7", "fourier-15", "cosine-7", "cosine-15", "piecewise-7", "piecewise-32", "learned-7"]
    methods = [*series, "learned-15", "curve", *(f"{method}-shared" for method in series), "learned-15-shared"]
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "rows.json"
        script = ROOM / "bench_bases_in_blender.py"
        run_script(ROOT / "blend_samples" / "plume.blend", script, str(ROOT / "tests/goldens"), str(answer), *methods)
        rows: list[BasisRow] = json.loads(answer.read_text(encoding="utf-8"))
    return rows, basis_remarks(rows)


def basis_remarks(rows: list[BasisRow]) -> list[str]:
    """Of each case, the methods that no other beats in both the basis's own error and the time."""
    remarks = []
    for case in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == case]
        best = [
            row["method"]
            for row in own
            if not any(r["series_error"] < row["series_error"] and r["seconds"] < row["seconds"] for r in own)
        ]
        remarks.append(f"{case}: none is better in both error and time than {', '.join(best)}")
    return remarks


def lights() -> tuple[Sequence[Row], list[str]]:
    """Whole renders of the plume in each kind of light."""
    methods = [f"sfumato-{quality}" for quality in ("draft", "preview", "final")]
    methods += [f"cycles-{samples}" for samples in (4, 16, 64)]
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "rows.json"
        script = ROOM / "bench_lights_in_blender.py"
        goldens = ROOT / "tests" / "goldens" / "lights"
        run_script(ROOT / "blend_samples" / "plume.blend", script, str(goldens), str(answer), *methods)
        rows: list[LightRow] = json.loads(answer.read_text(encoding="utf-8"))
    return rows, light_remarks(rows)


def light_remarks(rows: list[LightRow]) -> list[str]:
    """For each light and quality, how many times longer Cycles needs for Sfumato's error, both without the golden's
    noise. Where an error is less than a quarter of that noise, the golden cannot tell it and the remark says so."""
    remarks = []
    for case in dict.fromkeys(row["case"] for row in rows):
        ours = [row for row in rows if row["case"] == case and row["method"].startswith("sfumato-")]
        cycles = [row.copy() for row in rows if row["case"] == case and row["method"].startswith("cycles-")]
        for row in cycles:
            row["error"] = row["true_error"]
        said = []
        for row in ours:
            least = 0.25 * row["noise"]
            ratio = seconds_at_error(cycles, max(row["true_error"], least)) / row["seconds"]
            quality = row["method"].partition("-")[2]
            said.append(f"{quality} {'at least ' if row['true_error'] < least else ''}{ratio:.3g}")
        remarks.append(f"{case}: Cycles needs as many times as long for Sfumato's error: {', '.join(said)}")
    return remarks


def scale() -> tuple[Sequence[Row], list[str]]:
    """What light maps and lit smoke cost as the grid and the map grow."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_cost import cost

    rows = cost()
    return rows, growth(rows)


def growth(rows: list[CostRow]) -> list[str]:
    """How seconds grow with occupied cells, with the texels and without, and what empty space adds."""
    cubes = [row for row in rows if " in " not in row["case"]]
    fixed = [row for row in cubes if row["method"] == "map-512"]
    growing = [row for row in cubes if row["method"] == f"map-{2 * int(row['case'].partition('^')[0])}"]
    remarks = [
        f"{fine['case']}, {fine['method']}: {fine['voxels'] / coarse['voxels']:.2f} times the occupied cells of "
        f"{coarse['case']}, {coarse['method']}, in {fine['seconds'] / coarse['seconds']:.2f} times the time: "
        f"exponent {exponent(coarse, fine):.2f}"
        for series in (fixed, growing)
        for coarse, fine in zip(series, series[1:])
    ]
    for row in rows:
        if " in " in row["case"]:
            ratio = row["seconds"] / fixed[0]["seconds"]
            remarks.append(f"{row['case']}, {row['method']}: {ratio:.2f} times the time without the empty space")
    return remarks


def exponent(coarse: CostRow, fine: CostRow) -> float:
    """1 where time is linear in occupied cells."""
    return math.log(fine["seconds"] / coarse["seconds"]) / math.log(fine["voxels"] / coarse["voxels"])


def light_maps() -> tuple[Sequence[Row], list[str]]:
    """Ways to store a light ray, and rivals, on seeded profiles and on real frames."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_light_maps import light_rays  # needs the module, which Blender's side of the benchmark does not

    return light_rays()


def area_lights() -> tuple[Sequence[Row], list[str]]:
    """Integrals over area lights: cosine lobes, and microfacets."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_area_lights import cosine_lights
    from bench_microfacet import microfacet_lights

    rows: list[Row] = []
    remarks: list[str] = []
    for part in (cosine_lights, microfacet_lights):
        more, said = part()
        rows += more
        remarks += said
    return rows, remarks


def versions() -> tuple[Sequence[Row], list[str]]:
    """Each kind of lamp and material in each Blender at hand, against that one's Cycles."""
    from bench_versions import versions as in_all

    return in_all()


def denoised() -> tuple[Sequence[Row], list[str]]:
    """The plume in an official Blender, against its Cycles without and with the denoiser."""
    from bench_denoised import denoised as in_official

    return in_official()


def of_options(subject: Subject, options: dict[str, Any]) -> tuple[Sequence[Row], list[str]]:
    """What a subject measures; where an option has a value that it does not know, what it says of that and no more."""
    try:
        return subject(**options)
    except ValueError as error:
        raise SystemExit(str(error)) from error


def heavy(**options: Any) -> tuple[Sequence[Row], list[str]]:
    """Scenes with many triangles, many objects and much smoke, against another commit and against Cycles."""
    from bench_heavy import heavy as heavy_scenes

    return of_options(heavy_scenes, options)


def transparency() -> tuple[Sequence[Row], list[str]]:
    """Transparent fragments without sorting, seeded ones and those of four scenes."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_transparency import transparency as composited

    return composited()


def preintegrated() -> tuple[Sequence[Row], list[str]]:
    """Transfer functions: ways through real smoke, and building tables."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_preintegration import preintegration

    return preintegration()


def particles() -> tuple[Sequence[Row], list[str]]:
    """Light maps and pictures of a plume of particles, as in Jansen and Bavoil (2010), and beside Cycles."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_particles import particles as plumes

    return plumes()


def shafts() -> tuple[Sequence[Row], list[str]]:
    """Light in air: a lamp's, beside the published table; and ways to follow the light that solids leave."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_airlight import points
    from bench_shafts import samples, windows

    lamps, of_lamps = points()
    rows, said = windows()
    blends, of_blends = samples()
    return [*lamps, *rows, *blends], [*of_lamps, *said, *of_blends]


def scenes(**options: Any) -> tuple[Sequence[Row], list[str]]:
    """What scenes have beside smoke, against an official Blender's Cycles without and with the denoiser."""
    from bench_scenes import scenes as in_official

    return of_options(in_official, options)


def package() -> tuple[Sequence[Row], list[str]]:
    """The module that packaging/release made, against the one of this build."""
    from bench_package import package as both

    return both()


def measured(seed: int = 1) -> tuple[Sequence[Row], list[str]]:
    """What frames say of their own errors, on scenes drawn from a seed."""
    sys.path.insert(0, str(ROOT / "build" / "python"))
    from bench_measured import measured as of_seed

    return of_seed(seed)


SUBJECTS: dict[str, Subject] = {
    "arealights": area_lights,
    "bases": bases,
    "cost": scale,
    "cycles": against_cycles,
    "denoised": denoised,
    "heavy": heavy,
    "lightmaps": light_maps,
    "lights": lights,
    "measured": measured,
    "oit": transparency,
    "package": package,
    "particles": particles,
    "preintegration": preintegrated,
    "scenes": scenes,
    "shafts": shafts,
    "versions": versions,
}

OPTIONS = {"heavy": ("case", "method", "against"), "scenes": ("case",), "measured": ("seed",)}


COLUMNS = ("error", "seconds", "bytes")


def table(rows: Sequence[Row]) -> str:
    """The rows as text, one metric named above each group of them; what only some subjects measure comes last."""
    lines: list[str] = []
    metric = ""
    for row in rows:
        numbers = {name: value for name, value in row.items() if name not in ("case", "method", "metric")}
        names = [*COLUMNS, *(name for name in numbers if name not in COLUMNS)]
        if row["metric"] != metric:
            metric = row["metric"]
            lines += [f"error: {metric}", f"{'case':15} {'method':18} " + " ".join(f"{name:>12}" for name in names)]
        cells = " ".join(f"{cell(numbers[name]):>12}" for name in names)
        lines.append(f"{row['case']:15} {row['method']:18} {cells}")
    return "\n".join(lines)


def cell(value: object) -> str:
    if value is None or not isinstance(value, float):
        return "-" if value is None else str(value)
    return f"{value:.2e}" if 0.0 < abs(value) < 1e-3 else f"{value:.5f}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure one subject and print a table.")
    parser.add_argument("name", choices=sorted(SUBJECTS))
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows there too")
    parser.add_argument("--case", action="append", help="of heavy and scenes: this one; may be given several times")
    only = parser.add_argument_group("heavy alone")
    only.add_argument("--method", action="append", help="by this one; may be given several times")
    only.add_argument("--against", metavar="COMMIT", help="what the method `before` is")
    parser.add_argument("--seed", type=int, help="measured alone: what its scenes are drawn from")
    arguments = parser.parse_args()
    every = ("case", "method", "against", "seed")
    options = {name: value for name in every if (value := getattr(arguments, name)) is not None}
    for name in options:
        if name not in OPTIONS.get(arguments.name, ()):
            parser.error(f"{arguments.name} has no --{name}")
    for ending in (signal.SIGINT, signal.SIGTERM):  # what a subject has started ends with it
        signal.signal(ending, signal.default_int_handler)
    try:
        rows, remarks = SUBJECTS[arguments.name](**options)
    except KeyboardInterrupt:
        print(f"{arguments.name}: interrupted", file=sys.stderr)
        sys.exit(130)
    print(table(rows))
    for remark in remarks:
        print(remark)
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
