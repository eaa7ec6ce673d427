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


def quality(
    coefficients: int, texels: float, steps: float, light_samples: int, edge_samples: int, air_texels: int
) -> Quality:
    frame = {"coefficients": coefficients, "texels_per_cell": texels, "steps_per_cell": steps}
    return Quality({**frame, "light_samples": light_samples, "air_texels": air_texels}, edge_samples)


# Against 63 coefficients, 8 texels and 4 steps a cell, the sample plume is off by (relative RMSE of its whole picture):
QUALITIES = {
    "DRAFT": quality(7, 1.0, 0.5, 4, 4, 256),  # 1.4 %
    "PREVIEW": quality(15, 2.0, 1.0, 16, 16, 512),  # 0.4 %
    "FINAL": quality(31, 4.0, 2.0, 36, 64, 1024),  # 0.08 %
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
    reflections: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Reflections",
        description="Gloss shows the surfaces around it, as they are in the light of lamps and the world, where Cycles' "
        "Light Paths have Glossy bounces",
        default=True,
    )
    bounced_light: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Bounced Light",
        description="Surfaces light each other, as often as Cycles' Light Paths have Diffuse bounces",
        default=False,
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
    """What a script sets reaches no view by itself. Particles stay where they are: another tag would have them simulated
    anew."""
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


class SfumatoAir(bpy.types.PropertyGroup):
    """Of a world: what fills it where its own nodes have no volume. addon/export/air.py reads it."""

    shown: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Air",
        description="Fill the world with air that scatters the light of lamps on its way, so that light shafts are seen. "
        "A volume in the world's own nodes is shown in any case, and instead of this",
        default=False,
        update=_changed,
    )
    visibility: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Visibility",
        description="How far one sees: where haze leaves 2 % of a contrast. The haze takes 3.912 over this of the light "
        "at each metre",
        default=100.0,
        min=0.01,
        soft_max=1e5,
        max=1e9,
        subtype="DISTANCE",
        update=_changed,
    )
    color: bpy.props.FloatVectorProperty(  # type: ignore[valid-type]
        name="Color",
        description="Of the light that haze takes, the share that it scatters; the rest it absorbs",
        default=(1.0, 1.0, 1.0),
        min=0.0,
        max=1.0,
        subtype="COLOR",
        update=_changed,
    )
    anisotropy: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Anisotropy",
        description="Whether haze scatters light forward, above 0, or back",
        default=0.6,
        min=-0.999,
        max=0.999,
        update=_changed,
    )
    phase: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Phase",
        description="How haze spreads what it scatters",
        items=(
            ("henyey-greenstein", "Henyey-Greenstein", "As volume shaders do"),
            ("cornette-shanks", "Cornette-Shanks", "As water droplets do: at an anisotropy of 0 as molecules"),
        ),
        update=_changed,
    )
    rayleigh: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Molecules",
        description="How many times as much as the air at sea level its molecules scatter, of which it is blue. At 1 that "
        "is seen over many kilometres",
        default=0.0,
        min=0.0,
        soft_max=1000.0,
        max=1e9,
        update=_changed,
    )
    scale_height: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Height",
        description="The height over which all of it becomes 2.718 times thinner; 0: it is even",
        default=0.0,
        min=0.0,
        soft_max=1e4,
        subtype="DISTANCE",
        update=_changed,
    )
    ground: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Ground",
        description="The height, along Z, at which it is as thick as said; below it is thicker still",
        default=0.0,
        subtype="DISTANCE",
        update=_changed,
    )
    directed: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Art-Directed Shafts",
        description="Multiply the light that the air scatters, which no air does",
        default=False,
        update=_changed,
    )
    shaft_strength: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Strength",
        description="How many times as bright as it should be what the air scatters is",
        default=1.0,
        min=0.0,
        soft_max=10.0,
        update=_changed,
    )
    shaft_color: bpy.props.FloatVectorProperty(  # type: ignore[valid-type]
        name="Color",
        description="In which color, times that of the light, what the air scatters is",
        default=(1.0, 1.0, 1.0),
        min=0.0,
        max=1.0,
        subtype="COLOR",
        update=_changed,
    )


_CLASSES = {SfumatoSettings: bpy.types.Scene, SfumatoParticles: bpy.types.ParticleSettings, SfumatoAir: bpy.types.World}


def register() -> None:
    for own, owner in _CLASSES.items():
        bpy.utils.register_class(own)
        owner.sfumato = bpy.props.PointerProperty(type=own)


def unregister() -> None:
    for own, owner in reversed(_CLASSES.items()):
        del owner.sfumato
        bpy.utils.unregister_class(own)


def of(scene: Any) -> SfumatoSettings:
    """The settings of a scene."""
    settings: SfumatoSettings = scene.sfumato
    return settings


def of_air(world: Any) -> SfumatoAir:
    """Those of a world."""
    own: SfumatoAir = world.sfumato
    return own


def of_particles(settings: Any) -> SfumatoParticles:
    """Those of particle settings."""
    own: SfumatoParticles = settings.sfumato
    return own
