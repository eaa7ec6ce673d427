# SPDX-License-Identifier: GPL-3.0-or-later
"""A viewport at rest shows what F12 shows: soft shadows of solids. And then it is at rest."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import harness
import numpy as np
import pictures
import screen
import sfumato
from mathutils import Quaternion, Vector
from numpy.typing import NDArray
from sfumato import props  # type: ignore[attr-defined]
from sfumato.export import scene
from sfumato.view import overlay, painter, refinement

Steps = Iterator["float | None"]
# As in screen.py, between the GPU and the CPU: half floats, and weights of 8 bits on hardware.
TOLERANCE, LARGEST = 1e-3, 1e-2
PLATE = Vector((3.0, 1.0, 1.0))


def soft_plume(shading: str) -> Generator[None, None, Any]:
    """The sample under an area light of 1.5 m, with a plate whose shadow keeps clear of the smoke's. In a small viewport
    is what the camera sees, pixel for pixel as F12 sees it. Gives back the viewport's space."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)  # what a test opened before is in the way of the sample's names
    harness.open_plume(25)
    for direction in ("VERTICAL", "HORIZONTAL"):
        window, area, region = screen.viewport()
        before = {other.as_pointer() for other in window.screen.areas}
        with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
            bpy.ops.screen.area_split(direction=direction, factor=0.5)
        next(other for other in window.screen.areas if other.as_pointer() not in before).type = "TEXT_EDITOR"
        yield
    bpy.data.objects.remove(bpy.data.objects["Sun"])
    light = bpy.data.lights.new("Lamp", "AREA")
    light.shape, light.size, light.energy = "SQUARE", 1.5, 5000.0
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location = (4.5, -2.5, 6.0)
    lamp.rotation_euler = (PLATE - lamp.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(lamp)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=PLATE, scale=(0.9, 0.9, 0.02))
    bpy.context.view_layer.objects.active.name = "Plate"
    settings = bpy.context.scene
    settings.render.engine = "SFUMATO"
    settings.eevee.taa_samples = 1  # Material Preview is EEVEE's, which else redraws by itself
    space = screen.prepare(shading)
    region = screen.viewport()[2]
    settings.render.resolution_x, settings.render.resolution_y = region.width, region.height
    space.region_3d.view_perspective = "CAMERA"
    # The camera's frame is as large as the view where (sqrt(2) + zoom / 50)^2 / 4 = 1.
    space.region_3d.view_camera_zoom = 50.0 * (2.0 - 2.0**0.5)
    space.region_3d.view_camera_offset = (0.0, 0.0)
    return space


@contextmanager
def made() -> Iterator[list[bool]]:
    """Every picture that is made for a view: whether it is refined."""
    out: list[bool] = []
    original = painter.Painter._make_picture

    def make(self: Any, view: Any, frame: Any, look: Any, refined: Any, spacing: int) -> Any:
        out.append(refined is not None)
        return original(self, view, frame, look, refined, spacing)

    painter.Painter._make_picture = make
    try:
        yield out
    finally:
        painter.Painter._make_picture = original


@contextmanager
def started() -> Iterator[list[int]]:
    """How many threads are started."""
    count = [0]
    original = refinement._Refinement.start

    def start(self: Any) -> None:
        count[0] += 1
        original(self)

    refinement._Refinement.start = start
    try:
        yield count
    finally:
        refinement._Refinement.start = original


@contextmanager
def counted_draws() -> Iterator[list[int]]:
    """How often a 3D viewport is drawn."""
    count = [0]

    def draw() -> None:
        count[0] += 1

    handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "PRE_VIEW")
    try:
        yield count
    finally:
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")


@contextmanager
def resting_after(seconds: float) -> Iterator[None]:
    """Another time that a view must rest before it is refined; a long one leaves first looks alone."""
    rest, refinement.REST = refinement.REST, seconds
    try:
        yield
    finally:
        refinement.REST = rest


def first_look(seen: list[Any]) -> Steps:
    for _ in range(2):
        seen.clear()
        while not seen:
            yield None


def surfaces_of(size: tuple[int, int]) -> NDArray[np.float32]:
    """Distances through the middles of the pixels of the view."""
    frame = sfumato.Frame(scene.export(bpy.context.evaluated_depsgraph_get()).scene, light_samples=1)
    return frame.surfaces(sfumato.Camera(screen.view_matrix()), *size)[..., 3]


