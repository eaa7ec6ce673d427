# SPDX-License-Identifier: GPL-3.0-or-later
"""A view whose camera moves: close to what it shows at rest, and made of what is there already."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import gpu
import harness
import numpy as np
import screen
import sfumato
from mathutils import Quaternion
from numpy.typing import NDArray
from sfumato import log, props  # type: ignore[attr-defined]
from sfumato.export import scene
from sfumato.view import pace, painter, refinement

SIZE = (640, 360)
KINDS: list[dict[str, bool]] = [{}, {"overlay": True}, {"overlay": True, "solids_shade": True}]
# Of the picture's mean, and of its 99th percentile.
RMSE, PERCENTILE = 0.01, 0.04


def plume_frame() -> tuple[Any, int, NDArray[np.float64]]:
    """The sample at frame 25, how finely F12 samples it, and its camera."""
    harness.open_plume(25)
    settings = bpy.context.scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = settings.camera
    projection = camera.calc_matrix_camera(depsgraph, x=SIZE[0], y=SIZE[1])
    matrix = np.array(projection) @ np.array(camera.matrix_world.normalized().inverted())
    quality = props.QUALITIES[settings.sfumato.quality]
    return sfumato.Frame(scene.export(depsgraph).scene, **quality.frame), quality.edge_samples, matrix


def look(matrix: NDArray[np.float64], angle: float = 0.0, **kind: bool) -> painter.Look:
    """Of a camera that has gone round the smoke by so many radians."""
    turn = np.eye(4)
    turn[:3, :3] = np.array(Quaternion((0.0, 0.0, 1.0), angle).to_matrix())
    return painter.Look(tuple((matrix @ turn).ravel()), SIZE, **kind)


def pixels(made: Any) -> list[NDArray[np.float32]]:
    """What a picture's textures hold, of radiance and of transmittance."""
    textures = [held for held in (made.radiance, made.transmittance) if held is not None]
    return [screen.read(gpu.types.GPUFrameBuffer(color_slots=[held]), 0, SIZE)[..., :3] for held in textures]


def paced(artist: painter.Painter, view: str, spacing: int) -> None:
    """Make a view as coarse as a slow machine's, or as a fast one's."""
    kept = artist._views[view].pace
    kept.spacing = spacing
    kept.moved = lambda _now: spacing


def test_a_moving_view_is_close_to_one_at_rest() -> None:
    frame, edge_samples, matrix = plume_frame()
    for software in (True, False):
        for spacing in (pace.HALF, pace.QUARTER):
            for kind in KINDS:
                artist = painter.Painter()
                artist.software = software
                artist.picture("view", frame, look(matrix, -0.002, **kind))
                paced(artist, "view", spacing)
                seen = look(matrix, **kind)
                moving = pixels(artist.picture("view", frame, seen))
                fine = frame.surfaces(seen.camera(), *SIZE, seen.output, edge_samples)
                resting = pixels(artist.picture("view", frame, seen, fine))
                for name, there, here in zip(("radiance", "transmittance"), resting, moving):
                    error = np.abs(here - there)
                    # Of smoke's own radiance little is seen: what counts is the picture it is added to.
                    scale = there if not kind else resting[1] * 0.5 + resting[0]
                    rmse = float(np.sqrt(np.mean(error**2)) / scale.mean())
                    high = float(np.quantile(error.max(-1), 0.99) / np.quantile(scale, 0.99))
                    where = "processor" if software else "GPU"
                    print(f"  {where}, spacing {spacing}, {kind or 'rendered'}, {name}: RMSE {rmse:.2%}, "
                          f"99th percentile {high:.2%}")  # fmt: skip
                    assert 0.0 < rmse <= RMSE and high <= PERCENTILE


def test_most_pixels_are_not_traced() -> None:
    """Between pixels that are traced lies the middle: for floats, not what tracing gives."""
    frame, _edge_samples, matrix = plume_frame()
    camera = look(matrix).camera()
    floor = frame.surfaces(camera, *SIZE)[..., 3] < 100.0
    for output in ("radiance", "all_shadows"):
        full, coarse = frame.surfaces(camera, *SIZE, output), frame.glance(camera, *SIZE, output, pace.QUARTER)
        traced = (full[..., 3] == coarse[..., 3])[floor].mean()
        print(f"  {output}: {traced:.1%} of the distances are traced")
        assert 0.05 < traced < 0.35


