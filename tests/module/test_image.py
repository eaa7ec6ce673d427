# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures on surfaces beside formulas in NumPy: between texels, and over footprints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sfumato import Image

Array = NDArray[np.float64]
EXTENSIONS = ("repeat", "extend", "clip", "mirror")


def linear_of(encoded: Array) -> Array:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4)


def wrapped(number: NDArray[np.int64], size: int, extension: str) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    inside = np.ones(number.shape, bool)
    if extension == "repeat":
        return number % size, inside
    if extension == "mirror":
        turn = number % (2 * size)
        return np.where(turn < size, turn, 2 * size - 1 - turn), inside
    if extension == "clip":
        inside = (number >= 0) & (number < size)
    return np.clip(number, 0, size - 1), inside


def bilinear(pixels: Array, u: Array, v: Array, extension: str) -> Array:
    height, width = pixels.shape[:2]
    x, y = u * width - 0.5, v * height - 0.5
    left, low = np.floor(x), np.floor(y)
    out = np.zeros((len(u), 4))
    for j in (0, 1):
        for i in (0, 1):
            column, across = wrapped(left.astype(int) + i, width, extension)
            row, up = wrapped(low.astype(int) + j, height, extension)
            weight = np.abs(1 - i - (x - left)) * np.abs(1 - j - (y - low)) * (across & up)
            out += weight[:, None] * pixels[row, column]
    return out


def bytes_of(height: int, width: int, seed: int = 1) -> NDArray[np.uint8]:
    return np.random.default_rng(seed).integers(0, 256, (height, width, 4)).astype(np.uint8)


@pytest.mark.parametrize("shape", [(1, 1), (7, 1), (5, 3), (12, 16)])
@pytest.mark.parametrize("extension", EXTENSIONS)
def test_between_texels_it_is_bilinear(shape: tuple[int, int], extension: str) -> None:
    pixels = bytes_of(*shape)
    u, v = np.random.default_rng(2).uniform(-1.5, 2.5, (2, 400))
    wanted = bilinear(pixels / 255.0, u, v, extension)
    np.testing.assert_allclose(Image(pixels).look_up(u, v, extension=extension), wanted, atol=2e-5)
    floats = (4.0 * pixels - 300.0).astype(np.float32)
    wanted = bilinear(floats.astype(float), u, v, extension)
    np.testing.assert_allclose(Image(floats).look_up(u, v, extension=extension), wanted, atol=1e-2)


def test_curves_and_alpha_come_after_mixing() -> None:
    pixels = bytes_of(6, 5)
    pixels[..., 3] = np.maximum(pixels[..., 3], 20)
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    u, v = np.random.default_rng(3).uniform(0.0, 1.0, (2, 300))
    mixed = bilinear(pixels / 255.0, u, v, "repeat")
    found = Image(pixels, curved=True).look_up(u, v)
    np.testing.assert_allclose(found[:, :3], linear_of(mixed[:, :3]), atol=1e-4)
    np.testing.assert_allclose(found[:, 3], mixed[:, 3], atol=1e-5)
    found = Image(pixels, curved=True, divided=True).look_up(u, v)
    np.testing.assert_allclose(found[:, :3], linear_of(mixed[:, :3] / mixed[:, 3:]), atol=1e-4)


def test_every_byte_is_decoded() -> None:
    pixels = np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 4, axis=2)
    u = (np.arange(256) + 0.5) / 256
    for interpolation in ("closest", "linear"):
        found = Image(pixels, curved=True).look_up(u, np.full(256, 0.5), interpolation=interpolation)
        np.testing.assert_allclose(found[:, 0], linear_of(np.arange(256) / 255.0), atol=1e-4)


@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("interpolation", ["closest", "linear", "cubic"])
def test_weights_are_one_in_all(extension: str, interpolation: str) -> None:
    pixels = np.full((3, 5, 4), 200, np.uint8)
    u, v = np.random.default_rng(4).uniform(0.45, 0.55, (2, 100))
    steps = np.random.default_rng(5).uniform(-0.1, 0.1, (2, 100, 2))
    for du, dv in ((None, None), tuple(steps)):
        found = Image(pixels).look_up(u, v, du, dv, interpolation, extension)
        if extension != "clip" or du is None and interpolation != "cubic":
            np.testing.assert_allclose(found, 200.0 / 255.0, atol=1e-5)
        else:
            assert found.max() < 200.0 / 255.0 + 1e-5


def test_nothing_is_beyond_the_edge_of_what_is_clipped() -> None:
    image = Image(np.full((4, 8, 4), 255, np.uint8))
    u = np.array([-0.07, -1e-4, 0.0, 0.0625, 0.99, 1.0, 1.0001, 1.07])
    v = np.full(len(u), 0.5)
    closest = image.look_up(u, v, interpolation="closest", extension="clip")[:, 3]
    np.testing.assert_array_equal(closest, [0, 0, 1, 1, 1, 1, 0, 0])
    linear = image.look_up(u, v, extension="clip")[:, 3]
    np.testing.assert_allclose(linear, np.clip(8 * np.minimum(u, 1 - u) + 0.5, 0, 1), atol=1e-5)


def mean(pixels: Array, u: Array, v: Array, du: Array, dv: Array, *, curved: bool) -> Array:
    side = (np.arange(48) + 0.5) / 48 - 0.5
    s, t = (each.ravel() for each in np.meshgrid(side, side))
    points = [at[:, None] + steps[:, :1] * s + steps[:, 1:] * t for at, steps in ((u, du), (v, dv))]
    found = bilinear(pixels, points[0].ravel(), points[1].ravel(), "repeat")
    found = np.concatenate((linear_of(found[:, :3]), found[:, 3:]), axis=1) if curved else found
    return found.reshape(len(u), -1, 4).mean(axis=1)


