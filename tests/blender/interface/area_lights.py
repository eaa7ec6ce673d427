# SPDX-License-Identifier: GPL-3.0-or-later
"""The text of area lights as GLSL, one light a pixel: the module's answers in double precision, and black where there is
no light to speak of. Test-only GLSL: what puts edges together into a polygon's cosine power is C++ elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import harness
import numpy as np
import sfumato
from area_light_text import NUMBERS, Lights, Picture

SIZE = 64  # pixels along the picture: as many lights as it has

# n >= 9, cut to the horizon of `view`, which is what the others call n.
POLES_QUAD = """
struct Cut {
  Gap below;
  Gap behind;
  float sum;
};

Cut with_edge(Cut cut, Edge edge, vec3 axis, vec3 n, Poles poles)
{
  float from = dot(edge.from, n), to = dot(edge.to, n);
  Edge lit = clip_edge(edge, from, to);
  cut.below = gap_after(cut.below, edge, from, to);
  from = dot(lit.from, axis);
  to = dot(lit.to, axis);
  cut.sum += poles_along(arc_of(lit, axis, from, to), poles);
  cut.behind = gap_after(cut.behind, lit, from, to);
  return cut;
}

float poles_quad(vec3 axis, float exponent, vec3 n, vec3 a, vec3 b, vec3 c, vec3 d)
{
  Poles poles = two_poles(exponent);
  Cut cut;
  cut.below = no_gap();
  cut.behind = no_gap();
  cut.sum = 0.0f;
  cut = with_edge(with_edge(cut, edge_between(a, b), axis, n, poles), edge_between(b, c), axis, n, poles);
  cut = with_edge(with_edge(cut, edge_between(c, d), axis, n, poles), edge_between(d, a), axis, n, poles);
  Edge edge = gap_edge(cut.below, n);
  float from = dot(edge.from, axis), to = dot(edge.to, axis);
  cut.sum += poles_along(arc_of(edge, axis, from, to), poles);
  cut.behind = gap_after(cut.behind, edge, from, to);
  float whole = abs(cut.sum + gap_angle(cut.behind, axis)) / (2.0f * PI_EXACT);
  float size2 = dot(a, a) + dot(b, b) + dot(c, c) + dot(d, d) + dot(n, n) + dot(axis, axis) + exponent;
  return if_finite(size2, min(whole, 1.0f));
}
"""


class Function(NamedTuple):
    statement: str
    shape: str
    module: Callable[..., np.ndarray]
    rms: float  # error allowed
    high: float  # of all but one in a thousand


def corners(n: np.ndarray) -> np.ndarray:
    return n[:, :12].reshape(-1, 4, 3)


VIEW, ALPHA, AXIS = slice(12, 15), slice(15, 17), slice(17, 20)

# Two to three times what llvmpipe leaves. The mean of ggx_quad is that of one light in 4,096, which is off by 2e-3 there; the
# lanes of the CPU, of the same text, leave 2e-5 at most.
FUNCTIONS = {
    "diffuse_quad": Function(
        "light.plain = diffuse_quad(view, a, b, c, d);",
        "quad", lambda n: sfumato.diffuse_polygon(corners(n), n[:, VIEW], two_sided=True), 5e-7, 2e-6),
    "diffuse_sphere": Function(
        "light.plain = diffuse_sphere(view, a, b.x);",
        "sphere", lambda n: sfumato.diffuse_sphere(n[:, :3], n[:, 3], n[:, VIEW]), 5e-7, 2e-6),
    "diffuse_ellipse": Function(
        "light.plain = diffuse_ellipse(view, a, b, c);",
        "ellipse", lambda n: sfumato.diffuse_ellipse(n[:, :3], n[:, 3:6], n[:, 6:9], n[:, VIEW]), 5e-7, 2e-6),
    "poles": Function(
        "light.plain = poles_quad(axis, alpha.x, view, a, b, c, d);",
        "quad power", lambda n: sfumato.polygon_integral(corners(n), n[:, AXIS], n[:, 15], normal=n[:, VIEW], two_sided=True),
        5e-7, 2e-6),
    "ellipse_lobe": Function(
        "light.plain = ellipse_lobe(axis, alpha.x, view, a, b, c);",
        "ellipse power", lambda n: sfumato.ellipse_integral(n[:, :3], n[:, 3:6], n[:, 6:9], n[:, AXIS], n[:, 15], normal=n[:, VIEW]),
        1e-6, 1e-5),
    "ggx_quad": Function(
        "light = ggx_quad(view, alpha.x, alpha.y, a, b, c, d);",
        "quad rough", lambda n, f0=1.0: sfumato.microfacet_polygon(corners(n), n[:, VIEW], n[:, ALPHA], f0=f0), 1e-4, 1e-5),
    "dielectric_quad": Function(
        "Microfacets m = microfacets(BRDF_GGX, view, alpha.x, alpha.y); m.index = 1.45f; light = microfacet_quad(m, a, b, c, d);",
        "quad rough",
        lambda n, f0=1.0: sfumato.microfacet_polygon(corners(n), n[:, VIEW], n[:, ALPHA], f0=f0, index=1.45), 1e-4, 1e-5),
    "ggx_sphere": Function(
        "light = ggx_sphere(view, alpha.x, alpha.y, a, b.x);",
        "sphere rough", lambda n, f0=1.0: sfumato.microfacet_sphere(n[:, :3], n[:, 3], n[:, VIEW], n[:, ALPHA], f0=f0), 1e-6, 1e-5),
    "ggx_ellipse": Function(
        "light = ggx_ellipse(view, alpha.x, alpha.y, a, b, c);",
        "ellipse rough", lambda n, f0=1.0: sfumato.microfacet_ellipse(n[:, :3], n[:, 3:6], n[:, 6:9], n[:, VIEW], n[:, ALPHA], f0=f0),
        4e-6, 2e-5),
}  # fmt: skip


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def some_lights(shape: str, count: int = SIZE * SIZE, seed: int = 1) -> np.ndarray:
    """Numbers (count, NUMBERS) of lights of all sizes, half near the mirrored view, many cut by the horizon; half of the
    rough surfaces brushed. The normal of what is not rough points anywhere."""
    random = np.random.default_rng(seed)
    out = np.zeros((count, NUMBERS))

    def normal() -> np.ndarray:
        return random.normal(size=(count, 3))

    view = unit(normal())
    view[:, 2] = np.abs(view[:, 2])
    mirror = view * [-1, -1, 1]
    if "rough" not in shape:
        view = unit(normal())
        mirror = unit(normal())
    out[:, VIEW] = view
    out[:, AXIS] = mirror
    towards = np.where(random.random((count, 1)) < 0.5, unit(mirror + 0.5 * normal()), unit(normal()))
    centre = towards * random.uniform(0.5, 4.0, (count, 1))
    facing = unit(normal())
    u = unit(np.cross(facing, normal()))
    v = np.cross(facing, u) * np.exp(random.uniform(np.log(0.1), np.log(2.0), (count, 1)))
    u = u * np.exp(random.uniform(np.log(0.1), np.log(2.0), (count, 1)))
    if "quad" in shape:
        out[:, :12] = np.concatenate([centre - u - v, centre + u - v, centre + u + v, centre - u + v], 1)
    elif "sphere" in shape:
        out[:, :3] = centre
        out[:, 3] = np.linalg.norm(centre, axis=1) * np.exp(random.uniform(np.log(0.01), np.log(0.95), count))
    else:
        out[:, :9] = np.concatenate([centre, u, v], 1)
    alphas = random.uniform(0.15, 1.0, (count, 2)) ** 2
    alphas[::2, 1] = alphas[::2, 0]
    out[:, ALPHA] = alphas
    if "power" in shape:
        out[:, 15] = np.exp(random.uniform(np.log(9.0), np.log(1000.0), count))
    return out.astype(np.float32).astype(float)


def evaluated(function: Function, numbers: np.ndarray) -> np.ndarray:
    """What the GPU makes of as many lights as the picture has pixels: (count, 2)."""
    lights = Lights(function.statement, function.statement, POLES_QUAD)
    picture = Picture(SIZE, SIZE)
    lights.draw(lights.upload(numbers.reshape(SIZE, SIZE, NUMBERS)), picture)
    return picture.read().reshape(-1, 4)[:, :2]


def test_lights_are_what_the_module_says() -> None:
    failed = []
    for name, function in FUNCTIONS.items():
        numbers = some_lights(function.shape)
        made, expected = evaluated(function, numbers), function.module(numbers)
        assert np.isfinite(made).all()
        assert np.mean(expected > 0.01) > 0.1 and np.mean(expected == 0.0) > 0.02, "the lights test little"
        error = np.abs(made[:, 0] - expected)
        rms, high = float(np.sqrt(np.mean(error**2))), float(np.quantile(error, 0.999))
        print(f"  {name}: RMSE {rms:.1e}, 99.9th percentile {high:.1e}, largest {error.max():.1e}")
        if rms > function.rms or high > function.high:
            failed.append(name)
        if "rough" in function.shape:  # what Fresnel adds for a reflectance of zero
            black = np.abs(made[:, 1] - function.module(numbers, f0=0.0))
            assert np.quantile(black, 0.999) <= function.high, name
    assert not failed, failed


def without_light(function: Function) -> dict[str, np.ndarray]:
    """Lights that are none. Each kind on many surfaces."""
    good = some_lights(function.shape)
    shape = function.shape
    size = 12 if "quad" in shape else 4 if "sphere" in shape else 9
    kinds = {}
    for hole in (np.nan, np.inf, -np.inf):
        kind = good.copy()
        kind[np.arange(len(kind)), np.arange(len(kind)) % size] = hole
        kinds[f"a coordinate is {hole}"] = kind
    kind = good.copy()
    kind[:, :size] = np.nan
    kinds["all coordinates are nan"] = kind
    kind = good.copy()
    kind[np.arange(len(kind)), 12 + np.arange(len(kind)) % 3] = np.nan
    kinds["the view or the normal has a nan"] = kind
    if "rough" in shape:
        kind = good.copy()
        kind[np.arange(len(kind)), 15 + np.arange(len(kind)) % 2] = np.nan
        kinds["a roughness is nan"] = kind
    kind = good.copy()
    if "quad" in shape:
        kind[:, :12] = np.tile(kind[:, :3], 4)
        kinds["a point"] = kind
        kind = good.copy()
        kind[:, :12] = 0.0
        kinds["all corners where the point is"] = kind
        kind = good.copy()
        kind[:, 6:12] = kind[:, [3, 4, 5, 0, 1, 2]]
        kinds["a line"] = kind
        kind = good.copy()
        kind[:, 3:6] = 2.0 * kind[:, :3]
        kind[:, 9:12] = 3.0 * kind[:, 6:9]
        kind[:, 9:12], kind[:, 6:9] = kind[:, :3] * 2.5 + kind[:, 6:9] * 1e-20, kind[:, :3] * 3.0
        kinds["a line to the point"] = kind
    elif "sphere" in shape:
        kind[:, 3] = 0.0
        kinds["no radius"] = kind
    else:
        kind[:, 3:9] = 0.0
        kinds["no axes"] = kind
        kind = good.copy()
        kind[:, 6:9] = 0.0
        kinds["one axis"] = kind
        kind = good.copy()
        kind[:, 3:6] = 0.0
        kinds["the other axis"] = kind
        kind = good.copy()
        kind[:, :3] = 2.0 * kind[:, 3:6] - 3.0 * kind[:, 6:9]
        kinds["seen along its plane"] = kind
    return kinds


def test_what_is_no_light_is_black() -> None:
    """Not NaN, which a picture never loses again."""
    failed = []
    for name, function in FUNCTIONS.items():
        for kind, numbers in without_light(function).items():
            made = evaluated(function, numbers)
            brightest = float(np.abs(made[np.isfinite(made)]).max(initial=0.0))
            print(f"  {name}, {kind}: {np.mean(~np.isfinite(made)):.1%} not finite, else up to {brightest:.1e}")
            # What has a size but no area leaves rounding, and so does the text's bend of a disk's rim.
            allowed = {"a line": 1e-5, "a line to the point": 1e-5, "seen along its plane": 3e-4}.get(kind, 0.0)
            if not np.isfinite(made).all() or brightest > allowed:
                failed.append(f"{name}, {kind}")
    assert not failed, failed


harness.main()
