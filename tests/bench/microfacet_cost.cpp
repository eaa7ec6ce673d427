// SPDX-License-Identifier: GPL-3.0-or-later
// The cost of a GGX rectangle beside that of linearly transformed cosines (Heitz et al. 2016), in one process, on the
// same lanes, both from text compiled alike:  ninja microfacet_cost && build/tests/microfacet_cost
// LTC as engines evaluate it: two bilinear fetches, clipping where any lane needs it, the authors' rational edge
// integral. Rectangles are above the horizon, as most of a scene's are, or six in ten cut by it, so that every packet
// has some; Fresnel's reflectance is Schlick's, as LTC's tables have it, or that of a dielectric, which they have not.
#include "text/lanes.hpp"
#include "text/microfacets_text.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using MicrofacetsText = text::MicrofacetsText<Real, Isa>;
using LitEdge = MicrofacetsText::LitEdge;
using Microfacets = MicrofacetsText::Microfacets;
using Reflection = MicrofacetsText::Reflection;

constexpr int SIZE = 64;

struct Table {
    // What the text reads costs the same whatever it holds: a lobe without skew, as wide as it is rough.
    std::vector<float> entries = std::vector<float>(SIZE * SIZE * 8);
    Table() {
        for (std::size_t k = 0; k < SIZE * SIZE; ++k) {
            const float rough = static_cast<float>(k / SIZE) / SIZE;
            const std::array<float, 8> cell{1.0F, 0.1F, -0.1F, 0.1F + rough, 0.9F, 0.1F, 0.0F, 0.0F};
            std::copy(cell.begin(), cell.end(), entries.begin() + static_cast<std::ptrdiff_t>(8 * k));
        }
    }
};

// Heitz and Hill, "Real-Time Line- and Disk-Light Shading", 2017: angle / sin(angle), times the product's z.
Real edge_integral(const vec3 &a, const vec3 &b) {
    const Real x = dot(a, b), y = abs(x);
    const Real over = 0.8543985F + (0.4965155F + 0.0145206F * y) * y, under = 3.4175940F + (4.1616724F + y) * y;
    const Real v = over / under;
    const Real share = pick(x > 0.0F, v, 0.5F / sqrt(max(1.0F - x * x, 1e-7F)) - v);
    return share * (a.x * b.y - a.y * b.x);
}

Reflection ltc_quad(const Table &table, const vec3 &view, Real alpha, const vec3 *corners) {
    const Real u = sqrt(alpha) * (SIZE - 1.001F), v = sqrt(max(1.0F - view.z, 0.0F)) * (SIZE - 1.001F);
    const Real u0 = floor(u), v0 = floor(v), fu = u - u0, fv = v - v0;
    const Index base = truncate((u0 * static_cast<float>(SIZE) + v0) * 8.0F);
    std::array<Real, 6> e;
    for (std::size_t k = 0; k < e.size(); ++k) {
        const float *at = table.entries.data() + k;
        const Real low = gather(at, base) * (1.0F - fv) + gather(at + 8, base) * fv;
        const Real high = gather(at + 8 * SIZE, base) * (1.0F - fv) + gather(at + 8 * SIZE + 8, base) * fv;
        e[k] = low * (1.0F - fu) + high * fu;
    }
    const Real k = 1.0F / sqrt(max(view.x * view.x + view.y * view.y, 1e-12F)), tx = view.x * k, ty = view.y * k;
    std::array<vec3, 4> p;
    for (std::size_t c = 0; c < 4; ++c) {
        const vec3 &q = corners[c];
        const Real x = q.x * tx + q.y * ty, y = q.y * tx - q.x * ty;
        p[c] = MicrofacetsText().unit(vec3(e[0] * x + e[1] * q.z, y, e[2] * x + e[3] * q.z));
    }
    Real sum = 0.0F;
    // The same shortcut as ours: no clipping where nothing is below the horizon.
    if (any_lane(min(min(p[0].z, p[1].z), min(p[2].z, p[3].z)) < 0.0F)) {
        vec3 leave(Real(0.0F), Real(0.0F), Real(0.0F)), enter = leave;
        for (std::size_t c = 0; c < 4; ++c) {
            const LitEdge edge = MicrofacetsText().lit_edge(p[c], p[(c + 1) % 4]);
            leave = leave + edge.leave;
            enter = enter + edge.enter;
            sum = sum + edge_integral(edge.a, edge.b);
        }
        sum = sum + edge_integral(leave, enter);
    } else {
        for (std::size_t c = 0; c < 4; ++c) {
            sum = sum + edge_integral(p[c], p[(c + 1) % 4]);
        }
    }
    sum = abs(sum);
    Reflection light;
    light.plain = sum * e[4];
    light.fresnel = sum * e[5];
    return light;
}

