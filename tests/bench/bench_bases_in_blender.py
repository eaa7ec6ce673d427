# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of `bench.py bases` that runs inside Blender: frames of the plume with light maps of every basis.

    blender -b plume.blend --python bench_bases_in_blender.py -- GOLDENS ROWS.json METHOD ...

GOLDENS is tests/goldens. A METHOD is BASIS-COEFFICIENTS, for one range of depth a map with -shared behind it, or `curve`.
What is timed is the native module's part of a render: the frame with its maps, and the picture, at preview quality, in
seconds of the processor, on one thread: those hardly depend on what else the machine does.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import progress  # noqa: E402
import sfumato  # noqa: E402
from bench_in_blender import pixels, relative_rmse  # noqa: E402
from bench_rows import BasisRow  # noqa: E402
from light_cases import put_lights, small_picture  # noqa: E402
from sfumato import engine, props  # type: ignore[attr-defined] # noqa: E402
from sfumato.export import scene as exported  # noqa: E402

ROUNDS = 9  # of all methods in turn; the shortest counts
CONVERGED = "cosine-63"


def settings_of(method: str) -> dict[str, Any]:
    """Arguments of Frame, at preview quality but for the basis."""
    basis, count, shared = (method.split("-") + ["", ""])[:3]
    settings = {**props.QUALITIES["PREVIEW"].frame, "basis": basis, "ranges": shared or "own"}
    del settings["coefficients"]
    return settings | ({"coefficients": int(count)} if count else {})


class Case:
    """A scene as the add-on exports it, and a golden of a part of its picture."""

    def __init__(self, name: str, golden: Path, rectangle: tuple[slice, slice]) -> None:
        graph = bpy.context.evaluated_depsgraph_get()
        camera = bpy.context.scene.camera.evaluated_get(graph)
        projection = engine.projection_of(camera, camera.data.shift_x, bpy.context.scene.render, graph)
        self.name, self.golden, self.rectangle = name, golden.stem, rectangle
        self.scene = exported.export(graph, exported.Parts()).scene
        self.camera = sfumato.Camera(projection @ np.array(camera.matrix_world.normalized().inverted()))
        self.picture = pixels(golden)
        self.converged = self.run(CONVERGED)[0]

    def run(self, method: str) -> tuple[np.ndarray, float, float, int]:
        """The picture, row 0 at the top; seconds of all and of the frame alone; and the bytes of the first light's maps."""
        height, width = self.picture.shape[:2]
        settings = settings_of(method)
        prepared = sfumato.Prepared(threads=1)
        start = time.process_time()
        frame = sfumato.Frame(self.scene, prepared=prepared, **settings)
        made = time.process_time() - start
        image = frame.render(self.camera, width, height, edge_samples=props.QUALITIES["PREVIEW"].edge_samples)
        seconds = time.process_time() - start
        samples = int(frame.lights[0, 2, 3])
        size = sum(frame.light_map(sample=sample).bytes for sample in range(samples))
        return image[::-1, :, :3].astype(np.float64), seconds, made, size

    def rows(self, methods: list[str]) -> list[BasisRow]:
        shortest = {method: (math.inf, math.inf) for method in methods}
        found = {}
        for turn in range(ROUNDS):
            progress.step(f"{self.name}, round {turn + 1} of {ROUNDS}")
            for method in methods:
                image, *times, size = self.run(method)
                shortest[method] = (min(shortest[method][0], times[0]), min(shortest[method][1], times[1]))
                found[method] = image, size
        return [
            BasisRow(
                case=self.name,
                method=method,
                metric=f"relative RMSE in the smoke and its shadow, against {self.golden}",
                error=relative_rmse(image[self.rectangle], self.picture[self.rectangle]),
                seconds=shortest[method][0],
                bytes=size,
                series_error=relative_rmse(image[self.rectangle], self.converged[self.rectangle]),
                frame_seconds=shortest[method][1],
            )
            for method, (image, size) in found.items()
        ]


def main(goldens: Path, rows_path: Path, methods: list[str]) -> None:
    facts = json.loads((goldens / "plume_cycles.json").read_text(encoding="utf-8"))
    bpy.context.scene.frame_set(facts["frame"])
    x0, y0, x1, y1 = facts["rectangle"]
    rows = Case("plume", goldens / "plume_cycles.exr", (slice(y0, y1), slice(x0, x1))).rows(methods)
    small_picture()
    put_lights("sun-10")
    bpy.context.view_layer.update()
    rows += Case("sun-10", goldens / "lights" / "sun-10.exr", (slice(None), slice(None))).rows(methods)
    rows_path.write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    goldens_argument, rows_argument, *method_arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(goldens_argument), Path(rows_argument), method_arguments)