@contextmanager
def counted_makings() -> Iterator[dict[str, int]]:
    """How many of each kind of the GPU's objects are made."""
    counts: dict[str, int] = {}
    originals = {name: getattr(gpu.types, name) for name in ("GPUTexture", "GPUFrameBuffer", "GPUUniformBuf")}
    shader = gpu.shader.create_from_info

    def counting(name: str, original: Any) -> Any:
        def make(*args: Any, **settings: Any) -> Any:
            counts[name] = counts.get(name, 0) + 1
            return original(*args, **settings)

        return make

    for name, original in originals.items():
        setattr(gpu.types, name, counting(name, original))
    gpu.shader.create_from_info = counting("shader", shader)
    try:
        yield counts
    finally:
        for name, original in originals.items():
            setattr(gpu.types, name, original)
        gpu.shader.create_from_info = shader


def test_nothing_but_the_surfaces_is_made_anew_while_the_camera_moves() -> None:
    frame, _edge_samples, matrix = plume_frame()
    for software in (True, False):
        for kind in KINDS[:2]:
            artist = painter.Painter()
            artist.software = software
            first = artist.picture("view", frame, look(matrix, **kind))
            with counted_makings() as made:
                for step in range(1, 6):
                    artist.picture("view", frame, look(matrix, 0.01 * step, **kind))
                uploads = 2 if software and kind else 1
                assert made == {"GPUTexture": 5 * uploads}, made
                made.clear()
                again = artist.picture("view", frame, look(matrix, 0.05, **kind))
                assert not made and again.look == look(matrix, 0.05, **kind), "the same look is kept"
                fine = frame.surfaces(again.look.camera(), *SIZE, again.look.output, 2)
                resting = artist.picture("view", frame, again.look, fine)
                assert made == {"GPUTexture": 1} and resting.buffer is first.buffer, made


def test_a_pace_is_kept_until_redraws_agree() -> None:
    kept = pace.Pace()
    now = 0.0

    def redraws(count: int, gap: float) -> int:
        nonlocal now
        for _ in range(count):
            now += gap
            spacing = kept.moved(now)
        return spacing

    assert redraws(4, 0.1) == pace.HALF, "three gaps are not enough"
    assert redraws(1, 0.1) == pace.QUARTER
    assert redraws(20, 0.025) == pace.QUARTER, "between the two it stays as it is"
    assert redraws(20, 0.01) == pace.HALF
    assert redraws(20, 0.025) == pace.HALF
    for _ in range(10):
        assert redraws(1, 0.5) == redraws(1, 0.01) == pace.HALF, "a mouse that halts is no slow machine"
    assert redraws(10, 2.0) == pace.HALF


def test_a_slow_view_never_traces_a_whole_picture_while_it_moves() -> Iterator[float | None]:
    harness.open_plume(25)
    bpy.context.scene.render.engine = "SFUMATO"
    for shading in ("RENDERED", "SOLID"):
        space = screen.prepare(shading)
        view = space.region_3d
        view.view_perspective = "PERSP"
        slow = pace.SLOW
        rest, refinement.REST = refinement.REST, 1e9
        spacings: list[int] = []
        original = painter.Painter._make_picture

        def make(self: Any, view: Any, frame: Any, look: Any, refined: Any, spacing: int) -> Any:
            spacings.append(spacing)
            return original(self, view, frame, look, refined, spacing)

        try:
            with screen.watched() as seen:
                while len(seen) < 3:
                    yield None
                painter.Painter._make_picture = make
                pace.SLOW = 0.0
                for _ in range(8):
                    view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.01) @ view.view_rotation
                    before = len(seen)
                    while len(seen) < before + 1:
                        yield None
                moving = seen[-1][0]
                refinement.REST = rest
                # Another look, that of the last redraw and a little more, is asked for, and then left alone.
                view.view_rotation = Quaternion((0.0, 0.0, 1.0), 1e-5) @ view.view_rotation
                yield from screen.drawn(seen)
                resting = seen[-1][0]
        finally:
            painter.Painter._make_picture = original
            refinement.REST, pace.SLOW = rest, slow
        print(f"  {shading}: {spacings}")
        assert len(spacings) >= 9 and min(spacings[:8]) >= pace.HALF and pace.QUARTER in spacings[:8]
        assert spacings[-1] == 1, "and at rest, all of it"
        difference = np.abs(moving - resting)[..., :3]
        rmse = float(np.sqrt(np.mean(difference**2)) / np.quantile(resting[..., :3], 0.99))
        print(f"  RMSE {rmse:.2%} of the 99th percentile")
        assert 0.0 < rmse < 0.03
    assert not log.notices(), log.notices()


harness.main()
