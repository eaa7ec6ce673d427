# SPDX-License-Identifier: GPL-3.0-or-later
"""What a benchmark says while it runs: a line a step on the standard error."""

from __future__ import annotations

import sys
import time

MARK = "bench: "  # by which blender_run knows the lines that a script inside Blender says
START = time.monotonic()


def step(text: str) -> None:
    """Say what begins now, with the seconds since the process did."""
    print(f"{MARK}{time.monotonic() - START:6.1f} s  {text}", file=sys.stderr, flush=True)
