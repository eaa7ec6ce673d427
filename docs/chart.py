# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/cycles.png, denoised.png, lights.png, cost.png, arealights.png, lightmaps.png, bases.png, oit.png, preintegration.png and airlight.png, from what `tests/bench.py NAME --json docs/NAME.json` measured."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
CYCLES = "0.4"
SFUMATO = "tab:orange"


def rows_of(name: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))
    return rows


def column(rows: list[dict[str, Any]], name: str, scale: float = 1.0) -> list[float]:
    return [scale * row[name] for row in rows]


def save(figure: Any, name: str, dpi: int) -> None:
    figure.tight_layout()
    figure.savefig(HERE / f"{name}.png", dpi=dpi)
    plt.close(figure)


def cycles_chart() -> None:
    rows = rows_of("cycles")
    cycles = [row for row in rows if row["method"].startswith("cycles")]
    ours = next(row for row in rows if row["method"] == "sfumato")
    figure, axes = plt.subplots(figsize=(7.0, 3.6))
    axes.loglog([row["seconds"] for row in cycles], [100.0 * row["error"] for row in cycles], "o-", color=CYCLES)
    for row in cycles:
        samples = row["method"].removeprefix("cycles-")
        axes.annotate(f"{samples} spp", (row["seconds"], 100.0 * row["error"]), (4, 5), textcoords="offset points")
    axes.loglog([ours["seconds"]], [100.0 * ours["error"]], "D", color=SFUMATO, markersize=9)
    axes.annotate("Sfumato", (ours["seconds"], 100.0 * ours["error"]), (8, 8), textcoords="offset points")
    axes.annotate("Cycles", (cycles[1]["seconds"], 100.0 * cycles[1]["error"]), (-46, -4), textcoords="offset points")
    axes.set_xlabel("seconds for the whole render call")
    axes.set_ylabel("relative RMSE, %")
    axes.set_title("The plume at 640 x 360, frame 25, two cores")
    axes.margins(0.12, 0.14)
    axes.grid(True, which="both", alpha=0.25)
    save(figure, "cycles", 120)


WAYS = {"cycles": ("0.4", "Cycles"), "marching": ("tab:blue", "Cycles, biased volumes")}


def denoised_chart() -> None:
    """Cycles of an official Blender; hollow and dashed where its denoiser has worked."""
    rows = rows_of("denoised")
    figure, axes = plt.subplots(figsize=(7.0, 3.9))
    for way, (colour, name) in WAYS.items():
        own = [row for row in rows if row["method"].startswith(way)]
        for line, filled in (
            ([row for row in own if row["method"].count("-") == count], count == 1) for count in (1, 2)
        ):
            errors = column(line, "true_error", 100.0)
            axes.loglog(
                column(line, "seconds"),
                errors,
                "o-" if filled else "o--",
                color=colour,
                markerfacecolor=colour if filled else "white",
                label=name if filled else f"{name}, denoised",
            )
            for row, error in zip(line, errors):
                samples = row["method"].split("-")[1]
                axes.annotate(samples, (row["seconds"], error), (5, 4), textcoords="offset points", fontsize=8)
    ours = rows[0]
    axes.loglog([ours["seconds"]], [100.0 * ours["true_error"]], "D", color=SFUMATO, markersize=9, label="Sfumato")
    axes.set_xlabel("seconds for the whole render call; samples beside the marks")
    axes.set_ylabel("relative RMSE, %")
    axes.set_title("The plume at 640 x 360, frame 25, Blender 5.0.1, two busy cores")
    axes.margins(0.08, 0.14)
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8, loc="center left")
    save(figure, "denoised", 120)


