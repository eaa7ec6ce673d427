# SPDX-License-Identifier: GPL-3.0-or-later
"""Write plume.blend: a Mantaflow plume over a floor under a sun, its cache beside it.

Run with:  blender -b --factory-startup --python blend_samples/make.py
"""

from __future__ import annotations

import math
import shutil
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
RESOLUTION = 64
LAST_FRAME = 30


def material(name: str, colour: tuple[float, float, float]) -> bpy.types.Material:
    """A purely diffuse surface, so that Cycles and Sfumato are asked for the same light."""
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*colour, 1.0)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*colour, 1.0)
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    return made


def smoke_material() -> bpy.types.Material:
    made = bpy.data.materials.new("Smoke")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
    volume.inputs["Density"].default_value = 3.5
    volume.inputs["Anisotropy"].default_value = 0.3
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
    return made


def add(name: str, data: bpy.types.ID | None, location: tuple[float, float, float]) -> bpy.types.Object:
    made = bpy.data.objects.new(name, data)
    made.location = location
    bpy.context.scene.collection.objects.link(made)
    return made


def receivers() -> None:
    """A floor, a block and a ball for the shadow to fall on."""
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    floor = bpy.context.object
    floor.name = "Floor"
    floor.data.materials.append(material("Floor", (0.6, 0.57, 0.52)))
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(2.35, 0.75, 0.35), rotation=(0.0, 0.0, 0.5))
    block = bpy.context.object
    block.name = "Block"
    block.data.materials.append(material("Block", (0.55, 0.25, 0.16)))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.35, location=(2.0, -0.9, 0.35))
    ball = bpy.context.object
    ball.name = "Ball"
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(material("Ball", (0.2, 0.3, 0.5)))


def smoke(cache: Path) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=3.0, location=(0.0, 0.0, 1.5))
    domain = bpy.context.object
    domain.name = "Smoke Domain"
    domain.data.materials.append(smoke_material())
    modifier = domain.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type = "GAS"
    settings.resolution_max = RESOLUTION
    settings.cache_directory = str(cache)
    settings.cache_type = "ALL"
    settings.cache_data_format = "OPENVDB"
    settings.openvdb_data_depth = "16"
    settings.cache_frame_start = 1
    settings.cache_frame_end = LAST_FRAME
    settings.alpha = 0.6
    settings.beta = 3.0
    settings.vorticity = 0.35
    settings.time_scale = 2.0
    settings.use_adaptive_domain = False

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.32, location=(-0.25, 0.0, 0.4))
    emitter = bpy.context.object
    emitter.name = "Emitter"
    emitter.hide_render = True
    flow = emitter.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type = "SMOKE"
    flow.flow_settings.flow_behavior = "INFLOW"
    flow.flow_settings.density = 1.0
    flow.flow_settings.temperature = 1.5
    return domain


def view_and_light() -> None:
    scene = bpy.context.scene
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 4.0
    sun.angle = math.radians(0.526)
    sun.color = (1.0, 0.94, 0.86)
    add("Sun", sun, (-4.0, -1.0, 6.0)).rotation_euler = (math.radians(14.0), math.radians(-42.0), 0.0)
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 35.0
    seat = add("Camera", camera, (1.6, -8.4, 3.6))
    seat.rotation_euler = (math.radians(75.0), 0.0, math.radians(5.0))
    scene.camera = seat
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.world = world


def output() -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, LAST_FRAME
    scene.frame_set(25)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 640, 360, 100
    render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    # Single scattering and no bounces: the light that Sfumato computes, and nothing else.
    scene.cycles.max_bounces = 0
    scene.cycles.volume_bounces = 0
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples = 64


def main() -> None:
    cache = HERE / "plume_cache"
    shutil.rmtree(cache, ignore_errors=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"
    receivers()
    domain = smoke(cache)
    view_and_light()
    path = HERE / "plume.blend"
    with bpy.context.temp_override(object=domain, active_object=domain):
        bpy.ops.fluid.bake_all()
    output()
    domain.modifiers["Fluid"].domain_settings.cache_directory = "//plume_cache"
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


if __name__ == "__main__":
    sys.exit(main())
