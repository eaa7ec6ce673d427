# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns: what steps give, what is refused, and that a material whose pattern gives a constant looks as that constant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import sfumato
from numpy.typing import NDArray

Array = NDArray[np.float64]
CHANNEL = 64
CODES = {name: number for number, name in enumerate(sfumato.Pattern.operations())}
QUAD = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
FACES = [[0, 1, 2], [0, 2, 3]]


def step(name: str, to: int, setting: int = 0, *inputs: int) -> list[int]:
    return [CODES[name], to, setting, *inputs, *[0] * (10 - len(inputs))]


def of_channels(name: str, count: int, setting: int = 0, outputs: int = 1, **more: Any) -> sfumato.Pattern:
    """One operation, of the first so many channels."""
    steps = [step("input", k, CHANNEL + k) for k in range(count)]
    steps.append(step(name, count, setting, *range(count)))
    return sfumato.Pattern(steps, [(k, count + k) for k in range(outputs)], **more)


def _power(a: Array, b: Array) -> Array:
    with np.errstate(all="ignore"):
        found: Array = np.power(a, b)
    return np.where(np.isfinite(found), found, 0.0)


FORMULAS: dict[str, Callable[..., Any]] = {
    "add": np.add,
    "subtract": np.subtract,
    "multiply": np.multiply,
    "divide": lambda a, b: np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0),
    "minimum": np.minimum,
    "maximum": np.maximum,
    "power": _power,
    "floor": np.floor,
    "ceil": np.ceil,
    "truncate": np.trunc,
    "square root": lambda a: np.sqrt(np.maximum(a, 0.0)),
    "absolute": np.abs,
    "sign": np.sign,
    "exponent": np.exp,
    "logarithm": lambda a: np.where(a > 0.0, np.log(np.where(a > 0.0, a, 1.0)), 0.0),
    "sine": np.sin,
    "cosine": np.cos,
    "arc tangent": np.arctan2,
    "less": lambda a, b: (a < b) * 1.0,
    "equal": lambda a, b: (a == b) * 1.0,
    "select": lambda c, a, b: np.where(c != 0.0, a, b),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_an_operation_is_what_it_is_called(name: str) -> None:
    formula = FORMULAS[name]
    count = 3 if name == "select" else 2 if isinstance(formula, np.ufunc) and formula.nin == 2 else 1
    count = {"divide": 2, "power": 2, "less": 2, "equal": 2}.get(name, count)
    rows = np.random.default_rng(1).uniform(-3.0, 3.0, (200, count)).astype(np.float32)
    rows[:40] = np.round(rows[:40])  # whole numbers, and zeros
    found = of_channels(name, count).of(rows)[:, 0]
    expected = np.asarray(formula(*rows.astype(np.float64).T))
    np.testing.assert_allclose(found, expected, rtol=3e-6, atol=3e-6)


def test_tables_are_linear_or_stepped_between_their_entries() -> None:
    entries, rows = [0.0, 2.0, -1.0], np.linspace(-0.5, 1.5, 41)[:, None]
    linear = of_channels("table", 1, tables=[entries]).of(rows)[:, 0]
    np.testing.assert_allclose(linear, np.interp(rows[:, 0], [0.0, 0.5, 1.0], entries), atol=1e-6)
    stepped = of_channels("stepped table", 1, tables=[entries]).of(rows)[:, 0]
    below = np.floor(2.0 * np.clip(rows[:, 0], 0.0, 1.0)).astype(int)
    np.testing.assert_array_equal(stepped, np.array(entries, np.float32)[below])


def test_textures_repeat_and_are_within_their_range() -> None:
    rows = np.random.default_rng(2).uniform(-4.0, 4.0, (500, 10))
    rows[:, 4:] = (2.0, 0.5, 2.0, 0.0, 0.0, 0.0)  # detail, roughness, lacunarity, offset, gain, distortion
    noise = of_channels("noise", 10, outputs=4, integers=[[3, 0, 1, 1, 1, 0]]).of(rows)
    assert noise.min() >= 0.0 and noise.max() <= 1.0 and noise.std() > 0.05
    checker = of_channels("checker", 3, integers=[[0] * 6]).of(rows[:, :3])[:, 0]
    np.testing.assert_array_equal(checker, np.floor(rows[:, :3]).sum(1) % 2)


def test_an_image_gives_its_texels() -> None:
    pixels = np.random.default_rng(3).random((4, 8, 4)).astype(np.float32)
    u, v = np.meshgrid((np.arange(8) + 0.5) / 8, (np.arange(4) + 0.5) / 4)
    rows = np.stack([u.ravel(), v.ravel(), *np.zeros((4, 32))], axis=1)
    image = sfumato.Image(pixels)
    found = of_channels("image", 6, outputs=4, images=[(image, "linear", "repeat")]).of(rows)
    np.testing.assert_allclose(found.reshape(4, 8, 4), pixels, atol=1e-5)


