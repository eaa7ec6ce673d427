# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of gloss over a diffuse surface: what they take from that, and what their facets send to each other."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sfumato import Camera, Frame, Scene

ANGLES = np.radians([0.0, 20.0, 40.0, 60.0, 75.0, 82.0])
Array = NDArray[np.float64]


Layer = list[float]


def seen(gloss: Layer | list[Layer], albedo: float, angle: float, sun: float = 0.0) -> Array:
    """The radiance of a floor, RGB, whose diffuse part alone would be `albedo` in a sun from straight above; which may be
    turned away from the eye, as far as that is turned, or further."""
    scene = Scene()
    floor = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
    normals = np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3))
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], normals, [0, 0], [[albedo] * 3], gloss=[gloss])
    scene.add_sun((np.sin(sun), 0, -np.cos(sun)), [np.pi] * 3)
    eye = np.array([np.sin(angle), 0.0, np.cos(angle)])
    view = np.eye(4)
    view[:3, :3] = (0.0, 1.0, 0.0), np.cross(eye, (0.0, 1.0, 0.0)), eye  # looks from the eye at the origin
    return np.asarray(Frame(scene).surfaces(Camera(np.diag([1.0, 1.0, -0.1, 1.0]) @ view), 1, 1)[0, 0, :3], float)


def kept(gloss: list[float]) -> Array:
    """The share of what is diffuse that is left, at all angles."""
    return np.array([(seen(gloss, 0.5, a) - seen(gloss, 0.0, a))[0] / 0.5 for a in ANGLES])


def row(alpha: float, f0: float, index: float, lossless: bool = False, below: float = 0.0, share: float = 1.0) -> Layer:
    return [f0, f0, f0, 1.0, alpha, alpha, 0.0, index, float(lossless), below, 0.0, 0.0, 0.0, 0.0, share, 0.0]


REST, NOTHING = 0.5, 1.0


def fresnel(cosine: Array, index: float) -> Array:
    """By Snell's law, as the textbooks have it."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    within = (index * cosine - inside) / (index * cosine + inside)
    return np.asarray(0.5 * (across**2 + within**2))


def reflected(alpha: float, angle: float, index: float | None) -> float:
    """Of light from all sides by GGX facets, each of them once: an integral over their normals; without index for F = 1."""
    eye = np.array([np.sin(angle), 0.0, np.cos(angle)])
    count = 400
    share = (np.arange(count) + 0.5) / count
    lean = np.arctan(alpha * np.sqrt(share / (1.0 - share)))[:, None]  # equal parts of D cos
    turn = (2.0 * np.pi * share)[None, :]
    normals = np.stack(np.broadcast_arrays(np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)), -1)
    towards = normals @ eye
    light = 2.0 * towards[..., None] * normals - eye

    def smith(cosine: Array) -> Array:
        tangent2 = 1.0 / np.clip(cosine, 1e-9, 1.0) ** 2 - 1.0
        return np.asarray(0.5 * (np.sqrt(1.0 + alpha**2 * tangent2) - 1.0))

    lit = (towards > 0.0) & (light[..., 2] > 0.0)
    masking = 1.0 / (1.0 + smith(np.array(eye[2])) + smith(light[..., 2]))
    weight = np.where(lit, masking * towards / (eye[2] * normals[..., 2]), 0.0)
    return float((weight if index is None else weight * fresnel(np.clip(towards, 0.0, 1.0), index)).mean())


@pytest.mark.parametrize("alpha", [0.04, 0.25, 1.0])
@pytest.mark.parametrize("index", [1.2, 1.5, 2.0])
def test_what_is_reflected_is_missing_below(alpha: float, index: float) -> None:
    """What facets lose to each other counts as if it were not lost."""
    f0 = ((index - 1.0) / (index + 1.0)) ** 2
    expected = [1.0 - reflected(alpha, angle, index) / reflected(alpha, angle, None) for angle in ANGLES]
    assert kept(row(alpha, f0, index, below=REST)) == pytest.approx(expected, abs=0.008)


@pytest.mark.parametrize("alpha", [0.25, 1.0])
def test_without_losses_both_layers_send_on_all_light(alpha: float) -> None:
    """Of a white surface: what the gloss reflects, by the factor that the picture shows, and what is left below it."""
    gloss = row(alpha, 0.04, 1.5, lossless=True, below=REST)
    gain = [seen(gloss, 0.0, a)[0] / seen(row(alpha, 0.04, 1.5), 0.0, a)[0] for a in ANGLES]
    once = [reflected(alpha, angle, 1.5) for angle in ANGLES]
    assert min(gain) > 1.0
    assert kept(gloss) + np.multiply(gain, once) == pytest.approx(np.ones(len(ANGLES)), abs=0.004)


@pytest.mark.parametrize("alpha", [0.25, 1.0])
def test_a_white_mirror_loses_nothing(alpha: float) -> None:
    for angle in ANGLES:
        gain = seen(row(alpha, 1.0, 0.0, lossless=True), 0.0, angle) / seen(row(alpha, 1.0, 0.0), 0.0, angle)
        assert gain * reflected(alpha, angle, None) == pytest.approx(np.ones(3), abs=0.01)


def test_a_coloured_mirror_deepens_its_colour() -> None:
    """What was reflected twice was coloured twice."""
    once, again = ([0.9, 0.5, 0.1, 0.0, 1.0, 1.0, 0.0, 0.0, lossless, *[0.0] * 5, 1.0, 0.0] for lossless in (0.0, 1.0))
    gain = seen(again, 0.0, 0.3) / seen(once, 0.0, 0.3)
    assert gain[0] > 1.2 * gain[1] > 1.2 * gain[2] > 1.2


def test_rows_without_layers_take_nothing() -> None:
    plain = row(0.25, 0.04, 1.5)
    assert kept(plain) == pytest.approx(np.ones(len(ANGLES)), rel=1e-5)
    assert (seen(plain, 0.5, 0.3) == seen(plain[:8], 0.5, 0.3)).all()


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_an_opaque_layer_leaves_the_rest_of_the_surface(share: float) -> None:
    """As a metal that is mixed with something else: one beside the other."""
    alone, coat = row(0.25, 0.6, 0.0), row(0.1, 0.04, 1.5, below=REST)
    for angle in ANGLES:
        both = seen([row(0.25, 0.6, 0.0, below=NOTHING, share=share), coat], 0.5, angle)
        expected = share * seen(alone, 0.0, angle) + (1.0 - share) * seen(coat, 0.5, angle)
        assert both == pytest.approx(expected, rel=1e-4)


def test_a_coat_dims_all_that_it_lies_over() -> None:
    coat, gloss = row(0.1, 0.04, 1.5, below=REST), row(0.3, 0.5, 0.0)
    for angle in ANGLES:
        left = kept(coat)[list(ANGLES).index(angle)]
        expected = seen(coat, 0.0, angle) + left * seen(gloss, 0.5, angle)
        assert seen([coat, gloss], 0.5, angle) == pytest.approx(expected, rel=2e-4)


def test_a_layer_takes_by_its_strongest_colour() -> None:
    tinted = row(0.25, 0.2, 1.8, below=REST)
    tinted[0], tinted[2] = 0.1, 0.02
    assert kept(tinted) == pytest.approx(kept(row(0.25, 0.2, 1.8, below=REST)), rel=1e-5)


def test_a_metal_dips_before_the_edge() -> None:
    """At 82 degrees a tinted metal reflects its tint times what Schlick's does, straight on and at the edge all of it."""
    tint, f0 = np.array([1.0, 0.6, 0.2]), 0.5
    before_edge = f0 + (1.0 - f0) * (6.0 / 7.0) ** 5
    plain = row(0.01, f0, 0.0)
    tinted = [*plain[:10], *(before_edge * (1.0 - tint)), *plain[13:]]
    for cosine, expected in ((1.0, np.ones(3)), (1.0 / 7.0, tint)):
        angle = float(np.arccos(cosine))
        ratio = seen(tinted, 0.0, angle, angle) / seen(plain, 0.0, angle, angle)
        assert ratio == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("alphas", [(0.3, 0.3), (0.5, 0.2)])
