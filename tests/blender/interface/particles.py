# SPDX-License-Identifier: GPL-3.0-or-later
"""Particles in the viewport: over Solid and Material Preview as in Rendered mode, at rest, moving, and with the frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import harness
import numpy as np
import screen
from mathutils import Quaternion
from sfumato import log, ui  # type: ignore[attr-defined]


def puffs(shading: str) -> tuple[Any, bpy.types.ParticleSettings]:
    """A few hundred puffs that fly up out of a plate, in a sun: the viewport, and their settings."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    harness.enable()
    cube = bpy.data.objects["Cube"]
    cube.scale = (0.5, 0.5, 0.05)
    settings = cube.modifiers.new("Puff", "PARTICLE_SYSTEM").particle_system.settings
    settings.count, settings.frame_end, settings.lifetime, settings.normal_factor = 300, 20, 100, 2.0
    settings.effector_weights.gravity = 0.0
    bpy.data.objects["Light"].data.type = "SUN"
    bpy.data.objects["Light"].data.energy = 3.0
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    for frame in range(1, 26):
        bpy.context.scene.frame_set(frame)
    space = screen.prepare(shading)
    view = space.region_3d
    view.view_perspective, view.view_distance, view.view_location = "PERSP", 7.0, (0.0, 0.0, 1.0)
    view.view_rotation = Quaternion((1.0, 0.0, 0.0), 1.3)
    return space, settings


def test_the_rendered_view_is_the_processors() -> Iterator[float | None]:
    puffs("RENDERED")
    bpy.context.scene.render.engine = "SFUMATO"
    with screen.watched() as seen:
        yield from screen.drawn(seen)
    expected = screen.processed()
    assert expected[..., :3].max() > 0.1
    screen.assert_same("particles, rendered", seen[-1][0][..., :3], expected[..., :3])


def test_overlays_show_them_and_leave_no_trace() -> Iterator[float | None]:
    for shading in ("SOLID", "MATERIAL"):
        _space, settings = puffs(shading)
        with screen.watched() as seen:
            yield from screen.settled(seen)  # by then Material Preview has compiled what it shows
            settings.sfumato.shown = False
            yield from screen.settled(seen)
            without = seen[-1][0]
            settings.sfumato.shown = True
            yield from screen.settled(seen)
            with_puffs = seen[-1][0]
            settings.sfumato.shown = False
            yield from screen.settled(seen)
        smoke = np.abs(with_puffs - without)[..., :3].max(axis=-1)
        print(f"  {shading}: {(smoke > 0.02).mean():.1%} of the view changes, {smoke.max():.2f} at most")
        assert 0.01 < (smoke > 0.02).mean() < 0.6
        top = slice(-len(smoke) // 20, None)
        assert smoke[top].max() < 5e-3, "above all puffs nothing changes"
        # In Material Preview Blender draws a line of its own while EEVEE samples: 3e-4 of the view.
        left = (np.abs(seen[-1][0] - without)[..., :3].max(axis=-1) > 0.02).mean()
        assert left == 0.0 if shading == "SOLID" else left < 1e-3, left
        assert not [line for line in log.notices() if line.startswith("Cube")], log.notices()


def test_they_follow_the_view_and_the_frame() -> Iterator[float | None]:
    space, _settings = puffs("SOLID")
    with screen.watched() as seen:
        yield from screen.drawn(seen)
        first = seen[-1][0]
        space.region_3d.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.4) @ space.region_3d.view_rotation
        seen.clear()
        while not seen:
            yield None
        moving = seen[-1][0]  # at a glance
        yield from screen.drawn(seen)
        still = seen[-1][0]
        assert np.abs(still - first).max() > 0.05
        away = np.abs(moving - still)[..., :3]
        print(f"  a glance is {np.sqrt((away**2).mean()):.4f} off")
        assert np.sqrt((away**2).mean()) < 0.03
        bpy.context.scene.frame_set(27)
        yield from screen.drawn(seen)
        assert np.abs(seen[-1][0] - still).max() > 0.05, "the particles move with the frame"


def test_their_panel_is_there_where_they_render_as_halo() -> None:
    _space, settings = puffs("SOLID")
    thing = bpy.data.objects["Cube"]
    bpy.context.view_layer.objects.active = thing
    system = thing.particle_systems[0]
    with bpy.context.temp_override(particle_system=system):
        for kind, there in (("HALO", True), ("OBJECT", False), ("NONE", False)):
            settings.render_type = kind
            assert ui.SfumatoParticlesPanel.poll(bpy.context) == there, kind
    assert (settings.sfumato.shown, settings.sfumato.anisotropy) == (True, 0.0)
    assert 0.0 < settings.sfumato.opacity < 1.0 and settings.sfumato.size >= 1.0


harness.main()