// As a frame calls it: one function in which all is inlined, so that nothing passes through memory.
[[gnu::flatten]] Reflection flat_ggx_quad(const vec3 &view, Real alpha, Real index, const vec3 *c) {
    Microfacets m = MicrofacetsText().microfacets(BRDF_GGX, view, alpha, alpha);
    m.index = index;
    return MicrofacetsText().microfacet_quad(m, c[0], c[1], c[2], c[3]);
}

Real triangle_solid_angle(const vec3 &a, const vec3 &b, const vec3 &c) {
    return 2.0F * atan(abs(dot(a, cross(b, c))), 1.0F + dot(a, b) + dot(b, c) + dot(c, a));
}

// Karis, "Real Shading in Unreal Engine 4", 2013, for rectangles, as tests/bench/ltc.py has it.
[[gnu::flatten]] Reflection representative_point(const vec3 &view, Real alpha, const vec3 *c) {
    const vec3 u = c[1] - c[0], v = c[3] - c[0], normal = MicrofacetsText().unit(cross(u, v)),
               mirror = MicrofacetsText().mirrored(view);
    const Real along = dot(normal, mirror);
    const Real t = dot(normal, c[0]) / pick(abs(along) < 1e-6F, 1e-6F, along);
    const vec3 hit = mirror * pick(t > 0.0F, t, 1e3F) - c[0];
    const vec3 point =
        c[0] + u * clamp(dot(hit, u) / dot(u, u), 0.0F, 1.0F) + v * clamp(dot(hit, v) / dot(v, v), 0.0F, 1.0F);
    const vec3 p[4] = {MicrofacetsText().unit(c[0]), MicrofacetsText().unit(c[1]), MicrofacetsText().unit(c[2]),
                       MicrofacetsText().unit(c[3])};
    const Real omega = triangle_solid_angle(p[0], p[1], p[2]) + triangle_solid_angle(p[0], p[2], p[3]);
    const Real wider = clamp(alpha + 0.5F * sqrt(omega * 0.318309886F), 0.0F, 1.0F), narrower = alpha / wider;
    Reflection light = MicrofacetsText().microfacet_reflection(
        MicrofacetsText().microfacets(BRDF_GGX, view, alpha, alpha), MicrofacetsText().unit(point));
    light.plain = light.plain * narrower * narrower * omega;
    return light;
}

// An even grid of 64 points: what a renderer would do without noise's other half, the random numbers.
[[gnu::flatten]] Reflection sampled(const vec3 &view, Real alpha, const vec3 *c) {
    constexpr int SIDE = 8;
    const Microfacets m = MicrofacetsText().microfacets(BRDF_GGX, view, alpha, alpha);
    const vec3 u = c[1] - c[0], v = c[3] - c[0], normal = cross(u, v);
    Reflection light;
    light.plain = light.fresnel = 0.0F;
    for (int k = 0; k < SIDE * SIDE; ++k) {
        const Real a = (static_cast<float>(k % SIDE) + 0.5F) / SIDE, b = (static_cast<float>(k / SIDE) + 0.5F) / SIDE;
        const vec3 point = c[0] + u * a + v * b;
        const Real inverse = inversesqrt(dot(point, point));
        const Real share = abs(dot(point, normal)) * inverse * inverse * inverse / (SIDE * SIDE);
        light.plain = light.plain + MicrofacetsText().microfacet_reflection(m, point * inverse).plain * share;
    }
    return light;
}

