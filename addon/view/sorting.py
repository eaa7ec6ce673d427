# SPDX-License-Identifier: GPL-3.0-or-later
"""How what is seen through is put in order while a view moves: by the processor, exactly, or by the GPU without sorting."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

PROCESSOR, AUTO = "PROCESSOR", "AUTO"
# Sprites and triangles from which one pass over them counts more than what it shows: `nearest` takes seven.
MANY = 200_000

# What a scene can ask for: its name and, for the panel, what that does.
WAYS = {
    AUTO: ("Automatic", "The graphics card's nearest layers, where there is one and the scene allows; its weights where "
           "there is very much to draw; else the processor"),
    "NEAREST": ("Nearest Layers", "The four nearest layers in order, all behind them by a series over their depths"),
    "WEIGHTED": ("Weighted", "By depth and opacity alone (McGuire and Mara 2017): fastest, and furthest from the truth"),
    "FOURIER": ("Fourier", "By a Fourier series over all depths, as published (Song 2021)"),
    "SORTED": ("Back to Front", "Particles alone, in order of their middles, in the light of a map as published (Jansen "
               "and Bavoil 2010) where one sun is all there is"),
    PROCESSOR: ("Processor", "Exactly, at a glance, as finely as time allows"),
}  # fmt: skip


@dataclass(frozen=True)
class Way:
    """method: of gpu/transparency.py, or none where the processor does it; and why, for the panel."""

    method: str
    why: str


def way_of(asked: str, frame: Any, software: bool) -> Way:
    """Of a frame that has what must be sorted, the way to draw it, as far as the frame alone says."""
    if asked == PROCESSOR:
        return Way("", "the processor, as chosen")
    if not frame.drawable:
        return Way(
            "", "the processor: with it there is smoke of grids, air, a holdout or a shadow catcher, or colored glass"
        )
    if asked == AUTO and software:
        return Way("", "the processor: there is no graphics card")
    return Way("nearest" if asked == AUTO else asked.lower(), told("NEAREST" if asked == AUTO else asked))


def way_for(way: Way, asked: str, count: int, triangles: bool) -> Way:
    """The same, of so many sprites and triangles."""
    if way.method == "sorted" and triangles:
        return Way("nearest", told("NEAREST") + ", as there is more than particles")
    if asked == AUTO and count > MANY:
        return Way("weighted", told("WEIGHTED") + f", as there are {count} to draw")
    return way


def told(asked: str) -> str:
    return f"the graphics card, {WAYS[asked][0].lower()}"
