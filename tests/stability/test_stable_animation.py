# SPDX-License-Identifier: GPL-3.0-or-later
"""A long animation through one Prepared, as a render's: it ends where it began, and needs no more memory on its way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frame_failures import add_floor, add_smoke, camera, cube, revolved
from known import judge
from sfumato import Frame, Prepared, Scene

FRAMES, PHASES = 250, 10
SIZE = 48, 32
SMOKE = [np.roll(revolved(24), k, axis=1) for k in range(PHASES)]
EYE = camera((0.5, -5, 3), (0, 0, 0.9), *SIZE)


def at(number: int, prepared: Prepared | None = None) -> np.ndarray:
    """Smoke that repeats every ten frames; a sun that goes round once, and a lamp that moves and comes back."""
    angle = 2.0 * np.pi * (number % FRAMES) / FRAMES
    scene = Scene()
    add_smoke(scene, SMOKE[number % PHASES], cube(24, 2.0, (0, 0, 0.3)), 7.0)
    scene.add_sun((np.cos(angle), np.sin(angle), -1.5), (4, 4, 4))
    scene.add_point((2.0 * np.sin(angle), -2.0, 2.5), (9, 9, 9))
    add_floor(scene)
    return np.asarray(Frame(scene, light_samples=1, prepared=prepared).render(EYE, *SIZE, 4))


def resident_bytes() -> int:
    """Of this process, now."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096


def test_two_hundred_and_fifty_frames_neither_drift_nor_grow() -> None:
    prepared = Prepared(threads=2)
    first, middle = at(0, prepared), None
    for number in range(1, FRAMES):
        seen = at(number, prepared)
        if number == FRAMES // 5:
            used = resident_bytes()
        if number == FRAMES // 2:
            middle = seen
    grown = resident_bytes() - used
    assert np.array_equal(at(FRAMES, prepared), first), "frame 250 is frame 0"
    assert middle is not None and np.array_equal(middle, at(FRAMES // 2)), "whatever was rendered before"
    assert not np.array_equal(middle, first)
    judge(grown, 2e6)


@pytest.mark.parametrize("number", [0, 7, 131])
def test_equal_arrays_give_equal_pixels_on_one_thread_and_on_two(number: int) -> None:
    one, two = (at(number, Prepared(threads=threads)) for threads in (1, 2))
    assert np.array_equal(one, two)
    assert np.array_equal(one, at(number, Prepared(threads=1)))
