# SPDX-License-Identifier: GPL-3.0-or-later
"""Particle systems that render as Halo, and point clouds: soft puffs, or spheres.

Cycles draws no halos; here they are puffs. To Cycles the points of a cloud are spheres, of which it ignores the volume;
here they are puffs where their material is a volume or is seen through. Particles that render as objects or collections
are instances of meshes like all others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import props
from ..limits import MOST_SPHERES
from . import looks, materials, surfaces, visibility
from .known.objects import POINTS
from .shading import shaders

Floats = NDArray[np.float32]

DEAD, UNBORN, ALIVE = 1, 2, 3  # of a particle's alive_state
POINT_RADIUS = 0.01  # metres, of points that have none of their own, as in Cycles
FARTHEST = 1e9  # metres: Blender makes 3.4e38 of an infinite place
LEAST_LEFT = 1e-6  # of the light that passes one side of a sphere, since what is opaque has no optical depth


@dataclass
class Look:
    """How a body of puffs looks. What each takes of the light through its middle, in the colour of which most is taken, is
    its `opacity`, or follows from its radius and what it takes per metre there (`thickness`)."""

    albedo: NDArray[np.float64]
    opacity: float = 0.0
    thickness: float | None = None
    relative: NDArray[np.float64] = field(
        default_factory=lambda: np.ones(3)
    )  # what is taken of each colour, of the most
    anisotropy: float = 0.0

    def opacities(self, radii: Floats) -> NDArray[np.float64]:
        """Of puffs whose density falls as 1 - (r / radius)^2."""
        if self.thickness is None:
            return np.full(len(radii), self.opacity)
        opacities: NDArray[np.float64] = -np.expm1(-4.0 / 3.0 * self.thickness * radii.astype(np.float64))
        return opacities


@dataclass
class Body:
    """The particles of a system or the points of a cloud in a space of their own, and all matrices (4, 4) from there to
    the scene's, with the numbers of the depsgraph's instances. Spheres have a `surface`, puffs a `look`."""

    name: str
    places: Floats  # (n, 3)
    radii: Floats  # (n,)
    look: Look | None
    surface: looks.Surface | None = None
    object_index: int = 0
    material_index: int = 0
    matrices: list[NDArray[np.float64]] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)

    def add(self, number: int, matrix: NDArray[np.float64]) -> None:
        """One more place; what has none is nowhere."""
        if not np.isfinite(matrix).all():
            return
        self.numbers.append(number)
        self.matrices.append(matrix)

    def divided(self, seen: dict[int, visibility.Visibility]) -> dict[visibility.Visibility | None, list[int]]:
        """Which of its places are alike to the camera and to lights."""
        kinds: dict[visibility.Visibility | None, list[int]] = {}
        for index, number in enumerate(self.numbers):
            kinds.setdefault(seen.get(number), []).append(index)
        return kinds

    def is_uneven(self, which: list[int]) -> bool:
        """Whether any of these places stretches what is there."""
        matrices = np.array([self.matrices[index] for index in which])
        stretches = np.linalg.svd(matrices[:, :3, :3], compute_uv=False)
        return bool((stretches.max(axis=1) > 1.001 * stretches.min(axis=1)).any())

    def in_all_places(self, which: list[int]) -> tuple[Floats, Floats]:
        """Centres (n, 3) and radii (n,) in the scene's space, from those of its matrices."""
        centres, radii = [], []
        for matrix in (self.matrices[index] for index in which):
            turned = not np.array_equal(matrix[:3, :3], np.eye(3))
            here = self.places @ matrix[:3, :3].T if turned else self.places
            scale = np.cbrt(abs(np.linalg.det(matrix[:3, :3]))) if turned else 1.0
            centres.append((here + matrix[:3, 3]).astype(np.float32) if matrix[:3, 3].any() else here)
            radii.append((self.radii * scale).astype(np.float32))
        return np.concatenate(centres), np.concatenate(radii)

    def spheres(self, which: list[int]) -> NDArray[np.float64]:
        """Matrices (n, 4, 4) from a sphere of radius 1 to the scene's space."""
        own: NDArray[np.float64] = np.zeros((len(self.places), 4, 4))
        own[:, (0, 1, 2), (0, 1, 2)] = self.radii[:, None]
        own[:, :3, 3], own[:, 3, 3] = self.places, 1.0
        return np.concatenate([self.matrices[index] @ own for index in which])


