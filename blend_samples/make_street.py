# SPDX-License-Identifier: GPL-3.0-or-later
"""Write street.blend, street_sky.exr and frames/mist.vdb: a street of brick houses in the morning's ground fog, in the light
of a sky that is painted here, with a tree and a hedge of leaves cut out by their alpha, chrome bollards, and steam from a
manhole.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_street.py
It needs pyopenvdb (Debian: python3-openvdb). The steam is plume_cache/data/fluid_data_0025.vdb, which make.py bakes.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pyopenvdb
from mathutils import Vector
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # the materials and settings that the samples share
import street_pictures as pictures  # noqa: E402
from make_frames import FRAMES  # noqa: E402
from make_room import block, plain  # noqa: E402
from make_textures import Graph, image  # noqa: E402

Array = NDArray[np.float64]

LEFT, RIGHT, KERB = -3.2, 3.0, 0.14  # of the road, and how high its pavements are; metres
FACADE = -5.6  # where the houses on the left begin
SUN = Vector((0.62, 0.60, 0.50)).normalized()  # towards it
SKY = "street_sky.exr"
SEED = 7


def sky() -> None:
    """Into a file of half floats, and around the scene."""
    rgb = pictures.sky(SUN, SEED)
    height, width = rgb.shape[:2]
    painted = bpy.data.images.new("Painted", width, height, float_buffer=True)
    painted.pixels.foreach_set(np.concatenate((rgb, np.ones((height, width, 1))), axis=2).astype(np.float32).ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "16"
    settings.exr_codec = "DWAA"
    painted.save_render(str(HERE / SKY))
    bpy.data.images.remove(painted)
    world = bpy.context.scene.world
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(HERE / SKY))
    texture.image.filepath = f"//{SKY}"
    world.node_tree.links.new(texture.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0


def slabs() -> bpy.types.Material:
    """Paving stones by two images, of their colour and of their height."""
    rgb, high = pictures.slabs(SEED)
    graph = Graph("Slabs")
    where = graph.scaled("Object", 0.4)
    for name, values, into in (("Slabs", rgb, "Base Color"), ("Slabs' Height", high, None)):
        texture = graph.node("TexImage", {"Vector": where})
        texture.image = image(name, np.concatenate((values, np.ones((*values.shape[:2], 1))), axis=2))
        if into:
            graph.into(into, texture.outputs["Color"])
            continue
        texture.image.colorspace_settings.name = "Non-Color"
        bump = graph.node("Bump", {"Height": texture.outputs["Color"], "Distance": 0.02})
        graph.into("Normal", bump.outputs[0])
    graph.shader.inputs["Specular"].default_value = 0.0
    return graph.material


def asphalt() -> bpy.types.Material:
    graph = Graph("Asphalt")
    fine = graph.node("TexNoise", {"Vector": graph.scaled("Object", 1.0), "Scale": 40.0, "Detail": 3.0})
    wide = graph.node("TexNoise", {"Vector": graph.scaled("Object", 1.0), "Scale": 0.5, "Detail": 3.0})
    tone = graph.ramp(wide.outputs[0], (0.35, (0.085, 0.085, 0.09)), (0.65, (0.16, 0.155, 0.15)))
    mixed = graph.node("MixRGB", {"Color1": tone, "Color2": fine.outputs["Color"], "Fac": 0.35}, blend_type="MULTIPLY")
    graph.into("Base Color", mixed.outputs[0])
    bump = graph.node("Bump", {"Height": fine.outputs[0], "Distance": 0.01})
    graph.into("Normal", bump.outputs[0])
    graph.shader.inputs["Specular"].default_value = 0.0
    return graph.material


def bricks(name: str, first: make.Colour, second: make.Colour, mortar: make.Colour) -> bpy.types.Material:
    """On walls along x and y: rows of their z."""
    graph = Graph(name)
    split = graph.node("SeparateXYZ", {"Vector": graph.node("TexCoord").outputs["Object"]})
    along = graph.node("Math", {0: split.outputs["X"], 1: split.outputs["Y"]}, operation="ADD")
    where = graph.node("CombineXYZ", {"X": along.outputs[0], "Y": split.outputs["Z"]})
    brick = graph.node("TexBrick", {"Vector": where.outputs[0], "Color1": (*first, 1.0), "Color2": (*second, 1.0),
                                    "Mortar": (*mortar, 1.0), "Scale": 2.2, "Mortar Size": 0.012})  # fmt: skip
    stains = graph.node("TexNoise", {"Vector": where.outputs[0], "Scale": 0.9, "Detail": 4.0})
    mixed = graph.node("MixRGB", {"Color1": brick.outputs["Color"], "Color2": stains.outputs["Color"], "Fac": 0.4},
                       blend_type="MULTIPLY")  # fmt: skip
    graph.into("Base Color", mixed.outputs[0])
    height = graph.node("Math", {0: 1.0, 1: brick.outputs["Fac"]}, operation="SUBTRACT")
    graph.into("Normal", graph.node("Bump", {"Height": height.outputs[0], "Distance": 0.02}).outputs[0])
    graph.shader.inputs["Specular"].default_value = 0.0
    return graph.material


def spray() -> bpy.types.Material:
    """A twig with leaves on a card, of which alpha keeps no more; light comes through them."""
    graph = Graph("Spray")
    graph.tree.nodes.remove(graph.shader)
    texture = graph.node("TexImage", extension="CLIP")
    texture.image = image("Spray", pictures.spray())
    matt = graph.node("BsdfDiffuse", {"Color": texture.outputs["Color"]})
    through = graph.node("BsdfTranslucent", {"Color": texture.outputs["Color"]})
    leaf_shader = graph.node("MixShader", {"Fac": 0.4, 1: matt.outputs[0], 2: through.outputs[0]})
    clear = graph.node("BsdfTransparent")
    cut = graph.node("MixShader", {"Fac": texture.outputs["Alpha"], 1: clear.outputs[0], 2: leaf_shader.outputs[0]})
    graph.tree.links.new(cut.outputs[0], graph.tree.nodes["Material Output"].inputs["Surface"])
    return graph.material


def leaves(name: str, places: Array, normals: Array, size: float, material: bpy.types.Material) -> None:
    """A card for each place (n, 3): instances on the small faces of a mesh, which itself does not show."""
    rng = np.random.default_rng(SEED)
    aside = np.cross(normals, rng.normal(size=normals.shape))
    aside /= np.linalg.norm(aside, axis=1)[:, None]
    other = np.cross(normals, aside)
    corners = places[:, None] + 0.01 * np.stack((-aside - other, aside - other, aside + other, other - aside), axis=1)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners.reshape(-1, 3).tolist(), [], np.arange(4 * len(places)).reshape(-1, 4).tolist())
    parent = make.add(name, mesh, (0.0, 0.0, 0.0), Vector((0.0, 0.0, 0.0)))
    parent.instance_type, parent.show_instancer_for_render = "FACES", False
    parent.show_instancer_for_viewport = False
    bpy.ops.mesh.primitive_plane_add(size=size)
    card = make.named(f"{name} Card")
    card.data.materials.append(material)
    card.parent = parent


def cloud_of(rng: np.random.Generator, middle: make.Colour, radii: make.Colour, count: int) -> tuple[Array, Array]:
    """Places in the outer part of an ellipsoid, and ways to face, outwards by and large."""
    away = rng.normal(size=(count, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    places = np.array(middle) + np.array(radii) * away * (0.55 + 0.45 * rng.random((count, 1)))
    facing = away + 0.8 * rng.normal(size=(count, 3))
    return places, facing / np.linalg.norm(facing, axis=1)[:, None]


def limb(name: str, start: make.Colour, end: make.Colour, radius: float, material: bpy.types.Material) -> None:
    a, b = Vector(start), Vector(end)
    bpy.ops.mesh.primitive_cone_add(vertices=16, radius1=radius, radius2=0.55 * radius, depth=(b - a).length,
                                    location=(a + b) / 2.0, rotation=(b - a).to_track_quat("Z", "Y").to_euler())  # fmt: skip
    bpy.ops.object.shade_smooth()
    make.named(name).data.materials.append(material)


def green() -> None:
    rng = np.random.default_rng(SEED)
    bark, card = make.material("Bark", (0.13, 0.09, 0.06)), spray()
    limb("Trunk", (4.3, 8.0, 0.0), (4.2, 8.1, 2.9), 0.2, bark)
    crowns: list[tuple[make.Colour, make.Colour, int]] = [
        ((4.1, 8.2, 4.4), (1.7, 1.7, 1.3), 210),
        ((3.0, 7.5, 3.7), (1.1, 1.1, 0.8), 80),
        ((5.3, 8.6, 3.8), (1.2, 1.2, 0.9), 90),
        ((4.4, 8.3, 5.7), (1.1, 1.1, 0.8), 80),
    ]
    for number, (middle, _, _) in enumerate(crowns):
        limb(f"Limb {number + 1}", (4.2, 8.1, 2.7), middle, 0.1, bark)
    parts = [cloud_of(rng, *crown) for crown in crowns]
    places, facing = (np.concatenate(each) for each in zip(*parts))
    leaves("Crown", places, facing, 1.0, card)
    count = 420
    places = np.array((5.6, -1.0, 0.2)) + np.array((0.8, 13.0, 1.1)) * rng.random((count, 3))
    side = rng.integers(0, 2, count) == 0
    places[side, 0] = 5.6 + 0.15 * rng.random(side.sum())
    places[~side, 2] = 1.2 + 0.15 * rng.random((~side).sum())
    facing = np.where(side[:, None], (-1.0, 0.0, 0.2), (0.0, 0.0, 1.0)) + 0.5 * rng.normal(size=(count, 3))
    leaves("Hedge", places, facing / np.linalg.norm(facing, axis=1)[:, None], 0.6, card)
    block("Hedge Inside", (5.8, -1.0, 0.0), (6.4, 12.0, 1.15), make.material("Twigs", (0.03, 0.04, 0.015)))


def house(name: str, y: float, length: float, floors: int, wall: bpy.types.Material, trim: Any, pane: Any) -> None:
    """On the left: a wall, windows with their sills and lintels, a door, and a cornice."""
    high = 3.2 * floors + 0.6
    block(name, (FACADE - 5.0, y, 0.0), (FACADE, y + length, high), wall)
    block(f"{name} Cornice", (FACADE - 5.0, y, high), (FACADE + 0.3, y + length, high + 0.35), trim)
    block(f"{name} Base", (FACADE, y, 0.0), (FACADE + 0.06, y + length, 0.55), trim)
    columns = max(int(length / 2.4), 1)
    for floor in range(floors):
        for column in range(columns):
            middle, low = y + length * (column + 0.5) / columns, 3.2 * floor + 1.1
            door = floor == 0 and column == columns - 1
            low, top, half = (KERB, 2.6, 0.55) if door else (low, low + 1.7, 0.5)
            each = f"{name} {floor + 1}.{column + 1}"
            for part, (a, b, c, d, out, look) in {
                "Pane": (middle - half, middle + half, low, top, 0.02, trim if door else pane),
                "Left": (middle - half - 0.09, middle - half, low, top, 0.1, trim),
                "Right": (middle + half, middle + half + 0.09, low, top, 0.1, trim),
                "Lintel": (middle - half - 0.15, middle + half + 0.15, top, top + 0.2, 0.13, trim),
                "Sill": (middle - half - 0.15, middle + half + 0.15, low - 0.1, low, 0.2, trim),
                "Bar": (middle - 0.03, middle + 0.03, low, top, 0.05, trim),
            }.items():
                block(f"{each} {part}", (FACADE - 0.02, a, c), (FACADE + out, b, d), look)


def street() -> None:
    paving, stone = slabs(), make.material("Stone", (0.52, 0.49, 0.44))
    bpy.ops.mesh.primitive_plane_add(size=160.0)
    make.named("Road").data.materials.append(asphalt())
    for name, low, high in (("Left", FACADE - 0.5, LEFT), ("Right", RIGHT, 7.5)):
        block(f"{name} Pavement", (low, -12.0, -0.1), (high, 60.0, KERB), paving)
    for name, low in (("Left", LEFT), ("Right", RIGHT - 0.18)):
        block(f"{name} Kerb", (low, -12.0, -0.1), (low + 0.18, 60.0, KERB + 0.005), stone)
    pane = plain("Pane", (0.02, 0.025, 0.03), 0.08)
    red = bricks("Red Bricks", (0.42, 0.14, 0.09), (0.3, 0.09, 0.06), (0.5, 0.46, 0.4))
    ochre = bricks("Ochre Bricks", (0.62, 0.45, 0.26), (0.52, 0.36, 0.2), (0.6, 0.56, 0.48))
    grey = bricks("Grey Bricks", (0.46, 0.45, 0.44), (0.36, 0.36, 0.37), (0.6, 0.58, 0.55))
    house("First House", -8.0, 10.0, 3, ochre, stone, pane)
    house("Second House", 2.0, 8.0, 3, red, make.material("White", (0.72, 0.7, 0.66)), pane)
    house("Third House", 10.0, 9.6, 2, grey, stone, pane)
    house("Fourth House", 19.6, 12.0, 4, ochre, stone, pane)
    block("Across", (7.5, 20.0, 0.0), (13.0, 45.0, 5.0), red)
    block("End", (-12.0, 52.0, 0.0), (14.0, 56.0, 7.0), grey)


def things() -> None:
    chrome = plain("Chrome", (0.92, 0.92, 0.93), 0.15, 1.0)
    for number in range(5):
        x, y = RIGHT + 0.42, 0.4 + 2.3 * number
        bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.1, depth=0.85, location=(x, y, KERB + 0.42))
        bpy.ops.object.shade_smooth(use_auto_smooth=True)
        make.named(f"Bollard {number + 1}").data.materials.append(chrome)
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.2, location=(x, y, KERB + 0.98))
        bpy.ops.object.shade_smooth()
        make.named(f"Ball {number + 1}").data.materials.append(chrome)
    iron = plain("Iron", (0.04, 0.04, 0.045), 0.5, 1.0)
    bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.42, depth=0.02, location=(-1.5, 5.2, 0.01))
    make.named("Manhole").data.materials.append(iron)


def steam() -> None:
    data = bpy.data.volumes.new("Steam")
    data.filepath = "//plume_cache/data/fluid_data_0025.vdb"
    made = make.smoke_material()
    volume = made.node_tree.nodes["Principled Volume"]
    volume.inputs["Color"].default_value = (0.97, 0.97, 0.97, 1.0)
    volume.inputs["Density"].default_value = 8.0
    volume.inputs["Anisotropy"].default_value = 0.0
    data.materials.append(made)
    cloud = make.add("Steam", data, (-2.9, 3.8, -0.1), Vector((0.0, 0.0, 0.0)))
    cloud.scale = (1.0, 1.0, 1.0)


def mist() -> None:
    """Patches of ground fog, thicker down the street, in a file of cells that are longer than they are high."""
    rng = np.random.default_rng(SEED)
    cells, low, high = (16, 56, 10), np.array((FACADE, 4.0, -0.2)), np.array((7.4, 56.0, 2.8))
    x, y, z = (a + (b - a) * (np.arange(n) + 0.5) / n for a, b, n in zip(low, high, cells))
    patches = pictures.noise(rng, cells[0], cells[1], 8, 3)[..., None]
    curls = np.stack([np.roll(patches[..., 0], k, axis=1) for k in range(cells[2])], axis=2)
    above = np.maximum(z, 0.0)
    ground = np.clip(2.2 * curls - 0.55, 0.0, None) * np.exp(-above / 0.7)
    far = np.clip((y - 4.0) / 30.0, 0.0, 1.0)[None, :, None]
    ends = np.clip((high[2] - z) / 1.5, 0.0, 1.0)
    density = far * (2.0 * ground + 0.5) * ends + 0.0 * x[:, None, None]
    grid = pyopenvdb.FloatGrid(0.0)
    grid.name, grid.saveFloatAsHalf = "density", True
    grid.copyFromArray(density.astype(np.float32), tolerance=0.002)
    FRAMES.mkdir(exist_ok=True)
    pyopenvdb.write(str(FRAMES / "mist.vdb"), grids=[grid])
    data = bpy.data.volumes.new("Mist")
    data.filepath = "//frames/mist.vdb"
    made = make.smoke_material()
    volume = made.node_tree.nodes["Principled Volume"]
    made.name, volume.inputs["Density"].default_value = "Mist", 0.04
    volume.inputs["Color"].default_value = (0.95, 0.95, 0.95, 1.0)
    volume.inputs["Anisotropy"].default_value = 0.0
    data.materials.append(made)
    step = (high - low) / cells
    make.add("Mist", data, tuple(low + 0.5 * step), Vector((0.0, 0.0, 0.0))).scale = step


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    street()
    green()
    things()
    steam()
    mist()
    make.look_at(Vector((-0.9, 9.0, 2.3)), Vector((1.3, -4.6, 1.65)), 27.0)
    sky()
    make.output()
    scene = bpy.context.scene
    scene.sfumato.bounced_light = True
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 4, 2, 2
    scene.cycles.caustics_reflective = False  # specks of the sun by way of the chrome
    scene.view_settings.view_transform, scene.view_settings.look = "Filmic", "Medium High Contrast"
    scene.view_settings.exposure = 0.6
    scene.frame_end = 1
    scene.render.filepath = "//out/street"
    make.save("street")


if __name__ == "__main__":
    main()