struct Inputs {
    std::vector<float> numbers; // twelve of the corners, three of the view, alpha: each as many as there are lanes
    explicit Inputs(int packets) : numbers(static_cast<std::size_t>(16 * packets * LANES)) {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> uniform(0.1F, 1.0F);
        for (float &x : numbers) {
            x = uniform(random);
        }
    }
};

template <typename Method>
double nanoseconds(const Inputs &inputs, float lowest, bool dielectric, const Method &method) {
    double best = 1e30;
    float sink = 0.0F;
    const std::size_t packet = 16 * LANES;
    for (int repeat = 0; repeat < 200; ++repeat) {
        const auto start = std::chrono::steady_clock::now();
        Real sum = 0.0F;
        for (std::size_t at = 0; at < inputs.numbers.size(); at += packet) {
            const auto number = [&](std::size_t k) {
                return Real::load_unaligned(inputs.numbers.data() + at + k * LANES);
            };
            const vec3 corners[4] = {{number(0), -number(1), number(2) + (lowest - 0.1F)},
                                     {-number(3), -number(4), number(5) + (lowest - 0.1F)},
                                     {-number(6), number(7), number(8) + (lowest - 0.1F)},
                                     {number(9), number(10), number(11) + (lowest - 0.1F)}};
            const vec3 view = MicrofacetsText().unit(vec3(number(12), number(13), number(14)));
            const Reflection light = method(view, number(15), dielectric ? 1.0F + number(0) : Real(0.0F), corners);
            sum = sum + light.plain + light.fresnel;
        }
        const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
        best = std::min(best, taken.count());
        sink += highest(sum);
    }
    if (sink == 0.123F) {
        std::puts("");
    }
    return best / (static_cast<double>(inputs.numbers.size()) / 16.0);
}

// Nanoseconds a rectangle of each method that the benchmark of area lights compares, by the names that it has there.
void print_methods(const Inputs &inputs, const Table &table) {
    constexpr float LOWEST = -0.2F; // many are cut by the horizon
    const auto print = [&](const char *name, const auto &method) {
        std::printf("%s %.2f\n", name, nanoseconds(inputs, LOWEST, false, method));
    };
    print("closed-form",
          [](const vec3 &view, Real alpha, Real index, const vec3 *c) { return flat_ggx_quad(view, alpha, index, c); });
    print("ltc",
          [&](const vec3 &view, Real alpha, Real /*index*/, const vec3 *c) { return ltc_quad(table, view, alpha, c); });
    print("mrp", [](const vec3 &view, Real alpha, Real /*index*/, const vec3 *c) {
        return representative_point(view, alpha, c);
    });
    print("montecarlo-64",
          [](const vec3 &view, Real alpha, Real /*index*/, const vec3 *c) { return sampled(view, alpha, c); });
}

} // namespace
} // namespace sfumato::SFUMATO_ISA

int main(int count, char ** /*arguments*/) {
    using namespace sfumato::SFUMATO_ISA;
    const Inputs inputs(256);
    const Table table;
    if (count > 1) {
        print_methods(inputs, table);
        return 0;
    }
    struct Case {
        const char *name;
        float lowest; // of a corner's height; the highest is 0.9 more
        bool dielectric;
    };
    constexpr std::array<Case, 4> CASES{{{"above the horizon, Schlick", 0.05F, false},
                                         {"above the horizon, dielectric", 0.05F, true},
                                         {"cut by the horizon, Schlick", -0.2F, false},
                                         {"cut by the horizon, dielectric", -0.2F, true}}};
    for (int round = 0; round < 3; ++round) {
        for (const Case &c : CASES) {
            const double ours = nanoseconds(inputs, c.lowest, c.dielectric,
                                            [](const vec3 &view, Real alpha, Real index, const vec3 *corners) {
                                                return flat_ggx_quad(view, alpha, index, corners);
                                            });
            const double theirs = nanoseconds(inputs, c.lowest, c.dielectric,
                                              [&](const vec3 &view, Real alpha, Real /*index*/, const vec3 *corners) {
                                                  return ltc_quad(table, view, alpha, corners);
                                              });
            std::printf("%d lanes, %-31s GGX rectangle %5.1f ns, LTC rectangle %4.1f ns, ratio %.2f\n", LANES, c.name,
                        ours, theirs, ours / theirs);
        }
    }
}
