# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles reads of a scene, property by property: what we follow, what we name, and what makes no difference to us.

Data, of which addon/export/omissions.py makes notices and docs/followed.py a page. tests/blender/background/walk.py goes
through Blender's own lists and fails at a property that is in none of these. Nothing here knows Blender.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

RENDER = "render"


@dataclass(frozen=True)
class Named:
    """A property that makes Cycles show something that we do not, and what is said of it then.

    `says` is the sentence after the owner's name; {value} stands for what it is set to. `neutral` are the values with
    which Cycles shows what we do. `when`: other properties of the same root, and the values without which this one means
    nothing. `only` RENDER: a view does without it in Cycles, too. `kinds`: types of objects, for which alone it matters.
    `elsewhere`: the export says it by itself, since it takes more than a look at one property.
    """

    property: str
    neutral: tuple[Any, ...]
    says: str
    when: tuple[tuple[str, Any], ...] = ()
    only: str = ""
    kinds: tuple[str, ...] = ()
    elsewhere: bool = False


@dataclass(frozen=True)
class Struct:
    """The properties of one of Blender's structs. `root` is what a notice is about, `at` the path from there. Followed
    and idle ones stand in groups: what an artist calls them, or why they make no difference, and their identifiers."""

    name: str
    root: str
    at: str = ""
    followed: dict[str, str] = field(default_factory=dict)
    named: tuple[Named, ...] = ()
    idle: dict[str, str] = field(default_factory=dict)

    def path(self, named: Named) -> str:
        return f"{self.at}.{named.property}" if self.at else named.property


@dataclass(frozen=True)
class Socket:
    """An input of a followed node that makes Cycles show something that we do not. `neutral` are the values with which
    it does not; none for one whose value is followed, so that only links matter. `instead` is what we show. `unless`:
    another input and the value of it with which this one means nothing."""

    name: str
    neutral: tuple[Any, ...]
    instead: str
    unless: tuple[str, Any] | None = None


@dataclass(frozen=True)
class Node:
    """A followed node's inputs and properties. Links into the followed ones are named where these are read, except from
    nodes of a constant value or color."""

    name: str
    followed: tuple[str, ...] = ()
    named: tuple[Socket, ...] = ()
    elsewhere: tuple[str, ...] = ()
    idle: dict[str, tuple[str, ...]] = field(default_factory=dict)
