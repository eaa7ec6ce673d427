# SPDX-License-Identifier: GPL-3.0-or-later
"""Write plume.blend: a Mantaflow plume that shades a floor, a block and a ball, and its cache beside it.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make.py
It needs pyopenvdb (Debian: python3-openvdb) and takes about half a minute.
"""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import bpy
from mathutils import Vector

HERE = Path(__file__).resolve().parent
CACHE = HERE / "plume_cache"
LAST_FRAME = 28
STILL_FRAME = 25

Colour = tuple[float, float, float]


def material(name: str, colour: Colour) -> bpy.types.Material:
    """A purely diffuse surface: Cycles and Sfumato are asked for the same light."""
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
    """White-grey smoke. A density of 12 makes the middle of the plume 3 to 8 optical depths thick."""
    made = bpy.data.materials.new("Smoke")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1.0)
    volume.inputs["Density"].default_value = 12.0
    volume.inputs["Anisotropy"].default_value = 0.3
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
    return made


def named(name: str) -> bpy.types.Object:
    """The object that the last operator added, under its name."""
    added = bpy.context.object
    added.name = name
    added.data.name = name
    return added


def add(name: str, data: bpy.types.ID, location: Colour, rotation: Vector) -> bpy.types.Object:
    made = bpy.data.objects.new(name, data)
    made.location = location
    made.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(made)
    return made


def receivers() -> None:
    """What the shadow falls on. The floor reaches beyond the picture, so that no horizon shows."""
    bpy.ops.mesh.primitive_plane_add(size=80.0)
    named("Floor").data.materials.append(material("Floor", (0.075, 0.09, 0.115)))
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(2.2, 0.5, 0.3), rotation=(0.0, 0.0, 0.75))
    named("Block").data.materials.append(material("Block", (0.22, 0.07, 0.035)))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.3, location=(1.7, -0.72, 0.3))
    named("Ball").data.materials.append(material("Ball", (0.06, 0.12, 0.2)))
    bpy.ops.object.shade_smooth()


def smoke() -> bpy.types.Object:
    """A domain of 64 x 64 x 80 cells, an emitter, and the turbulence that curls the plume. Returns the domain."""
    bpy.ops.object.effector_add(type="TURBULENCE", location=(0.3, 0.2, 0.5))
    turbulence = bpy.context.object
    turbulence.name = "Turbulence"
    turbulence.field.strength = 3.0
    turbulence.field.size = 1.0
    turbulence.field.flow = 0.0

    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 1.75), scale=(2.8, 2.8, 3.5))
    bpy.ops.object.transform_apply(location=False, rotation=False)
    domain = named("Smoke Domain")
    domain.data.materials.append(smoke_material())
    modifier = domain.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type = "GAS"
    settings.resolution_max = 80
    settings.use_adaptive_domain = False
    settings.alpha = 0.6
    settings.beta = 3.0
    settings.vorticity = 0.2
    settings.time_scale = 0.85
    settings.display_thickness = 0.001  # Solid mode's own smoke would show through Sfumato's
    settings.cache_directory = str(CACHE)
    settings.cache_type = "ALL"
    settings.cache_data_format = "OPENVDB"
    settings.openvdb_data_depth = "16"
    settings.cache_frame_start = 1
    settings.cache_frame_end = LAST_FRAME

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.25, location=(0.0, 0.0, 0.32))
    emitter = named("Emitter")
    flow = emitter.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type = "SMOKE"
    flow.flow_settings.flow_behavior = "INFLOW"
    flow.flow_settings.temperature = 2.0
    emitter.hide_render = True
    return domain


def bake(domain: bpy.types.Object) -> None:
    """Run the simulation and keep of each frame's grids the one that is read, the density."""
    import pyopenvdb  # which the scripts that borrow from this one do without

    shutil.rmtree(CACHE, ignore_errors=True)
    try:
        bpy.context.view_layer.update()
    except SystemError:
        # The first evaluation in Blender 3.4 often asks Mantaflow for grids that it has not made yet, and Mantaflow's
        # Python error surfaces here. The second evaluation finds them.
        bpy.context.view_layer.update()
    with bpy.context.temp_override(object=domain, active_object=domain):
        bpy.ops.fluid.bake_all()
    frames = sorted((CACHE / "data").glob("fluid_data_*.vdb"))
    if len(frames) != LAST_FRAME:
        raise RuntimeError(f"the bake wrote {len(frames)} frames, expected {LAST_FRAME}")
    for frame in frames:
        density = pyopenvdb.read(str(frame), "density")
        # Mantaflow takes a file's only grid for whatever it looks for, and would show the density as fire.
        flame = pyopenvdb.FloatGrid(0.0)
        flame.name, flame.transform = "flame", density.transform
        pyopenvdb.write(str(frame), grids=[density, flame])
    for folder in CACHE.iterdir():
        if not any(folder.iterdir()):
            folder.rmdir()


def view_and_light() -> None:
    scene = bpy.context.scene
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 24.0
    sun.angle = math.radians(0.526)
    sun.color = (1.0, 0.95, 0.87)
    # From the left, so that the shadow crosses the picture, and low, so that it reaches the block and the ball.
    add("Sun", sun, (-4.0, 0.0, 4.0), Vector((0.72, 0.02, -0.53)).to_track_quat("-Z", "Y").to_euler())
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 49.0
    pitch = Vector((math.radians(65.2), 0.0, 0.0))
    scene.camera = add("Camera", camera, (1.25, -8.2, 5.2), pitch)
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.world = world


def output() -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, LAST_FRAME
    scene.view_settings.view_transform = "Standard"
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 640, 360, 100
    render.image_settings.file_format = "PNG"
    render.filepath = "//out/plume"
    render.use_persistent_data = True
    render.use_compositing = False
    render.use_sequencer = False
    # Single scattering and no bounces: the light that Sfumato computes, and nothing else.
    render.engine = "CYCLES"
    scene.cycles.max_bounces = 0
    scene.cycles.volume_bounces = 0
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples = 64


def look_at(focus: Vector, place: Vector, lens: float) -> None:
    """Through a camera, into the dark."""
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.lens = lens
    scene.camera = add("Camera", camera, place, (focus - place).to_track_quat("-Z", "Y").to_euler())
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)


def save(name: str) -> None:
    """As NAME.blend, with nothing in it of whoever made it."""
    forget_home()
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(HERE / f"{name}.blend"), compress=True)


def forget_home() -> None:
    """Factory settings put the folder of whoever runs this into the file browsers; a file to share has none."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            for space in area.spaces:
                if space.type == "FILE_BROWSER" and space.params is not None:
                    space.params.directory = b"//"


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    receivers()
    domain = smoke()
    bake(domain)
    # Only the bake needs the emitter, and Blender leaves out of a bake what the viewport hides.
    bpy.data.objects["Emitter"].hide_viewport = True
    domain.modifiers["Fluid"].domain_settings.cache_directory = "//plume_cache"
    view_and_light()
    output()
    bpy.context.scene.frame_set(STILL_FRAME)
    save("plume")


if __name__ == "__main__":
    main()
