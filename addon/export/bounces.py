# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that goes between surfaces: how often, by the panel and by Cycles' Light Paths."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from .. import props

MIRROR = 0.08  # the slope of facets up to which a surface is as sharp as what it shows


def of_scene(scene: Any) -> tuple[bool, int]:
    """Whether gloss shows the surfaces around it, and how many times light goes between matt ones: as often as Cycles' Light
    Paths say, where its settings are there."""
    settings, cycles = props.of(scene), getattr(scene, "cycles", None)
    glossy, diffuse = 4, 4
    if cycles is not None:
        glossy, diffuse = (min(cycles.max_bounces, kind) for kind in (cycles.glossy_bounces, cycles.diffuse_bounces))
    return settings.reflections and glossy > 0, min(diffuse, 64) if settings.bounced_light else 0


def said(looks: Iterable[Any], bounced: bool, things: dict[str, bool], smoke: bool) -> Iterable[str]:
    """What light between surfaces leaves out, of surfaces with these looks, and of all `things`, by what artists call them,
    that are there."""
    missing = [name for name, there in things.items() if there]
    if missing and any(gloss.alpha[0] <= MIRROR for look in looks for gloss in look.gloss):
        yield f"What mirrors shows surfaces and smoke, but not {' or '.join(missing)}"
    lit = ["smoke"] * smoke + [name for name in ("hair", "particles") if things.get(name)]
    if bounced and lit:
        yield f"Bounced Light does not reach {' or '.join(lit)}, which lamps and the world light"
