# SPDX-License-Identifier: GPL-3.0-or-later
"""The air of the world: the volume of its nodes, or what the panel Air says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat, props
from . import emission, materials, omissions

Array = NDArray[np.float64]

# Of air at sea level, per metre: what Intel's "Light Scattering" sample (Yusov 2013) scatters by its molecules.
MOLECULES = np.array((5.8e-6, 13.5e-6, 33.1e-6))
# Koschmieder's law (1924): the optical depth that leaves 2 % of a contrast.
UNSEEN = -np.log(0.02)


@dataclass(frozen=True)
class Even:
    """What a volume does that is the same everywhere: what its molecules and its particles scatter and what it absorbs,
    per metre, what it emits, W/(m^3 sr), each (3,), and Henyey and Greenstein's anisotropy of the particles."""

    rayleigh: Array
    mie: Array
    absorption: Array
    emission: Array
    anisotropy: float = 0.0

    @property
    def is_nothing(self) -> bool:
        return not any(each.any() for each in (self.rayleigh, self.mie, self.absorption, self.emission))


NOTHING = Even(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3))


def even_volume(shaders: list[Any], name: str, notices: list[str]) -> Even:
    """The sum of volume shaders where there are no grids, as Cycles fills the world or a mesh: attributes of theirs that
    are not there count for nothing."""
    out = NOTHING
    leanings: list[tuple[float, float]] = []  # what scatters with which anisotropy
    for shader in shaders:
        each = _of_shader(shader, name, notices)
        emitted = sum(
            (emitter.everywhere().of(np.zeros(1))[0] for emitter in emission.of_shader(shader, name, [])), 0.0
        )
        out = Even(
            out.rayleigh + each.rayleigh,
            out.mie + each.mie,
            out.absorption + each.absorption,
            out.emission + emitted,
        )
        if each.mie.any():
            leanings.append((float(each.mie.sum()), each.anisotropy))
    if not leanings:
        return out
    mean = float(np.average([g for _, g in leanings], weights=[weight for weight, _ in leanings]))
    if max(abs(g - mean) for _, g in leanings) > 1e-3:
        notices.append(
            f"{name}: its volume shaders differ in anisotropy; all of it scatters with their mean, {mean:.3g}"
        )
    return replace(out, anisotropy=mean)


def _of_shader(shader: Any, name: str, notices: list[str]) -> Even:
    """What one volume shader scatters and absorbs."""
    if shader.type == "EMISSION":
        return NOTHING
    if shader.type == "PRINCIPLED_VOLUME":
        smoke = materials.of_points(shader, name, notices)
        return replace(NOTHING, mie=smoke.scattering, absorption=smoke.absorption, anisotropy=smoke.anisotropy)
    if shader.type not in {"VOLUME_SCATTER", "VOLUME_ABSORPTION"}:
        notices.append(f"{name}: its volume shader {shader.bl_rna.name} is not shown; it fills nothing")
        return NOTHING
    omissions.of_node(shader, name, notices)
    density = max(0.0, materials.value_of(shader, "Density", name, notices))
    colour = np.maximum(materials.value_of(shader, "Color", name, notices), 0.0)
    if shader.type == "VOLUME_ABSORPTION":
        if density * colour.max() > density:
            notices.append(f"{name}: Color above 1 of its Volume Absorption adds light in Cycles; it absorbs none here")
        return replace(NOTHING, absorption=density * np.maximum(1.0 - colour, 0.0))
    phase = getattr(shader, "phase", "HENYEY_GREENSTEIN")  # 4.3
    if phase == "RAYLEIGH":
        return replace(NOTHING, rayleigh=density * colour)
    anisotropy = float(np.clip(materials.value_of(shader, "Anisotropy", name, notices), -0.999, 0.999))
    if phase != "HENYEY_GREENSTEIN":
        called = shader.bl_rna.properties["phase"].enum_items[phase].name
        notices.append(
            f"{name}: the phase {called} of its {shader.bl_rna.name} is not followed; it scatters as Henyey and "
            f"Greenstein's of anisotropy {anisotropy:.3g}"
        )
    return replace(NOTHING, mie=density * colour, anisotropy=anisotropy)


def has_volume(world: Any) -> bool:
    """Whether a world's own nodes fill it."""
    return bool(_shaders_of(world))


def _shaders_of(world: Any) -> list[Any]:
    """The volume shaders whose sum fills a world."""
    if not compat.uses_nodes(world) or world.node_tree is None:
        return []
    output = materials.output_in(world.node_tree, "OUTPUT_WORLD")
    return [] if output is None else materials.added(materials.linked_node(output, "Volume"))


def _of_panel(own: props.SfumatoAir) -> Even:
    taken = UNSEEN / own.visibility
    colour = np.array(own.color, np.float64)
    return Even(own.rayleigh * MOLECULES, taken * colour, taken * (1.0 - colour), np.zeros(3), own.anisotropy)


def add_air(scene: Any, depsgraph: Any, origin: Array, space: Any, suns: list[str], notices: list[str]) -> None:
    """The air of what `depsgraph` shows, in a 3D view if there is one, with lamps called `suns` in it, to a native scene
    around `origin`."""
    world = materials.world_of(depsgraph)
    if world is None:
        return
    own = props.of_air(world)
    # Without the sky Cycles has no volume of the world either. The panel's air is not of the sky.
    shaders = _shaders_of(world) if depsgraph.view_layer_eval.use_sky else []
    if shaders and _is_blenders(space):
        return
    volume = None
    shape: dict[str, Any] = {}
    if shaders:
        volume = even_volume(shaders, "World", notices)
        if suns and not volume.is_nothing:
            notices.append(
                f"World: in Cycles its volume, which never ends, lets no light of suns through; here {_listed(suns)} "
                "as if there were none of it on the way"
            )
    elif own.shown:
        volume = _of_panel(own)
        shape = {"phase": own.phase, "scale_height": own.scale_height, "ground": own.ground - float(origin[2])}
    if volume is None or volume.is_nothing:
        return
    if own.directed:
        shape["tint"] = own.shaft_strength * np.array(own.shaft_color, np.float64)
    try:
        scene.set_air(volume.rayleigh, volume.mie, volume.absorption, volume.emission, volume.anisotropy, **shape)
    except ValueError as error:
        notices.append(f"World: its air is left out: {error}")


def _is_blenders(space: Any) -> bool:
    """Whether a 3D view shows Blender's own picture with what fills the world in it."""
    shading = None if space is None else space.shading
    return shading is not None and shading.type == "MATERIAL" and bool(shading.use_scene_world)


def _listed(names: list[str]) -> str:
    return f"{names[0]} shines" if len(names) == 1 else f"{len(names)} suns shine"
