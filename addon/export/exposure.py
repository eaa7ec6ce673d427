# SPDX-License-Identifier: GPL-3.0-or-later
"""What blurs a picture as Cycles takes it: the camera's depth of field, and where it is while the shutter is open."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mathutils
import numpy as np
from numpy.typing import NDArray

from .. import core
from . import meshes

Matrix = NDArray[np.float64]

SHARES = 64  # of the light that a shutter lets in: when each has come
MOST_TIMES = 129  # of a place: what Embree takes
FINER = 4  # between two places of a camera that turns, as many steps as a straight line may stand for


def lens_of(camera: Any) -> dict[str, Any]:
    """What Exposure has of the lens of an evaluated camera; nothing where all is sharp."""
    data = camera.data
    field = data.dof
    if not field.use_dof:
        return {}
    parallel = data.type == "ORTHO"  # then the lens is as wide as Cycles has it, and stands in the near plane
    width = 1.0 if parallel else 1e-3 * data.lens
    return {
        "lens_radius": width / (2.0 * max(field.aperture_fstop, 1e-5)),
        "focus": min(max(_focus(camera, field), 1e-5), 1e9),
        "near": 0.0 if parallel else data.clip_start,
        "blades": field.aperture_blades,
        "rotation": field.aperture_rotation,
        "ratio": min(max(field.aperture_ratio, 1e-3), 1e3),
    }


def _focus(camera: Any, field: Any) -> float:
    """Metres along the camera's axis."""
    target = field.focus_object
    if target is None:
        return float(field.focus_distance)
    place = target.matrix_world
    bone = target.pose.bones.get(field.focus_subtarget) if target.pose is not None else None
    if bone is not None:
        place = place @ bone.matrix
    axis = camera.matrix_world.col[2].to_3d().normalized()
    return abs(float(axis.dot(camera.matrix_world.translation - place.translation)))


@dataclass(frozen=True)
class Shutter:
    """When it opens and closes, in frames; `middle` is when the scene is as it is exported."""

    opens: float
    closes: float
    curve: tuple[float, ...]  # when shares of the light have come in; none where it comes in evenly

    @property
    def middle(self) -> float:
        return 0.5 * (self.opens + self.closes)

    def times(self, count: int) -> NDArray[np.float64]:
        """So many, evenly from its opening to its closing; one is the middle."""
        return np.linspace(self.opens, self.closes, count) if count > 1 else np.array([self.middle])


def shutter_of(depsgraph: Any) -> Shutter | None:
    """That of a render with motion blur; None where everything stands still."""
    scene, render = depsgraph.scene, depsgraph.scene.render
    cycles = getattr(scene, "cycles", None)
    layer = depsgraph.view_layer
    if not (render.use_motion_blur and getattr(layer, "use_motion_blur", True)):
        return None
    width = render.motion_blur_shutter
    position: str = getattr(render, "motion_blur_position", "") or getattr(cycles, "motion_blur_position", "CENTER")
    now = scene.frame_current + scene.frame_subframe  # before Time Stretching, as the engine's frame_set takes it
    opens = now - {"START": 0.0, "CENTER": 0.5, "END": 1.0}[position] * width
    return Shutter(opens, opens + width, _arrivals(render.motion_blur_shutter_curve))


def _arrivals(mapping: Any) -> tuple[float, ...]:
    """When shares of the light have come in through a shutter with that curve."""
    mapping.initialize()
    curve = mapping.curves[0]
    times = np.linspace(0.0, 1.0, 4 * SHARES + 1)
    opening = np.maximum([mapping.evaluate(curve, float(time)) for time in times], 0.0)
    if np.ptp(opening) < 1e-6 or opening.sum() <= 0.0:
        return ()
    come = np.concatenate([[0.0], np.cumsum(0.5 * (opening[1:] + opening[:-1]))])
    return tuple(np.interp(np.linspace(0.0, 1.0, SHARES + 1), come / come[-1], times).tolist())


@dataclass(frozen=True)
class View:
    """Of a camera at one time: its own place in the world, and what takes its space to clip space."""

    place: Matrix
    projection: Matrix

    def matrix(self, origin: Matrix) -> Matrix:
        """What takes the space that begins at `origin` to clip space."""
        place = self.place.copy()
        place[:3, 3] -= origin
        return self.projection @ np.linalg.inv(place)


def between(first: View, second: View, share: float) -> View:
    """As Cycles moves what turns: by what its matrix is made of, a rotation (slerp), what it stretches and shears, and a
    place, each by itself (polar decomposition)."""
    (turn, stretch), (next_turn, next_stretch) = (_polar(view.place[:3, :3]) for view in (first, second))
    out = (1.0 - share) * first.place + share * second.place
    mixed = (
        mathutils.Matrix(turn.tolist())
        .to_quaternion()
        .slerp(mathutils.Matrix(next_turn.tolist()).to_quaternion(), share)
    )
    rotation = np.array(mixed.to_matrix(), dtype=np.float64)
    out[:3, :3] = rotation @ ((1.0 - share) * stretch + share * next_stretch)
    return View(out, (1.0 - share) * first.projection + share * second.projection)


