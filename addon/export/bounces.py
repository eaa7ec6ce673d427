# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that goes between surfaces: how often, by the panel and by Cycles' Light Paths."""

from __future__ import annotations

from typing import Any

from .. import props


def of_scene(scene: Any) -> tuple[bool, int]:
    """Whether gloss shows the surfaces around it, and how many times light goes between matt ones: as often as Cycles' Light
    Paths say, where its settings are there."""
    settings, cycles = props.of(scene), getattr(scene, "cycles", None)
    glossy, diffuse = 4, 4
    if cycles is not None:
        glossy, diffuse = (min(cycles.max_bounces, kind) for kind in (cycles.glossy_bounces, cycles.diffuse_bounces))
    return settings.reflections and glossy > 0, min(diffuse, 64) if settings.bounced_light else 0