def around(mask: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
    """Wherever `mask` is set within so many pixels."""
    height, width = mask.shape
    padded = np.pad(mask, pixels)
    shifts = range(2 * pixels + 1)
    return np.any([padded[y : y + height, x : x + width] for y in shifts for x in shifts], axis=0)


def silhouettes(distance: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Where the film's filter, 1.5 pixels to either side, reaches across a jump or a crease of the distance: F12 marches
    through the smoke once for each sample there, the GPU once for the pixel."""
    ratio = np.log(distance)
    jump = np.zeros(distance.shape, bool)
    for axis in (0, 1):
        leap = np.abs(np.diff(ratio, n=2, axis=axis)) > 3e-4
        inner = [slice(1, -1) if axis == a else slice(None) for a in (0, 1)]
        jump[tuple(inner)] |= leap
    return around(jump, 2)


def near_the_plates_shadow(distance: NDArray[np.float32]) -> NDArray[np.bool_]:
    """The pixels of the floor within a metre of the shadow's middle, away from silhouettes."""
    height, width = distance.shape
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, (np.arange(height) + 0.5) / height * 2 - 1)
    inverse = np.linalg.inv(screen.view_matrix())

    def at(depth: float) -> NDArray[np.float64]:
        point = np.stack([x, y, np.full_like(x, depth), np.ones_like(x)], -1) @ inverse.T
        return point[..., :3] / point[..., 3:]

    near, far = at(-1.0), at(1.0)
    along = (far - near) / np.linalg.norm(far - near, axis=-1, keepdims=True)
    point = near + along * distance[..., None]
    lamp = bpy.data.objects["Lamp"].location
    middle = PLATE + (PLATE - lamp) * (PLATE.z / (lamp.z - PLATE.z))
    beside = np.hypot(point[..., 0] - middle.x, point[..., 1] - middle.y) < 1.0
    return beside & (np.abs(point[..., 2]) < 1e-3) & ~silhouettes(distance)


def shadow_of(with_plate: NDArray[Any], without: NDArray[Any], floor: NDArray[np.bool_]) -> NDArray[Any]:
    """How much of the plate's shadow lies on each pixel of the floor: from 0 in the light to 1 in the umbra."""
    lost = 1.0 - with_plate[..., :3].mean(-1)[floor] / without[..., :3].mean(-1)[floor]
    return lost / np.quantile(lost, 0.99)


def between(shadow: NDArray[Any]) -> float:
    """Of the pixels that have any shadow, the share that is neither in the umbra nor in the light."""
    return float(np.mean((shadow > 0.1) & (shadow < 0.9)) / np.mean(shadow > 0.1))


def test_a_rendered_view_at_rest_is_f12() -> Steps:
    yield from soft_plume("RENDERED")
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        shown = seen[-1][0]
        with resting_after(1e9):
            bpy.data.objects["Lamp"].data.energy *= 1.000001
            yield from first_look(seen)
            at_once = seen[-1][0]
    size = shown.shape[1], shown.shape[0]
    f12 = pictures.render(size)
    edges = silhouettes(surfaces_of(size))
    inner = ~edges
    error = np.abs(shown - f12)[..., :3]
    rmse, mean = float(np.sqrt(np.mean(error[inner] ** 2))), float(f12[inner][..., :3].mean())
    # The two cameras differ by rounding, which moves one sample in many thousands across an edge.
    largest = float(np.quantile(error[inner].max(-1), 0.9999))
    before = float(np.sqrt(np.mean((at_once - f12)[inner][..., :3] ** 2)))
    print(f"  {size}: RMSE {rmse:.2e}, 99.99th percentile {largest:.2e}, before the refinement RMSE {before:.2e}, mean of "
          f"the image {mean:.3f}; at silhouettes, {edges.mean():.1%} of the pixels, RMSE "
          f"{np.sqrt(np.mean(error[edges] ** 2)):.2e}")  # fmt: skip
    assert inner.mean() > 0.8, "hardly anything is compared"
    assert rmse <= TOLERANCE * mean and largest <= LARGEST
    assert before > 10.0 * TOLERANCE * mean, "there is nothing to refine"


def test_shadows_of_solids_are_soft() -> Steps:
    """In the Rendered view and in the overlay, and the same in both."""
    shadows = {}
    for shading in ("RENDERED", "SOLID"):
        yield from soft_plume(shading)
        settings, plate = bpy.context.scene.sfumato, bpy.data.objects["Plate"]
        with screen.watched() as seen:
            plate.hide_viewport = True
            yield from screen.drawn(seen)
            without = seen[-1][0]
            plate.hide_viewport = False
            yield from screen.drawn(seen)
            rested = seen[-1][0]
            with resting_after(1e9):
                bpy.data.objects["Lamp"].data.energy *= 1.000001
                yield from first_look(seen)
                at_once = seen[-1][0]
        floor = near_the_plates_shadow(surfaces_of((rested.shape[1], rested.shape[0])))
        assert floor.sum() > 500
        shadows[shading] = shadow_of(rested, without, floor)
        soft, hard = between(shadows[shading]), between(shadow_of(at_once, without, floor))
        print(f"  {shading}: {soft:.1%} of the shadow is penumbra, {hard:.1%} in the first redraw")
        assert settings.viewport_enabled and soft > 0.3 and hard < 0.02
    # Both are the share of the lamp that the plate hides, in other terms: what differs is which rims count as edges.
    difference = shadows["RENDERED"] - shadows["SOLID"]
    print(f"  the two differ by {np.sqrt(np.mean(difference**2)):.2e}")
    assert np.sqrt(np.mean(difference**2)) < 0.02


def test_redraws_stop() -> Steps:
    for shading in ("RENDERED", "SOLID", "MATERIAL"):
        space = yield from soft_plume(shading)
        with screen.watched() as seen:
            yield from screen.drawn(seen)
        yield 1.0  # whatever Blender itself still has to draw
        with counted_draws() as draws, made() as pictures_made:
            space.region_3d.view_camera_offset = (0.01, 0.0)
            screen.viewport()[1].tag_redraw()
            yield 0.5
            yield from screen.refined()
            yield 1.0
            print(f"  {shading}: {draws[0]} draws, refined: {pictures_made}")
            assert pictures_made == [False, True], "a first look, and a refined one"
            assert draws[0] <= 4 or shading == "MATERIAL", "Blender's own may redraw while they compile"
            draws[0] = 0
            yield 2.0
            assert draws[0] == 0 or shading == "MATERIAL", f"{draws[0]} redraws of a view at rest"
            assert pictures_made == [False, True], "nothing of ours is made again"
            assert not refinement.busy() and not bpy.app.timers.is_registered(refinement._tick)


def test_what_keeps_changing_is_never_refined() -> Steps:
    for shading in ("RENDERED", "SOLID"):
        space = yield from soft_plume(shading)
        view = space.region_3d
        view.view_perspective = "PERSP"
        with screen.watched() as seen:
            yield from screen.drawn(seen)
        window, area, region = screen.viewport()
        with made() as pictures_made:
            with started() as threads_started, resting_after(1.0):
                for _ in range(8):
                    view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.01) @ view.view_rotation
                    area.tag_redraw()
                    yield 0.5
                assert len(pictures_made) >= 8 and not any(pictures_made), pictures_made
                # A machine that halts for a second makes a rest of it.
                assert threads_started[0] <= 1, f"{threads_started[0]} of 8 steps were refined in vain"
            yield from screen.refined()
            yield None
            yield None
            assert pictures_made[-1] and sum(pictures_made) == 1

            pictures_made.clear()
            # So slow that each frame has time to rest.
            bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 1, 1.0
            with bpy.context.temp_override(window=window, area=area, region=region):
                bpy.ops.screen.animation_play()
            yield 4.0
            for _ in range(60):  # a busy machine takes longer to make two pictures
                if len(pictures_made) < 2:
                    yield 1.0
            with bpy.context.temp_override(window=window, area=area, region=region):
                bpy.ops.screen.animation_cancel(restore_frame=False)
            print(f"  {shading}: {len(pictures_made)} pictures while it was played")
            assert len(pictures_made) >= 2 and not any(pictures_made), pictures_made


