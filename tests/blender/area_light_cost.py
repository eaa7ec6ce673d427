# SPDX-License-Identifier: GPL-3.0-or-later
"""What a GGX rectangle costs on the GPU beside linearly transformed cosines (Heitz et al. 2016).

    PATH=/usr/bin:$PATH xvfb-run -a blender --factory-startup --addons sfumato --python tests/blender/area_light_cost.py

Each pixel has its own rectangle, view and roughness. Both methods read them alike, take turns in one process, and the
shortest of their times counts, less that of a shader that does nothing else. The table of LTC is our own fit, its entries
for Schlick's Fresnel are made up: they cost the same. Edges by exact angles, and as engines have them, by a rational
function (Heitz and Hill, "Real-Time Line- and Disk-Light Shading", 2017).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import harness  # noqa: E402
from area_light_text import NUMBERS, Lights, Picture  # noqa: E402
from sfumato.gpu import shader as gpu_shader  # noqa: E402

SIZE = (640, 360)
REPEATS = 4
ROUNDS = 9

LTC = """
float ltc_edge(vec3 a, vec3 b)
{
  float x = dot(a, b);
#ifdef EXACT
  vec3 across = cross(a, b);
  float sine = sqrt(dot(across, across));
  return atan(sine, x) / (6.2831853f * max(sine, 1e-7f)) * across.z;
#else
  float y = abs(x);
  float v = (0.8543985f + (0.4965155f + 0.0145206f * y) * y) / (3.4175940f + (4.1616724f + y) * y);
  float share = x > 0.0f ? v : 0.5f * inversesqrt(max(1.0f - x * x, 1e-7f)) - v;
  return share * (a.x * b.y - a.y * b.x);
#endif
}

Reflection ltc_quad(vec3 view, float alpha, vec3 a, vec3 b, vec3 c, vec3 d)
{
  vec2 place = (sqrt(vec2(alpha, max(1.0f - view.z, 0.0f))) * 63.0f + 0.5f) / 64.0f;
  vec4 e = texture(matrices, place), amount = texture(amounts, place);
  vec2 x = view.xy * inversesqrt(max(dot(view.xy, view.xy), 1e-12f));
  mat3 inverse_matrix = mat3(vec3(e.x, 0.0f, e.z), vec3(0.0f, 1.0f, 0.0f), vec3(e.y, 0.0f, e.w)) *
                        mat3(vec3(x.x, -x.y, 0.0f), vec3(x.y, x.x, 0.0f), vec3(0.0f, 0.0f, 1.0f));
  vec3 p0 = normalize(inverse_matrix * a), p1 = normalize(inverse_matrix * b);
  vec3 p2 = normalize(inverse_matrix * c), p3 = normalize(inverse_matrix * d);
  LitEdge e0 = lit_edge(p0, p1), e1 = lit_edge(p1, p2), e2 = lit_edge(p2, p3), e3 = lit_edge(p3, p0);
  float sum = ltc_edge(e0.a, e0.b) + ltc_edge(e1.a, e1.b) + ltc_edge(e2.a, e2.b) + ltc_edge(e3.a, e3.b) +
              ltc_edge(e0.leave + e1.leave + e2.leave + e3.leave, e0.enter + e1.enter + e2.enter + e3.enter);
  Reflection light;
  light.plain = abs(sum) * amount.x;
  light.fresnel = abs(sum) * amount.y;
  return light;
}
"""


def some_rectangles() -> np.ndarray:
    """Many cut by the horizon."""
    random = np.random.default_rng(1)
    numbers = random.uniform(0.1, 1.0, (SIZE[1], SIZE[0], NUMBERS))
    numbers[..., :12] *= [1, -1, 1, -1, -1, 1, -1, 1, 1, 1, 1, 1]
    numbers[..., 2:12:3] -= 0.3
    numbers[..., 12:15] /= np.linalg.norm(numbers[..., 12:15], axis=-1, keepdims=True)
    numbers[..., 16] = numbers[..., 15]
    return numbers


def methods() -> dict[str, Lights]:
    table = np.load(harness.ROOT / "tests" / "goldens" / "ltc_ggx.npz")["table"].astype(np.float32)
    rows = table.transpose(1, 0, 2)  # roughness goes across
    amounts = np.stack([rows[..., 4], 0.1 * rows[..., 4], 0 * rows[..., 4], 0 * rows[..., 4]], -1)
    textures = {
        "matrices": gpu_shader.texture((64, 64), "RGBA", rows[..., :4]),
        "amounts": gpu_shader.texture((64, 64), "RGBA", amounts),
    }
    return {
        "nothing": Lights("nothing", "light.plain = dot(a + b + c + d, view) + alpha.x + alpha.y;"),
        "closed form": Lights("closed form", "light = ggx_quad(view, alpha.x, alpha.y, a, b, c, d);"),
        "LTC, exact": Lights(
            "LTC, exact", "light = ltc_quad(view, alpha.x, a, b, c, d);", "#define EXACT\n" + LTC, textures
        ),
        "LTC, rational": Lights("LTC, rational", "light = ltc_quad(view, alpha.x, a, b, c, d);", LTC, textures),
    }


def measure() -> Iterator[None]:
    yield
    rivals, picture = methods(), Picture(*SIZE)
    numbers = rivals["nothing"].upload(some_rectangles())
    best = dict.fromkeys(rivals, np.inf)
    mean = {}
    for _ in range(ROUNDS):
        for name, lights in rivals.items():
            picture.read()
            started = time.perf_counter()
            lights.draw(numbers, picture, REPEATS)
            picture.read_one()  # waits for the GPU
            best[name] = min(best[name], time.perf_counter() - started)
            mean[name] = picture.read()[..., 0].mean() / REPEATS
        yield
    each = 1e9 / (SIZE[0] * SIZE[1] * REPEATS)
    empty = best.pop("nothing")
    for name, seconds in best.items():
        ratio = (best["closed form"] - empty) / (seconds - empty)
        print(f"  {name}: {each * (seconds - empty):.1f} ns, the closed form takes {ratio:.2f} times as long;"
              f" mean radiance {mean[name]:.4f}")  # fmt: skip


harness.drive(measure())
