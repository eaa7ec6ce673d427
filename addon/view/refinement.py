# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport at rest: as finely sampled as F12.

While a view or its scene changes, each redraw traces its surfaces once a pixel, with every light seen at its middle.
Once a view has rested, a thread traces it as F12 does, beside whatever Blender is doing: that may take as long as F12,
and no redraw waits for it. When it is done one more redraw is asked for, which shows it. A change stops it.

Blender ignores a request to redraw that comes from within a redraw, so a timer makes it. The timer also starts the
thread, and ends with the last view that waits. The thread sees a native Frame and numbers, nothing of Blender's.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy

REST = 0.2  # seconds without a change: longer than it takes from step to step of a drag
TICK = 0.05  # seconds between looks at whether a thread is done

Progress = Callable[[float], bool]


@dataclass
class _Refinement:
    """Of one view."""

    subject: tuple[Any, ...]  # what is being looked at, and how
    trace: Callable[[Progress], Any]
    due: float = 0.0  # 0 until the first tick: a slow redraw is no rest, and neither is what waits in its wake
    stopped: threading.Event = field(default_factory=threading.Event)
    thread: threading.Thread | None = None
    surfaces: Any = None
    shown: bool = False  # whether a redraw was asked for

    def start(self) -> None:
        self.thread = threading.Thread(target=self._run, name="Sfumato refinement")
        self.thread.start()

    def _run(self) -> None:
        self.surfaces = self.trace(lambda _done: not self.stopped.is_set())

    @property
    def running(self) -> bool:
        return self.thread is not None and self.thread.is_alive()


_views: dict[Any, _Refinement] = {}
_stopping: list[_Refinement] = []  # replaced, and not yet at the next question whether to go on


def ask(view: Any, subject: tuple[Any, ...], trace: Callable[[Progress], Any]) -> None:
    """Have `trace`, a Frame.surfaces or render that lacks only its progress, called once the view has rested. `view` is the
    region's address. Asking for the same subject again changes nothing; another one takes its place."""
    known = _views.get(view)
    if known is not None and known.subject == subject:
        return
    _drop(view)
    _views[view] = _Refinement(subject, trace)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick)


def take(view: Any, subject: tuple[Any, ...]) -> Any:
    """The refined surfaces of a view, once; None while there are none of this subject."""
    known = _views.get(view)
    if known is None or known.surfaces is None or known.subject != subject:
        return None
    return _views.pop(view).surfaces


def busy() -> bool:
    """Whether any view is still to be refined, or to be redrawn for it."""
    return any(not refinement.shown for refinement in _views.values())


def stop() -> None:
    """Forget every view; no thread and no timer are left."""
    for view in list(_views):
        _drop(view)
    for refinement in _stopping:
        if refinement.thread is not None:
            refinement.thread.join()
    _stopping.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _drop(view: Any) -> None:
    refinement = _views.pop(view, None)
    if refinement is not None:
        refinement.stopped.set()
        if refinement.running:
            _stopping.append(refinement)


def _tick() -> float | None:
    """The timer: start what has rested, one at a time, and show what is done."""
    _stopping[:] = [refinement for refinement in _stopping if refinement.running]
    windows = bpy.context.window_manager.windows
    areas = [area for window in windows for area in window.screen.areas if area.type == "VIEW_3D"]
    regions = {region.as_pointer(): region for area in areas for region in area.regions}
    for view in set(_views) - set(regions):  # closed, or of another workspace
        _drop(view)
    idle = not _stopping and not any(refinement.running for refinement in _views.values())
    # Played frames may take longer than REST, and none of them is at rest.
    idle = idle and not any(window.screen.is_animation_playing for window in windows)
    now = time.monotonic()
    for view, refinement in _views.items():
        if refinement.thread is None:
            if refinement.due == 0.0:
                refinement.due = now + REST
            elif idle and now >= refinement.due:
                refinement.start()
                idle = False
        elif not refinement.running and not refinement.shown:
            refinement.shown = True
            regions[view].tag_redraw()
    return TICK if busy() or _stopping else None
