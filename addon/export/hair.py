# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: of particle systems, and hair curves; as strands with the materials that Cycles has for them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat
from . import looks, omissions, surfaces
from .materials import active_output, linked_node, materials_of, value_of

_EUMELANIN = np.array((0.506, 0.841, 1.653))
_PHEOMELANIN = np.array((0.343, 0.733, 1.924))
DEFAULT_RADIUS = 0.005  # metres, of curves without any


@dataclass
class Strands:
    """Of one object, in its own space: keys (n, 3), a radius (n,) each, the first key of each strand and the end (m + 1,);
    and whether a curve leads through the keys. `material`: the number of its slot."""

    points: NDArray[np.float64]
    radius: NDArray[np.float64]
    first: NDArray[np.int64]
    smooth: bool = True
    material: int = 0

    def in_world(self, matrix: NDArray[np.float64], name: str, notices: list[str]) -> Strands | None:
        """By a matrix (4, 4). What has no finite place is left out, and so are strands of one key."""
        scale = float(np.cbrt(abs(np.linalg.det(matrix[:3, :3]))))
        axes = np.linalg.norm(matrix[:3, :3], axis=0)
        if axes.max() > 1.01 * axes.min():
            notices.append(f"{name}: its uneven scale makes flat hairs; they are shown round")
        points = self.points @ matrix[:3, :3].T + matrix[:3, 3]
        radius = self.radius * scale
        sound = np.isfinite(points).all(axis=1) & np.isfinite(radius) & (radius >= 0.0)
        keys = np.diff(self.first)
        strand = np.repeat(np.arange(len(keys)), keys)
        bad = np.unique(strand[~sound])
        if len(bad):
            notices.append(f"{name}: {len(bad)} of {len(keys)} hairs have no finite place or size; left out")
        kept = keys > 1
        kept[bad] = False
        if (keys == 1).any():
            notices.append(f"{name}: {int((keys == 1).sum())} of {len(keys)} hairs have one key alone; left out")
        if not kept.any():
            return None
        which = kept[strand]
        first = np.concatenate(([0], np.cumsum(keys[kept])))
        return Strands(points[which], radius[which], first, self.smooth, self.material)


def absorption_of_colour(colour: NDArray[np.float64], azimuthal: float) -> NDArray[np.float64]:
    """The optical depth of a radius with which many hairs look so: Chiang et al. (2016), eq 9."""
    x = azimuthal
    fit = 5.969 - 0.215 * x + 2.532 * x**2 - 10.73 * x**3 + 5.574 * x**4 + 0.245 * x**5
    absorption: NDArray[np.float64] = (np.log(np.clip(colour, 1e-5, 1.0)) / fit) ** 2
    return absorption


def absorption_of_melanin(melanin: NDArray[np.float64], redness: float) -> NDArray[np.float64]:
    """Of an artist's melanin (n,) in [0, 1]; (n, 3)."""
    amount = -np.log(np.maximum(1.0 - melanin, 1e-4))[:, None]
    absorption: NDArray[np.float64] = amount * ((1.0 - redness) * _EUMELANIN + redness * _PHEOMELANIN)
    return absorption


def _random(count: int) -> NDArray[np.float64]:
    """Of each strand a number in [0, 1], as Cycles has it: Jenkins' hash (2006) of the strand's."""
    state = [np.full(count, (0xDEADBEEF + (2 << 2) + 13) & 0xFFFFFFFF, dtype=np.uint32) for _ in range(3)]
    state[0] += np.arange(count, dtype=np.uint32)
    for to, by, turn in ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24)):
        state[to] ^= state[by]
        state[to] -= (state[by] << np.uint32(turn)) | (state[by] >> np.uint32(32 - turn))
    return state[2] / float(0xFFFFFFFF)


@dataclass
class Look:
    """The arguments of Scene.add_strands that say how strands look."""

    fibre: NDArray[np.float64] | None = None  # (k, 8)
    matt: NDArray[np.float64] | None = None  # (1, 7)
    material: NDArray[np.int64] | None = None  # (m,)


class Reader:
    """What a shader's inputs say, which of hair is the same all over, and what is to be said of it to the artist."""

    def __init__(self, owner: str, notices: list[str]) -> None:
        self.owner, self.notices = owner, notices

    def say(self, words: str) -> None:
        self.notices.append(f"{self.owner}: {words}")

    def number(self, shader: Any, name: str, low: float = 0.0, high: float = 1.0) -> float:
        return float(np.clip(value_of(shader, name, self.owner, self.notices), low, high))

    def colour(self, shader: Any, name: str) -> NDArray[np.float64]:
        found: NDArray[np.float64] = np.maximum(value_of(shader, name, self.owner, self.notices), 0.0)
        return found


