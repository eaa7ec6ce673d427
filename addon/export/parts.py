# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with identity: what outlives an export, on Python's side.

Addresses and names lie: they are used again, and geometry that nodes make is new at each evaluation. So a part's
identity is its content, hashed; and what Blender says of changes only saves reading. What it does not say, as when a
script writes into an array without update(), is caught by the positions, which are always read.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .. import core


@dataclass(frozen=True)
class Owner:
    """Whose data a part is made of: the addresses of its originals, and what of it is cheap to look at."""

    addresses: tuple[int, ...]
    fingerprint: tuple[Any, ...]


class Parts:
    """Native parts by the content that they were made of, and what has changed since the last export.

    Unless it is `told` of changes, through note(), everything is read each time.
    """

    def __init__(self, threads: int = 0, told: bool = False) -> None:
        self.native = core.module().Prepared(threads=threads)
        self.threads = threads
        self.told = told
        self._made: dict[Any, Any] = {}  # by content
        self._asked_for: dict[Any, Any] = {}
        self._known: dict[Owner, Any] = {}  # the content, as it was read the last time
        self._seen: dict[Owner, Any] = {}
        self._changed: set[int] = set()
        if told:
            _listeners.add(self)

    def part(
        self,
        read: Callable[[], Sequence[Any] | None],
        how: tuple[Any, ...],
        make: Callable[..., Any],
        owner: Owner | None = None,
    ) -> Any | None:
        """make(*arrays) of the arrays that read() gives, or what was made of equal ones, and with the same `how`, before;
        None if it gives None. Where Blender said nothing of a change of the owner, nothing is read."""
        key = None
        if owner is not None and not self._changed.intersection(owner.addresses):
            key = self._known.get(owner)
        arrays: Sequence[Any] | None = None
        if key is None:
            arrays = read()
            if arrays is None:
                return None
            empty = np.zeros(0)
            key = core.module().content_hash(*(empty if array is None else array for array in arrays)), how
        part = self._asked_for.get(key, self._made.get(key))
        if part is None:
            arrays = arrays or read()
            if arrays is None:
                return None
            part = make(*arrays)
        self._asked_for[key] = part
        if self.told and owner is not None:
            self._seen[owner] = key
        return part

    def end_export(self) -> None:
        """What this export did not ask for is forgotten."""
        self._made, self._asked_for = self._asked_for, {}
        self._known, self._seen = self._seen, {}
        self._changed.clear()

    def note(self, updates: Iterable[Any]) -> None:
        """Blender says what has changed."""
        for update in updates:
            owner = update.id
            if not isinstance(owner, (bpy.types.Scene, bpy.types.Collection)):
                if update.is_updated_geometry or isinstance(owner, bpy.types.Image):
                    self._changed.add(owner.original.as_pointer())
                continue
            # What is linked, unlinked or deleted shows as no more than this, and its address may be another's soon.
            self.forget_owners()

    def forget_owners(self) -> None:
        """Addresses mean nothing any more: another file, undo, redo."""
        self._known.clear()
        self._seen.clear()


_listeners: weakref.WeakSet[Parts] = weakref.WeakSet()


def note(depsgraph: Any) -> None:
    """An evaluation has ended."""
    for parts in _listeners:
        parts.note(depsgraph.updates)


def forget_owners() -> None:
    """Addresses mean nothing any more: another file, undo, redo."""
    for parts in _listeners:
        parts.forget_owners()


_of_views: Parts | None = None
_of_renders: Parts | None = None


def of_views() -> Parts:
    """Those that all views of Blender's interface share."""
    global _of_views
    if _of_views is None:
        _of_views = Parts(told=True)
    return _of_views


def of_render(scene: Any) -> Parts:
    """Those of final renders, whose meshes and smoke may be finer than the views': kept from frame to frame where the
    scene keeps its data, and on as many threads as it asks for."""
    global _of_renders
    threads = scene.render.threads
    kept = _of_renders if scene.render.use_persistent_data else None
    if kept is None or kept.threads != threads:
        kept = Parts(threads=threads)
    _of_renders = kept if scene.render.use_persistent_data else None
    return kept


def free() -> None:
    """Forget everything."""
    global _of_views, _of_renders
    _of_views = _of_renders = None
