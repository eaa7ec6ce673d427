# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that live in the scene and are saved with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy

from .view import sorting


@dataclass(frozen=True)
class Quality:
    """What a quality means to the native module."""

    frame: dict[str, Any]
    edge_samples: int


def quality(coefficients: int, texels: float, steps: float, light_samples: int, edge_samples: int) -> Quality:
    frame = {"coefficients": coefficients, "texels_per_cell": texels, "steps_per_cell": steps}
    return Quality({**frame, "light_samples": light_samples}, edge_samples)


# Against 63 coefficients, 8 texels and 4 steps a cell, the sample plume is off by (relative RMSE of its whole picture):
QUALITIES = {
    "DRAFT": quality(7, 1.0, 0.5, 4, 4),  # 1.4 %
    "PREVIEW": quality(15, 2.0, 1.0, 16, 16),  # 0.4 %
    "FINAL": quality(31, 4.0, 2.0, 36, 64),  # 0.08 %
}
OFF = "The picture of the sample plume differs from one at the finest settings by {} (root mean square of all pixels)"


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
            ("DRAFT", "Draft", "Fastest. " + OFF.format("1.4 %")),
            ("PREVIEW", "Preview", OFF.format("0.4 %")),
            ("FINAL", "Final", "At several times the cost. " + OFF.format("0.08 %")),
        ),
        default="PREVIEW",
    )
    sorting: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Transparency",
        description="How particles, hair and transparent meshes are put in order while a view moves. At rest, and in "
        "renders, the processor does that exactly",
        items=tuple((name, *words) for name, words in sorting.WAYS.items()),
        default=sorting.AUTO,
    )
    missing_is_error: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Stop at Missing Smoke",
        description="In renders without a window, a cache or a file that is missing at a frame is an error: the render "
        "stops with status 1. Otherwise the frame is rendered without that smoke",
        default=True,
    )
    smoke_scene: bpy.props.PointerProperty(  # type: ignore[valid-type]
        name="Smoke Scene",
        description="The scene that has this one's smoke, where another engine renders all else",
        type=bpy.types.Scene,
    )


def _changed(own: bpy.types.PropertyGroup, _context: Any) -> None:
    """What a script sets reaches no view by itself. The particles stay where they are: another tag would have them
    simulated anew."""
    own.id_data.update_tag()


class SfumatoParticles(bpy.types.PropertyGroup):
    """Of particle settings."""

    shown: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Show as Smoke",
        description="Show each particle as a soft puff of smoke. Other engines show none of those that render as Halo",
        default=True,
        update=_changed,
    )
    opacity: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Opacity",
        description="The share of light that a puff takes through its middle, where its material does not say: that is, "
        "has no volume and is not seen through",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_changed,
    )
    color: bpy.props.FloatVectorProperty(  # type: ignore[valid-type]
        name="Color",
        description="Of the light that a puff takes, the share that it scatters, where its material does not say",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        subtype="COLOR",
        update=_changed,
    )
    size: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Size",
        description="How many times as large as its particle a puff is. Its radius is the particle's Scale, times this",
        default=4.0,
        min=0.0,
        soft_max=20.0,
        update=_changed,
    )
    anisotropy: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Anisotropy",
        description="Whether a puff scatters light forward, above 0, or back, where its material does not say",
        default=0.0,
        min=-0.999,
        max=0.999,
        update=_changed,
    )


def register() -> None:
    bpy.utils.register_class(SfumatoSettings)
    bpy.utils.register_class(SfumatoParticles)
    bpy.types.Scene.sfumato = bpy.props.PointerProperty(type=SfumatoSettings)
    bpy.types.ParticleSettings.sfumato = bpy.props.PointerProperty(type=SfumatoParticles)


def unregister() -> None:
    del bpy.types.ParticleSettings.sfumato
    del bpy.types.Scene.sfumato
    bpy.utils.unregister_class(SfumatoParticles)
    bpy.utils.unregister_class(SfumatoSettings)


def of(scene: Any) -> SfumatoSettings:
    """The settings of a scene."""
    settings: SfumatoSettings = scene.sfumato
    return settings


def of_particles(settings: Any) -> SfumatoParticles:
    """Those of particle settings."""
    own: SfumatoParticles = settings.sfumato
    return own
