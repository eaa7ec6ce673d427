# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to plain arrays.

What cannot be shown is said in a notice; it never stops the rest.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core, log, props
from ..limits import MOST_BODIES, MOST_LIGHTS, MOST_MEDIA
from . import (
    air,
    bounces,
    exposure,
    fog,
    hair,
    lights,
    materials,
    meshes,
    omissions,
    particles,
    smoke,
    surfaces,
    textures,
    visibility,
    voxels,
    world,
)
from .looks import Surface, brushed, diffuse_kinds, rows_of_gloss, sheens, translucences, transmittances
from .parts import Parts
from .visibility import Reach, Visibility


@dataclass
class Export:
    """A scene for the native module, and what an artist should know about it."""

    scene: Any
    notices: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)  # of these, the smoke that should be there
    drawn: set[str] = field(default_factory=set)  # objects whose smoke a viewport draws
    bounced: bool = False  # whether surfaces light each other
    moving: dict[int, list[NDArray[np.float64]]] = field(default_factory=dict)  # matrices of places that move, at times


LATTICE = 256.0  # metres


def origin_of(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a scene is exported relative to, (3,), of the places (n, 3) of all that it shows: single precision knows a place
    to 1e-7 of its distance from the origin. The middle of most, on a lattice so coarse that an edit seldom moves it, which
    would spoil all parts that are kept; near the world's own origin that one."""
    places = places[np.isfinite(places).all(axis=1)]
    middle = np.median(places, axis=0) if len(places) else np.zeros(3)
    origin: NDArray[np.float64] = LATTICE * np.round(middle / LATTICE)
    return origin


@dataclass
class _Group:
    """Surfaces that share a mesh and materials, and what fills it: the objects themselves may be gone when their matrices
    are known."""

    name: str
    mesh: Any
    surfaces: list[Surface]  # none: nothing but what fills it is seen
    triangles: meshes.Triangles | None  # of what glows
    material_indices: list[int]
    places: list[int] = field(default_factory=list)
    object_indices: list[int] = field(default_factory=list)
    reach: dict[int, Reach | None] = field(default_factory=dict)  # of what glows, in each of its places
    volume: air.Even | None = None
    vessel: fog.Vessel | None = None  # what that fills
    textures: textures.Textures | None = None  # where surfaces vary
    values: list[tuple[float, ...]] = field(default_factory=list)  # of its places, which these ask for

    def add(self, place: int, instance: Any, flags: visibility.Flags) -> None:
        thing = instance.object
        self.places.append(place)
        if self.textures is not None:
            self.values.append(textures.values_of(instance))
        self.object_indices.append(thing.pass_index)
        if self.triangles is not None:
            self.reach[place] = flags.reach_of(thing)

    def divided(self, seen: dict[int, Visibility]) -> dict[tuple[Visibility | None, Reach | None], list[int]]:
        """The numbers of its places by what these are to the camera and to lights, and what they light."""
        if not seen and not self.reach:
            return {(None, None): list(range(len(self.places)))}
        kinds: dict[tuple[Visibility | None, Reach | None], list[int]] = {}
        for number, place in enumerate(self.places):
            kinds.setdefault((seen.get(place), self.reach.get(place)), []).append(number)
        return kinds

    def filled(self, seen: dict[int, Visibility]) -> dict[Visibility | None, list[int]]:
        """The numbers of its places by what fills them is to the camera and to lights; none where nothing does."""
        kinds: dict[Visibility | None, list[int]] = {}
        for number, place in enumerate(self.places if self.volume is not None else ()):
            kinds.setdefault(seen.get(place), []).append(number)
        return kinds


Seen = dict[int, Visibility]


def _visibilities(
    depsgraph: Any, flags: visibility.Flags, surface_places: set[int], smoke_places: set[int]
) -> tuple[Seen, Seen]:
    """What places are to the camera and to lights, if any of them may not be plain: of surfaces, and of smoke. By then all
    lights are known."""
    of_surfaces: Seen = {}
    of_smoke: Seen = {}
    if flags.matter:
        for number, instance in enumerate(depsgraph.object_instances):
            if number in surface_places:
                of_surfaces[number] = flags.visibility_of(instance)
            if number in smoke_places:
                of_smoke[number] = flags.of_smoke(instance)
    return of_surfaces, of_smoke


def filter_of(space: Any) -> tuple[Any, ...]:
    """What tells what a 3D view leaves out from what others do: in local view, by its own collections, by types of
    objects that are hidden in it. Nothing for a view that shows all."""
    if space is None:
        return ()
    hidden = tuple(name for name in _type_switches() if not getattr(space, name))
    if space.local_view is None and not space.use_local_collections and not hidden:
        return ()
    return space.as_pointer(), space.local_view is not None, space.use_local_collections, hidden


@functools.cache
def _type_switches() -> tuple[str, ...]:
    """The properties of a 3D view that hide objects of one type."""
    names = bpy.types.SpaceView3D.bl_rna.properties.keys()
    return tuple(name for name in names if name.startswith("show_object_viewport_"))


def export(
    depsgraph: Any,
    parts: Parts | None = None,
    space: Any = None,
    smoke_alone: bool = False,
    camera: Any = None,
    motion: exposure.Motion | None = None,
) -> Export:
    """Everything that `depsgraph` shows, and its `motion`, in a 3D view if there is one, with what `parts` has of an earlier export. Where
    smoke and shadows alone are seen of it there are no notices of what surfaces and the world look like. Raises
    core.Missing without the native module. A render may look through another `camera` than the scene's."""
    parts = parts or Parts()
    out = Export(core.module().Scene())
    reflections, bounced = bounces.of_scene(depsgraph.scene)
    out.scene.set_bounces(reflections, bounced)
    out.bounced = bounced > 0
    looks: list[str] = [] if smoke_alone else out.notices
    lit = 0
    suns: list[str] = []
    sharp: list[str] = []
    layer = depsgraph.view_layer_eval
    flags = visibility.Flags(depsgraph, out.notices)
    media: list[tuple[int, str, smoke.Medium]] = []
    groups: dict[tuple[int, int], _Group | None] = {}
    shown, emits, matrices = compat.instance_matrices(depsgraph)
    origin = origin_of(matrices[shown | emits, :3, 3])
    matrices[:, :3, 3] -= origin
    out.scene.set_origin(origin)
    points = particles.Particles(depsgraph, origin, out.notices)
    filtered, lies_over = bool(filter_of(space)), omissions.lies_over(space)
    said_of: set[int] = set()  # objects
    strands: list[tuple[int, hair.Hair]] = []
    changing: list[str] = []  # while the shutter is open, their shapes
    flowing: set[int] = set()  # smoke of simulations
    for number, instance in enumerate(depsgraph.object_instances):
        if not (shown[number] or emits[number]):
            continue
        thing = instance.object
        if filtered and not thing.visible_in_viewport_get(space):
            continue
        if emits[number] and layer.use_volumes:
            points.add_systems(number, instance, matrices[number])
        if layer.use_strand and (shown[number] and thing.type == "CURVES" or emits[number] and thing.particle_systems):
            strands += [(number, each) for each in hair.hair_of(thing, matrices[number], depsgraph, looks)]
        if not shown[number]:
            continue
        key = _group_key(thing)
        if motion is not None:
            moves = motion.of(number, thing, origin)
            if moves is not None:
                out.moving[number] = moves
        if key in groups:
            group = groups[key]
            if group is not None:
                group.add(number, instance, flags)
                if not lies_over and thing.original.as_pointer() not in said_of:
                    omissions.of_copy(thing, group.triangles is not None, out.notices)
                    said_of.add(thing.original.as_pointer())
            continue
        said_of.add(thing.original.as_pointer())
        try:
            if thing.type == "LIGHT":
                reach = flags.reach_of(thing)
                lights_something = reach is not None and lights.add_light(
                    out.scene, thing, matrices[number], out.notices, reach
                )
                lit += lights_something
                suns += [thing.name] if lights_something and thing.data.type == "SUN" else []
                sharp += [thing.name] if lights_something and lights.is_sharp(thing.data) else []
                if not lies_over and (lights_something or (reach is None and thing.data.energy > 0.0)):
                    omissions.of("object", thing, thing.name, out.notices, "LIGHT")
                continue
            if not (layer.use_volumes if thing.type == "VOLUME" else layer.use_solid):
                continue
            if thing.type == "POINTCLOUD":
                points.add_cloud(number, thing, matrices[number])
                continue
            bodies = smoke.media_of(thing, matrices[number], depsgraph, parts, out.notices)
            if bodies is not None:
                omissions.of_smoke(thing, out.notices)
                media += [(number, thing.name, medium) for medium in bodies]
                flowing |= {number} if any(each.type == "FLUID" for each in thing.modifiers) else set()
                lit += add_flames(out.scene, bodies, flags.reach_of(thing))
            elif thing.type in meshes.SURFACE_TYPES:
                moving = None if motion is None else motion.vertices_of(thing, depsgraph)
                changing += [] if moving is None else [thing.name]
                groups[key] = group = _group_of(thing, depsgraph, parts, looks, out.notices, origin, moving)
                if group is not None:
                    group.add(number, instance, flags)
                    if lies_over:
                        omissions.of_pane(thing.name, group.surfaces, space, out.notices)
                    else:
                        omissions.of_surface(thing, group.triangles is not None, depsgraph, out.notices)
            elif not lies_over:
                omissions.of_type(thing, out.notices)
        except ValueError as error:
            groups[key] = None
            out.notices.append(f"{thing.name}: {error}")
            if isinstance(error, voxels.Missing):
                out.missing.append(out.notices[-1])
    solids = [group for group in groups.values() if group is not None]
    seen, smoke_seen = _visibilities(
        depsgraph,
        flags,
        {place for group in solids for place in group.places}
        | points.numbers(puffs=False)
        | {number for number, _ in strands},
        {number for number, *_ in media}
        | {place for group in solids if group.volume is not None for place in group.places}
        | points.numbers(puffs=True),
    )
    for group in solids:
        for kind, which in group.divided(seen).items() if group.surfaces else ():
            lit += add_surfaces(out, group, which, matrices, *kind)
        for of, which in group.filled(smoke_seen).items():
            if (
                lies_over and space is not None and space.shading.type == "MATERIAL"
            ):  # where Blender's own picture has it
                of = (of or Visibility())._replace(seen="unseen")
            add_fog(out, group, which, matrices, of)
    add_points(out, points, parts, seen, smoke_seen)
    light, backdrop = world.background(depsgraph, parts, looks) if layer.use_sky else (world.BLACK, world.BLACK)
    if world.add_light(out.scene, materials.world_of(depsgraph), light):
        lit += 1
        looks += [
            f"{group.name}: what its anisotropic gloss mirrors of the world is as if it were not"
            for group in solids
            if not isinstance(light.shown, np.ndarray) and brushed(group.surfaces)
        ]
    if lit == 0:
        out.notices.append("No light: nothing is lit. Add one, or raise its strength")
    for number, each in strands:
        try:
            each.add_to(out.scene, visibility.native(flags.of_hair(seen.get(number), each.name)))
        except ValueError as error:
            out.notices.append(f"{each.name}: {error}")
    add_media(out, [(name, medium, smoke_seen.get(number)) for number, name, medium in media])
    omissions.of_hair(
        dict.fromkeys(each.name for _, each in strands),
        depsgraph,
        smoke_alone and bool(media or points.bodies),
        out.notices,
    )
    glass = (group.name for group in solids if any(surface.glass for surface in group.surfaces))
    omissions.of_glass(dict.fromkeys(glass), sharp, depsgraph, looks)
    all_looks = [look for group in solids for look in group.surfaces or ()]
    unreflected = {
        "hair": bool(strands),
        "particles": bool(points.bodies),
        "what lets light through": any(look.lets_through for look in all_looks),
        "fog": any(group.volume is not None for group in solids),
    }
    if reflections and not lies_over:
        out.notices += bounces.said(all_looks, out.bounced, unreflected, bool(media))
    if motion is not None:
        still = {name: "smoke" for number, name, _ in media if number in out.moving or number in flowing}
        still |= {group.name: "fog" for group in solids if group.volume and out.moving.keys() & set(group.places)}
        still |= {each.name: "hair" for number, each in strands if number in out.moving}
        still |= {body.name: "particles" for body in points.bodies}
        out.notices += exposure.said(still, [thing for thing in changing if thing not in still])
    air.add_air(out.scene, depsgraph, origin, space, suns, out.notices)
    omissions.of_frame(depsgraph, materials.world_of(depsgraph), space, out.notices, camera)
    if not depsgraph.scene.render.film_transparent:
        out.scene.set_background(backdrop.shown, 1.0, backdrop.gain)
    parts.end_export()
    return out


def frame_of(
    depsgraph: Any,
    source: str,
    parts: Parts | None = None,
    whole: bool = False,
    space: Any = None,
    camera: Any = None,
    motion: exposure.Motion | None = None,
) -> Any:
    """The native Frame of what `depsgraph` shows, relative to its origin, in a 3D view if there is one, in the scene's
    quality; its notices go to the log under `source`. A render may look through another `camera` than the scene's.

    Raises core.Missing without the native module, ValueError and RuntimeError for what it refuses, and where it must be
    `whole`, ValueError for smoke that is missing.
    """
    parts = parts or Parts()
    out = export(depsgraph, parts, space, camera=camera, motion=motion)
    log.replace(source, out.notices)
    if whole and out.missing:
        raise ValueError("; ".join(out.missing))
    return made_of(out, depsgraph.scene, parts, source if space is not None else "")


def made_of(out: Export, settings: Any, parts: Parts, view: str = "") -> Any:
    """The native Frame of an export, in the quality of a scene. In a `view`, under whose name notices go to the log, its
    shader may have less room for lights than there are."""
    quality = props.QUALITIES[props.of(settings).quality]
    frame = core.module().Frame(out.scene, **quality.frame, prepared=parts.native)
    count = len(frame.lights)  # of what looks like one there may be many: a world, a mesh that glows
    if view and count > MOST_LIGHTS:
        said = f"{count} lights: in the viewport only the first {MOST_LIGHTS} light the smoke"
        log.replace(view, [*out.notices, said])
    return frame


def _group_key(thing: Any) -> tuple[int, int]:
    """Equal for objects that share mesh and materials, by addresses that hold while the depsgraph is being read. What
    has modifiers or materials of its own stands alone."""
    data = thing.data
    data_address = 0 if data is None else data.as_pointer()
    slots = thing.material_slots
    if thing.type != "MESH" or thing.modifiers or (slots and any(slot.link == "OBJECT" for slot in slots)):
        return thing.as_pointer(), data_address
    return 0, data_address


def _group_of(
    thing: Any,
    depsgraph: Any,
    parts: Parts,
    looks: list[str],
    notices: list[str],
    origin: NDArray[np.float64],
    moving: NDArray[np.float32] | None,
) -> _Group | None:
    """The surfaces of an object, whose vertices may be moving, and what fills it, without a place as yet; None where it
    has neither. Of surfaces is said what they look like."""
    said: list[str] = []
    found = surfaces.surfaces(thing, depsgraph, said, textures.readers(thing.name, parts, said))
    volume = fog.volume_of(thing, depsgraph, notices)
    vessel = None if volume is None else fog.vessel_of(thing, depsgraph, parts)
    made = None if found is None else textures.textures_of(thing, found, parts, origin, said)
    mesh = None
    if found is not None:
        wanted = () if made is None else made.channels
        mesh = meshes.mesh_of(thing, len(found), brushed(found), depsgraph, parts, wanted, moving)
    if mesh is None:  # as of what nodes make points of
        found = None
    if found is None and vessel is None:
        return None
    if vessel is not None:
        fog.say(thing.name, vessel, notices)
    if found is None:
        return _Group(thing.name, None, [], None, [], volume=volume, vessel=vessel)
    looks += said
    glows = any(surface.glows for surface in found)
    shown = materials.materials_of(thing, depsgraph)
    indices = [material.pass_index if material else 0 for material in shown] or [0]
    lamps = meshes.triangles_of(thing, len(found)) if glows else None
    volume = None if vessel is None else volume
    return _Group(thing.name, mesh, found, lamps, indices, volume=volume, vessel=vessel, textures=made)


def _usable(
    out: Export, group: _Group, which: list[int], matrices: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Those of its places (n, 4, 4) that are anywhere, and which they are."""
    places = matrices[[group.places[number] for number in which]]
    usable = np.isfinite(places).all(axis=(1, 2))
    if not usable.all():
        out.notices.append(f"{group.name}: its matrix is not finite in {int((~usable).sum())} places; left out there")
    return places[usable], usable


def add_fog(
    out: Export, group: _Group, which: list[int], matrices: NDArray[np.float64], seen: Visibility | None
) -> None:
    """What fills an object, in those of its places that are alike, of all `matrices` (n, 4, 4)."""
    volume, vessel = group.volume, group.vessel
    assert volume is not None and vessel is not None
    places, _ = _usable(out, group, which, matrices)
    try:
        out.scene.add_fog(
            vessel.mesh,
            places,
            volume.rayleigh,
            volume.mie,
            volume.absorption,
            volume.emission,
            volume.anisotropy,
            visibility=visibility.native(seen),
        )
    except ValueError as error:
        out.notices.append(f"{group.name}: {error}")


_WHOLE = {"holdout": "a Holdout", "catcher": "a Shadow Catcher"}


def add_surfaces(
    out: Export,
    group: _Group,
    which: list[int],
    matrices: NDArray[np.float64],
    seen: Visibility | None,
    reach: Reach | None,
) -> int:
    """The triangles of an object in those of its places that are alike, of all `matrices` (n, 4, 4). Returns how many
    lights those that emit are."""
    places, usable = _usable(out, group, which, matrices)
    indices = np.array([group.object_indices[number] for number in which], dtype=np.float64)[usable]
    emission = np.array([surface.emission for surface in group.surfaces])
    transmittance = transmittances(group.surfaces)
    values = np.array([group.values[number] for number in which])[usable] if group.textures is not None else None
    if any(surface.lets_through for surface in group.surfaces) and seen is not None and seen.seen in _WHOLE:
        out.notices.append(f"{group.name}: it lets light through, but is {_WHOLE[seen.seen]} as if it did not")
    emitters = _emitters(group, places, values, emission) if group.triangles is not None and reach is not None else []
    try:
        out.scene.add_instances(
            group.mesh,
            places,
            np.clip([surface.albedo for surface in group.surfaces], 0.0, 1.0),
            rows_of_gloss(group.surfaces),
            emission=emission if emission.any() else None,
            diffuse=diffuse_kinds(group.surfaces),
            object_index=indices,
            material_index=np.array(group.material_indices, dtype=np.float64),
            visibility=visibility.native(seen),
            transmittance=transmittance,
            patterns=[] if group.textures is None else group.textures.patterns,
            values=values,
            lamp=bool(emitters) and None not in emitters,
            translucence=translucences(group.surfaces),
            sheen=sheens(group.surfaces),
            moving=_moving(out, [group.places[number] for number in which], matrices, usable),
        )
    except ValueError as error:
        out.notices.append(f"{group.name}: {error}")
        return 0
    if None in emitters and not out.bounced:
        out.notices.append(
            f"{group.name}: it emits, but lights nothing: more than {lights.MOST_POLYGONS} of its faces do. With Bounced "
            "Light it does"
        )
    known = [polygon for each in emitters for polygon in each or []]
    if reach is not None and None not in emitters:
        for corners, colour in known:
            out.scene.add_polygon(corners, colour, reach=visibility.native(reach))
        return len(known)
    return 0


def _moving(
    out: Export, places: list[int], matrices: NDArray[np.float64], usable: NDArray[np.bool_]
) -> NDArray[np.float64] | None:
    """The matrices of the usable places at times, (times, n, 4, 4); None where all stand still."""
    times = max((len(out.moving[place]) for place in places if place in out.moving), default=0)
    if times == 0:
        return None
    still = [matrices[place] for place in places]
    all_places = np.stack(
        [at_times(out.moving.get(place, [matrix]), times) for place, matrix in zip(places, still)], axis=1
    )
    return all_places[:, usable]


def at_times(known: list[NDArray[np.float64]], count: int) -> NDArray[np.float64]:
    """Matrices at even times, (count, 4, 4), of those at fewer."""
    at = np.linspace(0.0, len(known) - 1, count)
    first = np.minimum(at.astype(int), max(len(known) - 2, 0))
    share = (at - first)[:, None, None]
    each = np.stack(known)
    mixed: NDArray[np.float64] = (1.0 - share) * each[first] + share * each[np.minimum(first + 1, len(known) - 1)]
    return mixed


def _emitters(
    group: _Group, places: NDArray[np.float64], values: NDArray[np.float64] | None, emission: NDArray[np.float64]
) -> list[list[tuple[NDArray[np.float64], NDArray[np.float64]]] | None]:
    """The polygons of each place that emit, and what; None for one that has too many."""
    read = group.triangles
    if read is None:
        return []
    rows = np.zeros(len(read.triangles), np.int32) if read.material is None else read.material
    out = []
    for number, matrix in enumerate(places):
        corners = (read.vertices @ matrix[:3, :3].T + matrix[:3, 3])[read.triangles]
        each = emission[rows]
        if group.textures is not None and values is not None:
            group.textures.add_emission(group.mesh, rows, matrix, values[number], each)
        out.append(lights.emitters(corners, each))
    return out


def add_points(out: Export, points: particles.Particles, parts: Parts, seen: Seen, smoke_seen: Seen) -> None:
    """Particles and the points of clouds, as puffs or as spheres."""
    for body in points.bodies:
        for kind, which in body.divided(seen if body.surface else smoke_seen).items():
            if body.surface is None:
                particles.add_puffs(out.scene, body, which, kind, out.notices)
                continue
            if body.is_uneven(which):
                out.notices.append(particles.said(body.name, "uneven"))
            places = body.spheres(which)
            numbers = list(range(len(places)))
            indices = [body.object_index] * len(places)
            group = _Group(
                body.name, meshes.sphere(parts), [body.surface], None, [body.material_index], numbers, indices
            )
            add_surfaces(out, group, numbers, places, kind, None)


def add_flames(scene: Any, media: list[smoke.Medium], reach: Reach | None) -> int:
    """The light of what burns. Returns how many lights that is."""
    flames = [flame for medium in media for flame in medium.flames] if reach is not None else []
    for flame in flames:
        scene.add_point(flame.position, flame.intensity, radius=flame.radius, reach=visibility.native(reach), part=True)
    return len(flames)


def add_media(out: Export, media: list[tuple[str, smoke.Medium, Visibility | None]]) -> None:
    """The bodies of smoke; where there are too many, those with the most in them."""
    media = sorted(media, key=lambda entry: entry[1].amount, reverse=True)
    for name, *_ in media[MOST_BODIES:]:
        out.notices.append(f"{name}: only {MOST_BODIES} bodies of smoke are shown; this one has the least in it")
    if len(media) > MOST_MEDIA:
        kept = ", ".join(name for name, *_ in media[:MOST_MEDIA])
        out.notices.append(
            f"{len(media)} bodies of smoke: the viewport draws the {MOST_MEDIA} with the most in them, {kept}; "
            "renders, and shadows on surfaces, have all"
        )
    for number, (name, medium, seen) in enumerate(media[:MOST_BODIES]):
        try:
            out.scene.add_medium(
                medium.grid,
                medium.grid_to_world,
                medium.scattering,
                medium.absorption,
                medium.anisotropy,
                visibility=visibility.native(seen),
                emission=medium.emission,
            )
            out.drawn |= {name} if number < MOST_MEDIA else set()
        except ValueError as error:
            out.notices.append(f"{name}: {error}")
