# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/stability/*.png, one for each row of docs/stability.md, from what tests/stability measures:

    PYTHONPATH=build/python python3 docs/stability_figures.py [NAME...]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("bench", "stability")]
matplotlib.use("Agg")

import frame_failures as frames  # noqa: E402
import light_failures as lights  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import ray_failures as rays  # noqa: E402
import sfumato  # noqa: E402
import test_stable_animation as animation  # noqa: E402
from bench_light_maps import METHODS  # noqa: E402
from light_rays import RECEIVERS, Rays, flat, translations  # noqa: E402

Array = np.ndarray
# What of METHODS is drawn: the paper's, slices, deep opacity maps, and ours: the curve and what adds up.
NAMES = {
    "fourier": "Fourier, 7",
    "fourier-range": "Fourier, 7, own range",
    "piecewise": "slices, 7 (OSM)",
    "deep-opacity": "deep opacity, 7",
    "cosine-range": "cosine, 15, own range",
    "auto-additive": "ours, additive",
    "auto": "ours, curve",
}
COLOURS = dict(zip(NAMES, ("tab:blue", "tab:cyan", "tab:green", "tab:purple", "0.5", "tab:pink", "tab:orange")))


def curves(
    name: str, x: Iterable[float], lines: dict[str, Array], labels: tuple[str, str], scale: str = "linear"
) -> None:
    figure, axes = plt.subplots(figsize=(6.0, 2.8))
    plot = {"linear": axes.plot, "loglog": axes.loglog, "semilogx": axes.semilogx}[scale]
    for label, y in lines.items():
        style: dict[str, Any] = {"color": COLOURS.get(label)}
        if label == "exact":
            style = {"color": "black", "linestyle": "--"}
        plot(list(x), y, label=NAMES.get(label, label), linewidth=1.3, **style)
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=7)
    save(figure, name)


def save(figure: Any, name: str, dpi: int = 100) -> None:
    figure.tight_layout()
    figure.savefig(ROOT / "docs" / "stability" / f"{name}.png", dpi=dpi)
    plt.close(figure)


def pictures(name: str, rows: list[list[tuple[str, Array, float]]], height: float = 1.9) -> None:
    """Each a title, values, and which of them is white."""
    shape = rows[0][0][1].shape
    width = len(rows[0]) * height * shape[1] / shape[0]
    figure, all_axes = plt.subplots(len(rows), len(rows[0]), figsize=(width, len(rows) * (height + 0.25)))
    for axes, (title, values, white) in zip(np.ravel(all_axes), [cell for row in rows for cell in row]):
        axes.imshow(values, origin="lower", interpolation="nearest", cmap="gray", vmin=0.0, vmax=white)
        axes.set_title(title, fontsize=7)
        axes.set_axis_off()
    save(figure, name, 110)


def translation() -> None:
    moved = translations()
    lines = {
        method: np.array([METHODS[method].method(given)[0, 2] for given in moved])
        for method in ("fourier", "piecewise", "deep-opacity", "auto-additive", "auto")
    }
    lines["exact"] = np.array([given.exact[0, 2] for given in moved])
    shifts = 12.5 * np.arange(len(moved)) / len(moved)
    curves("translation", shifts, lines, ("shift of smoke and receiver, % of the map's depth", "light in the middle"))


def orbits() -> None:
    """A cloud of revolution, and what changes between two frames of an orbit around it."""
    scene = sfumato.Scene()
    frames.add_smoke(scene, frames.revolved(), frames.cube(32, 2.0, (0, 0, 0.3)), 7.0)
    scene.add_sun((0, 0, -1), (4, 4, 4))
    frames.add_floor(scene)
    made, seen = frames.frame(scene), []
    for angle in np.radians((0.0, 3.0, 30.0)):
        eye = frames.camera((5 * np.sin(angle), -5 * np.cos(angle), 4.0), (0, 0, 0.8))
        seen.append(frames.pixels(made.render(eye, frames.WIDTH, frames.HEIGHT))[..., 0])
    white = float(seen[0].max())
    change = 100 * np.abs(seen[1] - seen[0])
    pictures("orbits", [[("0°", seen[0], white), ("30°", seen[2], white), ("3° less 0°, 100 times", change, white)]])


