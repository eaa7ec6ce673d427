# SPDX-License-Identifier: GPL-3.0-or-later
"""How coarse a view is drawn while it moves: by how soon one redraw has followed the other."""

from __future__ import annotations

from collections import deque

SLOW, FAST = 0.03, 0.02  # seconds from redraw to redraw; in between it stays as it is
COUNTED = 4  # redraws that must agree: the shortest counts, since between two others the mouse may have rested
PAUSE = 1.0  # seconds: another movement

HALF, QUARTER = 2, 4  # pixels from one that is traced to the next


class Pace:
    """Of one view."""

    def __init__(self) -> None:
        self.spacing = HALF
        self._last: float | None = None
        self._gaps: deque[float] = deque(maxlen=COUNTED)

    def moved(self, now: float) -> int:
        """The view is drawn at another place at the time `now`, in seconds: the spacing to draw it with."""
        gap = PAUSE if self._last is None else now - self._last
        self._last = now
        if gap >= PAUSE:
            self._gaps.clear()
            return self.spacing
        self._gaps.append(gap)
        if len(self._gaps) == COUNTED:
            shortest = min(self._gaps)
            wanted = QUARTER if shortest > SLOW else HALF if shortest < FAST else self.spacing
            if wanted != self.spacing:
                self.spacing = wanted
                self._gaps.clear()
        return self.spacing