def _fibres(shader: Any, count: int, reader: Reader) -> Look:
    """A Principled Hair BSDF on so many strands."""
    omissions.of_node(shader, reader.owner, reader.notices)
    if getattr(shader, "model", "CHIANG") == "HUANG":  # 4.0
        reader.say("its Principled Hair's model Huang is shown as Chiang's, without the details of its own")
    varied = reader.number(shader, "Random Color"), reader.number(shader, "Random Roughness")
    random = np.full(1, 0.5)
    if any(varied):
        linked = bool(shader.inputs["Random"].links)
        random = np.full(1, reader.number(shader, "Random")) if linked else _random(count)
    roughness, azimuthal = reader.number(shader, "Roughness"), reader.number(shader, "Radial Roughness")
    rough = 1.0 + 2.0 * (random - 0.5) * varied[1]
    if shader.parametrization == "ABSORPTION":
        absorption = np.maximum(value_of(shader, "Absorption Coefficient", reader.owner, reader.notices), 0.0)[None]
    elif shader.parametrization == "COLOR":
        absorption = absorption_of_colour(reader.colour(shader, "Color"), azimuthal)[None]
    else:
        melanin = reader.number(shader, "Melanin") * (1.0 + 2.0 * (random - 0.5) * varied[0])
        absorption = absorption_of_melanin(melanin, reader.number(shader, "Melanin Redness"))
        absorption = absorption + absorption_of_colour(reader.colour(shader, "Tint"), azimuthal)
    rows = np.zeros((max(len(rough), len(absorption)), 8))
    rows[:, :3] = absorption
    rows[:, 3] = np.clip(roughness * rough, 0.001, 1.0)
    rows[:, 4] = np.clip(azimuthal * rough, 0.001, 1.0)
    rows[:, 5] = np.clip((1.0 - reader.number(shader, "Coat")) * rows[:, 3], 0.001, 1.0)
    rows[:, 6] = reader.number(shader, "Offset", -np.pi / 2.0, np.pi / 2.0)
    rows[:, 7] = reader.number(shader, "IOR", 1.0, 1000.0)
    return Look(fibre=rows, material=np.arange(count) if len(rows) > 1 else None)


def _matt(surface: looks.Surface, reader: Reader, name: str) -> Look:
    reader.say(f"its hair's shader {name} is shown as Kajiya and Kay's (1989), which has one highlight")
    if surface.emission.any():
        reader.say("its hair's glow is not shown")
    gloss = surface.gloss[0] if surface.gloss else looks.Gloss(np.zeros(3), (0.3, 0.3))
    roughness = np.clip(max(gloss.alpha) ** 0.5, 0.05, 1.0)
    row = (*np.clip(surface.albedo, 0.0, 1.0), *np.clip(gloss.reflectance, 0.0, 1.0), roughness)
    return Look(matt=np.array([row]))


def _hair_bsdf(shader: Any, reader: Reader) -> looks.Surface:
    colour = np.clip(reader.colour(shader, "Color"), 0.0, 1.0)
    if shader.component == "Transmission":
        return looks.Surface(colour)
    roughness = max(reader.number(shader, "RoughnessU"), 0.05)
    return looks.Surface(gloss=[looks.Gloss(colour, (roughness**2, roughness**2))])


def look_of(material: Any, count: int, owner: str, notices: list[str]) -> Look:
    """How a material, or none, makes so many strands look."""
    reader, output = Reader(owner, notices), active_output(material)
    shader = None if output is None else linked_node(output, "Surface")
    if shader is not None and not shader.mute and shader.type == "BSDF_HAIR_PRINCIPLED":
        return _fibres(shader, count, reader)
    if shader is not None and not shader.mute and shader.type == "BSDF_HAIR":
        return _matt(_hair_bsdf(shader, reader), reader, shader.bl_rna.name)
    surface = surfaces.surface_of(material, owner, notices) or looks.Surface()
    return _matt(surface, reader, "material" if shader is None else shader.bl_rna.name)


def systems_of(thing: Any, depsgraph: Any) -> Iterator[Any]:
    """Its particle systems that show hair."""
    for modifier in thing.modifiers:
        shown = modifier.show_render if depsgraph.mode == "RENDER" else modifier.show_viewport
        if shown and modifier.type == "PARTICLE_SYSTEM":
            settings = modifier.particle_system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                yield modifier.particle_system


def _profile(settings: Any, share: NDArray[np.float64]) -> NDArray[np.float64]:
    """The radius at shares of the way from root to tip. Its Diameter Root and its Tip are diameters."""
    root, tip = (0.5 * settings.radius_scale * width for width in (settings.root_radius, settings.tip_radius))
    power = 1.0 + settings.shape if settings.shape < 0.0 else 1.0 / max(1.0 - settings.shape, 1e-6)
    radius: NDArray[np.float64] = (1.0 - share) ** power * (root - tip) + tip
    return radius


