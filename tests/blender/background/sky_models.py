# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Textures of worlds beside the Cycles of this very Blender: what the eye sees of each model, and the sun's light."""

import functools
import math
from typing import Any

import bpy
import harness
import numpy as np
import pictures
from numpy.typing import NDArray
from sfumato.export import world as export
from sfumato.export.shading import skies

SIZE = (64, 48)
COLUMNS = 1024


@functools.cache
def models() -> frozenset[str]:
    """Of this Blender."""
    return frozenset(item.identifier for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items)


def scattering() -> list[str]:
    return sorted({"NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"} & models())


def sky(model: str, **settings: Any) -> bpy.types.Node:
    """A world of one, the sun's disc left out."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_percentage = 100
    scene.sfumato.quality = "FINAL"
    scene.world = bpy.data.worlds.new("World")
    if hasattr(scene.world, "use_nodes") and not scene.world.use_nodes:
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    node = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(node.outputs[0], tree.nodes["Background"].inputs["Color"])
    node.sky_type = model
    for name, value in {"sun_disc": False, **settings}.items():
        if name == "dust_density" and not hasattr(node, name):
            name = "aerosol_density"
        setattr(node, name, value)
    return node


def look_around(case: str) -> float:
    """The largest error of views ahead, behind and down to the ground, in blocks: the horizon is as sharp as the picture
    that is made of the world."""
    camera = bpy.context.scene.camera
    camera.data.angle = 2.2
    errors = []
    for turn in ((1.9, 0.0, 0.4), (1.9, 0.0, 3.4), (1.2, 0.3, -1.2)):
        camera.rotation_euler = turn
        errors.append(pictures.error_beside_cycles(f"{case}, turned {turn[2]}", SIZE, 32, 4))
    return max(errors)


def test_skies_of_scattering_are_those_of_cycles() -> None:
    settings: dict[str, dict[str, float]] = {
        "dawn": {"sun_elevation": -0.035, "sun_rotation": 0.5},
        "low sun": {"sun_elevation": 0.04, "sun_rotation": 1.0},
        "mountains": {"sun_elevation": 0.5, "sun_rotation": 3.9, "altitude": 3000.0},
        "haze": {"sun_elevation": 0.5, "sun_rotation": 0.8, "dust_density": 5.0},
        "much of all": {"sun_elevation": 1.0, "air_density": 5.0, "dust_density": 2.0, "ozone_density": 6.0},
        "past the zenith": {"sun_elevation": 1.9, "sun_rotation": 5.0},
    }
    for model in scattering():
        for name, values in settings.items():
            sky(model, **values)
            error = look_around(f"{model}, {name}")
            assert error < 0.008, (model, name, error)


def test_preetham_is_that_of_cycles() -> None:
    for turbidity, sun in ((2.2, (0.5, 0.6, 0.7)), (6.0, (-0.6, 0.2, 0.1)), (4.0, (0.3, 0.9, -0.05))):
        sky("PREETHAM", turbidity=turbidity, sun_direction=sun)
        error = look_around(f"Preetham, turbidity {turbidity}")
        assert error < 0.005, (turbidity, error)


def test_hosek_wilkie_is_close_to_that_of_cycles() -> None:
    for turbidity, albedo, sun, most in (
        (2.2, 0.3, (0.5, 0.6, 0.7), 0.03),
        (3.0, 0.0, (-0.6, 0.2, 0.1), 0.03),
        (4.5, 1.0, (0.3, 0.9, 0.3), 0.03),
        (6.0, 0.3, (0.2, 0.1, 0.9), 0.08),
    ):
        sky("HOSEK_WILKIE", turbidity=turbidity, ground_albedo=albedo, sun_direction=sun)
        error = look_around(f"Hosek / Wilkie, turbidity {turbidity}, albedo {albedo}")
        assert error < most, (turbidity, albedo, error)


def test_what_is_shown_differently_is_named() -> None:
    for turbidity, shown in ((8.0, "8.0 is shown as 6"), (1.0, "1.0 is shown as 2")):
        sky("HOSEK_WILKIE", turbidity=turbidity)
        assert any(shown in said for said in harness.said()), harness.said()
    sky("HOSEK_WILKIE", sun_direction=(0.3, 0.9, -0.05))
    assert any("at the horizon or below" in said for said in harness.said()), harness.said()
    for model in (*scattering(), "PREETHAM", "HOSEK_WILKIE"):
        sky(model)
        assert not harness.said(), (model, harness.said())


def directions() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Those of a picture's texels, (n, 3), and their solid angles (n,)."""
    rows = COLUMNS // 2
    up = np.pi * ((np.arange(rows) + 0.5) / rows - 0.5)[:, None]
    around = 2.0 * np.pi * (np.arange(COLUMNS) + 0.5) / COLUMNS
    x, y = np.cos(up) * np.sin(around), np.cos(up) * np.cos(around)
    found = np.stack((x, y, np.broadcast_to(np.sin(up), x.shape)), axis=-1).reshape(-1, 3)
    return found, np.repeat(np.cos(up[:, 0]), COLUMNS) * (np.pi / rows) ** 2


