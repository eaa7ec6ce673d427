# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke that Solid mode draws by itself, hidden where the overlay draws the same.

Only the depsgraph's copies of domains and volumes are told, so that nothing of the artist's is touched: what is saved,
undone, rendered or shown by another view layer is what was set. An object that changes is copied anew, and told again.
"""

from __future__ import annotations

import math
from collections.abc import Set
from typing import Any

import bpy

from ..export import smoke

# The least that either property takes.
THINNEST, THINNEST_VOLUME = 1e-3, 1e-5


def hide(depsgraph: Any, names: Set[str], shown: Set[str] = frozenset()) -> bool:
    """Hide what Solid mode draws of the objects called so, and let it draw those again that were `shown` the overlay's
    way before. Whether that changes what is seen."""
    changed = [_switch(thing, thing.name in names) for thing in depsgraph.objects if thing.name in names | shown]
    return any(changed)


def hide_again(depsgraph: Any, names: Set[str]) -> None:
    """What of them this depsgraph has copied anew."""
    if names and any(
        isinstance(update.id, bpy.types.Volume) or (isinstance(update.id, bpy.types.Object) and update.id.name in names)
        for update in depsgraph.updates
    ):
        hide(depsgraph, names)


def _switch(thing: Any, off: bool) -> bool:
    """Of an evaluated object."""
    of_ours, of_theirs = _drawing(thing), _drawing(thing.original)
    if of_ours is None or of_theirs is None:
        return False
    owner, name, least = of_ours
    wanted = least if off else getattr(of_theirs[0], name)
    if math.isclose(getattr(owner, name), wanted, rel_tol=1e-5):
        return False
    setattr(owner, name, wanted)
    return True


def _drawing(thing: Any) -> tuple[Any, str, float] | None:
    """Which property of what makes an object's smoke thick in Solid mode, and its least value."""
    if thing.type == "VOLUME":
        return thing.data.display, "density", THINNEST_VOLUME
    domain = smoke.domain_settings(thing)
    return None if domain is None else (domain, "display_thickness", THINNEST)
