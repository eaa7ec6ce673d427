# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke in the viewport: an overlay that leaves nothing behind, and the picture of the Rendered mode."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import harness
import numpy as np
import screen
import sfumato
from mathutils import Quaternion
from screen import assert_same
from sfumato import log, props  # type: ignore[attr-defined]
from sfumato.export import scene
from sfumato.view import overlay


def plume(shading: str) -> tuple[Any, bpy.types.Object]:
    """The sample at frame 25, seen by its camera, with nothing else in the viewport: the viewport and the smoke."""
    smoke = harness.open_plume(25)
    space = screen.prepare(shading)
    space.region_3d.view_perspective = "CAMERA"
    return space, smoke


@contextmanager
def counted_exports() -> Iterator[list[int]]:
    """How often the overlay reads the scene."""
    count = [0]
    original = scene.export

    def export(*arguments: Any) -> scene.Export:
        count[0] += 1
        return original(*arguments)

    scene.export = export
    try:
        yield count
    finally:
        scene.export = original


def shaded_and_sunny(smoke: bpy.types.Object) -> tuple[tuple[int, int], tuple[int, int]]:
    """Two pixels (row, column) of surfaces in the sun and beside the smoke: in its shadow, and out of it."""
    _window, _area, region = screen.viewport()
    size = region.width, region.height
    matrix = screen.view_matrix()
    frame = sfumato.Frame(scene.export(bpy.context.evaluated_depsgraph_get()).scene)
    camera = sfumato.Camera(matrix)
    surfaces = frame.surfaces(camera, *size)
    # In the sun but for the smoke: some of its light arrives, or the smoke takes it.
    smoke_shadow = frame.surfaces(camera, *size, output="smoke_shadow")
    sunny = np.maximum(surfaces, smoke_shadow)[..., :3].max(-1) > 0.1
    corners = matrix @ np.array(smoke.matrix_world) @ np.array([(*corner, 1.0) for corner in smoke.bound_box]).T
    columns, rows = ((corners[axis] / corners[3] * 0.5 + 0.5) * size[axis] for axis in (0, 1))

    best: dict[str, tuple[float, tuple[int, int]]] = {"dark": (2.0, (0, 0)), "bright": (-1.0, (0, 0))}
    inverse = np.linalg.inv(matrix)
    for row in range(2, size[1], 4):
        for column in range(2, size[0], 4):
            beside = not (rows.min() < row < rows.max() and columns.min() < column < columns.max())
            if not beside or not sunny[row, column]:
                continue
            ndc = 2.0 * (column + 0.5) / size[0] - 1.0, 2.0 * (row + 0.5) / size[1] - 1.0
            near, far = (inverse @ (*ndc, depth, 1.0) for depth in (-1.0, 1.0))
            near, far = near[:3] / near[3], far[:3] / far[3]
            along = (far - near) / np.linalg.norm(far - near)
            through = float(frame.transmittance(near + along * surfaces[row, column, 3])[0])
            best["dark"] = min(best["dark"], (through, (row, column)))
            best["bright"] = max(best["bright"], (through, (row, column)))
    assert best["dark"][0] < 0.3 and best["bright"][0] > 0.99, best
    return best["dark"][1], best["bright"][1]


def test_overlay_darkens_the_shadow_and_leaves_no_trace() -> Iterator[float | None]:
    _space, smoke = plume("SOLID")
    settings = bpy.context.scene.sfumato
    with screen.watched() as seen:
        settings.viewport_enabled = False
        yield from screen.drawn(seen)
        without = seen[-1]
        settings.viewport_enabled = True
        yield from screen.drawn(seen)
        with_smoke = seen[-1]
        settings.viewport_enabled = False
        yield from screen.drawn(seen)
        again = seen[-1]
    dark, bright = shaded_and_sunny(smoke)
    print(f"  shadow {with_smoke[0][dark][0] / without[0][dark][0]:.3f} of what it was, beside it "
          f"{with_smoke[0][bright][0] / without[0][bright][0]:.3f}")  # fmt: skip
    assert (with_smoke[0][dark][:3] < 0.7 * without[0][dark][:3]).all()
    assert np.allclose(with_smoke[0][bright][:3], without[0][bright][:3], rtol=5e-3)
    for before, after in zip(without, again):
        assert np.array_equal(before, after), "switching the overlay off must restore every pixel"
    assert not log.notices(), log.notices()


