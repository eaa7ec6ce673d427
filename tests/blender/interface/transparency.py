# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent fragments on the GPU: the picture that the module composites of the same fragments, by every method. It
takes no window."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import harness
import numpy as np
import sfumato
from mathutils import Matrix
from numpy.typing import NDArray
from sfumato.gpu import shader as gpu_shader
from sfumato.gpu.fragments import Fragments, Sprites, Triangles
from sfumato.gpu.light_maps import LightMaps
from sfumato.gpu.transparency import Light, Transparency, View
from sprites import SIZE, drawn, expected_fragments, read, rmse, some_sheets, some_sprites, view_of, world_points

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import transparency_rivals as rivals  # noqa: E402
from bench_transparency import TARGETS  # noqa: E402
from fragments import draws  # noqa: E402

# Pictures of about one; half floats that a software rasteriser cuts are off by up to 1e-3 there, 5e-4 in the mean.
TOLERANCE = 1e-3
SMALL = (24, 16)  # for thousands of fragments a pixel
COMPOSITE: dict[str, Callable[..., Any]] = {
    "nearest": sfumato.composite_nearest,
    "fourier": sfumato.composite_fourier,
    "weighted": sfumato.composite_weighted,
}


CASES = {
    "three sprites": (some_sprites(3, most=0.9), None),
    "three hundred sprites": (some_sprites(300), None),
    "sheets": (None, some_sheets(3)),
    "both": (some_sprites(60, most=0.8), some_sheets(8)),
}


def test_gpu_and_module_make_the_same_picture() -> None:
    transparency = Transparency()
    for name, (sprites, triangles) in CASES.items():
        fragments = Fragments(sprites, triangles)
        for perspective in (True, False):
            view = view_of(perspective)
            there = expected_fragments(fragments, view, sprites, triangles)
            for method, composite in COMPOSITE.items():
                made = read(transparency.composite(fragments, view, method))
                error = rmse(made, composite(*there))
                print(f"  {name}, {'perspective' if perspective else 'orthographic'}, {method}: {error:.1e}")
                assert error <= TOLERANCE


def test_seeded_fragments_reach_their_targets() -> None:
    """Of the benchmark, in 22 bytes a pixel."""
    transparency = Transparency()
    for case, pixels in draws().items():
        made = read(transparency.composite(*drawn(pixels)))[: len(pixels.depth), :3]
        error = 1e3 * rmse(made, rivals.exact(pixels))
        print(f"  {case}: {error:.2f}e-3, target {TARGETS[case]}e-3")
        assert error <= TARGETS[case]


def test_a_series_of_any_length_is_the_modules() -> None:
    sprites, triangles = CASES["both"]
    fragments, view, transparency = Fragments(sprites, triangles), view_of(), Transparency()
    there = expected_fragments(fragments, view, sprites, triangles)
    for terms, sigma in ((2, 0.0), (5, 2.0), (12, 1.0)):
        made = read(transparency.composite(fragments, view, "fourier", terms=terms, sigma=sigma))
        error = rmse(made, sfumato.composite_fourier(*there, terms, sigma))
        print(f"  {terms} terms, exponent {sigma}: {error:.1e}")
        assert error <= TOLERANCE


def test_order_does_not_matter() -> None:
    sprites, triangles = CASES["both"]
    assert sprites is not None and triangles is not None
    transparency, view = Transparency(), view_of()
    turned = [np.random.default_rng(5).permutation(len(np.asarray(some.alpha))) for some in (sprites, triangles)]
    other = Fragments(
        Sprites(
            *(np.asarray(part)[turned[0]] for part in (sprites.points, sprites.radius, sprites.alpha, sprites.colour))
        ),
        Triangles(*(np.asarray(part)[turned[1]] for part in (triangles.corners, triangles.alpha, triangles.colour))),
    )
    for method in COMPOSITE:
        one, same = (
            read(transparency.composite(some, view, method)) for some in (Fragments(sprites, triangles), other)
        )
        print(f"  {method}: {np.abs(one - same).max():.1e}")
        # Half floats of the picture have steps of up to 1e-3; but few sums lie so near the edge of one.
        assert rmse(one, same) <= 1e-5


def test_ours_is_nearer_the_truth_than_weights_and_the_published_series() -> None:
    sprites, triangles = CASES["both"]
    fragments, view, transparency = Fragments(sprites, triangles), view_of(), Transparency()
    depth, alpha, colour = expected_fragments(fragments, view, sprites, triangles)
    order = np.argsort(depth, axis=1)
    alpha, colour = np.take_along_axis(alpha, order, 1), np.take_along_axis(colour, order[..., None], 1)
    before = np.cumprod(np.concatenate((np.ones((len(alpha), 1)), 1.0 - alpha), axis=1), axis=1)
    exact = np.concatenate(((colour * (alpha * before[:, :-1])[..., None]).sum(1), 1.0 - before[:, -1:]), axis=1)
    error = {method: rmse(read(transparency.composite(fragments, view, method)), exact) for method in COMPOSITE}
    print("  " + ", ".join(f"{method} {value:.4f}" for method, value in error.items()))
    assert error["nearest"] < 0.5 * min(error["fourier"], error["weighted"])


