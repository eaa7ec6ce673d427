# SPDX-License-Identifier: GPL-3.0-or-later
"""Light maps built on the GPU: the coefficients that the module computes, from particles and from a density."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from unittest import mock

import bpy
import gpu
import harness
import numpy as np
import sfumato
from mathutils import Matrix
from sfumato.export import scene
from sfumato.gpu import light_maps, shader as gpu_shader
from sfumato.gpu.light_maps import LightMaps

SIZE = (40, 28)  # texels; neither number is the other's, nor a power of two


def sun_map(metres: tuple[float, float, float]) -> np.ndarray:
    """world_to_map of a slanting sun: a box of `metres` about the origin fills the map."""
    turn = np.array(Matrix.Rotation(0.7, 4, "Z") @ Matrix.Rotation(0.9, 4, "X")).T
    matrix = np.diag((*(1.0 / np.array(metres)), 1.0)) @ turn
    matrix[:3, 3] = 0.5
    return matrix


def some_particles(count: int, world_to_map: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, radii in metres and opacities; a few reach beyond the map on every side."""
    random = np.random.default_rng(5)
    inside = random.uniform(-0.05, 1.05, (count, 3))
    points = (inside - world_to_map[:3, 3]) @ np.linalg.inv(world_to_map[:3, :3]).T
    return points, random.uniform(0.25, 0.6, count), random.uniform(0.0, 0.95, count)


def projected(particles: Any, world_to_map: np.ndarray, texel: tuple[int, int], count: int, thick: bool) -> np.ndarray:
    """The coefficients of one texel (column, row), in double precision but for the module's own sum."""
    points, radius, alpha = particles
    metre = np.linalg.norm(world_to_map[:3, :3], axis=1)
    centre = points @ world_to_map[:3, :3].T + world_to_map[:3, 3]
    place = (np.array(texel) + 0.5) / SIZE
    q2 = (((place - centre[:, :2]) / (radius[:, None] * metre[:2])) ** 2).sum(axis=1)
    tau = -np.log1p(-alpha) * np.maximum(1.0 - q2, 0.0) ** 1.5
    depth = centre[:, 2]
    if not thick:
        kept = (tau > 0.0) & (depth >= 0.0) & (depth <= 1.0)
        return sfumato.project(depth[kept], tau[kept], count)
    reach = np.sqrt(3.0 / 7.0) * radius * metre[2]
    near, far = np.clip(depth - reach, 0.0, 1.0), np.clip(depth + reach, 0.0, 1.0)
    tau *= (far - near) / (2.0 * reach)
    slabs = zip(*(values[tau > 0.0] for values in (0.5 * (near + far), tau, far - near)))
    each = [sfumato.project(np.array([z]), np.array([t]), count, width=float(w)) for z, t, w in slabs]
    return np.sum(each, axis=0)


def refused(expected: str, build: Any, *arguments: Any, **named: Any) -> None:
    """`build` must raise a ValueError with this text."""
    try:
        build(*arguments, **named)
    except ValueError as error:
        assert expected in str(error), f"{error}, but expected {expected}"
    else:
        raise AssertionError(f"no error, but expected: {expected}")


def test_twenty_thousand_thin_layers() -> None:
    """The sum of many small opacities, in any order. Half floats, the paper's, stop growing long before the end."""
    count, alpha, middle = 20000, 2e-4, (2, 2)
    depth = (np.arange(count) + 0.5) / count
    np.random.default_rng(1).shuffle(depth)
    points = np.stack((np.full(count, 0.5), np.full(count, 0.5), depth), axis=1)
    receivers = np.linspace(0.0, 1.0, 21)
    exact = (1.0 - alpha) ** (count * receivers)
    error = {}
    for half in (False, True):
        maps = LightMaps()
        texel = maps.read(maps.splat(points, 10.0, alpha, np.eye(4), (5, 5), 7, thick=False, half=half), 7)[middle]
        error[half] = np.abs(sfumato.transmittance(texel.astype(np.float64), receivers) - exact).max()
    print(f"  error of T {error[False]:.1e}; in half floats {error[True]:.2f}")
    assert error[False] <= 0.005
    assert error[True] > 0.3, "half floats would do: then use them"


