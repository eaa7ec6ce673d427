# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent fragments without sorting: what their mathematics fixes, the targets that the benchmark measures, and the
rivals there."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import sfumato
import transparency_rivals as rivals
from bench_transparency import METHODS, MOST_BYTES, TARGETS, rmse, transmittance_errors
from fragments import SCENES, Pixels, draws, random_fragments

OURS = ("sfumato", "fourier", "weighted-blended")
# RMSE of colour x1000 that a text of another author's measurements gives for these draws, in the order of draws().
SAID = {
    "moments-4": (3.9, 34, 69),
    "moments-6": (4.0, 26, 57),
    "mlab-4": (0, 11.0, 18.2, 21, 1.2),
    "nearest-tail": (0.7, 6.8, 16.5, 25, 1.1),
}


@pytest.fixture(scope="module", name="drawn")
def all_draws() -> dict[str, Pixels]:
    return draws()


def error(name: str, pixels: Pixels) -> float:
    return 1e3 * rmse([METHODS[name].composite(pixels) - rivals.exact(pixels)])


@pytest.mark.parametrize("name", SAID)
def test_rivals_do_as_well_as_they_are_said_to(drawn: dict[str, Pixels], name: str) -> None:
    for (case, pixels), said in zip(drawn.items(), SAID[name]):
        assert error(name, pixels) == pytest.approx(said, rel=0.15, abs=0.1), case


@pytest.mark.parametrize("case", TARGETS)
def test_seeded_fragments_reach_their_targets(drawn: dict[str, Pixels], case: str) -> None:
    assert METHODS["sfumato"].bytes <= MOST_BYTES
    assert error("sfumato", drawn[case]) <= TARGETS[case]


@pytest.mark.parametrize("case", [case for case in SCENES if case != "hair"])  # which takes long to make
def test_scenes_are_better_than_with_any_rival_of_no_more_bytes(case: str) -> None:
    groups = [pixels.every(9) for pixels in SCENES[case]().pixels()]
    exact = [rivals.exact(pixels) for pixels in groups]

    def of(name: str) -> float:
        return rmse(METHODS[name].composite(pixels) - truth for pixels, truth in zip(groups, exact))

    for name, method in METHODS.items():
        if name != "sfumato" and method.bytes <= MOST_BYTES:
            assert of("sfumato") < of(name), name


@pytest.mark.parametrize("name", OURS)
def test_order_of_submission_does_not_matter(drawn: dict[str, Pixels], name: str) -> None:
    for pixels in drawn.values():
        first = METHODS[name].composite(pixels)
        for seed in range(4):
            order = np.argsort(np.random.default_rng(seed).random(pixels.depth.shape), axis=1)
            assert np.abs(METHODS[name].composite(pixels.taken(order)) - first).max() <= 1e-5


def test_a_few_fragments_are_exact() -> None:
    """As many as are kept, to the rounding of their opacities; of one, whatever its opacity, to that of optical depth."""
    for count in (1, 2, 3, 4):
        pixels = random_fragments(count)
        made = METHODS["sfumato"].composite(pixels)
        assert np.abs(made - rivals.exact(pixels)).max() <= (1.3e-5 if count == 1 else 0.003)
    # Opacities that eight bits of their root hold exactly.
    levels = np.random.default_rng(1).integers(1, 255, (2000, 4))
    pixels = Pixels(np.random.default_rng(2).random((2000, 4)), (levels / 255.0) ** 2, random_fragments(4).colour)
    assert np.abs(METHODS["sfumato"].composite(pixels) - rivals.exact(pixels)).max() <= 2e-5


def test_fragments_of_depths_that_are_stored_as_one_share_their_layer() -> None:
    """None is lost, and none is seen twice: five at one depth are one of their opacity together and their mean colour."""
    alpha, colour = np.full(5, 0.3), np.random.default_rng(3).random((5, 3))
    depth = 0.5 + np.arange(5) * 1e-9
    made = sfumato.composite_nearest(depth, alpha, colour)
    opacity = 1.0 - 0.7**5
    assert np.abs(made[:3] - opacity * colour.mean(0)).max() <= 2e-5
    assert made[3] == pytest.approx(opacity, abs=1.3e-5)
    # With others before and behind, more than there are layers.
    every = np.linspace(0.1, 0.9, 12)
    depths, alphas = np.concatenate((depth, every)), np.full(17, 0.2)
    pixels = Pixels(depths[None], alphas[None], np.ones((1, 17, 3)))
    assert np.abs(METHODS["sfumato"].composite(pixels) - (1.0 - 0.8**17)).max() <= 1.3e-5