def test_what_is_opaque_cuts_sprites_where_they_stand_in_it() -> None:
    """And hides triangles behind it."""
    sprites, triangles = some_sprites(40, most=0.9), some_sheets(2)
    fragments, transparency = Fragments(sprites, triangles), Transparency()
    distance = np.linspace(3.0, 5.0, SIZE[0] * SIZE[1]).reshape(SIZE[1], SIZE[0])
    view = view_of(solids=gpu_shader.texture(SIZE, "R", distance))
    there = expected_fragments(fragments, view, sprites, triangles, distance.ravel())
    for method, composite in COMPOSITE.items():
        error = rmse(read(transparency.composite(fragments, view, method)), composite(*there))
        print(f"  {method}: {error:.1e}")
        assert error <= TOLERANCE


def test_a_sheet_passes_through_a_sprite_without_a_pop() -> None:
    """Step by step, no pixel changes by much more than by its share of the way; a flat sprite would change at once."""
    transparency, view = Transparency(), view_of()
    sprite = Sprites([(0.0, 0.0, 0.0)], 0.5, 0.8, [(1.0, 0.0, 0.0)])
    sheet = some_sheets(1)
    away = np.array(view.from_world)[2, :3]  # towards the camera
    made = []
    for place in np.linspace(-0.55, 0.55, 45):
        middle = np.asarray(sheet.corners) - np.asarray(sheet.corners).mean((0, 1)) + place * away
        made.append(
            read(transparency.composite(Fragments(sprite, Triangles(middle, 0.6, (0.0, 1.0, 0.0))), view))[:, :3]
        )
    steps = np.abs(np.diff(made, axis=0)).max(axis=(1, 2))
    whole = np.abs(made[0] - made[-1]).max()
    print(f"  {whole:.3f} all in all, at most {steps.max():.3f} in one of 44 steps")
    assert steps.max() <= 0.45 * whole and np.count_nonzero(steps > 0.05 * whole) >= 4


def test_half_floats_as_published() -> None:
    """Of few fragments they do; of many thin ones their sums stall."""
    transparency, view = Transparency(), view_of(size=SMALL)
    few = Fragments(some_sprites(30))
    error = rmse(*(read(transparency.composite(few, view, "fourier", half=half)) for half in (False, True)))
    count = 6000
    thin = Fragments(Sprites(np.zeros((count, 3)) + np.linspace(-0.5, 0.5, count)[:, None], 5.0, 4e-4, (1.0, 1.0, 1.0)))
    opacity = {
        half: read(transparency.composite(thin, view, "fourier", half=half))[:, 3].mean() for half in (False, True)
    }
    exact = 1.0 - (1.0 - 4e-4) ** count
    print(
        f"  few: {error:.1e}; thin: {opacity[False]:.3f} and in half floats {opacity[True]:.3f}, for at most {exact:.3f}"
    )
    assert error <= 0.02
    assert opacity[False] - opacity[True] > 0.05, "half floats would do: then use them"


def sun_map() -> NDArray[np.float64]:
    """A box of 6 metres about the origin fills the map."""
    turn = np.array(Matrix.Rotation(0.7, 4, "Z") @ Matrix.Rotation(0.9, 4, "X")).T
    matrix = np.diag((1 / 6, 1 / 6, 1 / 6, 1.0)) @ turn
    matrix[:3, 3] = 0.5
    return matrix


def test_sprites_shaded_by_their_light_map_back_to_front() -> None:
    """The two passes of Jansen and Bavoil: splat into a map, then draw in order, each sprite looking up its light."""
    sprites = some_sprites(200)
    white = Sprites(sprites.points, sprites.radius, sprites.alpha, np.ones((200, 3)))
    fragments, view, maps, transparency = Fragments(white), view_of(), LightMaps(), Transparency()
    light_maps = {}
    for half in (False, True):
        light_map = maps.splat(
            sprites.points, sprites.radius, sprites.alpha, sun_map(), (64, 64), 7, thick=False, half=half
        )
        light_maps[half] = light_map
        assert light_map.format == ("RGBA16F" if half else "RGBA32F")
    # Sprites small enough that their middle's light is that of the whole, in a map of its own.
    made = {half: read(transparency.composite(fragments, view, "sorted", Light(light_maps[half], 7, sun_map())))
            for half in (False, True)}  # fmt: skip
    depth, alpha, colour = expected_fragments(fragments, view, white, None)
    lit = np.stack([light_at(maps.read(light_maps[False], 7), points) for points in world_points(view, white)], axis=1)
    order = np.argsort(depth, axis=1, kind="stable")
    alpha, lit = np.take_along_axis(alpha, order, 1), np.take_along_axis(lit, order, 1)
    before = np.cumprod(np.concatenate((np.ones((len(alpha), 1)), 1.0 - alpha), axis=1), axis=1)
    exact = (lit * alpha * before[:, :-1]).sum(1)
    print(f"  32 bits {rmse(made[False][:, 0], exact):.1e}, 16 bits {rmse(made[True][:, 0], exact):.1e}")
    assert rmse(made[False][:, 0], exact) <= TOLERANCE
    assert rmse(made[True][:, 0], exact) <= 0.01
    assert rmse(made[False][:, 3], 1.0 - before[:, -1]) <= TOLERANCE
    # The same light in the other methods.
    ours = read(transparency.composite(fragments, view, "nearest", Light(light_maps[False], 7, sun_map())))
    assert rmse(ours[:, 0], exact) <= 0.02