def of_system(thing: Any, system: Any, depsgraph: Any, notices: list[str]) -> Strands | None:
    """The hairs of an evaluated object's particle system: children where there are any, else parents."""
    settings = system.settings
    render = depsgraph.mode == "RENDER"
    parents, children = len(system.particles), len(system.child_particles)
    if not render:
        children = int(children * settings.display_percentage / 100.0)
    first, last = (parents, parents + children) if settings.child_type != "NONE" and children else (0, parents)
    steps = 2 ** (settings.render_step if render else settings.display_step) + 1
    if settings.kink == "SPIRAL":
        steps += settings.kink_extra_steps
    count = last - first
    if count <= 0:
        return None
    own = np.array(thing.matrix_world, dtype=np.float64)
    if not abs(float(np.linalg.det(own[:3, :3]))) > 1e-12:
        notices.append(f"{thing.name}: its scale leaves its hair no place; left out")
        return None
    # Blender has no array of these.
    place = system.co_hair
    keys = np.array([place(thing, particle_no=i, step=step) for i in range(first, last) for step in range(steps)])
    world = np.linalg.inv(own)
    points = (keys @ world[:3, :3].T + world[:3, 3]).reshape(count, steps, 3)
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=2)
    used = np.concatenate((np.ones((count, 1), dtype=bool), lengths > 0.0), axis=1)
    along = np.concatenate((np.zeros((count, 1)), np.cumsum(lengths, axis=1)), axis=1)
    radius = _profile(settings, along / np.maximum(along[:, -1:], 1e-30))
    if settings.use_close_tip:
        radius[np.arange(count), used.shape[1] - 1 - np.argmax(used[:, ::-1], axis=1)] = 0.0
    ends = np.concatenate(([0], np.cumsum(used.sum(axis=1))))
    return Strands(points[used], radius[used], ends, material=max(settings.material - 1, 0))


def of_curves(data: Any, name: str, notices: list[str]) -> list[Strands]:
    """Hair curves; those with corners apart from smooth ones."""
    count, curves = len(data.points), len(data.curves)
    if count == 0 or curves == 0:
        return []
    points = np.empty(count * 3, dtype=np.float32)
    data.points.foreach_get("position", points)
    attribute = data.attributes.get("radius")
    radius = np.full(count, DEFAULT_RADIUS, dtype=np.float32)
    if attribute is not None and attribute.domain == "POINT" and attribute.data_type == "FLOAT":
        attribute.data.foreach_get("value", radius)
    first, length = (np.empty(curves, dtype=np.int32) for _ in range(2))
    data.curves.foreach_get("first_point_index", first)
    data.curves.foreach_get("points_length", length)
    kinds = np.zeros(curves, dtype=np.int32)
    kind = data.attributes.get("curve_type")
    if kind is not None and kind.domain == "CURVE":
        values = np.empty(curves, dtype=np.int8 if kind.data_type == "INT8" else np.int32)
        kind.data.foreach_get("value", values)
        kinds = values.astype(np.int32)
    if (kinds > 1).any():
        notices.append(f"{name}: its Bezier and NURBS hairs are shown as curves through their points")
    cornered = (kinds == 1) & compat.poly_curves_have_corners()
    found = []
    for smooth, which in ((True, ~cornered), (False, cornered)):
        if which.any():
            index = np.concatenate([np.arange(a, a + n) for a, n in zip(first[which], length[which])])
            ends = np.concatenate(([0], np.cumsum(length[which])))
            places = points.reshape(-1, 3)[index].astype(np.float64)
            found.append(Strands(places, radius[index].astype(np.float64), ends, smooth))
    return found


@dataclass
class Hair:
    """Strands in their place, for the native scene."""

    name: str
    strands: Strands
    look: Look

    def add_to(self, scene: Any, visibility: Any) -> None:
        """Raises ValueError for what the scene refuses."""
        scene.add_strands(
            self.strands.points,
            self.strands.radius,
            self.strands.first,
            fibre=self.look.fibre,
            matt=self.look.matt,
            material=self.look.material,
            smooth=self.strands.smooth,
            visibility=visibility,
        )


def hair_of(thing: Any, matrix: NDArray[np.float64], depsgraph: Any, notices: list[str]) -> list[Hair]:
    """All hair of an evaluated object in a place, (4, 4): of its particle systems, or its curves."""
    bodies: list[Strands] = []
    if thing.type == "CURVES":
        bodies = of_curves(thing.data, thing.name, notices)
    for system in systems_of(thing, depsgraph):
        body = of_system(thing, system, depsgraph, notices)
        bodies += [] if body is None else [body]
    slots = materials_of(thing, depsgraph) or [None]
    out = []
    for body in bodies:
        placed = body.in_world(matrix, thing.name, notices)
        if placed is not None:
            material = slots[min(placed.material, len(slots) - 1)]
            out.append(Hair(thing.name, placed, look_of(material, len(placed.first) - 1, thing.name, notices)))
    return out
