# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py shafts that runs inside an official Blender: samples with light shafts by Sfumato, and by Cycles
without and with OpenImageDenoise.

    tests/official --script tests/bench/bench_shafts_in_blender.py 5.0.1

The room of shafts.blend has its air in the panel, which Cycles does not see, and has it in a mesh here. Before 5.0 what
two volumes scatter at one place is too bright in Cycles, so it is no judge of that room.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
import harness
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from bench_denoised_in_blender import METHODS, linear_exr, print_rows  # noqa: E402

PARTS = {7: 512, 8: 256}  # samples of the judge by their seed
PERCENT = 50  # 320 x 200
FRAMES = {"fog": 1, "shafts": 40}
ROOM = (-2.2, -3.6, 0.0), (2.2, 4.4, 2.8)


def fill_the_room() -> None:
    """With what its air is, from wall to wall."""
    air = bpy.context.scene.world.sfumato
    air.shown = False
    low, high = (np.array(corner) for corner in ROOM)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(low + high) / 2.0, scale=high - low + 0.1)
    thing = bpy.context.object
    scatter = harness.shade(thing.data, "ShaderNodeVolumeScatter", "Volume")
    harness.put(scatter, Color=(1.0, 1.0, 1.0), Density=-math.log(0.02) / air.visibility, Anisotropy=air.anisotropy)


def up_to_white(image: np.ndarray) -> np.ndarray:
    """Air at a lamp is a thousand times as bright: its few pixels would be all that is measured."""
    return np.minimum(image, 1.0)


def main() -> None:
    for name, frame in FRAMES.items():
        bpy.ops.wm.open_mainfile(filepath=str(harness.ROOT / "blend_samples" / f"{name}.blend"))
        scene = bpy.context.scene
        scene.frame_set(frame)
        scene.render.resolution_percentage = PERCENT
        linear_exr()
        if name == "shafts":
            fill_the_room()
        print_rows(f"{name}-blend", METHODS, PARTS, up_to_white, "of the picture up to white")
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