def light_at(coefficients: NDArray[np.float32], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the nearest texels by bilinear interpolation, as the GPU's samplers do it."""
    matrix = sun_map()
    at = points @ matrix[:3, :3].T + matrix[:3, 3]
    height, width = coefficients.shape[:2]
    place = at[:, :2] * (width, height) - 0.5
    low = np.floor(place).astype(int)
    share = place - low
    mixed = np.zeros((len(points), coefficients.shape[2]))
    for x in (0, 1):
        for y in (0, 1):
            texel = np.clip(low + (x, y), 0, (width - 1, height - 1))
            weight = np.abs(1 - x - share[:, 0]) * np.abs(1 - y - share[:, 1])
            mixed += weight[:, None] * coefficients[texel[:, 1], texel[:, 0]]
    return np.asarray(sfumato.transmittance(mixed, np.clip(at[:, 2:], 0.0, 1.0)))[:, 0]


def test_nothing_to_draw() -> None:
    """Leaves an empty picture; so does what is behind the camera."""
    behind = np.array(view_of().from_world)
    place = np.linalg.inv(behind)[:3, 3] + 2.0 * np.linalg.inv(behind)[:3, 2]
    for fragments in (Fragments(), Fragments(Sprites(np.zeros((0, 3)), 1.0, 0.5, (1, 1, 1))),
                      Fragments(Sprites([place], 0.5, 0.5, (1, 1, 1)))):  # fmt: skip
        for method in (*COMPOSITE, "sorted"):
            assert not read(Transparency().composite(fragments, view_of(), method)).any()


def test_a_million_in_one_pixel_would_still_be_one_layer() -> None:
    """Opaque ones and thin ones, all at one place."""
    for alpha in (1.0, 0.001):
        fragments = Fragments(Sprites(np.zeros((5000, 3)), 1.0, alpha, (0.5, 0.25, 1.0)))
        made = read(Transparency().composite(fragments, view_of(size=SMALL)))
        middle = made[np.argmax(made[:, 3])]
        assert np.abs(middle[:3] - middle[3] * np.array((0.5, 0.25, 1.0))).max() <= 2e-3 and middle[3] > 0.98, middle


def test_bad_input_is_named() -> None:
    good: dict[str, Any] = {"points": [(0, 0, 0)], "radius": 0.1, "alpha": 0.5, "colour": (1, 1, 1)}
    for change, expected in (
        ({"points": [(np.nan, 0, 0)]}, "points holds nan at flat index 0"),
        ({"points": [(0, 0)]}, "points has shape (1, 2), but must have (n, 3)"),
        ({"radius": -1.0}, "radius holds -1 at flat index 0"),
        ({"alpha": 1.5}, "alpha holds 1.5 at flat index 0"),
        ({"colour": (1, 1)}, "colour has shape (2,), but must have (3,) or (1, 3)"),
        ({"colour": (1, np.inf, 1)}, "colour holds inf at flat index 1"),
    ):
        refused(expected, lambda change=change: Fragments(Sprites(**(good | change))))
    sheet = Triangles([[(0, 0, 0), (1, 0, 0)]], 0.5, (1, 1, 1))
    refused("corners has shape (1, 2, 3), but must have (n, 3, 3)", lambda: Fragments(None, sheet))
    fragments = Fragments(None, some_sheets(1))
    refused(
        "method is 'exact', but must be one of 'nearest'",
        lambda: Transparency().composite(fragments, view_of(), "exact"),
    )
    refused("terms is 13", lambda: Transparency().composite(fragments, view_of(), "fourier", terms=13))
    refused("method is 'sorted', but fragments", lambda: Transparency().composite(fragments, view_of(), "sorted"))


def refused(expected: str, work: Any) -> None:
    try:
        work()
    except ValueError as error:
        assert expected in str(error), f"{error}, but expected {expected}"
    else:
        raise AssertionError(f"no error, but expected: {expected}")


harness.main()
