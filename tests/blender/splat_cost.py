# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light map costs on the GPU: particles as Fourier coefficients and as slices of an opacity shadow map, and the
sample's plume marched.

    PATH=/usr/bin:$PATH xvfb-run -a blender --factory-startup --addons sfumato --python tests/blender/splat_cost.py

The plume of particles and the map are as in Jansen and Bavoil (2010): 16K particles, 512 x 512 texels. Rivals take
turns in one process, and the shortest of their times counts. The opacity shadow map is the same splat with another
vertex shader: equal footprints, targets and blending, one slice a channel instead of one coefficient.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import harness  # noqa: E402
import sfumato  # noqa: E402
from sfumato.export import scene
from sfumato.gpu import light_maps, shader as gpu_shader  # noqa: E402

ROUNDS = 7
SIZE = (512, 512)
COUNTS = (7, 15)

# Kim and Neumann (2001): the optical depth of each of 4 LAYERS slices, which a look-up sums up to its own.
OPACITY_SHADOW_MAP = """
void main()
{
  vec2 axes = puff.w * metre.xy * texels;
  vec2 widened = max(axes, LEAST_RADIUS);
  gl_Position = vec4(2.0f * (puff.xy + shape.xy * widened / texels) - 1.0f, 0.0f, 1.0f);
  footprint = vec4(puff.xy * texels, widened);
  float tau = optical_depth_of(shape.z) * (axes.x * axes.y) / (widened.x * widened.y);
  float reach = max(extent * PUFF_SLAB * puff.w * metre.z, 1e-6f);
  vec4 near_slice = vec4(float(4 * LAYERS) * (puff.z - reach));
  vec4 far_slice = vec4(float(4 * LAYERS) * (puff.z + reach));
  float share = tau / (2.0f * reach * float(4 * LAYERS));
  vec4 four = vec4(0.0f, 1.0f, 2.0f, 3.0f);
#define WEIGH(layer, target, weight) \\
  weight = share * max(min(far_slice, four + float(4 * layer + 1)) - max(near_slice, four + float(4 * layer)), 0.0f);
  EACH_LAYER(WEIGH)
}
"""


def plume() -> tuple[Any, Any, Any]:
    """Points, radii and opacities of a plume in the unit cube: it widens and thins as it rises."""
    random = np.random.default_rng(16)
    height = random.random(16384)
    angle = random.uniform(0.0, 2.0 * np.pi, height.size)
    away = (0.04 + 0.26 * height) * np.sqrt(random.random(height.size))
    points = np.stack((0.5 + away * np.cos(angle), 0.1 + 0.8 * height, 0.5 + away * np.sin(angle)), axis=1)
    return points, 0.01 + 0.04 * height, 0.3 - 0.25 * height


def opacity_shadow_maps() -> light_maps.LightMaps:
    """Builders whose splat fills slices."""
    original = gpu_shader.shader_text

    def text(name: str) -> str:
        return OPACITY_SHADOW_MAP if name == "viewport/splat_vertex.glsl" else original(name)

    maps = light_maps.LightMaps()
    with mock.patch.object(gpu_shader, "shader_text", text):
        for count in COUNTS:
            maps.splat([(0.5, 0.5, 0.5)], 0.1, 0.5, np.eye(4), (4, 4), count)
    return maps


def shortest(rivals: dict[str, Callable[[], Any]]) -> dict[str, float]:
    """Seconds of each."""
    best = dict.fromkeys(rivals, np.inf)
    reader = light_maps.LightMaps()
    for _ in range(ROUNDS):
        for name, build in rivals.items():
            started = time.perf_counter()
            reader.read(build(), 1)  # waits for the GPU
            best[name] = min(best[name], time.perf_counter() - started)
    return best


def splats() -> None:
    points, radius, alpha = plume()
    fourier, slices = light_maps.LightMaps(), opacity_shadow_maps()
    texels = np.pi * np.sum((radius * SIZE[0]) ** 2) / 1e6
    print(f"\n{len(points)} particles into {SIZE[0]} x {SIZE[1]} texels, {texels:.1f} M fragments:")
    for count in COUNTS:
        for thick in (False, True):
            arguments = points, radius, alpha, np.eye(4), SIZE, count, thick
            times = shortest({
                "Fourier": lambda: fourier.splat(*arguments), "slices": lambda: slices.splat(*arguments),
            })  # fmt: skip
            print(f"  {count:2} coefficients, {'thick' if thick else 'flat'}: {1e3 * times['Fourier']:.0f} ms, "
                  f"{times['Fourier'] / times['slices']:.2f} times as long as {count + 1} slices")  # fmt: skip


def marches() -> None:
    harness.open_plume(25)
    exported = scene.export(bpy.context.evaluated_depsgraph_get()).scene
    maps = light_maps.LightMaps()
    print("\nThe sample's plume:")
    for count in (7, 31):
        frame = sfumato.Frame(exported, coefficients=count, basis="fourier", ranges="shared")
        medium, light_map = frame.media[0], frame.light_map()
        smoke, clearance, expected = medium.density, medium.clearance, light_map.coefficients
        density = gpu_shader.texture(smoke.shape[::-1], "R", smoke)
        bricks = gpu_shader.texture(clearance.shape[::-1], "R", clearance)
        size = expected.shape[1], expected.shape[0]

        def upload() -> Any:
            layers = light_maps.light_map_layers(expected)
            return gpu_shader.texture(layers.shape[2:0:-1], "RGBA", layers, layers=layers.shape[0])

        times = shortest({
            "march": lambda: maps.march(density, bricks, medium.grid_to_world, light_map.world_to_light, size, count),
            "upload": upload,
        })  # fmt: skip
        print(f"  {size[0]} x {size[1]} texels, {count:2} coefficients: marched {1e3 * times['march']:.2f} ms, "
              f"the CPU's map uploaded {1e3 * times['upload']:.2f} ms")  # fmt: skip


def measure() -> Iterator[None]:
    yield
    splats()
    marches()


harness.drive(measure())
