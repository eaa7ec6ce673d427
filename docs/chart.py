# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/cycles.png: error against time, from what `tests/bench.py cycles --json docs/cycles.json` measured."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent


def main() -> None:
    rows = json.loads((HERE / "cycles.json").read_text(encoding="utf-8"))
    cycles = [row for row in rows if row["method"].startswith("cycles")]
    ours = next(row for row in rows if row["method"] == "sfumato")
    figure, axes = plt.subplots(figsize=(7.0, 3.6))
    axes.loglog([row["seconds"] for row in cycles], [100.0 * row["error"] for row in cycles], "o-", color="0.4")
    for row in cycles:
        samples = row["method"].removeprefix("cycles-")
        axes.annotate(f"{samples} spp", (row["seconds"], 100.0 * row["error"]), (4, 5), textcoords="offset points")
    axes.loglog([ours["seconds"]], [100.0 * ours["error"]], "D", color="tab:orange", markersize=9)
    axes.annotate("Sfumato", (ours["seconds"], 100.0 * ours["error"]), (8, 8), textcoords="offset points")
    axes.annotate("Cycles", (cycles[1]["seconds"], 100.0 * cycles[1]["error"]), (-46, -4), textcoords="offset points")
    axes.set_xlabel("seconds for the whole render call")
    axes.set_ylabel("relative RMSE, %")
    axes.set_title("The plume at 640 x 360, frame 25, two cores")
    axes.margins(0.12, 0.14)
    axes.grid(True, which="both", alpha=0.25)
    figure.tight_layout()
    figure.savefig(HERE / "cycles.png", dpi=120)


if __name__ == "__main__":
    main()
