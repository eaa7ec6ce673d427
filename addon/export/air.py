# SPDX-License-Identifier: GPL-3.0-or-later
"""The air of the world: the volume of its nodes, or what the panel Air says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat, props
from . import materials
from .shading import fields, shaders

Array = NDArray[np.float64]

# Of air at sea level, per metre: what Intel's "Light Scattering" sample (Yusov 2013) scatters by its molecules.
MOLECULES = np.array((5.8e-6, 13.5e-6, 33.1e-6))
_DENSEST = 1e20  # per metre: of what nodes make of an infinite density
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


def even_volume(output: Any, name: str, notices: list[str]) -> Even | None:
    """What fills a world or a mesh by its node of output, where there are no grids: attributes of theirs that are not there
    are as in Cycles. None where nothing is linked."""
    look = shaders.of_output(output, name, notices, even=True)
    if look is None:
        return None
    emitted = sum((each[0] for each in fields.evaluate(look.emission, {})), np.zeros(3))
    if look.plain is not None:
        return Even(np.zeros(3), look.plain.scattering, look.plain.absorption, emitted, look.plain.anisotropy)
    out = replace(NOTHING, emission=emitted)
    leanings: list[tuple[float, float]] = []  # what scatters with which anisotropy
    for body in look.bodies:
        scattering, absorption, leaning = (
            each[0] for each in fields.evaluate((body.scattering, body.absorption, body.anisotropy), {})
        )
        out = replace(out, absorption=out.absorption + absorption)
        if body.rayleigh:
            out = replace(out, rayleigh=out.rayleigh + scattering)
        else:
            out = replace(out, mie=out.mie + scattering)
            leanings += [(float(scattering.sum()), float(leaning))] if scattering.any() else []
    if not leanings:
        return out
    mean = float(np.average([g for _, g in leanings], weights=[weight for weight, _ in leanings]))
    if max(abs(g - mean) for _, g in leanings) > 1e-3:
        notices.append(
            f"{name}: its volume shaders differ in anisotropy; all of it scatters with their mean, {mean:.3g}"
        )
    return replace(out, anisotropy=mean)


def has_volume(world: Any) -> bool:
    """Whether a world's own nodes fill it."""
    output = _output_of(world)
    return output is not None and is_filled(output)


def is_filled(output: Any) -> bool:
    """Whether a node of output has a volume that is not muted."""
    linked = materials.linked_node(output, "Volume") is not None
    return linked and shaders.of_output(output, "", [], even=True) is not None


def _output_of(world: Any) -> Any | None:
    if not compat.uses_nodes(world) or world.node_tree is None:
        return None
    return materials.output_in(world.node_tree, "OUTPUT_WORLD")


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
    output = _output_of(world) if depsgraph.view_layer_eval.use_sky and has_volume(world) else None
    if output is not None and _is_blenders(space):
        return
    volume = None if output is None else even_volume(output, "World", notices)
    shape: dict[str, Any] = {}
    if volume is not None:
        if volume.emission.any():
            notices.append("World: its volume glows, but lights nothing by that")
        if suns and any(each.any() for each in (volume.rayleigh, volume.mie, volume.absorption)):
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
    if max(each.max() for each in (volume.rayleigh, volume.mie, volume.absorption, volume.emission)) > _DENSEST:
        notices.append("World: its air is left out: it is denser than any can be")
        return
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
