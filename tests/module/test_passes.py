# SPDX-License-Identifier: GPL-3.0-or-later
"""Frame.passes: what geometry and Beer and Lambert's law fix of a floor under a slab of smoke."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sfumato

DENSITY, THICKNESS = 0.4, 2.0
QUAD = sfumato.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], material=[0, 1])


def camera(half: float = 4.0) -> sfumato.Camera:
    """From a height of 10 straight down, orthographic, to 10 below the floor."""
    return sfumato.Camera(np.diag([1.0 / half, 1.0 / half, -0.1, 1.0]))


def scene(smoke: bool = True, albedo: float = 0.5) -> sfumato.Scene:
    """Two quads side by side, below a slab of smoke that takes light of each colour otherwise, in a sun from above."""
    out = sfumato.Scene()
    places = np.stack([np.eye(4), np.eye(4)])
    places[0, :3, 3], places[1, :3, 3] = (-2.0, 0.0, -1.0), (2.0, 0.0, -2.0)
    out.add_instances(QUAD, places, [[albedo] * 3] * 2, object_index=[3, 900], material_index=[7, 8])
    out.add_sun((0, 0, -1), (np.pi, np.pi, np.pi))
    if smoke:
        slab = np.eye(4)
        slab[:3, :3] *= 0.5
        slab[:3, 3] = (-8.0, -8.0, 0.0)
        cells = np.full((int(THICKNESS / 0.5), 32, 32), DENSITY, np.float32)
        out.add_medium(cells, slab, scattering=(0, 0, 0), absorption=(1.0, 0.5, 0.25))
    return out


def passes(of: sfumato.Scene, *names: str, **settings: Any) -> dict[str, Any]:
    """32 x 32 pixels: the middle row, through both quads."""
    frame = sfumato.Frame(of, coefficients=31, texels_per_cell=2.0, steps_per_cell=4.0)
    found = frame.passes(camera(), 32, 32, list(names), **settings)
    return {name: image[16] for name, image in found.items()}


def test_what_is_asked_for_is_there_and_no_more() -> None:
    assert set(passes(scene())) == {"picture"}
    found = passes(scene(), "normal", "smoke")
    assert {name: image.shape for name, image in found.items()} == {
        "picture": (32, 4), "normal": (32, 3), "smoke": (32, 4)}  # fmt: skip
    with pytest.raises(ValueError, match="names holds 'depth', but must be of 'position', 'normal'"):
        passes(scene(), "depth")


def test_the_picture_is_the_same_beside_any_passes() -> None:
    everything = ("position", "normal", "mist", "object_index", "material_index", "smoke", "smoke_shadow", "shadow")
    frame = sfumato.Frame(scene())
    picture = frame.render(camera(), 32, 32)
    assert np.array_equal(frame.passes(camera(), 32, 32, [])["picture"], picture)
    assert np.array_equal(frame.passes(camera(), 32, 32, [n for n in everything if n not in ("normal", "mist")])
                          ["picture"], picture)  # fmt: skip


def test_surfaces_are_where_and_what_they_are() -> None:
    found = passes(scene(), "position", "normal", "object_index", "material_index")
    left, right, nothing = 9, 22, 1  # pixels: of the first triangle of one quad, of the second of another
    for pixel, height, number, material in ((left, -1.0, 3.0, 7.0), (right, -2.0, 900.0, 8.0)):
        x = (pixel + 0.5) / 4.0 - 4.0
        assert np.allclose(found["position"][pixel], (x, 0.125, height, 1.0), atol=1e-5)
        assert np.allclose(found["normal"][pixel], (0.0, 0.0, 1.0), atol=1e-6)
        assert found["object_index"][pixel] == number
        assert found["material_index"][pixel] == material
    assert not any(found[name][nothing].any() for name in ("position", "normal", "object_index", "material_index"))


def test_mist_has_its_start_depth_and_power() -> None:
    for power in (0.5, 1.0, 2.0):
        found = passes(scene(), "mist", mist=(9.0, 5.0, power), eye=(0, 0, 10), axis=(0, 0, -1))["mist"][:, 0]
        assert np.allclose(found[[8, 24, 1]], ((11.0 - 9.0) / 5.0) ** power * np.array([1, 0, 0])
                           + ((12.0 - 9.0) / 5.0) ** power * np.array([0, 1, 0]) + np.array([0, 0, 1]), atol=1e-5)  # fmt: skip


def test_smoke_and_its_shadow_take_what_beer_and_lambert_say() -> None:
    found = passes(scene(), "smoke", "smoke_shadow", "shadow")
    left = np.exp(-DENSITY * THICKNESS * np.array([1.0, 0.5, 0.25]))
    for pixel in (8, 24):
        assert np.allclose(found["smoke"][pixel], (0.0, 0.0, 0.0, 1.0 - left.mean()), atol=2e-3)
        assert np.allclose(found["smoke_shadow"][pixel], left, atol=5e-3)
        assert np.allclose(found["shadow"][pixel], left, atol=5e-3)
    assert (found["smoke_shadow"][1] == 1.0).all(), "to multiply with"
    assert (found["shadow"][1] == 0.0).all(), "nothing is lit"
    bare = passes(scene(smoke=False), "smoke", "smoke_shadow")
    assert not bare["smoke"].any() and (bare["smoke_shadow"] == 1.0).all()


def test_black_surfaces_have_a_shadow_too() -> None:
    """Of what has no colour in one channel the others tell; of what has none at all, nothing."""
    dark = scene(albedo=0.0)
    assert (passes(dark, "smoke_shadow")["smoke_shadow"] == 1.0).all()


def test_what_is_refused() -> None:
    frame = sfumato.Frame(scene())
    with pytest.raises(ValueError, match="mist's depth is 0"):
        frame.passes(camera(), 4, 4, ["mist"], mist=(0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match="filter is 'tent'"):
        frame.passes(camera(), 4, 4, [], filter="tent")
    with pytest.raises(ValueError, match="object_index"):
        sfumato.Scene().add_instances(QUAD, np.eye(4), [[1, 1, 1]] * 2, object_index=[1, 2])
    with pytest.raises(ValueError, match="material_index holds -1"):
        sfumato.Scene().add_instances(QUAD, np.eye(4), [[1, 1, 1]] * 2, material_index=[1, -1])