def test_inputs_of_a_point() -> None:
    mesh = sfumato.Mesh(QUAD, FACES, channels=np.arange(6.0).reshape(2, 3, 1))
    matrix = np.diag([2.0, 3.0, 1.0, 1.0])
    matrix[:3, 3] = 5.0, 0.0, 1.0
    wanted = [0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 16, 20, 26, CHANNEL]
    steps = [step("input", k, code) for k, code in enumerate(wanted)]
    pattern = sfumato.Pattern(steps, [(k, k) for k in range(len(wanted))])
    # Halfway between the second and the third corner of the first triangle: (1, 0, 0).
    found = pattern.at(mesh, [0], [0.5], [0.5], matrix, [7.0])[0]
    np.testing.assert_allclose(found, [7, 0, 1, 1, 0, 0, 0, 0, 1, 0, 2, 3, 7, 1.5], atol=1e-6)


def picture(materials: dict[str, Any], pattern: sfumato.Pattern | None, **settings: Any) -> NDArray[np.float32]:
    scene = sfumato.Scene()
    mesh = sfumato.Mesh(QUAD, FACES, channels=np.ones((2, 3, 1)))
    scene.add_instances(mesh, np.eye(4), **materials, patterns=[pattern] if pattern is not None else [])
    scene.add_sun((0.3, 0.2, -1.0), (3.0, 3.0, 3.0))
    scene.set_background((0.1, 0.2, 0.3), 1.0)
    projection = np.diag([0.8, 0.8, -0.1, 1.0])
    tilt = np.eye(4)
    tilt[1:3, 1:3] = [[0.6, 0.8], [-0.8, 0.6]]
    return sfumato.Frame(scene, **settings).render(sfumato.Camera(projection @ tilt), 24, 24)


def constants(slots: dict[int, float]) -> sfumato.Pattern:
    steps = [step("constant", k, k) for k in range(len(slots))]
    return sfumato.Pattern(steps, [(slot, k) for k, slot in enumerate(slots)], list(slots.values()))


def rows_of(reflectance: Sequence[float], alpha: float, index: float, below: float, share: float) -> list[float]:
    return [*reflectance, 1.0, alpha, alpha, 0.0, index, 1.0, below, 0.0, 0.0, 0.0, 0.0, share, 0.0]


def test_a_pattern_that_gives_a_constant_is_that_constant() -> None:
    layers = [
        rows_of((0.9, 0.5, 0.3), 0.09, 0.0, 1.0, 0.4),
        rows_of((0.04, 0.04, 0.04), 0.25, 1.5, 0.5, 1.0),
    ]
    albedo, emission = [[0.7, 0.4, 0.2]], [[0.1, 0.0, 0.2]]
    plain = picture({"albedo": albedo, "gloss": [layers], "emission": emission}, None)
    other = [rows_of((0.2, 0.2, 0.2), 0.5, 0.0, 1.0, 0.9), rows_of((0.04, 0.04, 0.04), 0.6, 1.5, 0.5, 1.0)]
    slots = dict(zip(range(6), (*albedo[0], *emission[0])))
    slots |= {13: 0.9, 14: 0.5, 15: 0.3, 19: 0.09, 20: 0.09, 22: 0.4}  # of the first layer
    slots |= {30: 0.25, 31: 0.25}  # and of the second
    usual = {"albedo": [[0.5, 0.5, 0.5]], "gloss": [other], "emission": [[0.0, 0.0, 0.0]]}
    found = picture(usual, constants(slots))
    np.testing.assert_allclose(found, plain, rtol=3e-3, atol=1e-4)
    assert np.abs(picture(usual, None) - plain).max() > 0.1


def test_a_pattern_lets_light_through() -> None:
    clear = picture({"albedo": [[0.0, 0.0, 0.0]]}, constants({6: 0.25, 7: 0.5, 8: 0.75}))
    plain = picture({"albedo": [[0.0, 0.0, 0.0]], "transmittance": [[0.25, 0.5, 0.75]]}, None)
    np.testing.assert_allclose(clear, plain, atol=1e-6)
    np.testing.assert_allclose(clear[12, 12, :3], (0.025, 0.1, 0.225), atol=1e-5)


def of_the_angle() -> sfumato.Pattern:
    """Transmittance: the cosine between the normal and where light comes from, or goes."""
    steps = [step("input", k, (6, 7, 8, 12, 13, 14)[k]) for k in range(6)]
    steps += [step("multiply", 6 + k, 0, k, 3 + k) for k in range(3)]
    steps += [step("add", 9, 0, 6, 7), step("add", 9, 0, 9, 8), step("absolute", 9, 0, 9)]
    return sfumato.Pattern(steps, [(6, 9), (7, 9), (8, 9)])


