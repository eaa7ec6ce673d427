# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py heavy: scenes with many triangles, many objects and much smoke, and views of them that change.

Each measurement is a process of its own, Blender or plain Python, and leaves a file of numbers and its picture. The
methods are this tree's build (`sfumato`), that of another commit (`before`) and Cycles on the CPU with one sample and
light that scatters once (`cycles-1`). Where a scene has no golden, `error` tells how far the picture is from before's.

    bench.py heavy [--case CASE]... [--method METHOD]... [--against COMMIT]
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench_rows import HeavyRow
from blender_run import ROOT, environment
from heavy_before import PYTHON, command, tree_of
from heavy_targets import MIB, remarks

Image = NDArray[np.floating[Any]]

ROOM = Path(__file__).resolve().parent
BEFORE = "f1bdd73"
LONGEST = 1800.0  # seconds of one process

PICTURE = "picture against before's, relative RMSE"
SURFACES = "refined surfaces against a fresh view's, largest difference"
GOLDEN = "relative RMSE in the rectangle, against plume_cycles"


@dataclass(frozen=True)
class Case:
    script: str
    methods: tuple[str, ...]
    processes: int = 1  # that are asked; the medians count
    metric: str = PICTURE


ALL, OURS = ("before", "sfumato", "cycles-1"), ("before", "sfumato")
CASES = {
    "triangles-4m": Case("heavy_renders.py", ALL),
    "instances-2000": Case("heavy_renders.py", ALL, 3),
    "instances-20000": Case("heavy_renders.py", ALL),
    "lamp-drag": Case("heavy_views.py", OURS, metric=SURFACES),
    "lamp-drag-15k": Case("heavy_views.py", OURS, 3, SURFACES),
    "camera-drag": Case("heavy_views.py", OURS, 3),
    "playback": Case("heavy_views.py", OURS, 3),
    "trail": Case("heavy_renders.py", ALL, 3),
    "half-full": Case("heavy_module.py", OURS, 3),
    "dense-256": Case("heavy_module.py", OURS, 3),
    "plume": Case("heavy_renders.py", ALL, 3, GOLDEN),
}


def chosen(cases: Sequence[str] | None, methods: Sequence[str] | None) -> dict[str, list[str]]:
    """The methods by which each case is to be measured. Raises ValueError for a name that is not known."""
    for kind, names, known in (("case", cases, set(CASES)), ("method", methods, set(ALL))):
        for name in names or ():
            if name not in known:
                raise ValueError(f"--{kind} is '{name}', but must be one of {', '.join(sorted(known))}")
    return {
        name: [method for method in case.methods if not methods or method in methods]
        for name, case in CASES.items()
        if not cases or name in cases
    }


def relative_rmse(picture: Image, other: Image) -> float:
    return float(np.sqrt(np.mean((picture.astype(float) - other) ** 2)) / np.mean(np.abs(other)))


def largest_difference(surfaces: Image, other: Image) -> float:
    """Of radiances, and of distances by their own size; both are infinite where nothing is hit."""
    both = np.isfinite(surfaces) & np.isfinite(other)
    if not np.array_equal(surfaces[~both], other[~both]):
        return float("inf")
    a, b = surfaces[both].astype(float), other[both].astype(float)
    return float(np.max(np.abs(a - b) / np.maximum(1.0, np.abs(b)), initial=0.0))


def say(text: str) -> None:
    print(f"heavy: {text}", file=sys.stderr, flush=True)


def run(words: list[str], settings: dict[str, str]) -> None:
    """Wait for a program, and end it with all its children where the wait ends otherwise. Raises RuntimeError with what
    it printed last where it fails."""
    with tempfile.TemporaryFile(mode="w+", errors="replace") as output:
        child = subprocess.Popen(words, env=settings, stdout=output, stderr=output, start_new_session=True)
        ending = f"is stopped after {LONGEST:g} s"
        status = None
        try:
            status = child.wait(LONGEST)
            ending = f"ended with {status}"
        except subprocess.TimeoutExpired:
            pass
        finally:
            if child.poll() is None:
                os.killpg(child.pid, signal.SIGTERM)
                try:
                    child.wait(10.0)
                except subprocess.TimeoutExpired:
                    os.killpg(child.pid, signal.SIGKILL)
                    child.wait()
        if status != 0:
            output.seek(0)
            lines = "".join(output.readlines()[-15:])
            raise RuntimeError(f"{Path(words[0]).name} {ending}:\n{lines}")