def of_sun(node: bpy.types.Node) -> NDArray[np.float64]:
    """The irradiance (3,) of the disc that is drawn, across its rays."""
    towards, solid = directions()
    texel = 2.0 * np.pi / COLUMNS
    total = np.zeros(3)
    for sign, node.sun_disc in ((1.0, True), (-1.0, False)):
        shown = skies.Atmosphere.of(node).radiance(towards, texel)
        total += sign * (shown * solid[:, None]).sum(axis=0)
    return total


def of_sun_in_cycles(node: bpy.types.Node) -> NDArray[np.float64]:
    """The same, of a picture of the disc's surroundings."""
    scene, size = bpy.context.scene, 128
    data = scene.camera.data
    data.type = "PANO"
    pano = data if hasattr(data, "panorama_type") else data.cycles
    pano.panorama_type = "EQUIRECTANGULAR"
    scene.camera.rotation_euler = (0.5 * math.pi, 0.0, 0.0)
    half, sun = 0.6 * node.sun_size, node.sun_elevation
    aside = half / math.cos(sun)
    pano.latitude_min, pano.latitude_max = sun - half, sun + half
    pano.longitude_min, pano.longitude_max = -aside, aside
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    up = sun - half + 2.0 * half * (np.arange(size) + 0.5) / size
    solid = (np.cos(up) * 4.0 * half * aside / size**2)[:, None, None]
    shown = []
    for node.sun_disc in (True, False):
        shown.append(pictures.render((size, size), "CYCLES")[..., :3].astype(np.float64))
    # Where the disc is, there is nothing of the sky.
    inside = np.abs(shown[0] - shown[1]).sum(axis=2) > 0.0
    return (shown[0] * inside[..., None] * solid).sum(axis=(0, 1))


def test_the_sun_gives_the_light_of_its_disc() -> None:
    """In Cycles the disc takes the place of the sky behind it, which is too dark to matter."""
    for model in scattering():
        for elevation, size, altitude in (
            (1.2, 0.0095, 0.0),
            (0.3, 0.0095, 2500.0),
            (0.04, 0.02, 0.0),
            (0.0, 0.06, 0.0),
        ):
            node = sky(model, sun_elevation=elevation, sun_size=size, altitude=altitude, sun_intensity=0.7)
            ours, theirs = of_sun(node), of_sun_in_cycles(node)
            print(f"  {model}, {elevation}, {size}: {ours / np.maximum(theirs, 1e-9)}", flush=True)
            assert theirs[0] > 1.0, theirs
            assert np.abs(ours - theirs).max() < 0.012 * theirs.max(), (model, elevation, size, ours, theirs)


def test_a_floor_in_the_suns_light() -> None:
    for model in scattering():
        sky(model, sun_disc=True, sun_elevation=0.7, sun_rotation=1.0)
        bpy.ops.mesh.primitive_plane_add(size=4.0)
        harness.put(harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse"), Color=(0.6, 0.6, 0.6))
        bpy.context.scene.camera.location = (0.0, 0.0, 3.0)
        assert abs(pictures.beside_cycles(f"floor, {model}", (16, 16), 256) - 1.0) < 0.02


def test_a_sky_is_calculated_once() -> None:
    """The light's and the eye's, and not again when the sun is turned around or is brighter."""
    (model, *_) = scattering()
    node = sky(model, sun_elevation=0.6543)
    bpy.context.scene.camera.rotation_euler = (1.5, 0.0, 0.0)
    before = skies.picture.cache_info().misses
    pictures.render((8, 8))
    node.sun_rotation = 2.0
    node.sun_intensity = 0.5
    pictures.render((8, 8))
    assert skies.picture.cache_info().misses == before + 1


def test_suns_that_are_not_there() -> None:
    """A disc of no size, and one below the horizon."""
    towards, _ = directions()
    for model in scattering():
        for values in ({"sun_size": 0.0}, {"sun_elevation": -0.1}):
            node = sky(model, **values)
            shown = []
            for node.sun_disc in (False, True):
                shown.append(skies.Atmosphere.of(node).radiance(towards, 0.006))
            np.testing.assert_array_equal(*shown)


harness.main()
