# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen through, drawn by the GPU while a view moves: what the module composites of the same fragments, near to
what the processor sorts, and back to the processor wherever that cannot be."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest import mock

import bpy
import gpu
import harness
import numpy as np
import screen
import sfumato
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray
from sfumato import log, props  # type: ignore[attr-defined]
from sfumato.gpu import shader as gpu_shader, smoke as gpu_smoke
from sfumato.gpu.drawn import view_matrix
from sfumato.gpu.fragments import Fragments, Sprites, Triangles
from sfumato.gpu.light_maps import LightMaps
from sfumato.gpu.transparency import View
from sfumato.view import painter, sorting
from sprites import expected_fragments, rays, rmse

SIZE = (96, 64)
TOLERANCE = 1e-3
METHODS: dict[str, Callable[..., Any]] = {
    "NEAREST": sfumato.composite_nearest,
    "WEIGHTED": sfumato.composite_weighted,
    "FOURIER": sfumato.composite_fourier,
}
KINDS = ("particles", "hair", "sheets")


def frame_of(*kinds: str, seed: int = 3, suns: int = 2, smoke: bool = False, angle: float = 0.0) -> Any:
    """A floor and a pillar in two suns, and before and in them what is asked for."""
    random = np.random.default_rng(seed)
    made = sfumato.Scene()
    floor: Any = [(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)]
    pillar: Any = [(0.3, 0, 0), (0.7, 0, 0), (0.7, 0, 2), (0.3, 0, 2)]
    for corners, normal in ((floor, (0, 0, 1)), (pillar, (0, -1, 0))):
        made.add_mesh(corners, [(0, 1, 2), (0, 2, 3)], [[normal] * 3] * 2, [0, 0], [(0.7, 0.6, 0.5)])
    made.set_background((0.3, 0.4, 0.6), alpha=1.0)
    for direction in ((0.5, 0.3, -1.0), (-0.6, 0.5, -1.0))[:suns]:
        made.add_sun(direction, (4.0, 3.5, 3.0), angle=angle)
    if "particles" in kinds:
        points = random.normal(size=(120, 3)) * (0.5, 0.5, 0.4) + (0.0, 0.0, 1.2)
        made.add_particles(
            points, random.uniform(0.15, 0.4, 120), random.uniform(0.02, 0.4, 120), albedo=(0.9, 0.8, 0.7)
        )
    if "hair" in kinds:
        roots = random.uniform(-1.0, 1.0, (30, 3)) * (1.0, 0.6, 0.0)
        points = np.stack((roots, roots + (0.0, 0.0, 0.8), roots + (0.2, 0.0, 1.5)), axis=1)
        first = np.arange(0, 3 * len(roots) + 1, 3)
        made.add_strands(points.reshape(-1, 3), np.full(3 * len(roots), 0.02), first)
    if "sheets" in kinds:
        pane: Any = [(-1.2, -0.8, 0.1), (1.0, -0.5, 0.1), (1.0, -0.5, 1.8), (-1.2, -0.8, 1.8)]
        glass = sfumato.Mesh(pane, [[0, 1, 2], [0, 2, 3]])
        made.add_instances(glass, np.eye(4), albedo=[[0.1, 0.25, 0.3]], transmittance=[[0.5, 0.5, 0.5]])
        made.add_instances(glass, np.array(Matrix.Rotation(0.5, 4, "Z")), albedo=[[0.3, 0.1, 0.1]],
                           transmittance=[[0.6, 0.6, 0.6]])  # fmt: skip
    if smoke:
        made.add_medium(np.ones((4, 4, 4)), np.eye(4), (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
    return sfumato.Frame(made)


def look(way: str = "NEAREST", perspective: bool = True, turn: float = 0.0, **kind: bool) -> painter.Look:
    near, far = 0.1, 40.0
    if perspective:
        projection = Matrix(((1.6, 0, 0, 0), (0, 2.4, 0, 0),
                             (0, 0, (far + near) / (near - far), 2 * far * near / (near - far)), (0, 0, -1, 0)))  # fmt: skip
    else:
        projection = Matrix.Diagonal((0.4, 0.6, 2.0 / (near - far), 1.0))
        projection[2][3] = (far + near) / (near - far)
    eye = Matrix.Rotation(turn, 4, "Z") @ Matrix.Translation((0.4, -4.5, 2.4)) @ Matrix.Rotation(1.25, 4, "X")
    values = tuple(value for row in projection @ eye.inverted() for value in row)
    return painter.Look(values, SIZE, sorting=way, **kind)


def shown(frame: Any, seen: painter.Look, artist: painter.Painter | None = None) -> NDArray[np.float64]:
    """What the GPU draws: (pixels, 3)."""
    artist = artist or painter.Painter()
    picture = artist.picture("test", frame, seen)
    assert picture.buffer is not None, f"drawn by {artist.sorted_by}"
    return screen.read(picture.buffer, 0, SIZE).reshape(-1, 4)[:, :3].astype(np.float64)


def surfaces(frame: Any, seen: painter.Look) -> tuple[NDArray[np.float64], View, NDArray[np.float64]]:
    """The colours of what is opaque, the view, and the distances along it."""
    matrix = np.reshape(seen.matrix, (4, 4))
    from_world = view_matrix(matrix)
    view = View(from_world, matrix @ np.linalg.inv(from_world), SIZE)
    traced = frame.surfaces(seen.camera(), *SIZE, output="opaque").reshape(-1, 4).astype(np.float64)
    origin, along = rays(view)
    near = -np.linalg.inv(np.asarray(view.projection)) @ (0.0, 0.0, -1.0, 1.0)
    start = near[2] / -near[3]
    return traced[:, :3], view, start + traced[:, 3] / np.linalg.norm(along, axis=1)


def cover(strip: NDArray[np.float64]) -> NDArray[np.float64]:
    """The share of Blackman and Harris's filter (1978), 3 pixels wide, that lies on a strip (distance, half its width)."""
    edges = np.clip(0.5 + (strip[:, :1] + strip[:, 1:] * (-1.0, 1.0)) / 3.0, 0.0, 1.0)
    sums = edges.copy()
    for k, a in ((1, -0.48829), (2, 0.14128), (3, -0.01168)):
        sums += a / 0.35875 * np.sin(2.0 * np.pi * k * edges) / (2.0 * np.pi * k)
    return np.where(strip[:, 1] > 0.0, sums[:, 1] - sums[:, 0], 1.0)


def met(view: View, triangles: Triangles, solids: Any) -> tuple[Any, Any, Any]:
    """Where each pixel's ray meets each triangle: distance, alpha (0 beside it), and colour, in double precision."""
    origin, along = rays(view)
    turn = np.asarray(view.from_world)
    distances, alphas, colours = [], [], []
    parts = triangles.corners, triangles.alpha, triangles.colour, triangles.strip
    for corners, alpha, colour, strip in zip(*map(np.asarray, parts)):
        a, b, c = corners.astype(np.float64) @ turn[:3, :3].T + turn[:3, 3]
        normal = np.cross(b - a, c - a)
        facing = along @ normal
        distance = ((a - origin) @ normal) / np.where(facing == 0.0, 1e-30, facing)
        point = origin + along * distance[:, None]
        size = max(normal @ normal, 1e-300)
        u, v = (np.cross(point - a, c - a) @ normal) / size, (np.cross(b - a, point - a) @ normal) / size
        inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance < solids)
        distances.append(distance)

        def between(values: Any, u: Any = u[:, None], v: Any = v[:, None]) -> Any:
            return values[0] + u * (values[1] - values[0]) + v * (values[2] - values[0])

        alphas.append(np.where(inside, alpha * cover(between(strip)), 0.0))
        colours.append(between(colour))
    return np.stack(distances, 1), np.stack(alphas, 1), np.stack(colours, 1)


def composited(frame: Any, seen: painter.Look) -> NDArray[np.float64]:
    """The same picture, of the same fragments, by the module."""
    behind, view, solids = surfaces(frame, seen)
    sprites = Sprites(*frame.sprites(seen.camera()))
    parts = frame.triangles(seen.camera(), *SIZE)
    triangles = Triangles(*parts) if len(parts[0]) else None
    all_of_it = Fragments(sprites, triangles)
    low, high = all_of_it.depths(view.from_world)
    there: Any = list(expected_fragments(all_of_it, view, sprites, None, solids)) if len(all_of_it.points) else None
    if triangles is not None:
        distance, *rest = met(view, triangles, solids)
        of_triangles = [np.clip((distance - low) / (high - low), 0.0, 1.0), *rest]
        there = of_triangles if there is None else [np.concatenate(both, 1) for both in zip(there, of_triangles)]
    made = METHODS[seen.sorting](*there)
    return np.asarray(made[:, :3] + (1.0 - made[:, 3:]) * behind)


def test_it_is_what_the_module_composites() -> None:
    for kinds, ways in (
        (("particles",), METHODS),
        (("sheets",), METHODS),
        (("hair",), ["NEAREST"]),
        (KINDS, ["NEAREST"]),
    ):
        frame = frame_of(*kinds)
        assert frame.drawable and frame.sorted
        for way, perspective in ((way, way != "WEIGHTED") for way in ways):
            seen = look(way, perspective)
            error = rmse(shown(frame, seen), composited(frame, seen))
            print(f"  {' and '.join(kinds)}, {way}, {'perspective' if perspective else 'orthographic'}: {error:.1e}")
            assert error <= TOLERANCE


def test_it_is_near_to_what_the_processor_sorts() -> None:
    """Of the mean, and nearer than weights and a series alone."""
    for kinds, limit in ((("particles",), 0.02), (("sheets",), 0.02), (("hair",), 0.02), (KINDS, 0.02)):
        frame = frame_of(*kinds)
        exact = frame.render(look().camera(), *SIZE, edge_samples=1).reshape(-1, 4)[:, :3]
        error = {way: rmse(shown(frame, look(way)), exact) / exact.mean() for way in METHODS}
        print(f"  {' and '.join(kinds)}: " + ", ".join(f"{way} {value:.2%}" for way, value in error.items()))
        assert error["NEAREST"] <= limit and error["NEAREST"] <= min(error.values()) * 1.02


def test_an_overlay_shows_particles_alone() -> None:
    """All else is in Blender's own picture. What is left of that, and what is added, are the processor's."""
    for solids_shade in (False, True):
        frame = frame_of("particles")
        seen = look(overlay=True, solids_shade=solids_shade)
        artist = painter.Painter()
        picture = artist.picture("test", frame, seen)
        made = [screen.read(picture.buffer, slot, SIZE) for slot in (0, 1)]
        there = frame.glance(seen.camera(), *SIZE, seen.output, 1, gpu_smoke.SHADOW_STRENGTH)
        assert np.array_equal(made[1][..., 3], there[1][..., 3]), "what is a surface and what is background"
        error = [rmse(one[..., :3], other[..., :3]) for one, other in zip(made, there)]
        print(f"  radiance {error[0]:.1e}, transmittance {error[1]:.1e}")
        assert max(error) <= 0.02 and there[0].max() > 0.1 and there[1][..., :3].min() < 0.7
        hairy = painter.Painter().picture("test", frame_of("particles", "hair"), look(overlay=True))
        bare = painter.Painter().picture("test", frame, look(overlay=True))
        with_hair, without = (screen.read(each.buffer, 0, SIZE)[..., 3] for each in (hairy, bare))
        assert np.array_equal(with_hair, without)


def test_order_does_not_matter() -> None:
    def made(order: Any) -> NDArray[np.float64]:
        random, scene = np.random.default_rng(9), sfumato.Scene()
        parts = (
            random.normal(size=(200, 3)) * 0.5 + (0, 0, 1.2),
            random.uniform(0.1, 0.4, 200),
            random.uniform(0, 0.5, 200),
        )
        scene.add_particles(*(part[order] for part in parts))
        scene.add_sun((0.4, 0.2, -1.0), (9.0, 9.0, 9.0))
        return shown(sfumato.Frame(scene), look())

    turned = np.random.default_rng(2).permutation(200)
    error = rmse(made(slice(None)), made(turned))
    print(f"  {error:.1e}")
    assert error <= 1e-5


def test_particles_back_to_front_in_the_light_of_their_map() -> None:
    """As published, 7 coefficients in half floats: where one sun is all there is the GPU's own map shades them, and that
    comes near to the module's. With more than particles, the nearest layers are drawn instead."""
    artist = painter.Painter()
    frame = frame_of("particles", suns=1)
    with mock.patch.object(LightMaps, "splat", autospec=True, side_effect=LightMaps.splat) as splat:
        published = shown(frame, look("SORTED"), artist)
        shown(frame, look("SORTED", turn=0.1), artist)
        assert splat.call_count == 1, "one map serves all views of a frame"
        assert splat.call_args.kwargs["half"] and splat.call_args.args[6] == 7
        exact = frame.render(look().camera(), *SIZE, edge_samples=1).reshape(-1, 4)[:, :3]
        print(f"  {rmse(published, exact) / exact.mean():.2%} of the mean from the processor's")
        assert rmse(published, exact) <= 0.02 * exact.mean()
        assert "back to front" in artist.sorted_by
        wide = frame_of("particles", suns=1, angle=0.6)
        exact = wide.render(look().camera(), *SIZE, edge_samples=1).reshape(-1, 4)[:, :3]
        soft = rmse(shown(wide, look("SORTED")), exact)
        with mock.patch.object(LightMaps, "soften", lambda _self, light_map, *_rest: light_map):
            hard = rmse(shown(wide, look("SORTED")), exact)
        print(f"  of a wide sun {soft / exact.mean():.3%}, with a map that is not softened {hard / exact.mean():.3%}")
        assert soft < hard and soft <= 0.02 * exact.mean()
        splat.reset_mock()
        shown(frame_of("particles"), look("SORTED"), artist)  # two suns
        shown(frame_of("particles", "sheets", suns=1), look("SORTED"), artist)
    assert not splat.called and "nearest layers" in artist.sorted_by and "more than particles" in artist.sorted_by


def test_the_processor_does_it_where_it_must() -> None:
    artist = painter.Painter()
    plain = frame_of("particles")
    stained = sfumato.Scene()
    stained.add_particles([[0, 0, 1]], 0.5, 0.5, extinction=(1.0, 0.5, 0.2))
    for frame, way, software, reason in (
        (plain, "PROCESSOR", False, "as chosen"),
        (plain, "AUTO", True, "no graphics card"),
        (frame_of("particles", smoke=True), "NEAREST", False, "smoke of grids"),
        (sfumato.Frame(stained), "NEAREST", False, "colored glass"),
    ):
        artist.software = software
        picture = artist.picture("test", frame, look(way))
        assert picture.buffer is None and reason in artist.sorted_by, (artist.sorted_by, reason)
    artist.software = False
    shown(plain, look("AUTO"), artist)
    assert artist.sorted_by == "the graphics card, nearest layers"
    with mock.patch.object(sorting, "MANY", 100):
        shown(plain, look("AUTO", turn=0.01), artist)
    assert "weighted" in artist.sorted_by and "120" in artist.sorted_by


def test_a_shader_that_does_not_compile_leaves_it_to_the_processor() -> None:
    """And says so once; the next picture asks no compiler."""
    frame, artist, tried = frame_of("particles"), painter.Painter(), []

    def broken(name: str, *_args: Any, **_named: Any) -> Any:
        tried.append(name)
        raise gpu_shader.ShaderError("shaders/viewport/peel_fragment.glsl (peel): a test broke it")

    with mock.patch("sfumato.gpu.transparency.compile_shader", broken):
        pictures = [artist.picture("test", frame, look(turn=turn)) for turn in (0.0, 0.1)]
    assert [picture.buffer for picture in pictures] == [None, None] and tried == ["peel"]
    assert "did not compile" in artist.sorted_by
    said = [line for line in log.notices("sorting") if "peel" in line]
    assert len(said) == 1, log.notices()
    shown(frame, look(), painter.Painter())
    assert not log.notices("sorting")


def test_state_comes_back() -> None:
    state, before = gpu.state, (gpu.state.blend_get(), gpu.state.depth_test_get(), gpu.state.depth_mask_get())
    try:
        state.blend_set("MULTIPLY")
        state.depth_test_set("GREATER")
        state.depth_mask_set(True)
        target = state.active_framebuffer_get()
        one = shown(frame_of(*KINDS), look())
        assert (state.blend_get(), state.depth_test_get(), state.depth_mask_get()) == ("MULTIPLY", "GREATER", True)
        assert state.active_framebuffer_get() == target
    finally:
        state.blend_set(before[0])
        state.depth_test_set(before[1])
        state.depth_mask_set(before[2])
    assert np.array_equal(one, shown(frame_of(*KINDS), look())), "nor does what was set reach the picture"


@contextmanager
def alive() -> Iterator[Any]:
    """A function that counts the GPU's objects that were made within the block and are still held by anybody."""
    made: list[Any] = []
    names = ("GPUTexture", "GPUFrameBuffer", "GPUUniformBuf", "GPUVertBuf", "GPUIndexBuf", "GPUBatch")
    originals = {name: getattr(gpu.types, name) for name in names}

    def keeping(original: Any) -> Any:
        def make(*args: Any, **named: Any) -> Any:
            made.append(original(*args, **named))
            return made[-1]

        return make

    def count() -> int:
        gc.collect()
        before = len(made) + 1
        while len(made) < before:  # what only others in the list held goes with them
            before = len(made)
            made[:] = [each for each in made if sys.getrefcount(each) > 3]  # the list's, the loop's, the argument's
        return before

    try:
        for name, original in originals.items():
            setattr(gpu.types, name, keeping(original))
        yield count
    finally:
        for name, original in originals.items():
            setattr(gpu.types, name, original)


def test_fifty_edits_leave_as_many_objects_as_one() -> None:
    artist = painter.Painter()
    with alive() as count:
        counts = []
        for edit in range(50):
            frame = frame_of("particles", "sheets", seed=edit, suns=1)
            artist.picture(
                "test", frame, look(("NEAREST", "WEIGHTED", "FOURIER", "SORTED")[edit % 4], turn=0.01 * edit)
            )
            if edit % 4 == 3:
                counts.append(count())
        print(f"  {counts}")
        # The first round makes what is kept for good.
        assert counts[1] > 0 and len(set(counts[1:])) == 1
        del artist, frame
        left = count()
        print(f"  and {left} without it")
        assert left == 0, "with the painter they go"


def test_views_show_it_while_they_move_and_the_processors_picture_at_rest() -> Iterator[float | None]:
    """And the panel tells which it is."""
    for shading in ("RENDERED", "SOLID", "MATERIAL"):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        harness.enable()
        cube = bpy.data.objects["Cube"]
        cube.scale = (0.5, 0.5, 0.05)
        settings = cube.modifiers.new("Puff", "PARTICLE_SYSTEM").particle_system.settings
        settings.count, settings.frame_end, settings.lifetime, settings.normal_factor = 200, 20, 100, 2.0
        settings.effector_weights.gravity = 0.0
        for frame in range(1, 21):
            bpy.context.scene.frame_set(frame)
        bpy.context.scene.render.engine = "SFUMATO" if shading == "RENDERED" else "BLENDER_EEVEE"
        view = screen.prepare(shading).region_3d
        view.view_perspective, view.view_distance, view.view_location = "PERSP", 7.0, (0.0, 0.0, 1.0)
        view.view_rotation = Quaternion((1.0, 0.0, 0.0), 1.3)
        made: list[Any] = []
        original = painter.Painter._make_picture

        def make(*args: Any, kept: list[Any] = made, original: Any = original) -> Any:
            kept.append(original(*args))
            return kept[-1]

        own = props.of(bpy.context.scene)
        with screen.watched() as seen, mock.patch.object(painter.Painter, "_make_picture", make):
            own.sorting = "NEAREST"
            yield from screen.drawn(seen)
            still = seen[-1][0]
            assert made[-1].refined and made[-1].buffer is None, "at rest the processor's"
            before = len(made)
            view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.2) @ view.view_rotation
            while len(made) == before or not seen:
                yield None
            assert made[before].buffer is not None, "the graphics card's while it moves"
            assert painter.sorted_by() == "the graphics card, nearest layers"
            yield from screen.drawn(seen)
            assert np.abs(seen[-1][0] - still).max() > 0.05
            own.sorting = "PROCESSOR"
            before = len(made)
            bpy.context.scene.update_tag()
            view.view_rotation = Quaternion((0.0, 0.0, 1.0), -0.2) @ view.view_rotation
            while len(made) == before:
                yield None
            assert made[before].buffer is None and "as chosen" in painter.sorted_by()
            yield from screen.refined()
        print(f"  {shading}: {len(made)} pictures")
        assert not log.notices("sorting")


harness.main()