def start(tree: Path, script: str, arguments: list[str]) -> None:
    """Run one of the scripts with the build of `tree`."""
    settings = environment(tree)
    if script == "heavy_module.py":
        run([PYTHON, str(ROOM / script), *arguments], settings | {"PYTHONPATH": str(tree / "build" / "python")})
        return
    blender = shutil.which("blender")
    if blender is None:
        raise RuntimeError("blender is not on the PATH")
    addons = tree / "build" / "blender" / "scripts" / "addons"
    addons.mkdir(parents=True, exist_ok=True)
    link = addons / "sfumato"
    if not link.exists():
        link.symlink_to(tree / "build" / "addon" / "sfumato")
    # Debian's Blender takes the folders of the first Python in the PATH.
    settings["PATH"] = os.pathsep.join(("/usr/bin", settings.get("PATH", "")))
    words = [blender, "--factory-startup", "--addons", "sfumato", "--python-exit-code", "3"]
    if script == "heavy_views.py":
        words = ["xvfb-run", "-a", *words, "--window-geometry", "0", "0", "776", "497"]
    else:
        words.append("--background")
    run([*words, "--python", str(ROOM / script), "--", *arguments], settings)


def ask(name: str, method: str, number: int, tree: Path, folder: Path) -> dict[str, Any]:
    """What one process measures."""
    case = CASES[name]
    say(f"{name}, {method}: {number + 1} of {case.processes} ...")
    start(tree, case.script, [name, method, str(folder)])
    answer: dict[str, Any] = json.loads((folder / f"{name}-{method}.json").read_text(encoding="utf-8"))
    memory = "" if answer["bytes"] is None else f", {answer['bytes'] / MIB:.0f} MiB"
    say(f"{name}, {method}: {answer['seconds']:.4g} s{memory}")
    return answer


def measure(
    name: str, methods: Sequence[str], trees: dict[str, Path], folder: Path
) -> tuple[list[HeavyRow], list[str]]:
    """The rows of one case, and what failed. Its methods take turns, so that whatever else the machine does meets all."""
    answers: dict[str, list[dict[str, Any]]] = {method: [] for method in methods}
    failed: dict[str, str] = {}
    for number in range(CASES[name].processes):
        for method in methods:
            if method not in failed:
                try:
                    answers[method].append(ask(name, method, number, trees[method], folder))
                except RuntimeError as error:
                    failed[method] = f"{name}, {method}: {error}"
                    say(failed[method])
    rows: list[HeavyRow] = []
    for method in methods:
        if answers[method]:
            row = row_of(name, method, answers[method])
            if row["error"] is None and method == "sfumato":
                row["error"] = error_of(name, trees[method], folder)
            rows.append(row)
        loops = [answer["bare_loop"] for answer in answers[method] if answer.get("bare_loop") is not None]
        if loops and method == "sfumato":
            rows.append(row_of(name, "bare-loop", [{"seconds": loop} for loop in loops]))
    return rows, list(failed.values())


def row_of(name: str, method: str, answers: Sequence[dict[str, Any]]) -> HeavyRow:
    """The medians of what some processes measured."""

    def median(column: str) -> float | None:
        values = [answer[column] for answer in answers if answer.get(column) is not None]
        return statistics.median(values) if values else None

    peak = median("bytes")
    return HeavyRow(
        case=name,
        method=method,
        metric=CASES[name].metric,
        error=median("error"),
        seconds=statistics.median(answer["seconds"] for answer in answers),
        bytes=None if peak is None else int(peak),
        again=median("again"),
    )


def error_of(name: str, tree: Path, folder: Path) -> float | None:
    """Of what the last process left; None where there is nothing to compare with."""
    case = CASES[name]
    rival, difference = ("fresh", largest_difference) if case.metric == SURFACES else ("before", relative_rmse)
    if rival == "fresh":
        say(f"{name}: a fresh view ...")
        start(tree, case.script, [name, rival, str(folder)])
    path = folder / f"{name}-{rival}.npy"
    return difference(np.load(folder / f"{name}-sfumato.npy"), np.load(path)) if path.exists() else None


def heavy(
    case: Sequence[str] | None = None, method: Sequence[str] | None = None, against: str = BEFORE
) -> tuple[list[HeavyRow], list[str]]:
    """The rows of bench.py heavy, and how they stand to what is wanted. What fails is a remark, and so is Ctrl-C."""
    todo = chosen(case, method)
    rows: list[HeavyRow] = []
    failed: list[str] = []
    trees = {"sfumato": ROOT, "cycles-1": ROOT}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            if "trail" in todo:
                command("cmake", "--build", str(ROOT / "build"), "--target", "trail_file")
                command(str(ROOT / "build" / "tests" / "trail_file"), str(folder / "trail.vdb"))
            if any("before" in methods for methods in todo.values()):
                say(f"building {against}, where that is still to be done ...")
                trees["before"] = tree_of(against)
            for wanted, methods in todo.items():
                measured, problems = measure(wanted, methods, trees, folder)
                rows += measured
                failed += problems
        except KeyboardInterrupt:
            failed.append("interrupted: what is above is all that was measured")
    return rows, remarks(rows) + failed