def test_rendered_view_keeps_to_its_region() -> Iterator[float | None]:
    """That of the view; seen through the camera, the scene's, in the camera's frame."""
    space, _smoke = plume("RENDERED")
    render = bpy.context.scene.render
    render.engine = "SFUMATO"
    with screen.watched() as seen:
        for view in ("CAMERA", "PERSP"):
            space.region_3d.view_perspective = view
            render.use_border = space.use_render_border = False
            yield from screen.drawn(seen)
            whole = seen[-1][0]
            # Of the other kind of view, a region that must not count here.
            for owner, name, edges in ((render, "border", (0.25, 0.75)), (space, "render_border", (0.4, 0.6))):
                for axis in "xy":
                    setattr(owner, f"{name}_min_{axis}", edges[0])
                    setattr(owner, f"{name}_max_{axis}", edges[1])
            render.use_border = space.use_render_border = True
            yield from screen.drawn(seen)
            part = seen[-1][0]
            ours = np.any(np.abs(part - part[0, 0]) > 1e-3, axis=-1)  # Blender leaves the rest in one colour
            assert np.abs(part - whole)[ours].max() < 1e-3
            columns = np.nonzero(ours.any(axis=0))[0]
            height, width = ours.shape
            if view == "PERSP":
                low, high = 0.4, 0.6
            else:
                half = 0.25 * camera_frame(width, height)[0] / width
                low, high = 0.5 - half, 0.5 + half
            print(f"  {view}: columns {columns.min() / width:.3f} to {columns.max() / width:.3f}")
            assert abs(columns.min() / width - low) < 0.01 and abs(columns.max() / width - high) < 0.01, (low, high)
    render.use_border = space.use_render_border = False


def camera_frame(width: int, height: int) -> np.ndarray:
    """The size in pixels at which the camera's frame is seen."""
    scene_camera = bpy.context.scene.camera
    corners = np.array([(*corner, 1.0) for corner in scene_camera.data.view_frame(scene=bpy.context.scene)])
    seen = corners @ np.array(scene_camera.matrix_world).T @ screen.view_matrix().T
    places = seen[:, :2] / seen[:, 3:] * 0.5
    return np.asarray(np.ptp(places, axis=0) * (width, height))


def test_overlay_follows_view_and_time_and_reads_the_scene_only_when_it_changes() -> Iterator[float | None]:
    space, _smoke = plume("SOLID")
    view = space.region_3d
    with screen.watched() as seen, counted_exports() as exports:
        view.view_perspective = "PERSP"
        view.view_distance, view.view_location = 9.0, (0.5, 0.0, 1.2)
        yield from screen.drawn(seen)
        first, read_first = seen[-1][0], exports[0]
        assert read_first >= 1
        yield from screen.drawn(seen)
        assert np.array_equal(seen[-1][0], first)
        view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.4) @ view.view_rotation
        yield from screen.drawn(seen)
        assert np.abs(seen[-1][0] - first).max() > 0.1, "the smoke must move with the view"
        view.view_perspective = "ORTHO"
        yield from screen.drawn(seen)
        bpy.data.objects["Ball"].select_set(True)
        yield from screen.drawn(seen)
        assert exports[0] == read_first, "neither a view nor a selection changes the smoke"
        still = seen[-1][0]
        bpy.context.scene.frame_set(12)
        yield from screen.drawn(seen)
        assert exports[0] == read_first + 1
        if not harness.MANTAFLOW_ABORTS:  # else it is a still
            assert np.abs(seen[-1][0] - still).max() > 0.1, "the smoke must move with time"
        bpy.data.objects["Sun"].data.energy *= 2.0
        yield from screen.drawn(seen)
        assert exports[0] == read_first + 2
    assert not log.notices(), log.notices()


