# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that live in the scene and are saved with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy


@dataclass(frozen=True)
class Quality:
    """What a quality means to the native module."""

    frame: dict[str, float]
    edge_samples: int


QUALITIES = {
    "DRAFT": Quality({"coefficients": 7, "texels_per_cell": 0.5, "steps_per_cell": 0.5}, 4),
    "PREVIEW": Quality({"coefficients": 15, "texels_per_cell": 1.0, "steps_per_cell": 1.0}, 16),
    "FINAL": Quality({"coefficients": 31, "texels_per_cell": 2.0, "steps_per_cell": 2.0}, 64),
}


class SfumatoSettings(bpy.types.PropertyGroup):
    viewport_enabled: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Smoke in Viewport",
        description="Draw lit smoke and its shadow over the Solid and Material Preview modes",
        default=True,
    )
    quality: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Quality",
        description="How finely the smoke and its shadow are computed",
        items=(
            ("DRAFT", "Draft", "Fastest: half the smoke's resolution"),
            ("PREVIEW", "Preview", "The smoke's own resolution"),
            ("FINAL", "Final", "Twice the smoke's resolution"),
        ),
        default="PREVIEW",
    )


def register() -> None:
    bpy.utils.register_class(SfumatoSettings)
    bpy.types.Scene.sfumato = bpy.props.PointerProperty(type=SfumatoSettings)


def unregister() -> None:
    del bpy.types.Scene.sfumato
    bpy.utils.unregister_class(SfumatoSettings)


def of(scene: Any) -> SfumatoSettings:
    """The settings of a scene."""
    settings: SfumatoSettings = scene.sfumato
    return settings