def test_light_passes_by_its_own_angle() -> None:
    """A sun from aside and an eye above: a pane over a floor lets the sun through by the sun's angle, the eye by its own."""
    aside = np.radians(50.0)
    seen = {}
    for tilt in (0.0, 0.4):
        scene = sfumato.Scene()
        scene.add_instances(sfumato.Mesh(QUAD, FACES), np.diag([20.0, 20.0, 1.0, 1.0]), [[0.5] * 3])
        turned = np.eye(4)
        turned[:3, :3] = [[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]]
        turned[:3, :3] *= 8.0
        turned[2, 3] = 2.0
        pane = sfumato.Mesh(QUAD, FACES)
        scene.add_instances(pane, turned, [[0.0] * 3], transmittance=[[0.1] * 3], patterns=[of_the_angle()])
        scene.add_sun((np.sin(aside), 0.0, -np.cos(aside)), (np.pi,) * 3)
        down = sfumato.Camera(np.diag([1.0, 1.0, -0.1, 1.0]))
        seen[tilt] = float(sfumato.Frame(scene).render(down, 3, 3)[1, 1, 0])
    lit = 0.5 * np.cos(aside)
    assert seen[0.0] == pytest.approx(lit * np.cos(aside), rel=1e-4)
    assert seen[0.4] == pytest.approx(lit * np.cos(aside + 0.4) * np.cos(0.4), rel=1e-4)


def test_what_is_drawn_of_a_pane_hides_by_the_angle() -> None:
    scene = sfumato.Scene()
    turned = np.eye(4)
    turned[:3, :3] = [[np.cos(0.7), 0, np.sin(0.7)], [0, 1, 0], [-np.sin(0.7), 0, np.cos(0.7)]]
    pane = sfumato.Mesh(QUAD, FACES)
    scene.add_instances(pane, turned, [[0.0] * 3], transmittance=[[0.1] * 3], patterns=[of_the_angle()])
    opacity = sfumato.Frame(scene).triangles(sfumato.Camera(np.diag([1.0, 1.0, -0.1, 1.0])), 64, 64)[1]
    np.testing.assert_allclose(opacity, 1.0 - np.cos(0.7), rtol=1e-4)


def test_a_bent_normal_sees_another_light() -> None:
    straight = picture({"albedo": [[0.8, 0.8, 0.8]]}, constants({10: 0.0, 11: 0.0, 12: 1.0}))
    plain = picture({"albedo": [[0.8, 0.8, 0.8]]}, None)
    np.testing.assert_allclose(straight, plain, atol=1e-6)
    # Towards the sun: as much brighter as the cosine grows, and no softer, since the smooth surface faces it too.
    sun = -np.array((0.3, 0.2, -1.0)) / np.linalg.norm((0.3, 0.2, -1.0))
    bent = picture({"albedo": [[0.8, 0.8, 0.8]]}, constants({10: sun[0], 11: sun[1], 12: sun[2]}))
    np.testing.assert_allclose(bent[12, 12, :3] / plain[12, 12, :3], 1.0 / sun[2], rtol=1e-3)


def test_what_cannot_be_run_is_refused() -> None:
    for steps, words in (
        ([step("sine", 0, 0, 3)], "reads register 3, which nothing has written"),
        ([step("constant", 0, 4)], "asks for constant 4, but there are 0"),
        ([step("input", 0, 500)], "asks for input 500"),
        ([step("table", 0, 0, 0)], "asks for table 0"),
        ([[99, *[0] * 12]], "has operation 99"),
        ([[0, 300, *[0] * 11]], "names register 300"),
    ):
        with pytest.raises(ValueError, match=words):
            sfumato.Pattern(steps, np.zeros((0, 2)))
    with pytest.raises(ValueError, match="slot 200"):
        sfumato.Pattern([step("input", 0, 0)], [(200, 0)])
    asks = sfumato.Pattern([step("input", 0, CHANNEL + 1)], [(0, 0)])
    with pytest.raises(ValueError, match="asks for 2 channels, but the mesh has 0"):
        sfumato.Scene().add_instances(sfumato.Mesh(QUAD, FACES), np.eye(4), [[1, 1, 1]], patterns=[asks])


def test_meshes_without_channels_stand_beside_those_with() -> None:
    """In one packet: what one pattern asks of its mesh another mesh has not."""
    scene = sfumato.Scene()
    asks = sfumato.Pattern([step("input", 0, CHANNEL), step("input", 1, CHANNEL, 1)], [(0, 0), (1, 1)])
    own = sfumato.Pattern([step("input", 0, 3)], [(2, 0)])
    for number, (pattern, channels) in enumerate(((asks, np.ones((2, 3, 1))), (own, None), (None, None))):
        matrix = np.diag([0.1, 0.1, 1.0, 1.0])
        matrix[0, 3] = 0.2 * number - 0.2
        mesh = sfumato.Mesh(QUAD, FACES, channels=channels)
        scene.add_instances(mesh, matrix, [[0.5, 0.5, 0.5]], patterns=[pattern] if pattern else [])
    scene.add_sun((0.0, 0.0, -1.0), (np.pi, np.pi, np.pi))
    shown = sfumato.Frame(scene).render(sfumato.Camera(np.diag([2.0, 2.0, -0.1, 1.0])), 40, 40)
    np.testing.assert_allclose(shown[20, 12], (1.0, 1.0, 0.5, 1.0), atol=2e-3)
    np.testing.assert_allclose(shown[20, 28], (0.5, 0.5, 0.5, 1.0), atol=2e-3)
    assert 0.0 < shown[20, 21, 2] < shown[20, 21, 0]
