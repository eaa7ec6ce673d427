# SPDX-License-Identifier: GPL-3.0-or-later
"""What flags of objects, collections and lights, and light linking, leave of an object for the camera and for lights: as
in Cycles, which asks some of them of an instance's parent, too.

One fault of Cycles is not followed: from 4.2 on it may lose a part of the light on smoke that is outside a light's blocker
collection, in 5.3.0 half of it in tests/blender/background/flags.py's scene. Here such smoke throws no shadow in that
light, as that collection means."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import bpy
import numpy as np

from .. import compat, core

_ALL = 2**64 - 1
_MOST_SETS = 63  # of 64 bits the first stands for lights that are not linked


class Visibility(NamedTuple):
    """The arguments of the native one."""

    seen: str = "shown"
    lit_by: int = _ALL
    hides: int = _ALL


class Reach(NamedTuple):
    """The arguments of the native one."""

    lights: int = 1
    hidden_by: int = 1
    diffuse: bool = True
    gloss: bool = True
    smoke: bool = True
    plate: bool = True


def native(flags: Visibility | Reach | None) -> Any:
    """The module's own, None for what is nothing out of the ordinary."""
    if flags is None or flags in (Visibility(), Reach()):
        return None
    kind = core.module().Visibility if isinstance(flags, Visibility) else core.module().Reach
    return kind(*flags)


@dataclass(frozen=True)
class _Members:
    """The objects that a collection of light linking names, by their addresses."""

    included: frozenset[int] | None  # None: all
    excluded: frozenset[int]

    def has(self, addresses: set[int]) -> bool:
        return (self.included is None or bool(self.included & addresses)) and not self.excluded & addresses


class Flags:
    """Those of one export."""

    def __init__(self, depsgraph: Any, notices: list[str]) -> None:
        self._layer = depsgraph.view_layer_eval
        self._notices = notices
        self._receivers: list[_Members] = []
        self._blockers: list[_Members] = []
        # A view's depsgraph hands animated flags back to the objects themselves, a render's does not.
        objects = (bpy.data.objects, depsgraph.objects) if depsgraph.mode == "RENDER" else (bpy.data.objects,)
        self._flagged = _any_collection(self._layer.layer_collection) or any(map(_any_object, objects))

    @property
    def matter(self) -> bool:
        """Whether any object may not be plain, by the lights that reach_of was asked for by now."""
        return self._flagged or bool(self._receivers) or bool(self._blockers)

    def visibility_of(self, instance: Any) -> Visibility:
        """What an object of the depsgraph's instances is to the camera and to lights."""
        thing, parent = instance.object, instance.parent if instance.is_instance else None
        both = (thing,) if parent is None else (thing, parent)
        top = parent or thing
        addresses = {each.original.as_pointer() for each in both}
        seen = "shown"
        if not all(each.visible_camera for each in both) or top.indirect_only_get(view_layer=self._layer):
            seen = "unseen"
        elif thing.type == "VOLUME":
            pass
        elif top.holdout_get(view_layer=self._layer):
            seen = "holdout"
        elif any(each.is_shadow_catcher for each in both):
            seen = "catcher"
        hides = _sets(self._blockers, addresses) if all(each.visible_shadow for each in both) else 0
        return Visibility(seen, _sets(self._receivers, addresses), hides)

    def of_smoke(self, instance: Any) -> Visibility:
        """The same of smoke, which Cycles shows where it is held out; as a catcher it would cut holes into surfaces."""
        found = self.visibility_of(instance)
        if found.seen == "catcher" or instance.object.type == "VOLUME" and instance.object.is_shadow_catcher:
            self._notices.append(f"{instance.object.name}: smoke catches no shadow; it is shown as smoke")
        return found._replace(seen="unseen" if found.seen == "unseen" else "shown")

    def of_hair(self, flags: Visibility | None, name: str) -> Visibility | None:
        """The flags of an object, for its hair, which is no holdout and catches no shadow."""
        if flags is None or flags.seen in {"shown", "unseen"}:
            return flags
        self._notices.append(f"{name}: its hair is no {flags.seen}; it is shown as hair")
        return flags._replace(seen="shown")

    def reach_of(self, thing: Any) -> Reach | None:
        """What a light, or an object that glows, reaches; None where that is nothing."""
        shows = thing.visible_diffuse, thing.visible_glossy, thing.visible_volume_scatter
        if not any(shows):
            return None
        linking = getattr(thing, "light_linking", None)  # 4.0
        lights = hidden_by = 1
        if linking is not None:
            lights = self._set_of(self._receivers, linking.receiver_collection, thing.name)
            hidden_by = self._set_of(self._blockers, linking.blocker_collection, thing.name)
        if thing.type == "LIGHT" and not compat.casts_shadow(thing.data):
            hidden_by = 0
        return Reach(lights, hidden_by, *shows, plate=thing.is_shadow_catcher)

    def _set_of(self, sets: list[_Members], collection: Any | None, name: str) -> int:
        """The bit of a collection."""
        members = None if collection is None else _members_of(collection)
        if members is None:
            return 1
        if members not in sets:
            if len(sets) == _MOST_SETS:
                self._notices.append(
                    f"{name}: more than {_MOST_SETS} collections of light linking; it lights everything"
                )
                return 1
            sets.append(members)
        return 2 << sets.index(members)


def _sets(sets: list[_Members], addresses: set[int]) -> int:
    """The bits of all sets but those that an object is not in."""
    return _ALL - sum(2 << number for number, members in enumerate(sets) if not members.has(addresses))


def _members_of(collection: Any) -> _Members | None:
    """None for a collection without objects, which says nothing."""
    states: dict[str, set[int]] = {"INCLUDE": set(), "EXCLUDE": set()}
    for item, thing in zip(collection.collection_objects, collection.objects):
        states[item.light_linking.link_state].add(thing.original.as_pointer())
    for item, child in zip(collection.collection_children, collection.children):
        states[item.light_linking.link_state].update(thing.original.as_pointer() for thing in child.all_objects)
    included, excluded = frozenset(states["INCLUDE"]), frozenset(states["EXCLUDE"])
    return _Members(included or None, excluded) if included or excluded else None


def _any_collection(collection: Any) -> bool:
    return collection.holdout or collection.indirect_only or any(map(_any_collection, collection.children))


_USUAL = {"visible_camera": True, "visible_shadow": True, "is_holdout": False, "is_shadow_catcher": False}


def _any_object(things: Any) -> bool:
    """Whether any object but lights has a flag that matters, read in bulk: few scenes have any, and some have many
    objects."""
    values = np.empty(len(things), bool)
    odd = np.zeros(len(values), bool)
    for name, usual in _USUAL.items():
        things.foreach_get(name, values)
        odd |= values != usual
    # New lights are shadow catchers that the camera does not see. 3.4.1 reads types in bulk wrongly, without a word.
    return any(things[int(number)].type != "LIGHT" for number in np.flatnonzero(odd))