def test_splats_are_what_the_module_projects() -> None:
    """For every number of coefficients: those that leave a layer half empty, fill one pass, and need three."""
    world_to_map = sun_map((4.0, 3.0, 5.0))
    particles = some_particles(600, world_to_map)
    maps, random = LightMaps(), np.random.default_rng(3)
    for thick in (False, True):
        texels = [(0, 0), (SIZE[0] - 1, SIZE[1] - 1), *zip(*(random.integers(0, n, 30) for n in SIZE))]
        worst = 0.0
        for count in (1, 3, 5, 7, 23, 31, 63):
            read = maps.read(maps.splat(*particles, world_to_map, SIZE, count, thick=thick), count)
            assert read.shape == (SIZE[1], SIZE[0], count) and read.dtype == np.float32
            for column, row in texels:
                expected = projected(particles, world_to_map, (column, row), count, thick)
                worst = max(worst, np.abs(read[row, column] - expected).max() / expected[0])
        print(f"  {'thick' if thick else 'flat'}: {worst:.1e} of a0")
        assert worst <= 1e-5


def test_order_does_not_matter() -> None:
    world_to_map = sun_map((4.0, 3.0, 5.0))
    points, radius, alpha = some_particles(600, world_to_map)
    maps, turned = LightMaps(), np.random.default_rng(4).permutation(len(points))
    one = maps.read(maps.splat(points, radius, alpha, world_to_map, SIZE, 15), 15)
    other = maps.read(maps.splat(points[turned], radius[turned], alpha[turned], world_to_map, SIZE, 15), 15)
    assert np.abs(one - other).max() <= 1e-5 * one[..., 0].max()


def test_a_puff_weighs_the_same_wherever_it_stands() -> None:
    """Its column's integral over the map is tau (2 pi / 5) radius^2, also where it is smaller than a texel."""
    maps, random = LightMaps(), np.random.default_rng(6)
    for texels in (0.1, 1.0, 2.0, 6.0):  # radius
        weights = []
        for _ in range(20):
            place = (*(0.5 + random.random(2) / SIZE[0]), 0.5)
            read = maps.read(maps.splat([place], texels / SIZE[0], 0.5, np.eye(4), (SIZE[0], SIZE[0]), 1), 1)
            weights.append(0.5 * read.sum(dtype=np.float64) / (np.log(2.0) * 0.4 * np.pi * texels**2))
        print(f"  radius {texels} texels: {min(weights):.3f} to {max(weights):.3f}")
        assert max(np.abs(np.array(weights) - 1.0)) <= 0.04


def test_a_slab_stands_for_a_puff() -> None:
    """Along the light, a thick particle's mean optical depth is within 4 % of what the puff itself would have."""
    radius, depth = 0.3, 0.5
    maps, size = LightMaps(), 128
    mean = maps.read(maps.splat([(0.5, 0.5, depth)], radius, 0.5, np.eye(4), (size, size), 31), 31).sum(
        axis=(0, 1), dtype=np.float64
    )
    receivers = np.linspace(0.0, 1.0, 201)
    share = np.log(sfumato.transmittance(mean / mean[0], receivers)) / np.log(
        sfumato.transmittance(mean / mean[0], [1.0])
    )
    t = np.clip((receivers - depth) / radius, -1.0, 1.0)
    # A slice across a puff at t radii from its middle weighs (1 - t^2)^2.
    exact = 0.5 + 15.0 / 16.0 * (t - 2.0 * t**3 / 3.0 + t**5 / 5.0)
    print(f"  {np.abs(share - exact).max():.3f} of the puff's optical depth")
    assert np.abs(share - exact).max() <= 0.04


def test_an_opaque_giant() -> None:
    """Opacity 1 is taken for 1 - 2^-20; a radius is never too large."""
    maps = LightMaps()
    read = maps.read(maps.splat([(0.5, 0.5, 0.5)], 1e9, 1.0, np.eye(4), SIZE, 1, thick=False), 1)
    assert np.allclose(0.5 * read, 20.0 * np.log(2.0), rtol=1e-3), read