class Particles:
    """Those of one export, collected until it is known what each of their places is to the camera and to lights."""

    def __init__(self, depsgraph: Any, origin: NDArray[np.float64], notices: list[str]) -> None:
        self._depsgraph = depsgraph
        self._to_scene = np.eye(4)
        self._to_scene[:3, 3] -= origin
        self._notices = notices
        self._bodies: dict[tuple[int, ...], Body | None] = {}

    @property
    def bodies(self) -> list[Body]:
        return [body for body in self._bodies.values() if body is not None]

    def numbers(self, puffs: bool) -> set[int]:
        """The depsgraph's instances that have puffs, or spheres."""
        return {number for body in self.bodies if (body.surface is None) == puffs for number in body.numbers}

    def add_systems(self, number: int, instance: Any, matrix: NDArray[np.float64]) -> None:
        """The systems of an emitter that render as Halo, at a matrix to the scene's space."""
        thing = instance.object
        for system in self._halos(thing):
            key = (system.as_pointer(),)
            if key not in self._bodies:
                self._bodies[key] = self._of_system(thing, system)
            body = self._bodies[key]
            if body is None:
                continue
            if not instance.is_instance:
                body.add(number, self._to_scene)
                continue
            own = np.array(thing.matrix_world, dtype=np.float64)
            if abs(np.linalg.det(own[:3, :3])) < 1e-12:
                scale = [round(part, 6) for part in thing.matrix_world.to_scale()]
                self._say(thing, "flat", value=scale)
                continue
            body.add(number, matrix @ np.linalg.inv(own))

    def add_cloud(self, number: int, thing: Any, matrix: NDArray[np.float64]) -> None:
        shown = materials.materials_of(thing, self._depsgraph)
        key = (thing.data.as_pointer(), *(0 if each is None else each.as_pointer() for each in shown))
        if key not in self._bodies:
            self._bodies[key] = self._of_cloud(thing, shown[0] if shown else None)
        body = self._bodies[key]
        if body is not None:
            body.add(number, matrix)

    def _halos(self, thing: Any) -> Iterator[Any]:
        render = self._depsgraph.mode == "RENDER"
        for modifier in thing.modifiers:
            if modifier.type != "PARTICLE_SYSTEM" or not (modifier.show_render if render else modifier.show_viewport):
                continue
            system = modifier.particle_system
            settings = system.settings
            if settings.type == "HAIR" or settings.render_type != "HALO" or not props.of_particles(settings).shown:
                continue
            if settings.type == "FLIP":  # what a liquid is made of
                self._say(thing, "liquid", value=settings.name)
                continue
            yield system

    def _of_system(self, thing: Any, system: Any) -> Body | None:
        settings = system.settings
        if settings.child_type != "NONE":
            self._say(thing, "children", value=settings.name)
        places, radii = alive(system, self._depsgraph.mode == "RENDER")
        if len(places) == 0:
            self._say(thing, "dead", value=settings.name, frame=self._depsgraph.scene.frame_current)
            return None
        places, radii = self._usable(thing, places, radii * np.float32(props.of_particles(settings).size))
        slots = materials.materials_of(thing, self._depsgraph)
        material = slots[min(settings.material, len(slots)) - 1] if slots else None
        name, notices = thing.name, self._notices
        look = volume_look(material, name, notices) or seen_through_look(material, name, notices)
        look = look or panel_look(settings, name, notices)
        return self._shown(Body(name, places, radii, look))

    def _of_cloud(self, thing: Any, material: Any) -> Body | None:
        places, radii = points_of(thing.data)
        places, radii = self._usable(thing, places, radii)
        body = Body(thing.name, places, radii, None, object_index=thing.pass_index)
        of_volume: list[str] = []
        of_surface: list[str] = []
        look = volume_look(material, thing.name, of_volume)
        surface = surfaces.surface_of(material, thing.name, of_surface)
        if surface is None or (look is not None and surface.transmittance.any()):
            body.look = look
            self._notices += of_volume
            return self._shown(body)
        self._notices += of_surface
        if surface.transmittance.any():
            body.look = surface_look(surface, thing.name, self._notices)
            self._say(thing, "soft")
        elif len(places) > MOST_SPHERES:
            body.look = surface_look(surface, thing.name, self._notices)
            self._say(thing, "many", value=len(places), most=MOST_SPHERES)
        else:
            body.surface, body.material_index = surface, 0 if material is None else material.pass_index
            if surface.emission.any():
                self._say(thing, "glow")
        return self._shown(body)

    def _usable(self, thing: Any, places: Floats, radii: Floats) -> tuple[Floats, Floats]:
        """Those that have a place and a size."""
        placed, sized = (np.abs(places) < FARTHEST).all(axis=1), (radii >= 0.0) & (radii < FARTHEST)
        for right, key in ((placed, "misplaced"), (sized, "unsized")):
            if not right.all():
                self._say(thing, key, value=int((~right).sum()), all=len(places))
        usable = placed & sized & (radii > 0.0)
        return (places, radii) if usable.all() else (places[usable], radii[usable])

    def _shown(self, body: Body) -> Body | None:
        return body if len(body.places) else None

    def _say(self, thing: Any, key: str, **values: Any) -> None:
        self._notices.append(said(thing.name, key, **values))


