# SPDX-License-Identifier: GPL-3.0-or-later
"""Write frames/fire.vdb, collision.vdb and wisp.vdb: single Mantaflow frames, density only, for the benchmark of light maps.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_frames.py
It needs pyopenvdb (Debian: python3-openvdb) and takes about a minute.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import bpy
import pyopenvdb

FRAMES = Path(__file__).resolve().parent / "frames"
LAST_FRAME = 30
CELLS = 64


def flow(kind: str, radius: float, location: tuple[float, float, float]) -> bpy.types.FluidFlowSettings:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=location)
    modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "FLOW"
    modifier.flow_settings.flow_type = kind
    modifier.flow_settings.flow_behavior = "INFLOW"
    return modifier.flow_settings


def fire(domain: bpy.types.FluidDomainSettings) -> None:
    """Fire and the smoke that it makes."""
    domain.vorticity = 0.3
    domain.flame_smoke = 2.0
    flow("BOTH", 0.3, (0.0, 0.0, 0.4)).fuel_amount = 1.5


def collision(domain: bpy.types.FluidDomainSettings) -> None:
    """Smoke that rises against a ball and flows around it."""
    domain.beta = 3.0
    flow("SMOKE", 0.3, (0.1, 0.0, 0.4)).temperature = 2.0
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.45, location=(0.0, 0.1, 1.4))
    modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "EFFECTOR"


def wisp(domain: bpy.types.FluidDomainSettings) -> None:
    """A thin thread of smoke in moving air."""
    domain.vorticity = 0.05
    domain.beta = 4.0
    flow("SMOKE", 0.09, (0.0, 0.0, 0.2)).temperature = 2.5
    bpy.ops.object.effector_add(type="TURBULENCE", location=(0.4, 0.3, 0.6))
    bpy.context.object.field.strength = 0.6
    bpy.context.object.field.size = 0.7


def nothing(_: object) -> None:
    pass


def bake(name: str, furnish: Callable[[bpy.types.FluidDomainSettings], None]) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add(size=3.0, location=(0.0, 0.0, 1.5))
    thing = bpy.context.object
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type = "GAS"
    domain.resolution_max = CELLS
    domain.use_adaptive_domain = False
    domain.cache_type = "ALL"
    domain.cache_data_format = "OPENVDB"
    domain.openvdb_data_depth = "16"
    domain.cache_frame_start, domain.cache_frame_end = 1, LAST_FRAME
    with tempfile.TemporaryDirectory() as folder:
        domain.cache_directory = folder
        # Each operator updates the scene, and Blender 3.4's first update of a domain often fails: see make.py.
        for attempt in (furnish, nothing):
            try:
                attempt(domain)
                bpy.context.view_layer.update()
            except SystemError:
                bpy.context.view_layer.update()
        with bpy.context.temp_override(object=thing, active_object=thing):
            bpy.ops.fluid.bake_all()
        density = pyopenvdb.read(str(Path(folder) / "data" / f"fluid_data_{LAST_FRAME:04}.vdb"), "density")
    FRAMES.mkdir(exist_ok=True)
    pyopenvdb.write(str(FRAMES / f"{name}.vdb"), grids=[density])


if __name__ == "__main__":
    for furnish in (fire, collision, wisp):
        bake(furnish.__name__, furnish)
