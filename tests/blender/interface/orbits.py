# SPDX-License-Identifier: GPL-3.0-or-later
"""The plume while a camera or its sun goes round it, beside EEVEE with 128 volumetric samples and volumetric shadows."""

from __future__ import annotations

import math
from collections.abc import Callable

import bpy
import harness
import numpy as np
import pictures
from mathutils import Matrix
from numpy.typing import NDArray

SIZE, FRAMES, STEP = (128, 72), 10, math.radians(0.05)
MOST = 0.25  # of EEVEE's
SUN = 0.29  # a known weakness: what it is when the sun goes round


def eevee() -> str:
    """One sample a pixel, as a view takes that moves; its volumes in as many steps as it has."""
    if bpy.app.version >= (4, 2):
        raise harness.Skip("measured beside the EEVEE of 3.4; from 4.2 on it is another one")
    settings = bpy.context.scene.eevee
    settings.volumetric_samples, settings.volumetric_shadow_samples = 128, 32
    settings.use_volumetric_lights = settings.use_volumetric_shadows = True
    settings.taa_render_samples = 1
    return "BLENDER_EEVEE"


def flicker(engine: str, turn: Callable[[Matrix], None]) -> float:
    """Over frames a twentieth of a degree apart each pixel of smoke changes evenly: the root mean square of what a
    parabola leaves of it, by the mean of the picture."""
    seen = []
    for number in range(FRAMES):
        turn(Matrix.Rotation(STEP * (number - FRAMES // 2), 4, "Z"))
        seen.append(pictures.render(SIZE, engine)[..., :3].astype(np.float64))
    values = np.array(seen).reshape(FRAMES, -1)
    powers = np.vander(np.linspace(-1.0, 1.0, FRAMES), 3)
    left: NDArray[np.float64] = values - powers @ np.linalg.lstsq(powers, values, rcond=None)[0]
    return float(np.sqrt((left**2).mean()) / values.mean())


def ratio(name: str) -> float:
    """Ours by EEVEE's, while that object goes round the plume."""
    harness.open_plume(25)
    rival = eevee()
    bpy.context.scene.render.resolution_percentage = 100
    for sharp in ("Block", "Ball", "Floor"):  # at edges, and at those of shadows, pixels do not change evenly
        bpy.context.scene.objects[sharp].hide_render = True
    thing = bpy.context.scene.objects[name]
    start = thing.matrix_world.copy()

    def turn(by: Matrix) -> None:
        thing.matrix_world = by @ start
        bpy.context.view_layer.update()

    ours, theirs = flicker("SFUMATO", turn), flicker(rival, turn)
    print(f"  {name}: {ours:.3%}, EEVEE {theirs:.3%}, {ours / theirs:.2f} of it", flush=True)
    assert ours > 0.0
    return ours / theirs


def test_a_camera_goes_round_the_plume() -> None:
    assert ratio("Camera") <= MOST


def test_a_sun_goes_round_the_plume() -> None:
    found = ratio("Sun")
    assert 0.8 * SUN < found < 1.2 * SUN, f"{found:.3g}, but known to be {SUN}, above {MOST}"


harness.main()