def held(progress: Callable[[float], bool]) -> None:
    """A trace that goes on until it is stopped."""
    while progress(0.5):
        threading.Event().wait(0.01)


def threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name == "Sfumato refinement"]


def test_a_change_and_disabling_stop_what_runs() -> Steps:
    yield from soft_plume("SOLID")
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        view = screen.viewport()[2].as_pointer()
        refinement.ask(view, ("held",), held)
        while not threads():
            yield 0.02
        refinement.ask(view, ("another",), held)
        deadline = 100
        while threads() and deadline:
            deadline -= 1
            yield 0.01
        assert deadline, "what was replaced goes on"
        while not threads():
            yield 0.02
        assert bpy.app.timers.is_registered(refinement._tick)
        overlay.disable()
        assert not threads() and not bpy.app.timers.is_registered(refinement._tick) and not refinement.busy()
        overlay.enable()
        bpy.context.scene.render.engine = "SFUMATO"
        yield from screen.drawn(seen)
        # Waiting, not yet running.
        bpy.data.objects["Lamp"].data.energy *= 2.0
        yield from first_look(seen)
        overlay.disable()
        assert not threads() and not bpy.app.timers.is_registered(refinement._tick) and not refinement.busy()
        overlay.enable()


def test_every_quality_refines() -> None:
    assert all(quality.edge_samples > 1 for quality in props.QUALITIES.values())


harness.main()
