# SPDX-License-Identifier: GPL-3.0-or-later
"""Write fire.blend: a small Mantaflow fire with its smoke, which alone lights a floor and a wall, and its cache beside it.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_fire.py
It needs pyopenvdb (Debian: python3-openvdb) and takes about half a minute.
"""

from __future__ import annotations

import math
import shutil
import sys
from pathlib import Path

import bpy
import pyopenvdb
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from make import add, material, named, save  # noqa: E402

CACHE = HERE / "fire_cache"
STILL_FRAME = 16
# What is shown of each frame; the settings' temperature is made of the flame, a file's own is another.
GRIDS = ("density", "flame", "temperature")


def fire_material() -> bpy.types.Material:
    """Grey smoke, and what burns as a black body of 1000 K times the temperature in the grid, made brighter by its tint:
    so a fire of a metre lights a room as a lamp of a hundred watts does."""
    made = bpy.data.materials.new("Fire")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Color"].default_value = (0.7, 0.7, 0.7, 1.0)
    volume.inputs["Density"].default_value = 20.0
    volume.inputs["Blackbody Intensity"].default_value = 1.0
    volume.inputs["Blackbody Tint"].default_value = (30.0, 30.0, 30.0, 1.0)
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
    return made


def fire(folder: Path, last_frame: int, resolution: int) -> bpy.types.Object:
    """A domain of two metres with a burning ball in it, not baked yet. Returns the domain."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 1.0), scale=(1.0, 1.0, 2.0))
    bpy.ops.object.transform_apply(location=False, rotation=False)
    domain = named("Fire Domain")
    domain.data.materials.append(fire_material())
    modifier = domain.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type = "GAS"
    settings.resolution_max = resolution
    settings.use_adaptive_domain = False
    settings.alpha, settings.beta, settings.vorticity = 0.5, 1.5, 0.3
    settings.burning_rate, settings.flame_smoke = 1.5, 2.0
    settings.display_thickness = 0.001  # Solid mode's own smoke would show through Sfumato's
    settings.cache_directory = str(folder)
    settings.cache_type, settings.cache_data_format, settings.openvdb_data_depth = "ALL", "OPENVDB", "16"
    settings.cache_frame_start, settings.cache_frame_end = 1, last_frame

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.16, location=(0.0, 0.0, 0.22))
    emitter = named("Burner")
    flow = emitter.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "FIRE", "INFLOW"
    flow.flow_settings.fuel_amount = 0.7
    emitter.hide_render = True
    return domain


def bake(domain: bpy.types.Object, folder: Path) -> None:
    """Run the simulation."""
    for _ in range(2):
        try:
            bpy.context.view_layer.update()
        except SystemError:  # of Mantaflow's first evaluation in Blender 3.4
            continue
    with bpy.context.temp_override(object=domain, active_object=domain):
        bpy.ops.fluid.bake_all()
    if not list((folder / "data").glob("fluid_data_*.vdb")):
        raise RuntimeError(f"the bake wrote no frames into {folder}")


def keep_what_is_shown(folder: Path, first_frame: int, names: tuple[str, ...] = GRIDS) -> None:
    """Of the frames from one on, the grids that are read; nothing of the others."""
    for path in sorted((folder / "data").glob("fluid_data_*.vdb")):
        if int(path.stem.rsplit("_", 1)[1]) < first_frame:
            path.unlink()
            continue
        grids = [pyopenvdb.read(str(path), name) for name in names]
        if "flame" not in names:
            # Mantaflow takes a file's only grid for whatever it looks for, and would show the density as fire.
            grids.append(pyopenvdb.FloatGrid(0.0))
            grids[-1].name, grids[-1].transform = "flame", grids[0].transform
        for grid in grids:
            grid.saveFloatAsHalf = True
        pyopenvdb.write(str(path), grids=grids)
    for path in sorted((folder / "config").glob("*")):
        if int(path.stem.rsplit("_", 1)[1]) < first_frame:
            path.unlink()
    for inner in folder.iterdir():
        if not any(inner.iterdir()):
            inner.rmdir()


def room() -> None:
    """A floor and a wall for the fire to light, and a pillar that throws a shadow."""
    bpy.ops.mesh.primitive_plane_add(size=12.0)
    named("Floor").data.materials.append(material("Floor", (0.5, 0.45, 0.4)))
    bpy.ops.mesh.primitive_plane_add(size=12.0, location=(0.0, 1.5, 0.0), rotation=(math.pi / 2.0, 0.0, 0.0))
    named("Wall").data.materials.append(material("Wall", (0.4, 0.4, 0.45)))
    bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.12, depth=1.2, location=(0.95, 0.5, 0.6))
    named("Pillar").data.materials.append(material("Pillar", (0.5, 0.5, 0.5)))
    bpy.ops.object.shade_smooth()


def view() -> None:
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 45.0
    towards = Vector((0.1, 0.0, 0.7)) - Vector((0.9, -5.0, 1.5))
    scene.camera = add("Camera", camera, (0.9, -5.0, 1.5), towards.to_track_quat("-Z", "Y").to_euler())
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.world = world
    scene.view_settings.view_transform = "Filmic"
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 480, 480, 100
    render.image_settings.file_format = "PNG"
    render.filepath = "//out/fire"
    # What Sfumato computes: what the fire sends to the eye, to surfaces, and once by those or by the smoke to the eye.
    render.engine = "CYCLES"
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.volume_bounces = 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples = 256


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shutil.rmtree(CACHE, ignore_errors=True)
    room()
    domain = fire(CACHE, STILL_FRAME, 64)
    bake(domain, CACHE)
    keep_what_is_shown(CACHE, STILL_FRAME)
    # Only the bake needs the burner, and Blender leaves out of a bake what the viewport hides.
    bpy.data.objects["Burner"].hide_viewport = True
    domain.modifiers["Fluid"].domain_settings.cache_directory = "//fire_cache"
    view()
    scene = bpy.context.scene
    scene.frame_start = scene.frame_end = STILL_FRAME
    scene.frame_set(STILL_FRAME)
    save("fire")


if __name__ == "__main__":
    main()