def bounds() -> None:
    """Figure 5: rows of methods; the picture, that of a map a tenth deeper, their difference, and by the first."""
    exact = rays.plume_picture(None, fine=2)
    white, smoke = float(exact.max()), exact > 0.02 * exact.max()
    rows: list[list[tuple[str, Array, float]]] = []
    for method in ("fourier", "piecewise", "deep-opacity", "auto-additive"):
        here, deeper = (rays.plume_picture(METHODS[method].method, scale, fine=2) for scale in (1.0, 1.1))
        off = np.abs(deeper - here)
        relative = np.where(smoke, off / np.maximum(here, 1e-6), 0.0)
        shown = float(np.sqrt(np.mean(off[exact > 0.0] ** 2)) / here[exact > 0.0].mean())
        rows.append(
            [
                (NAMES[method], here, white),
                ("bounds + 10 %", deeper, white),
                (f"absolute, 5 times\nRMS {shown:.2%} of the mean", 5 * off, white),
                (f"relative, white is 30 %\n99th percentile {np.quantile(relative[smoke], 0.99):.1%}", relative, 0.3),
            ]
        )
    pictures("bounds", rows)


def outliers() -> None:
    rng = np.random.default_rng(5)
    depth = np.append(0.75 + 0.02 * rng.standard_normal(48), 0.03)[None]
    given = flat(depth, np.full(depth.shape, 0.05), RECEIVERS)
    depth, tau, receivers, light = (
        np.repeat(a, 4, 0) for a in (given.depth, given.optical_depth, given.receivers, given.exact)
    )
    several = Rays(depth, tau, receivers, light)
    lines = {name: METHODS[name].method(several)[0] for name in NAMES if name != "piecewise"}
    curves("outliers", RECEIVERS, lines | {"exact": given.exact[0]}, ("depth", "light"))


def ringing() -> None:
    """Figure 8: one ray."""
    exact = rays.sheets_in_haze().exact[1]
    figure, all_axes = plt.subplots(1, 3, figsize=(9.0, 2.6), sharey=True)
    for axes, coefficients in zip(all_axes, (15, 101, 1001)):
        for basis, colour in (("fourier", "tab:blue"), ("cosine", "0.5"), ("piecewise", "tab:green")):
            axes.plot(
                rays.ACROSS, rays.light_by_sheets(basis, coefficients)[1], color=colour, label=basis, linewidth=1.0
            )
        ours = METHODS["auto"].method(rays.sheets_in_haze())[1]
        axes.plot(rays.ACROSS, ours, color="tab:orange", label="ours, 20 bytes", linewidth=1.0)
        axes.plot(rays.ACROSS, exact, "k--", label="exact", linewidth=0.8)
        axes.set_title(f"{coefficients} coefficients", fontsize=8)
        axes.set_xlabel("depth")
    all_axes[0].set_ylabel("light")
    all_axes[0].legend(fontsize=6)
    save(figure, "ringing")


def stall() -> None:
    alphas = np.geomspace(1e-4, 2e-2, 12)
    given = [rays.many_layers(int(round(4.0 / alpha)), alpha, 1) for alpha in alphas]
    lines = {"RGBA16F, blended": np.array([rays.total_off(rays.summed_in_halves, one) for one in given])}
    lines["ours, additive"] = np.array(
        [max(rays.total_off(METHODS["auto-additive"].method, one), 1e-7) for one in given]
    )
    curves(
        "stall", alphas, lines, ("opacity of a layer, of so many that 1.8 % is left", "error of what is left"), "loglog"
    )


def leaks() -> None:
    heights = np.linspace(0.02, 1.0, 40)
    lines = {"smoke below a roof": np.array([frames.leak_below_a_roof(height) for height in heights])}
    curves("leaks", heights, lines, ("roof above the middles of the cells below, cells", "light below, by that above"))


def self_shadows() -> None:
    lifts = np.geomspace(0.03, 90.0, 30)
    lines = {kind: np.array([frames.shadow_of_itself(kind, lift) for lift in lifts]) for kind in ("solid", "sheet")}
    curves("self_shadows", lifts, lines, ("elevation of the sun, degrees", "largest relative error"), "loglog")