def said(name: str, key: str, **values: Any) -> str:
    """A notice in the words of known/."""
    return f"{name}: {POINTS[key].format(**values)}"


def alive(system: Any, render: bool) -> tuple[Floats, Floats]:
    """World places (n, 3) and sizes (n,) of the particles of an evaluated system that Blender would show: in a view, of
    which it leaves some out, those of that share."""
    particles, settings = system.particles, system.settings
    count = len(particles)
    states, there = np.empty(count, np.int32), np.empty(count, bool)
    particles.foreach_get("alive_state", states)
    particles.foreach_get("is_exist", there)
    shown = states == ALIVE
    if settings.show_unborn:
        shown |= states == UNBORN
    if settings.use_dead:
        shown |= states == DEAD
    shown &= there
    if not render:  # whose flags are the view's
        particles.foreach_get("is_visible", there)
        shown &= there
    places, sizes = np.empty(count * 3, np.float32), np.empty(count, np.float32)
    particles.foreach_get("location", places)
    particles.foreach_get("size", sizes)
    triples = places.reshape(-1, 3)
    return (triples, sizes) if shown.all() else (triples[shown], sizes[shown])


def points_of(cloud: Any) -> tuple[Floats, Floats]:
    """Places (n, 3) and radii (n,) of a point cloud, in its object's space."""
    found = cloud.attributes.get("position")
    count = 0 if found is None else len(found.data)
    places, radii = np.empty(count * 3, np.float32), np.full(count, POINT_RADIUS, np.float32)
    if count:
        found.data.foreach_get("vector", places)
    if count and "radius" in cloud.attributes:
        cloud.attributes["radius"].data.foreach_get("value", radii)
    return places.reshape(-1, 3), radii


def volume_look(material: Any, name: str, notices: list[str]) -> Look | None:
    """By the volume of a material; None without one."""
    look = shaders.of_material(material, name, notices)
    if look is None:
        return None
    smoke = look.everywhere()
    if look.emission:
        notices.append(said(name, "dark"))
    for attribute in sorted({*replace(look, emission=()).attributes, smoke.tint} - {"", "density"}):
        notices.append(said(name, "alike", value=attribute))
    most = float(smoke.extinction.max())
    albedo = np.divide(smoke.scattering, smoke.extinction, out=np.zeros(3), where=smoke.extinction > 0.0)
    relative = smoke.extinction / most if most > 0.0 else np.ones(3)
    return Look(np.clip(albedo, 0.0, 1.0), thickness=most, relative=relative, anisotropy=smoke.anisotropy)


def seen_through_look(material: Any, name: str, notices: list[str]) -> Look | None:
    """By a material whose surface lets light through; None by any other."""
    of_surface: list[str] = []
    surface = None if material is None else surfaces.surface_of(material, name, of_surface)
    if surface is None or not surface.transmittance.any():
        return None
    notices += of_surface
    return surface_look(surface, name, notices)


def surface_look(surface: looks.Surface, name: str, notices: list[str]) -> Look:
    """That of puffs of which the middle hides as much as both sides of a sphere that has this surface. They have its diffuse
    part alone."""
    if surface.emission.any():
        notices.append(said(name, "dark"))
    depths = -2.0 * np.log(np.clip(surface.transmittance, LEAST_LEFT, 1.0))
    most = float(depths.max())
    relative = depths / most if most > 0.0 else np.ones(3)
    scattered = looks.diffuse_share(surface) * surface.albedo + surface.translucence
    albedo = scattered / np.maximum(1.0 - surface.transmittance, LEAST_LEFT)
    return Look(np.clip(albedo, 0.0, 1.0), opacity=-float(np.expm1(-most)), relative=relative)


def panel_look(settings: Any, name: str, notices: list[str]) -> Look:
    """What the panel says of a particle system whose material says nothing."""
    own = props.of_particles(settings)
    opacity = float(own.opacity)
    if not 0.0 <= opacity <= 1.0:
        opacity = float(np.clip(np.nan_to_num(opacity), 0.0, 1.0))
        notices.append(
            said(name, "opacity", value=f"{own.opacity:.3g}", settings=settings.name, shown=f"{opacity:.3g}")
        )
    return Look(np.clip(np.array(own.color), 0.0, 1.0), opacity, anisotropy=own.anisotropy)


def add_puffs(scene: Any, body: Body, which: list[int], seen: visibility.Visibility | None, notices: list[str]) -> None:
    """A body in those of its places that are alike to the camera and to lights."""
    look = body.look
    assert look is not None
    if body.is_uneven(which):
        notices.append(said(body.name, "round"))
    centres, radii = body.in_all_places(which)
    try:
        scene.add_particles(
            centres,
            radii,
            look.opacities(radii),
            look.albedo,
            look.relative,
            look.anisotropy,
            visibility=visibility.native(seen),
        )
    except ValueError as error:
        notices.append(f"{body.name}: {error}")