def test_a_failure_is_said_once_and_blender_goes_on_drawing() -> Iterator[float | None]:
    plume("SOLID")
    original, calls = scene.export, []

    def export(*arguments: Any) -> scene.Export:
        calls.append(arguments)
        raise ValueError("a test broke the scene")

    with screen.watched() as seen:
        yield from screen.drawn(seen)
        good = seen[-1][0]
        scene.export = export
        try:
            bpy.data.objects["Sun"].data.energy *= 2.0
            for _ in range(3):
                yield from screen.drawn(seen)
            assert len(calls) == 1, f"{len(calls)} attempts at one broken scene"
            assert any("a test broke the scene" in line for line in log.notices()), log.notices()
        finally:
            scene.export = original
        bpy.data.objects["Sun"].data.energy /= 2.0
        yield from screen.drawn(seen)
        assert np.array_equal(seen[-1][0], good)
    assert not log.notices(), log.notices()


def test_what_a_view_leaves_out_is_left_out() -> Iterator[float | None]:
    """In local view, and by types of objects: then the overlay adds nothing to what Blender draws of the rest."""
    space, smoke = plume("SOLID")
    window, area, region = screen.viewport()

    def hidden_type() -> None:
        name = f"show_object_viewport_{smoke.type.lower()}"
        setattr(space, name, not getattr(space, name))

    def local_view() -> None:
        bpy.ops.object.select_all(action="DESELECT")
        bpy.data.objects["Ball"].select_set(True)
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.view3d.localview(frame_selected=False)

    with screen.watched() as seen:
        yield from screen.drawn(seen)
        whole = seen[-1][0]
        for switch in (hidden_type, local_view):
            switch()
            yield from screen.drawn(seen)
            without = seen[-1][0]
            bpy.context.scene.sfumato.viewport_enabled = False
            yield from screen.drawn(seen)
            assert np.array_equal(seen[-1][0], without)
            bpy.context.scene.sfumato.viewport_enabled = True
            switch()
            yield from screen.drawn(seen)
            assert np.abs(seen[-1][0] - whole).max() < 1e-3


def test_undo_and_another_file() -> Iterator[float | None]:
    plume("SOLID")
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        sun = bpy.data.objects["Sun"].data
        bpy.ops.ed.undo_push(message="before")
        bright = seen[-1][0]
        sun.energy *= 0.25
        bpy.ops.ed.undo_push(message="dim")
        yield from screen.drawn(seen)
        assert np.abs(seen[-1][0] - bright).max() > 0.1
        bpy.ops.ed.undo()
        yield from screen.drawn(seen)
        assert np.abs(seen[-1][0] - bright).max() < 1e-3, "undo must bring the light back"
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        yield from screen.drawn(seen)
    assert not [line for line in log.notices() if "cannot be drawn" in line], log.notices()


def test_enable_and_disable_may_be_repeated() -> Iterator[float | None]:
    plume("SOLID")
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        good = seen[-1][0]
        overlay.disable()
        overlay.disable()
        yield from screen.drawn(seen)
        bare = seen[-1][0]
        assert np.abs(good - bare).max() > 0.1
    overlay.enable()
    overlay.enable()
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        assert np.array_equal(seen[-1][0], good), "drawn twice?"


def test_every_view_of_a_quad_view_has_its_smoke() -> Iterator[float | None]:
    plume("SOLID")
    window, area, region = screen.viewport()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.region_quadview()
    try:
        with screen.watched() as seen:
            yield from screen.drawn(seen, 4)  # Blender may still be dividing the view
            bpy.context.scene.sfumato.viewport_enabled = False
            yield from screen.drawn(seen, 4)
            without = seen[-4:]
            bpy.context.scene.sfumato.viewport_enabled = True
            yield from screen.drawn(seen, 4)
            for before, after in zip(without, seen[-4:]):
                assert np.abs(after[0] - before[0]).max() > 0.05
    finally:
        window, area, region = screen.viewport()
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.screen.region_quadview()
        yield None