def test_a_layer_of_several_fragments_hides_as_all_of_them() -> None:
    """Green, then five red ones at one depth, then blue: as when the red ones were one."""
    alpha = np.array([0.4, *[0.2] * 5, 0.7])
    depth, red = np.array([0.1, *[0.5] * 5, 0.9]), 1.0 - 0.8**5
    colour = np.array([(0, 1, 0), *[(1, 0, 0)] * 5, (0, 0, 1)], float)
    made = sfumato.composite_nearest(depth, alpha, colour)
    assert made[:3] == pytest.approx([0.6 * red, 0.4, 0.6 * (1.0 - red) * 0.7], abs=3e-3)


def test_a_fragment_does_not_hide_itself() -> None:
    """By a series alone; without taking its own part off, two fragments are off by .015."""
    pixels = random_fragments(2)
    made = sfumato.composite_nearest(pixels.depth, pixels.alpha, pixels.colour, nearest=0, harmonics=9)[:, :3]
    assert rmse([made - rivals.exact(pixels)]) <= 0.004


@pytest.mark.parametrize("nearest, harmonics", itertools.product((0, 1, 4, 8), (0, 1, 3, 31)))
def test_opacity_is_that_of_all_fragments(drawn: dict[str, Pixels], nearest: int, harmonics: int) -> None:
    for pixels in drawn.values():
        made = sfumato.composite_nearest(pixels.depth, pixels.alpha, pixels.colour, nearest, harmonics)
        assert np.abs(made[:, 3] - 1.0 + np.prod(1.0 - pixels.alpha, axis=1)).max() <= 1.3e-5
        white = sfumato.composite_nearest(pixels.depth, pixels.alpha, np.ones_like(pixels.colour), nearest, harmonics)
        assert np.abs(white[:, :3] - white[:, 3:]).max() <= 1e-5


def test_published_opacity_is_that_of_half_floats(drawn: dict[str, Pixels]) -> None:
    for pixels in drawn.values():
        made = sfumato.composite_fourier(pixels.depth, pixels.alpha, pixels.colour)
        assert np.abs(made[:, 3] - 1.0 + np.prod(1.0 - pixels.alpha, axis=1)).max() <= 2e-4


def test_what_is_no_fragment_changes_nothing() -> None:
    pixels = random_fragments(8)
    more = [np.concatenate((values, values[:, :3]), axis=1) for values in (pixels.depth, pixels.alpha, pixels.colour)]
    more[1][:, 8:] = 0.0
    for name in OURS:
        difference = METHODS[name].composite(Pixels(*more)) - METHODS[name].composite(pixels)
        assert np.abs(difference).max() <= 1e-6, name


def test_more_fragments_and_more_harmonics_are_nearer_the_truth(drawn: dict[str, Pixels]) -> None:
    def of(case: str, nearest: int, harmonics: int) -> float:
        pixels = drawn[case]
        made = sfumato.composite_nearest(pixels.depth, pixels.alpha, pixels.colour, nearest, harmonics)[:, :3]
        return rmse([made - rivals.exact(pixels)])

    for case in ("fragments-32", "smoke-64"):
        assert of(case, 8, 3) < of(case, 4, 3) < of(case, 2, 3) < of(case, 2, 1) < of(case, 0, 0)
        # A series alone still lacks a fragment's own part.
        plain = rmse([METHODS["fourier"].composite(drawn[case]) - rivals.exact(drawn[case])])
        assert of(case, 0, 3) < plain


def test_sigma_factors_are_lanczos() -> None:
    terms = 5
    made = sfumato.average_series(np.ones(2 * terms - 1), 2.0)
    k = np.repeat(np.arange(1, terms), 2)
    assert np.abs(made[1:] - np.sinc(k / terms) ** 2.0).max() <= 1e-6 and made[0] == 1.0
    assert np.array_equal(sfumato.average_series(made, 0.0), made)


def test_sigma_factors_ring_less_and_err_more() -> None:
    """In front of one opaque layer transmittance overshoots; on many fragments the plain series is nearer all the same."""
    depths = np.linspace(0.0, 1.0, 400)
    series = sfumato.project([0.5], [2.0], 15)
    rough = np.diff(sfumato.transmittance(series, depths))
    smooth = np.diff(sfumato.transmittance(sfumato.average_series(series), depths))
    assert np.maximum(smooth, 0.0).sum() < 0.2 * np.maximum(rough, 0.0).sum()
    for terms in (2, 4, 8, 16, 32):
        plain, averaged = (transmittance_errors(terms, sigma, random_fragments(8)) for sigma in (0.0, 1.0))
        assert all(one < other for one, other in zip(plain, averaged))
