# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke before a wide lamp: what it hides of each of the lamp's points counts by what that point would bring."""

from __future__ import annotations

import numpy as np
from sfumato import Camera, Frame, Mesh, Scene, reference


def test_a_wide_lamp_counts_by_the_cosine_at_the_floor() -> None:
    """Smoke close to a floor hides the steep light of a wide lamp, which brings most: what is lost of it, by the judge's."""
    cells = 24
    at = (np.arange(cells) + 0.5) / cells * 2.0 - 1.0
    square = sum(axis**2 for axis in np.meshgrid(at, at, at, indexing="ij"))
    place = np.diag([0.6 / cells] * 3 + [1.0])
    place[:3, 3] = -0.3, -0.3, 0.1

    def scene(smoke: bool) -> Scene:
        out = Scene()
        if smoke:
            density = 24.0 * np.clip(0.8 - square, 0.0, None)
            out.add_medium(density, place, scattering=(0.01,) * 3, absorption=(1.5,) * 3)
        out.add_area((0, 0, 1), (0.5, 0, 0), (0, 0.5, 0), (1, 1, 1))
        floor = Mesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]])
        out.add_instances(floor, np.eye(4), albedo=[[0.5, 0.5, 0.5]])
        return out

    # From between the floor and the smoke, straight down.
    view = np.diag([1.0 / 1.2, 1.0 / 1.2, -25.0, 1.0])
    view[2, 3] = 0.5
    camera = Camera(view)
    exact = reference.render(scene(True), camera, 9, 9, light_samples_per_axis=24)[..., 0]
    clear, seen = (
        Frame(scene(smoke), light_samples=64, texels_per_cell=4.0).render(camera, 9, 9, edge_samples=1)[..., 0]
        for smoke in (False, True)
    )
    lost = np.sqrt(np.mean((clear - exact) ** 2))
    assert lost > 0.3 * exact.mean()
    assert np.sqrt(np.mean((seen - exact) ** 2)) < 0.03 * lost  # .11 if all of the lamp's points count alike