def lights_chart() -> None:
    """A panel for each light; below the line of a quarter of its golden's noise nothing can be told."""
    rows = rows_of("lights")
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, panels = plt.subplots(2, (len(cases) + 1) // 2, figsize=(9.6, 4.4), sharex=True, sharey=True)
    for case, axes in zip(cases, panels.flat):
        own = [row for row in rows if row["case"] == case]
        least = 25.0 * own[0]["noise"]
        for engine, style, colour in (("sfumato", "D-", SFUMATO), ("cycles", "o-", CYCLES)):
            line = [row for row in own if row["method"].startswith(engine)]
            errors = [max(error, least) for error in column(line, "true_error", 100.0)]
            axes.loglog(column(line, "seconds"), errors, style, color=colour, markersize=5, label=engine.capitalize())
        axes.axhline(least, color="0.7", linestyle=":", label="a quarter of the golden's noise")
        axes.set_title(case, fontsize=10)
        axes.grid(True, alpha=0.25)
    panels[0, 0].legend(fontsize=7)
    figure.supxlabel("seconds for the whole render call; draft, preview, final; 4, 16, 64 samples", fontsize=9)
    figure.supylabel("relative RMSE, %", fontsize=9)
    save(figure, "lights", 90)


def cost_chart() -> None:
    """Seconds against occupied cells, with a map of 512^2 and with one that grows with the grid."""
    rows = [row for row in rows_of("cost") if " in " not in row["case"]]
    fixed = [row for row in rows if row["method"] == "map-512"]
    growing = [row for row in rows if row["method"] == f"map-{2 * int(row['case'].partition('^')[0])}"]
    figure, axes = plt.subplots(figsize=(6.0, 3.6))
    axes.loglog(column(fixed, "voxels"), column(fixed, "seconds"), "s-", color=CYCLES, label="a map of 512 x 512")
    axes.loglog(
        column(growing, "voxels"),
        column(growing, "seconds"),
        "D-",
        color=SFUMATO,
        label="a map that grows with the grid",
    )
    first = growing[0]
    axes.loglog(
        column(growing, "voxels"),
        [first["seconds"] * row["voxels"] / first["voxels"] for row in growing],
        ":",
        color="0.6",
        label="linear",
    )
    for row in growing:
        axes.annotate(row["case"], (row["voxels"], row["seconds"]), (6, -10), textcoords="offset points", fontsize=8)
    axes.set_xlabel("occupied cells")
    axes.set_ylabel("seconds, light map and lit smoke")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    save(figure, "cost", 90)


def rivals(axes: Any, rows: list[dict[str, Any]], ours: set[str], scale: float) -> None:
    """A point for each method, by its time and its error, with its name."""
    for row in rows:
        own = row["method"] in ours
        colour, marker = (SFUMATO, "D") if own else (CYCLES, "o")
        axes.loglog([scale * row["seconds"]], [row["error"]], marker, color=colour, markersize=7 if own else 5)
        name = row["method"]
        place = (5, -10) if own else (5, 4)
        axes.annotate(name, (scale * row["seconds"], row["error"]), place, textcoords="offset points", fontsize=7)
    axes.margins(0.22, 0.16)
    axes.grid(True, alpha=0.25)


AREA_LIGHT_CASES = ("cosine-100", "cosine-500", "cosine-5000", "ggx", "ggx-grazing", "ggx-anisotropic")


def area_lights_chart() -> None:
    rows = rows_of("arealights")
    figure, panels = plt.subplots(2, 3, figsize=(10.0, 5.6))
    for case, axes in zip(AREA_LIGHT_CASES, panels.flat):
        rivals(axes, [row for row in rows if row["case"] == case], {"poles-2", "closed-form"}, 1e9)
        axes.set_title(case, fontsize=10)
    for axes, unit in zip(panels[:, 1], ("ns an edge, eight or more lanes; Monte Carlo in NumPy", "ns a rectangle")):
        axes.set_xlabel(unit, fontsize=9)
    figure.supylabel("RMSE over the range", fontsize=9)
    save(figure, "arealights", 90)


RAY_CASES = ("plume", "fire", "collision", "wisp")


def light_maps_chart() -> None:
    rows = rows_of("lightmaps")
    figure, panels = plt.subplots(2, 2, figsize=(10.0, 6.4), sharex=True, sharey=True)
    for case, axes in zip(RAY_CASES, panels.flat):
        own = [{**row, "method": f"{row['method']}, {row['bytes']} B"} for row in rows if row["case"] == case]
        rivals(axes, own, {row["method"] for row in own if row["method"].startswith("auto")}, 1e6)
        axes.set_title(case, fontsize=10)
    figure.supxlabel("microseconds to build a ray's transmittance", fontsize=9)
    figure.supylabel("RMSE of transmittance", fontsize=9)
    save(figure, "lightmaps", 90)


BASES = {"cosine": SFUMATO, "fourier": "tab:blue", "piecewise": "tab:green", "learned": "tab:red", "curve": "black"}


def bases_chart() -> None:
    """A frame's own share of the error against the time of its maps and lit smoke; hollow where a map has one range."""
    rows = rows_of("bases")
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, panels = plt.subplots(1, len(cases), figsize=(10.0, 4.4), sharey=True)
    for case, axes in zip(cases, panels):
        for row in (row for row in rows if row["case"] == case):
            basis, count, shared = (row["method"].split("-") + ["", ""])[:3]
            colour = BASES[basis]
            place = 1e3 * row["frame_seconds"], 100.0 * row["series_error"]
            axes.loglog(*place, "D", color=colour, markerfacecolor="none" if shared else colour, markersize=7)
            axes.annotate(count, place, (6, -3), textcoords="offset points", fontsize=8)
        axes.set_title({"plume": "the sun of the sample", "sun-10": "a sun of 10 degrees"}[case], fontsize=10)
        axes.set_xlabel("ms of one processor, light maps and lit smoke", fontsize=9)
        axes.margins(0.12, 0.12)
        axes.grid(True, which="both", alpha=0.25)
    for basis, colour in BASES.items():
        panels[0].loglog([], [], "D", color=colour, label=basis)
    panels[0].loglog([], [], "D", color="0.4", markerfacecolor="none", label="one range a map")
    panels[0].legend(fontsize=8)
    panels[0].set_ylabel("relative RMSE of the picture, %, of the series alone", fontsize=9)
    save(figure, "bases", 90)


OIT_CASES = ("fragments-8", "fragments-32", "smoke-64", "hair-40", "sheets", "particles", "hair", "model")


def transparency_chart() -> None:
    """Error against the bytes that a pixel keeps; our other ways to spend them are a line."""
    rows = rows_of("oit")
    figure, panels = plt.subplots(2, 4, figsize=(12.0, 6.0), sharex=True, sharey=True)
    for case, axes in zip(OIT_CASES, panels.flat):
        own = [row for row in rows if row["case"] == case and row["error"] > 1e-9]
        for row in own:
            name, place = row["method"], (row["bytes"], 1e3 * row["error"])
            if name == "sfumato":
                axes.semilogy(*place, "D", color=SFUMATO, markersize=8)
            elif name.startswith("sfumato-"):
                axes.semilogy(*place, ".", color=SFUMATO, markersize=4)
            else:
                axes.semilogy(*place, "o", color=CYCLES, markersize=4)
                axes.annotate(name, place, (4, 3), textcoords="offset points", fontsize=6)
        axes.set_title(case, fontsize=10)
        axes.set_xlim(0, 42)
        axes.grid(True, which="major", alpha=0.25)
    panels[1, 3].semilogy([], [], "D", color=SFUMATO, label="Sfumato, 4 nearest + 1 harmonic")
    panels[1, 3].semilogy([], [], ".", color=SFUMATO, label="other numbers of both")
    panels[1, 3].legend(fontsize=6, loc="lower left")
    figure.supxlabel("bytes that a pixel keeps for transmittance", fontsize=9)
    figure.supylabel("RMSE of colour, thousandths", fontsize=9)
    save(figure, "oit", 90)


RAMP_CASES = {"smooth": "a smooth ramp", "ramp": "constants", "peaks": "four narrow peaks"}
RAMP_METHODS = {"post-classified": CYCLES, "mean-source": "tab:blue", "full": "tab:green", "split": SFUMATO}


def preintegration_chart() -> None:
    """Error against samples of the smoke; `auto` is a ring around what it chose."""
    rows = rows_of("preintegration")
    figure, panels = plt.subplots(1, 3, figsize=(10.0, 3.9), sharey=True)
    for (case, title), axes in zip(RAMP_CASES.items(), panels):
        own = [row for row in rows if row["case"] == case]
        for method, colour in RAMP_METHODS.items():
            line = [row for row in own if row["method"] == method]
            errors = column(line, "error", 100.0)
            marker = {"split": "D", "mean-source": "o-"}.get(method, "o--")  # two of them lie on each other
            axes.loglog(column(line, "samples"), errors, marker, color=colour, markersize=5, label=method)
        auto = [row for row in own if row["method"] == "auto"]
        axes.loglog(
            column(auto, "samples"),
            column(auto, "error", 100.0),
            "o",
            color="black",
            markerfacecolor="none",
            markersize=11,
            label="auto, .2 % asked for",
        )
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("samples of the smoke a voxel", fontsize=9)
        axes.set_xticks([0.5, 1.0, 2.0, 4.0], ["½", "1", "2", "4"])
        axes.minorticks_off()
        axes.margins(0.12, 0.12)
        axes.grid(True, which="both", alpha=0.25)
    panels[0].set_ylabel("RMSE of radiance by its mean, %", fontsize=9)
    panels[0].legend(fontsize=7)
    save(figure, "preintegration", 90)


AIR_METHODS = {
    "substitution": "ζ, 16 points",
    "substitution-12": "ζ, 12 points",
    "march": "512 even steps",
    "march-16": "16 even steps",
    "table": "table of 512²",
}


def airlight_chart() -> None:
    """Of a lamp's light in air, 95 in 100 errors and the most."""
    rows = rows_of("shafts")
    figure, panels = plt.subplots(1, 2, figsize=(9.0, 2.6), sharey=True)
    for case, axes in zip(("point", "spot"), panels):
        for place, method in enumerate(AIR_METHODS):
            row = next(row for row in rows if (row["case"], row["method"]) == (case, method))
            colour = SFUMATO if method.startswith("substitution") else CYCLES
            axes.semilogx([row["p95"], row["max_error"]], [place, place], "-", color=colour, linewidth=1)
            axes.semilogx(row["p95"], place, "o", color=colour)
            axes.semilogx(row["max_error"], place, "o", color=colour, markerfacecolor="white")
        axes.set_title(f"a {case}, unshadowed", fontsize=10)
        axes.set_yticks(range(len(AIR_METHODS)), list(AIR_METHODS.values()), fontsize=8)
        axes.set_xlabel("relative error: of 95 in 100 rays less; most (hollow)", fontsize=8)
        axes.set_xlim(1e-6, 30.0)  # what is further off is off the chart
        axes.grid(True, axis="x", alpha=0.25)
    save(figure, "airlight", 90)


def main() -> None:
    cycles_chart()
    denoised_chart()
    lights_chart()
    cost_chart()
    area_lights_chart()
    light_maps_chart()
    bases_chart()
    transparency_chart()
    preintegration_chart()
    airlight_chart()


if __name__ == "__main__":
    main()