def grazing() -> None:
    height = lights.setting().rectangles[:, :, 2].mean(1)
    lines = {name: lights.reflected(method) for method, name in (("ltc", "LTC"), ("closed-form", "ours"))}
    lines["64 samples"] = lights.reflected("montecarlo-64")
    curves("grazing", height, lines | {"exact": lights.of_reference()}, ("height of the lamp's middle, m", "radiance"))


def epipole() -> None:
    march, fine = (lights.shafts_round_an_edge(0.0, method) for method in ("march", "epipolar-fine"))
    white = float(np.quantile(march, 0.99))
    change = 10 * np.abs(fine - march)
    pictures(
        "epipole", [[("march", march, white), ("slices, fine", fine, white), ("difference, 10 times", change, white)]]
    )


def one_cell() -> None:
    rows: list[list[tuple[str, Array, float]]] = []
    for where in ("corners", "layer"):
        scene = sfumato.Scene()
        frames.add_smoke(scene, frames.filled(where), frames.cube(16, 1.6, (0, 0, 0.2)), 8.0)
        scene.add_sun((0.4, 0.3, -1.0), (4, 4, 4))
        frames.add_floor(scene)
        eye = frames.camera((0.5, -2.2, 2.0), (0, 0, 0.7))
        size = frames.WIDTH, frames.HEIGHT
        truth = frames.pixels(sfumato.reference.render(scene, eye, *size, sun_samples_per_axis=1, step=0.02))[..., 0]
        seen = frames.pixels(frames.frame(scene).render(eye, *size, 1))[..., 0]
        white = float(truth.max())
        rows.append([(f"{where}: the judge", truth, white), ("ours, Preview", seen, white)])
        rows[-1].append(("difference, 10 times", 10 * np.abs(seen - truth), white))
    pictures("one_cell", rows)


def far() -> None:
    metres = np.geomspace(100.0, 1e6, 17)
    lines = {
        name: np.maximum([frames.far_away(away, told) for away in metres], 1e-7)
        for name, told in (("from the world's origin", False), ("from the scene's own", True))
    }
    curves("far", metres, lines, ("distance, m", "change of the picture, RMS"), "loglog")


def dense() -> None:
    depths = np.geomspace(0.2, 20.0, 9)
    lines = {f"{edges} edges": np.array([frames.dense_cells(d, edges) for d in depths]) for edges in ("soft", "hard")}
    curves("dense", depths, lines, ("optical depth a cell", "error of smoke at Preview, RMS"), "loglog")


def long_animation() -> None:
    prepared = sfumato.Prepared(threads=2)
    first = animation.at(0, prepared)
    start, memory, change = animation.resident_bytes(), [], []
    for number in range(1, animation.FRAMES + 1):
        seen = animation.at(number, prepared)
        memory.append((animation.resident_bytes() - start) / 1e6)
        change.append(float(np.sqrt(np.mean((seen - first) ** 2)) / first.mean()))
    figure, axes = plt.subplots(figsize=(6.0, 2.6))
    axes.plot(range(1, animation.FRAMES + 1), change, color="tab:blue", linewidth=1.0)
    axes.set_xlabel("frame")
    axes.set_ylabel("RMS from frame 0")
    beside = axes.twinx()
    beside.plot(range(1, animation.FRAMES + 1), memory, color="tab:orange", linewidth=1.0)
    beside.set_ylabel("MB more than at frame 0")
    beside.set_ylim(-1.0, 10.0)
    save(figure, "long_animation")


FIGURES: dict[str, Callable[[], None]] = {
    figure.__name__: figure
    for figure in (
        translation,
        orbits,
        bounds,
        outliers,
        ringing,
        stall,
        leaks,
        self_shadows,
        grazing,
        epipole,
        one_cell,
        far,
        dense,
        long_animation,
    )
}

if __name__ == "__main__":
    for wanted in sys.argv[1:] or FIGURES:
        print(wanted, flush=True)
        FIGURES[wanted]()