def test_beckmanns_facets(alphas: tuple[float, float]) -> None:
    """Beckmann and Spizzichino (1963) with Smith's masking, as Walter et al. (2007) fit it; brushed along the plane of
    light and eye, and turned by a quarter across it."""
    layer = row(0.3, 0.8, 0.0)
    layer[3], layer[4:6], layer[13] = 0.0, alphas, 1.0
    for angle, sun in ((0.9, 0.4), (0.3, 1.2), (1.3, 1.3)):
        eye, light = np.array([np.sin(angle), np.cos(angle)]), np.array([-np.sin(sun), np.cos(sun)])
        half = (eye + light) / np.linalg.norm(eye + light)
        expected = []
        for along in alphas:

            def hidden(d: Array, along: float = along) -> float:
                a = float(d[1] / (along * abs(d[0])))
                return (1.0 + 2.276 * a + 2.577 * a * a) / (3.535 * a + 2.181 * a * a) - 1.0 if a < 1.6 else 0.0

            density = np.exp(-((half[0] / half[1] / along) ** 2)) / (np.pi * alphas[0] * alphas[1] * half[1] ** 4)
            expected.append(0.8 * np.pi * density / (1.0 + hidden(eye) + hidden(light)) / (4.0 * eye[1]))
        found = [seen([*layer[:15], turn], 0.0, angle, sun)[0] for turn in (0.0, 0.25)]
        # Which is which hangs on the tangent, which a floor without one of its own does not fix.
        assert sorted(found) == pytest.approx(sorted(expected), rel=2e-3)


@pytest.mark.parametrize(
    "gloss, words",
    [
        (row(0.25, 0.04, 1.5)[:9], "(1, 9)"),
        ([row(0.25, 0.04, 1.5)] * 5, "5 lobes"),
        (row(0.25, 0.04, 0.5), "0.5 at flat index 7"),
        ([*row(0.25, 0.04, 1.5)[:8], 2.0, *row(0.25, 0.04, 1.5)[9:]], "2 at flat index 8"),
        ([*row(0.25, 0.04, 1.5, lossless=True)[:13], 1.0, 1.0, 0.0], "Beckmann"),
    ],
)
def test_what_is_refused(gloss: Layer | list[Layer], words: str) -> None:
    with pytest.raises(ValueError) as refusal:
        seen(gloss, 0.5, 0.0)
    assert "gloss" in str(refusal.value) and words in str(refusal.value)