def test_two_windows() -> Iterator[float | None]:
    plume("SOLID")
    window, area, region = screen.viewport()
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.wm.window_new()
    second = bpy.context.window_manager.windows[-1]
    try:
        with screen.watched() as seen:
            for enabled in (False, True):
                bpy.context.scene.sfumato.viewport_enabled = enabled
                yield from screen.drawn(seen, 4)
                shapes = {picture.shape for picture, _ in seen[-2:]}
                if not enabled:
                    without = {picture.shape: picture for picture, _ in seen[-2:]}
            assert len(shapes) == 2, f"two windows of different sizes, drawn in turn: {shapes}"
            for picture, _ in seen[-2:]:
                assert np.abs(picture - without[picture.shape]).max() > 0.1
    finally:
        with bpy.context.temp_override(window=second):
            bpy.ops.wm.window_close()
        yield None
    assert not log.notices(), log.notices()


def test_rendered_view_is_scene_linear() -> Iterator[float | None]:
    """Before Blender's view transform, the Rendered view holds the radiance that the CPU computes."""
    space, _smoke = plume("RENDERED")
    bpy.context.scene.render.engine = "SFUMATO"
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        shown = seen[-1][0]
    quality = props.QUALITIES[bpy.context.scene.sfumato.quality]
    frame = sfumato.Frame(scene.export(bpy.context.evaluated_depsgraph_get()).scene, **quality.frame)
    height, width = shown.shape[:2]
    cpu = frame.render(sfumato.Camera(screen.view_matrix()), width, height, edge_samples=quality.edge_samples)
    assert space.shading.type == "RENDERED" and cpu[..., 0].max() > 0.2
    assert_same("plume", shown[..., :3], cpu[..., :3])
    assert (shown[..., 3] == 1.0).all()
    assert not log.notices(), log.notices()


def test_rendered_view_holds_out_and_catches_before_a_transparent_film() -> Iterator[float | None]:
    """Where surfaces have an alpha of their own, the processor makes the whole picture."""
    _space, _smoke = plume("RENDERED")
    settings = bpy.context.scene
    settings.render.engine, settings.render.film_transparent = "SFUMATO", True
    settings.objects["Ball"].is_holdout = True
    settings.objects["Floor"].is_shadow_catcher = True
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        shown = seen[-1][0]
    quality = props.QUALITIES[settings.sfumato.quality]
    frame = sfumato.Frame(scene.export(bpy.context.evaluated_depsgraph_get()).scene, **quality.frame)
    height, width = shown.shape[:2]
    cpu = frame.render(sfumato.Camera(screen.view_matrix()), width, height, edge_samples=quality.edge_samples)
    partly = (cpu[..., 3] > 0.1) & (cpu[..., 3] < 0.9)
    assert not frame.opaque and partly.sum() > 100 and (cpu[..., 3] == 0.0).any()
    assert_same("plume on a plate", shown, cpu)


def test_rendered_view_has_what_lies_behind_a_transparent_ball() -> Iterator[float | None]:
    """Sheets lie between smoke and smoke, so here, too, the processor makes the whole picture."""
    _space, _smoke = plume("RENDERED")
    settings = bpy.context.scene
    settings.render.engine = "SFUMATO"
    ball = settings.objects["Ball"].data
    ball.materials.clear()
    harness.shade(ball, "ShaderNodeBsdfPrincipled").inputs["Alpha"].default_value = 0.4
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        shown = seen[-1][0]
    quality = props.QUALITIES[settings.sfumato.quality]
    frame = sfumato.Frame(scene.export(bpy.context.evaluated_depsgraph_get()).scene, **quality.frame)
    height, width = shown.shape[:2]
    cpu = frame.render(sfumato.Camera(screen.view_matrix()), width, height, edge_samples=quality.edge_samples)
    assert not frame.opaque and "sheets" in frame.stages, frame.stages
    assert_same("plume and a transparent ball", shown, cpu)


harness.main()