def test_a_softened_map_is_what_the_module_filters() -> None:
    world_to_map = sun_map((4.0, 3.0, 5.0))
    particles, maps = some_particles(600, world_to_map), LightMaps()
    for count, reach in ((1, 3), (7, 0), (7, 5), (15, 16)):
        light_map = maps.splat(*particles, world_to_map, SIZE, count)
        softened = maps.read(maps.soften(light_map, count, reach), count)
        expected = sfumato.filter_map(maps.read(light_map, count), 2 * reach + 1)
        error = np.abs(softened - expected).max() / expected[..., 0].max()
        print(f"  {count} coefficients, {2 * reach + 1} texels: {error:.1e} of the largest a0")
        assert error <= 1e-5
    refused("reach is -1", maps.soften, light_map, 15, -1)


def in_grid(density: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """The density, (z, y, x), at points (..., 3) in cells, interpolated between cell centres; its rim is empty."""
    size = np.array(density.shape[::-1])
    place = np.clip(cell - 0.5, 0.0, size - 1.0)
    low = np.minimum(place.astype(np.int64), size - 2)
    share = place - low
    out = np.zeros(cell.shape[:-1])
    for corner in range(8):
        step = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        x, y, z = np.moveaxis(low + step, -1, 0)
        out += density[z, y, x] * np.where(step == 1, share, 1.0 - share).prod(axis=-1)
    return out


def slices_of(medium: Any, world_to_map: np.ndarray) -> int:
    """Two a cell along the light, as the viewport takes them."""
    along = np.linalg.inv(medium.grid_to_world)[:3, :3] @ np.linalg.inv(world_to_map)[:3, 2]
    return max(1, int(np.ceil(2.0 * np.linalg.norm(along))))


def expected_map(medium: Any, world_to_map: np.ndarray, size: tuple[int, int], count: int) -> np.ndarray:
    """The coefficients of the paper's series over the whole map, by the module's sum over the slices of each ray."""
    slices = slices_of(medium, world_to_map)
    to_world = np.linalg.inv(world_to_map)
    axes = [(np.arange(n) + 0.5) / n for n in (*size, slices)]
    y, x, z = np.meshgrid(axes[1], axes[0], axes[2], indexing="ij")
    world = np.stack((x, y, z), axis=-1) @ to_world[:3, :3].T + to_world[:3, 3]
    to_grid = np.linalg.inv(medium.grid_to_world)
    density = in_grid(medium.density.astype(np.float64), world @ to_grid[:3, :3].T + to_grid[:3, 3])
    tau = density * np.linalg.norm(to_world[:3, 2]) / slices
    return np.asarray(sfumato.project(z, tau, count, width=1.0 / slices))


def marched(frame: Any, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients that the GPU and the CPU compute."""
    medium, light_map = frame.media[0], frame.light_map()
    density = gpu_shader.texture(medium.density.shape[::-1], "R", medium.density)
    bricks = gpu_shader.texture(medium.clearance.shape[::-1], "R", medium.clearance)
    maps = LightMaps()
    size = light_map.coefficients.shape[1], light_map.coefficients.shape[0]
    made = maps.march(density, bricks, medium.grid_to_world, light_map.world_to_light, size, count)
    return maps.read(made, count), expected_map(medium, light_map.world_to_light, size, count)


def box(sun: tuple[float, float, float]) -> Any:
    """Two blocks with clear air between them, in a grid that is flattened and turned."""
    density = np.zeros((20, 30, 36), np.float32)
    density[3:8, 4:12, 5:15], density[12:17, 18:26, 20:33] = 2.0, 0.5
    grid_to_world = np.array(Matrix.Rotation(0.4, 4, "Z") @ Matrix.Diagonal((0.1, 0.1, 0.2, 1.0)), np.float64)
    made = sfumato.Scene()
    made.add_medium(density, grid_to_world, (3.0, 3.0, 3.0), (1.0, 1.0, 1.0))
    made.add_sun(sun, (4.0, 4.0, 4.0))
    return made


def test_march_is_the_march_of_the_cpu() -> None:
    harness.open_plume(25)
    scenes = {"plume": scene.export(bpy.context.evaluated_depsgraph_get()).scene}
    scenes |= {f"box, {name}": box(sun) for name, sun in (("slanting", (0.5, 0.3, -1.0)), ("along x", (1.0, 0.0, 0.0)))}
    for name, made in scenes.items():
        for count in (1, 5, 7, 31, 63):
            gpu_made, expected = marched(sfumato.Frame(made, coefficients=1), count)
            error = np.abs(gpu_made - expected).max() / expected[..., 0].max()
            print(f"  {name}, {count} coefficients: {error:.1e} of the largest a0")
            assert error <= 1e-4
            # A frame that is asked for the paper's maps has them too.
            own = sfumato.Frame(made, coefficients=count, basis="fourier", ranges="shared").light_map().coefficients
            assert np.abs(gpu_made - own).max() <= 1e-4 * own[..., 0].max()


def test_layers_are_those_of_an_uploaded_map() -> None:
    """Every float of every layer, those included that no coefficient fills."""
    frame = sfumato.Frame(box((0.5, 0.3, -1.0)), coefficients=5)
    medium, light_map = frame.media[0], frame.light_map()
    size = light_map.coefficients.shape[1], light_map.coefficients.shape[0]
    expected = expected_map(medium, light_map.world_to_light, size, 5).astype(np.float32)
    layers = light_maps.light_map_layers(expected)
    density = gpu_shader.texture(medium.density.shape[::-1], "R", medium.density)
    bricks = gpu_shader.texture(medium.clearance.shape[::-1], "R", medium.clearance)
    maps = LightMaps()
    made = maps.march(density, bricks, medium.grid_to_world, light_map.world_to_light, size, 5)
    uploaded = gpu_shader.texture(size, "RGBA", layers, layers=len(layers))
    assert (made.width, made.height, made.format) == (uploaded.width, uploaded.height, uploaded.format)
    ours, theirs = (maps.read(texture, 7) for texture in (made, uploaded))
    assert not ours[..., 5:].any() and not theirs[..., 5:].any()
    assert np.array_equal(theirs[..., :5], expected)
    assert np.abs(ours - theirs).max() <= 1e-4 * theirs[..., 0].max()


def test_bad_input_is_named() -> None:
    maps, unit = LightMaps(), np.eye(4)
    good: dict[str, Any] = {"points": [(0.5, 0.5, 0.5)], "radius": 0.1, "alpha": 0.5, "world_to_map": unit,
                            "size": (4, 4), "coefficients": 7}  # fmt: skip
    slanted, last_row = np.eye(4), np.eye(4)
    slanted[0, 2], last_row[3, 1] = 0.5, 2.0
    refusals: tuple[tuple[dict[str, Any], str], ...] = (
        ({"points": []}, "points has shape (0,)"),
        ({"points": np.zeros((0, 3))}, "points has shape (0, 3)"),
        ({"points": [(0.5, np.nan, 0.5)]}, "points holds nan at flat index 1"),
        ({"points": [(0.5, 0.5, np.inf)]}, "points holds inf at flat index 2"),
        ({"radius": 0.0}, "radius holds 0 at flat index 0"),
        ({"radius": [0.1, 0.2]}, "radius has shape (2,)"),
        ({"radius": np.nan}, "radius holds nan at flat index 0"),
        ({"alpha": 1.5}, "alpha holds 1.5 at flat index 0"),
        ({"alpha": -0.25}, "alpha holds -0.25 at flat index 0"),
        ({"size": (0, 4)}, "size is (0, 4)"),
        ({"size": (4, 1 << 24)}, f"size is (4, {1 << 24})"),
        ({"coefficients": 8}, "coefficients is 8, but must be odd"),
        ({"coefficients": 0}, "coefficients is 0"),
        ({"coefficients": 65}, "coefficients is 65"),
        ({"world_to_map": np.eye(3)}, "world_to_map has shape (3, 3)"),
        ({"world_to_map": np.zeros((4, 4))}, "world_to_map holds 0 at flat index 15"),
        ({"world_to_map": np.diag((1.0, 0.0, 1.0, 1.0))}, "world_to_map flattens space"),
        ({"world_to_map": last_row}, "world_to_map holds 2 at flat index 13"),
        ({"world_to_map": slanted}, "world_to_map is not a sun's"),
    )
    for change, expected in refusals:
        refused(expected, maps.splat, **(good | change))
    texture = gpu_shader.texture((1, 1, 1), "R", np.zeros(1))
    good = {"density": texture, "clearance": texture, "grid_to_world": unit, "world_to_map": unit, "size": (4, 4),
            "coefficients": 7}  # fmt: skip
    refusals = (
        ({"grid_to_world": np.full((4, 4), np.nan)}, "grid_to_world holds nan at flat index 0"),
        ({"size": (4, 0)}, "size is (4, 0)"),
        ({"coefficients": 2}, "coefficients is 2, but must be odd"),
        ({"slices": 0}, "slices is 0"),
    )
    for change, expected in refusals:
        refused(expected, maps.march, **(good | change))


def test_particles_outside_leave_an_empty_map() -> None:
    """Whatever the memory held before."""
    maps, size, count = LightMaps(), (8, 8), 31
    rubbish = np.full((8, *size, 4), 7.0)
    for place in ((0.5, 0.5, 1.7), (0.5, 0.5, -0.7), (3.0, 0.5, 0.5)):
        used = gpu_shader.texture(size, "RGBA", rubbish, layers=8)
        with mock.patch.object(light_maps, "_new_map", return_value=used):
            assert not maps.read(maps.splat([place], 0.3, 0.5, np.eye(4), size, count), count).any()


def test_state_comes_back() -> None:
    """Also when a build fails halfway. Nor does the state that was set reach the map."""
    state, maps, broken = gpu.state, LightMaps(), LightMaps()
    texture = gpu_shader.texture((1, 1, 1), "R", np.ones(1))
    before = state.blend_get(), state.depth_test_get(), state.depth_mask_get()
    try:
        state.blend_set("MULTIPLY")
        state.depth_test_set("GREATER")
        state.depth_mask_set(True)
        target = state.active_framebuffer_get()
        assert maps.read(maps.splat([(0.5, 0.5, 0.5)], 0.3, 0.5, np.eye(4), (8, 8), 31), 31).any()
        with mock.patch.object(gpu_shader.Shaders, "draw_screen", side_effect=RuntimeError("a test broke the drawing")):
            try:
                broken.march(texture, texture, np.eye(4), np.eye(4), (8, 8), 31)
            except RuntimeError:
                pass
        assert (state.blend_get(), state.depth_test_get(), state.depth_mask_get()) == ("MULTIPLY", "GREATER", True)
        assert state.active_framebuffer_get() == target
    finally:
        state.blend_set(before[0])
        state.depth_test_set(before[1])
        state.depth_mask_set(before[2])


def resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def test_maps_are_freed_with_the_last_reference() -> None:
    """On a software rasteriser the maps are in this process's own memory; on hardware the test says little."""
    maps, side = LightMaps(), 1024
    arguments = [(0.5, 0.5, 0.5)], 0.01, 0.5, np.eye(4), (side, side), 15
    one = 4 * side * side * 16  # bytes of a map
    maps.read(maps.splat(*arguments), 1)
    before = resident_bytes()
    for _ in range(8):
        maps.read(maps.splat(*arguments), 1)
    grown = resident_bytes() - before
    kept = [maps.splat(*arguments) for _ in range(3)]
    maps.read(kept[-1], 1)
    held = resident_bytes() - before
    print(f"  8 maps made and dropped: {grown / one:+.2f} maps; 3 kept: {held / one:+.2f}")
    assert grown < 4 * one


harness.main()
