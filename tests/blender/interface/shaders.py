# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke as the GPU draws it is the picture of the CPU. It takes no window: tests/official runs it where Blender can
draw without one."""

from __future__ import annotations

from typing import Any

import harness
import numpy as np
import screen
import sfumato
from mathutils import Matrix
from numpy.typing import ArrayLike
from screen import assert_same
from sfumato.view import painter

SIZE = (320, 180)


def synthetic_frame(coloured: bool, lamps: bool = False, smoke: bool = True, fire: bool = False) -> Any:
    """Two puffs of noise, with clear air between, in front of the sky and over a floor; a table stands in the upper.
    With lamps, a wide sun, a spot and an area light too, and a second body of smoke that overlaps the first. With fire
    the first glows, and its glow reaches beyond its smoke."""
    noise = np.random.default_rng(7).random((20, 24, 28), dtype=np.float32)
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in noise.shape), indexing="ij")
    puffs = [np.sqrt((x - s * 0.6) ** 2 + (y - s * 0.6) ** 2 + (z - s * 0.5) ** 2) for s in (-1.0, 1.0)]
    density = 2.0 * np.maximum(0.0, 0.45 - np.minimum(*puffs)) * noise
    grid_to_world = np.diag([0.1, 0.1, 0.12, 1.0])
    grid_to_world[:3, 3] = -1.4, -1.2, 0.2
    made = sfumato.Scene()
    scattering = (8.0, 12.0, 18.0) if coloured else (12.0, 12.0, 12.0)
    if smoke:
        # The first body has a colour of its own in every cell, where there is a second beside it, which is white.
        own = np.stack((x, y, z), axis=3) * 0.5 + 0.5 if lamps else None
        glow = np.clip(1.8 - 3.0 * puffs[0], 0.0, 1.0) * noise[::-1] if fire else None
        rows = np.linspace(0.0, 1.0, 128)[:, None] ** np.array([2.0, 3.0, 4.0]) * (20.0, 30.0, 40.0) if fire else None
        made.add_medium(density, grid_to_world, scattering, (1.0, 1.0, 1.0), 0.4, colour=own, glow=glow, emission=rows)
    made.add_sun((0.5, 0.3, -1.0), (8.0, 7.0, 6.0))
    made.set_background((0.3, 0.4, 0.6))
    walls: tuple[tuple[ArrayLike, tuple[int, int, int]], ...] = (
        ([(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], (0, 0, 1)),
        ([(0, 0, 1.9), (1.4, 0, 1.9), (1.4, 1.2, 1.9), (0, 1.2, 1.9)], (0, 0, 1)),
    )
    for corners, normal in walls:
        made.add_mesh(corners, [(0, 1, 2), (0, 2, 3)], [[normal] * 3] * 2, [0, 0], [(0.7, 0.6, 0.5)])
    if lamps:
        made.add_sun((-0.2, 0.6, -1.0), (2.0, 2.0, 3.0), angle=0.3)
        made.add_point((1.5, -1.0, 3.0), (9.0, 5.0, 3.0), direction=(-0.4, 0.4, -1.0), cone=1.0, blend=0.4)
        made.add_area((-2.0, 0.5, 2.5), (0.4, 0.0, 0.4), (0.0, 0.5, 0.0), (6.0, 8.0, 9.0), spread=2.5)
        grid_to_world[:3, 3] = 0.2, -0.2, 1.4
        made.add_medium(density[::2, ::-1], grid_to_world, scattering, absorption=(1.0, 1.0, 1.0))
    return sfumato.Frame(made, coefficients=15, light_samples=4)


def ramped_frame(coloured: bool, beside: bool) -> Any:
    """A ball under a transfer function of narrow peaks and an edge, which scatters and glows in colours of its own, and,
    with `beside`, plain smoke that overlaps it and glows too."""
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in (20, 24, 28)), indexing="ij")
    density = np.maximum(0.0, 1.0 - x**2 - y**2 - z**2) * (1.0 + 0.3 * np.sin(5.0 * x + 1.0) * np.cos(4.0 * y))
    stops = np.array([0.0, 0.17, 0.2, 0.23, 0.57, 0.6, 0.63, 0.8, 0.801, 1.2])
    extinction = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.2, 0.2])
    colour = 0.5 + 0.5 * np.sin(np.multiply.outer(stops, (9.0, 5.0, 3.0)))
    matrix = np.diag([0.1, 0.1, 0.12, 1.0])
    matrix[:3, 3] = -1.4, -1.2, 0.2
    scattering, absorption = ((4.0, 6.0, 9.0) if coloured else (6.0,) * 3), (1.0,) * 3
    made = sfumato.Scene()
    made.add_medium(
        density,
        matrix,
        scattering,
        absorption,
        0.4,
        transfer=sfumato.TransferFunction(stops, extinction, colour, associated=False),
        radiated=sfumato.TransferFunction(stops, 0.0 * stops, 2.0 * extinction[:, None] * colour[:, ::-1]),
    )
    if beside:
        matrix[:3, 3] = -0.2, -0.8, 1.0
        rows = np.array([(0.0, 0.0, 0.0), (1.0, 2.0, 3.0)])
        made.add_medium(density[:, ::-1], matrix, scattering, absorption, glow=np.minimum(density, 1.0), emission=rows)
    made.add_sun((0.5, 0.3, -1.0), (8.0, 7.0, 6.0))
    made.add_point((1.5, -1.0, 3.0), (9.0, 5.0, 3.0))
    made.set_background((0.3, 0.4, 0.6))
    return sfumato.Frame(made, light_samples=2, steps_per_cell=0.8)  # the steps of glance()


def look(perspective: bool, **kind: bool) -> painter.Look:
    """From beside the cloud, with floor and sky in the picture."""
    near, far = 0.1, 50.0
    if perspective:
        projection = Matrix(((1.5, 0, 0, 0), (0, 2.7, 0, 0),
                             (0, 0, (far + near) / (near - far), 2 * far * near / (near - far)), (0, 0, -1, 0)))  # fmt: skip
    else:
        projection = Matrix.Diagonal((0.3, 0.55, 2.0 / (near - far), 1.0))
        projection[2][3] = (far + near) / (near - far)
    eye = Matrix.Translation((3.0, -4.5, 3.0)) @ Matrix.Rotation(0.6, 4, "Z") @ Matrix.Rotation(1.3, 4, "X")
    values = tuple(value for row in projection @ eye.inverted() for value in row)
    return painter.Look(values, SIZE, **kind)


def test_gpu_and_cpu_make_the_same_picture() -> None:
    cases = ((False, False), (True, False), (False, True), (True, True))
    for coloured, lamps, fire in (*((*case, False) for case in cases), *((*case, True) for case in cases)):
        frame = synthetic_frame(coloured, lamps, fire=fire)
        for perspective in (True, False):
            seen = look(perspective)
            cpu = frame.render(sfumato.Camera(np.reshape(seen.matrix, (4, 4))), *SIZE, edge_samples=1)
            picture = painter.Painter().picture("test", frame, seen)
            gpu = screen.read(picture.buffer, 0, SIZE)
            assert (cpu[..., 3] < 1.0).any() and (cpu[..., 3] == 1.0).any(), "the picture lacks sky or floor"
            name = f"{'coloured' if coloured else 'grey'}{', lamps' if lamps else ''}{', fire' if fire else ''}, "
            name += "perspective" if perspective else "orthographic"
            assert_same(name, gpu, cpu)


def test_smoke_under_transfer_functions_is_the_same_picture() -> None:
    for coloured, beside in ((False, False), (True, False), (False, True)):
        frame = ramped_frame(coloured, beside)
        seen = look(not beside)
        cpu = frame.glance(sfumato.Camera(np.reshape(seen.matrix, (4, 4))), *SIZE, spacing=1)
        picture = painter.Painter().picture("test", frame, seen)
        gpu = screen.read(picture.buffer, 0, SIZE)
        assert np.ptp(cpu[..., 2]) > 0.05, "there is no smoke"
        assert_same(f"ramps, {'coloured' if coloured else 'grey'}{', beside others' if beside else ''}", gpu, cpu)


def test_overlay_is_the_picture_taken_apart() -> None:
    """Transmittance times the surfaces, plus radiance, is the picture again: where the sun alone lights a surface, the
    overlay's share of shadow is all of it."""
    for coloured in (False, True):
        frame = synthetic_frame(coloured)
        seen = look(True, overlay=True, solids_shade=True)
        camera = sfumato.Camera(np.reshape(seen.matrix, (4, 4)))
        picture = painter.Painter().picture("test", frame, seen)
        radiance, transmittance = (screen.read(picture.buffer, slot, SIZE) for slot in (0, 1))
        surfaces = synthetic_frame(coloured, smoke=False).surfaces(camera, *SIZE)
        cpu = frame.render(camera, *SIZE, edge_samples=1)
        sky = transmittance[..., 3] == 0.0
        rebuilt = radiance[..., :3] + transmittance[..., :3] * surfaces[..., :3]
        assert_same("before the sky", rebuilt[sky], cpu[..., :3][sky])
        # A surface keeps the light that is not the sun's.
        assert (rebuilt[~sky] >= cpu[..., :3][~sky] - 4e-3).all()
        assert (rebuilt[~sky] > cpu[..., :3][~sky] + 0.05).any()


harness.main()