def footprints(size: int, width: float, anisotropy: float, count: int = 60) -> tuple[Any, ...]:
    random = np.random.default_rng(int(10 * width + anisotropy))
    angle = random.uniform(0.0, 2.0 * np.pi, count)
    across = np.stack((np.cos(angle), np.sin(angle))) * width * anisotropy / size
    up = np.stack((-np.sin(angle), np.cos(angle))) * width / size
    u, v = random.uniform(-1.0, 2.0, (2, count))
    return u, v, np.stack((across[0], up[0]), axis=1), np.stack((across[1], up[1]), axis=1)


@pytest.mark.parametrize("anisotropy", [1.0, 3.0, 16.0])
@pytest.mark.parametrize("width", [1.5, 4.0, 9.0])
def test_a_footprint_is_a_mean(width: float, anisotropy: float) -> None:
    pixels = bytes_of(96, 96)  # noise, which is the hardest
    u, v, du, dv = footprints(96, width, anisotropy)
    for curved in (False, True):
        wanted = mean(pixels / 255.0, u, v, du, dv, curved=curved)
        found = Image(pixels, curved=curved).look_up(u, v, du, dv)
        assert np.sqrt(np.mean((found - wanted) ** 2)) < 0.04
        assert abs(np.mean(found - wanted)) < 0.012
        without = Image(pixels, curved=curved).look_up(u, v)
        assert np.sqrt(np.mean((without - wanted) ** 2)) > 0.07


def test_below_a_texel_nothing_is_filtered() -> None:
    pixels = bytes_of(16, 16)
    u, v, du, dv = footprints(16, 0.2, 4.9)
    for interpolation in ("closest", "linear", "cubic"):
        image = Image(pixels, curved=True)
        found = image.look_up(u, v, du, dv, interpolation)
        np.testing.assert_array_equal(found, image.look_up(u, v, interpolation=interpolation))


@pytest.mark.parametrize("shape", [(1, 1), (7, 1), (5, 3), (33, 64), (1, 500)])
def test_from_far_away_it_is_its_mean(shape: tuple[int, int]) -> None:
    pixels = bytes_of(*shape).astype(np.float32) / 255.0
    far = np.array([[1000.0, 0.0]]), np.array([[0.0, 1000.0]])
    found = Image(pixels, curved=True, closest=True).look_up([0.3], [0.8], *far, "closest")
    wanted = np.append(linear_of(pixels[..., :3].astype(float)).mean(axis=(0, 1)), pixels[..., 3].mean())
    np.testing.assert_allclose(found[0], wanted, atol=1e-4)


def test_what_is_clear_has_no_say_in_colours() -> None:
    pixels = np.zeros((8, 8, 4), np.uint8)
    pixels[::2] = (200, 100, 50, 255)
    one, far = [0.5], np.array([[2.0, 0.0]])
    found = Image(pixels, curved=True, divided=True).look_up(one, one, far, far[:, ::-1])
    np.testing.assert_allclose(found[0, :3], linear_of(np.array((200, 100, 50)) / 255.0), atol=3e-3)
    assert abs(found[0, 3] - 0.5) < 3e-3


def test_the_middle_of_odd_sizes_stays_there() -> None:
    """A bump of light is as bright to either side of it."""
    pixels = np.zeros((101, 101, 4), np.float32)
    pixels[50, 50] = 1.0
    offsets = np.array((0.02, 0.05, 0.1))
    for width in (0.03, 0.1, 0.3):
        steps = np.repeat([[width, 0.0]], 3, axis=0)
        half = np.full(3, 0.5)
        found = [
            Image(pixels).look_up(half + sign * offsets, half, steps, steps[:, ::-1], extension="extend")[:, 0]
            for sign in (-1.0, 1.0)
        ]
        np.testing.assert_allclose(found[0], found[1], atol=0.05 / (width * 101) ** 2)


def test_no_place_at_all_is_black() -> None:
    image = Image(bytes_of(5, 3), curved=True)
    for extension in EXTENSIONS:
        for interpolation in ("closest", "linear", "cubic"):
            found = image.look_up(
                [np.nan, np.inf, 1e6, -1e30], [0.5, 0.5, -1e6, 1e30], None, None, interpolation, extension
            )
            assert np.isfinite(found).all() and not found[:2].any()
    found = image.look_up([0.5], [0.5], [[np.nan, 0.0]], [[0.0, np.inf]])
    assert np.isfinite(found).all()


def test_no_image_is_refused_in_silence() -> None:
    wrong: tuple[tuple[Any, str], ...] = (
        (np.ones((4, 3), np.float32), "shape"),
        (np.ones((4, 3, 3), np.uint8), "shape"),
        (np.ones((0, 3, 4), np.uint8), "texels"),
        (np.ones((2, 3, 4), np.int32), "int32"),
        (np.full((2, 3, 4), np.inf, np.float32), "flat index 0"),
        (np.broadcast_to(np.zeros(1, np.uint8), (2**16, 2**16, 4)), "at most 1073741824 texels"),
    )
    for given, said in wrong:
        with pytest.raises(ValueError, match=f"pixels.*{said}"):
            Image(given)
    image = Image(bytes_of(2, 2))
    with pytest.raises(ValueError, match="interpolation is 'smooth'.*'closest', 'linear', 'cubic'"):
        image.look_up([0.5], [0.5], interpolation="smooth")
    with pytest.raises(ValueError, match="extension is 'wrap'"):
        image.look_up([0.5], [0.5], extension="wrap")
    with pytest.raises(ValueError, match="v has shape"):
        image.look_up([0.5], [0.5, 0.6])
    with pytest.raises(ValueError, match="du has shape"):
        image.look_up([0.5], [0.5], [0.5, 0.5])
