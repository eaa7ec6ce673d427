# SPDX-License-Identifier: GPL-3.0-or-later
"""Write shafts.blend: a room whose dusty air shows the light of the sun through a window, and Mantaflow smoke that drifts
through it, with its cache beside it.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --addons sfumato --python-exit-code 3 \
               --python blend_samples/make_shafts.py
It needs the add-on, whose panel Air the world has, and pyopenvdb (Debian: python3-openvdb), and takes half a minute.
"""

from __future__ import annotations

import math
import shutil
import sys
from pathlib import Path

import bpy
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # what the samples share
from make_fire import bake, keep_what_is_shown  # noqa: E402

CACHE = HERE / "shafts_cache"
STILL_FRAME = 40
# Of the room, metres: half its width, its depth, its height; of the window, from where to where along Y and Z.
HALF, DEPTH, HEIGHT, THICK = 2.2, 4.4, 2.8, 0.2
WINDOW_Y, WINDOW_Z = (1.2, 3.2), (0.9, 2.4)

Corner = tuple[float, float, float]


def block(name: str, low: Corner, high: Corner, made: bpy.types.Material) -> None:
    """A box from one corner to the other."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(made)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def room() -> None:
    """Open towards the camera, with a window of six panes on the left."""
    plaster, wood = make.material("Plaster", (0.42, 0.4, 0.38)), make.material("Wood", (0.2, 0.12, 0.07))
    left, outside = -HALF, -HALF - THICK
    block("Floor", (outside, -1.0, -THICK), (HALF + THICK, DEPTH, 0.0), wood)
    block("Ceiling", (outside, -1.0, HEIGHT), (HALF + THICK, DEPTH, HEIGHT + THICK), plaster)
    block("Back Wall", (outside, DEPTH, -THICK), (HALF + THICK, DEPTH + THICK, HEIGHT + THICK), plaster)
    block("Right Wall", (HALF, -1.0, 0.0), (HALF + THICK, DEPTH, HEIGHT), plaster)
    block("Left Wall Below", (outside, -1.0, 0.0), (left, DEPTH, WINDOW_Z[0]), plaster)
    block("Left Wall Above", (outside, -1.0, WINDOW_Z[1]), (left, DEPTH, HEIGHT), plaster)
    block("Left Wall Front", (outside, -1.0, WINDOW_Z[0]), (left, WINDOW_Y[0], WINDOW_Z[1]), plaster)
    block("Left Wall Back", (outside, WINDOW_Y[1], WINDOW_Z[0]), (left, DEPTH, WINDOW_Z[1]), plaster)
    bar, depth = 0.03, (outside + 0.07, outside + 0.13)
    for share in (1 / 3, 2 / 3):
        y = WINDOW_Y[0] + share * (WINDOW_Y[1] - WINDOW_Y[0])
        block("Mullion", (depth[0], y - bar, WINDOW_Z[0]), (depth[1], y + bar, WINDOW_Z[1]), wood)
    z = 0.5 * (WINDOW_Z[0] + WINDOW_Z[1])
    block("Transom", (depth[0], WINDOW_Y[0], z - bar), (depth[1], WINDOW_Y[1], z + bar), wood)
    block("Table", (-0.55, 1.6, 0.66), (0.45, 2.4, 0.72), wood)
    for x in (-0.5, 0.34):
        for y in (1.65, 2.29):
            block("Leg", (x, y, 0.0), (x + 0.06, y + 0.06, 0.66), wood)
    block("Bowl", (-0.13, 1.92, 0.72), (0.03, 2.08, 0.77), make.material("Clay", (0.3, 0.16, 0.1)))


def smoke() -> bpy.types.Object:
    """What rises from the bowl on the table. Returns the domain."""
    bpy.ops.object.effector_add(type="TURBULENCE", location=(0.3, 2.2, 1.0))
    field = bpy.context.object.field
    field.strength, field.size, field.flow = 1.2, 0.6, 0.0
    bpy.ops.object.effector_add(type="WIND", location=(-2.0, 2.0, 1.0), rotation=(0.0, math.pi / 2.0, 0.0))
    field = bpy.context.object.field
    field.strength, field.flow = 0.15, 0.0

    low, high = Vector((-0.65, 1.4, 0.74)), Vector((1.05, 2.6, 2.5))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(low + high) / 2.0, scale=high - low)
    bpy.ops.object.transform_apply(location=False, rotation=False)
    domain = make.named("Smoke Domain")
    made = make.smoke_material()
    made.node_tree.nodes["Principled Volume"].inputs["Density"].default_value = 14.0
    domain.data.materials.append(made)
    modifier = domain.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type = "GAS"
    settings.resolution_max = 72
    settings.use_adaptive_domain = False
    settings.alpha, settings.beta, settings.vorticity = 0.3, 0.6, 0.15
    settings.display_thickness = 0.001  # Solid mode's own smoke would show through Sfumato's
    settings.cache_directory = str(CACHE)
    settings.cache_type, settings.cache_data_format, settings.openvdb_data_depth = "ALL", "OPENVDB", "16"
    settings.cache_frame_start, settings.cache_frame_end = 1, STILL_FRAME

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.08, location=(-0.05, 2.0, 0.83))
    emitter = make.named("Incense")
    flow = emitter.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "SMOKE", "INFLOW"
    flow.flow_settings.temperature = 1.5
    emitter.hide_render = True
    return domain


def lights() -> None:
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 30.0, math.radians(0.526), (1.0, 0.9, 0.76)
    make.add("Sun", sun, (-5.0, 0.0, 5.0), Vector((0.85, 0.12, -0.34)).to_track_quat("-Z", "Y").to_euler())
    sky = bpy.data.lights.new("Sky", "AREA")  # what comes in at the open side
    sky.shape, sky.size, sky.size_y, sky.energy, sky.color = "RECTANGLE", 4.0, 2.4, 12.0, (0.75, 0.85, 1.0)
    make.add("Sky", sky, (0.0, -0.9, 1.5), Vector((0.0, 1.0, 0.0)).to_track_quat("-Z", "Z").to_euler())


def view() -> None:
    make.look_at(Vector((0.0, 2.4, 1.2)), Vector((0.9, -3.2, 1.55)), 30.0)
    scene = bpy.context.scene
    air = scene.world.sfumato
    air.shown, air.visibility, air.anisotropy = True, 60.0, 0.6
    scene.view_settings.view_transform, scene.view_settings.exposure = "Filmic", 1.0
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 640, 400, 100
    render.image_settings.file_format = "PNG"
    render.filepath = "//out/shafts"
    render.engine = "CYCLES"
    # What Sfumato computes: light that nothing passes on.
    scene.cycles.max_bounces = scene.cycles.volume_bounces = 0
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples = 256


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="sfumato")
    shutil.rmtree(CACHE, ignore_errors=True)
    domain = smoke()
    bake(domain, CACHE)
    keep_what_is_shown(CACHE, STILL_FRAME, ("density",))
    bpy.data.objects["Incense"].hide_viewport = True  # only the bake needs it
    domain.modifiers["Fluid"].domain_settings.cache_directory = "//shafts_cache"
    room()
    lights()
    view()
    scene = bpy.context.scene
    scene.frame_start = scene.frame_end = STILL_FRAME
    scene.frame_set(STILL_FRAME)
    make.save("shafts")


if __name__ == "__main__":
    main()