def _polar(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """A rotation, and what it is applied to."""
    left, sizes, right = np.linalg.svd(matrix)
    turn = left @ right
    turn = -turn if np.linalg.det(turn) < 0.0 else turn
    return turn, turn.T @ (left * sizes) @ right


def finely(views: list[View], most: int = 1 << 16) -> list[View]:
    """With more between those of what turns, but not more than that."""
    first = views[0]
    if not any(np.abs(view.place[:3, :3] - first.place[:3, :3]).max() > 1e-6 for view in views):
        still = all(
            np.abs(view.place - first.place).max() < 1e-9 and np.abs(view.projection - first.projection).max() < 1e-9
            for view in views
        )
        return views[:1] if still else views
    finer = max(min(FINER, (most - 1) // max(len(views) - 1, 1)), 1)
    return [between(one, other, step / finer) for one, other in zip(views, views[1:]) for step in range(finer)] + views[
        -1:
    ]


def of(views: list[View], lens: dict[str, Any], origin: Matrix, shutter: Shutter | None) -> Any:
    """The native Exposure, or the Camera where all is sharp, of a camera's views while the shutter is open."""
    native = core.module()
    cameras = [native.Camera(view.matrix(origin)) for view in finely(views)]
    if len(cameras) == 1 and not lens and shutter is None:
        return cameras[0]
    return native.Exposure(cameras, **lens, shutter=shutter.curve if shutter is not None and shutter.curve else None)


@dataclass(frozen=True)
class Moment:
    """Where things are at one time."""

    names: tuple[tuple[Any, ...], ...]  # of the depsgraph's object instances
    matrices: Matrix  # (n, 4, 4), of these
    vertices: dict[str, NDArray[np.float32]]  # of meshes that may change their shape, by their objects


def moment_of(depsgraph: Any) -> Moment:
    names: list[tuple[Any, ...]] = []
    numbers: list[float] = []
    for instance in depsgraph.object_instances:
        parent = instance.parent if instance.is_instance else None
        names.append((instance.object.name_full, parent.name_full if parent else "", *instance.persistent_id))
        first, second, third, last = instance.matrix_world
        numbers += (*first, *second, *third, *last)
    vertices = {
        thing.name_full: meshes.vertices_of(thing.data)
        for thing in depsgraph.objects
        if thing.type == "MESH" and (thing.modifiers or thing.data.shape_keys) and _may_deform(thing)
    }
    return Moment(tuple(names), np.array(numbers, np.float64).reshape(-1, 4, 4), vertices)


def _may_deform(thing: Any) -> bool:
    settings = getattr(thing, "cycles", None)
    return settings is None or (settings.use_motion_blur and settings.use_deform_motion)


def _numbers_of(names: tuple[tuple[Any, ...], ...]) -> dict[tuple[Any, ...], int]:
    """Of those that name one instance."""
    count = Counter(names)
    return {name: number for number, name in enumerate(names) if count[name] == 1}


class Motion:
    """What moves while the shutter is open, of moments from its opening to its closing."""

    def __init__(self, moments: list[Moment]) -> None:
        self.moments = moments
        middle = moments[len(moments) // 2]
        self._numbers = [_numbers_of(moment.names) if moment.names != middle.names else None for moment in moments]
        self._names = middle.names

    def of(self, place: int, thing: Any, origin: Matrix) -> list[Matrix] | None:
        """The matrices of an instance, by its number at the middle, relative to `origin`; None where it stands still, or
        where it is not there all the time."""
        if steps_of(thing) == 0:
            return None
        found = []
        for moment, numbers in zip(self.moments, self._numbers):
            number = place if numbers is None else numbers.get(self._names[place])
            if number is None:
                return None
            found.append(moment.matrices[number])
        if all(np.allclose(matrix, found[0], rtol=0.0, atol=1e-7) for matrix in found):
            return None
        views = [View(matrix, np.eye(4)) for matrix in found]
        out = [view.place.copy() for view in finely(views, MOST_TIMES)]
        for matrix in out:
            matrix[:3, 3] -= origin
        return out

    def vertices_of(self, thing: Any, depsgraph: Any) -> NDArray[np.float32] | None:
        """(times, n, 3) of a mesh; None where it keeps its shape, or its faces change, or where it is not the object's own,
        but what nodes make an instance of."""
        if thing.type != "MESH" or thing.original.evaluated_get(depsgraph).data != thing.data:
            return None
        found = [moment.vertices.get(thing.name_full) for moment in self.moments]
        first = found[0]
        if first is None or any(each is None or each.shape != first.shape for each in found):
            return None
        stacked = np.stack([each for each in found if each is not None])
        return None if np.ptp(stacked, axis=0).max(initial=0.0) < 1e-7 else stacked


def steps_of(thing: Any) -> int:
    """How many times Cycles looks at where an object is while the shutter is open: 0 for one that is to stand still."""
    settings = getattr(thing, "cycles", None)
    if settings is None:
        return 3
    if not settings.use_motion_blur:
        return 0
    doublings: int = max(settings.motion_steps, 1)
    return (1 << doublings) + 1


def said(still: dict[str, str], changing: list[str]) -> list[str]:
    """That Motion Blur leaves what is not a surface as it is at the shutter's middle, by the names of objects; and how
    surfaces look whose shapes are changing."""
    return [
        f"{name}: Motion Blur does not blur its {what}, which stays as at the middle" for name, what in still.items()
    ] + [f"{name}: its shape changes while the shutter is open, and is shaded as at the middle" for name in changing]


def over_times(go_to: Callable[[int, float], None], shutter: Shutter, count: int, look: Callable[[], Any]) -> list[Any]:
    """What look() finds at so many times from the shutter's opening to its closing, with the scene gone to each; it is at
    the middle afterwards."""
    found: list[tuple[int, Any]] = []
    middle = count // 2  # comes last
    times = shutter.times(count)
    for number in [*(each for each in range(count) if each != middle), middle]:
        time = float(times[number])
        frame = int(np.floor(time))
        go_to(frame, time - frame)
        found.append((number, look()))
    return [each for _, each in sorted(found, key=lambda each: each[0])]
