// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/lights/polygon.glsl, poles.glsl, edge_integrals.glsl and ellipse.glsl, in one lane, many, and double
// precision.
#include "lights/area_light.hpp"
#include "lights/light_kernels.hpp"
#include "reference/area_light.hpp"
#include "text/integrals_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using IntegralsText = text::IntegralsText<float>;

using glm::dvec3;
using glm::vec3;
using Quad = std::array<vec3, 4>;
constexpr double PI = std::numbers::pi;

dvec3 random_direction(std::mt19937 &generator) {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(generator), normal(generator), normal(generator)));
}

// A parallelogram somewhere around the origin, as wide as it is far away or less.
Quad random_quad(std::mt19937 &generator) {
    std::uniform_real_distribution<double> uniform(0.02, 0.7);
    const dvec3 centre = random_direction(generator);
    const dvec3 u = random_direction(generator) * uniform(generator),
                v = random_direction(generator) * uniform(generator);
    return {vec3(centre - u - v), vec3(centre + u - v), vec3(centre + u + v), vec3(centre - u + v)};
}

float diffuse(const vec3 &n, const Quad &q) {
    return IntegralsText().diffuse_quad(n, q[0], q[1], q[2], q[3]);
}

double exact(const Quad &quad, const dvec3 &axis, double exponent) {
    const std::array<dvec3, 4> corners{dvec3(quad[0]), dvec3(quad[1]), dvec3(quad[2]), dvec3(quad[3])};
    return reference::cosine_power(corners, axis, exponent);
}

TEST(DiffuseQuad, IsTheReferenceFromEitherSide) {
    std::mt19937 generator(1);
    for (int i = 0; i < 5000; ++i) {
        const Quad q = random_quad(generator);
        const vec3 n(random_direction(generator));
        const double expected = exact(q, n, 1.0);
        EXPECT_NEAR(diffuse(n, q), expected, 1e-6);
        EXPECT_NEAR(diffuse(n, {q[3], q[2], q[1], q[0]}), expected, 1e-6);
    }
}

// Far from a light of area A: A cos cos / (pi d^2). The formula's own error is of the order of (size / d)^2.
TEST(DiffuseQuad, OfATinyLightIsThePointFormula) {
    const vec3 n = glm::normalize(vec3(0.3F, -0.2F, 1.0F));
    for (const float size : {1e-2F, 1e-3F, 3e-4F}) {
        const vec3 c(0.5F, 0.25F, 1.0F), u(size, 0.0F, 0.0F), v(0.0F, size, 0.0F);
        const double d2 = dot(dvec3(c), dvec3(c)), area = 4.0 * double{size} * double{size};
        const double point = area * dot(dvec3(n), dvec3(c)) * double{c.z} / (PI * d2 * d2);
        EXPECT_NEAR(diffuse(n, {c - u - v, c + u - v, c + u + v, c - u + v}) / point, 1.0,
                    2.0 * double{size} * double{size} + 1e-6 / double{size});
    }
}

TEST(DiffuseQuad, ThatFillsTheHemisphereGivesOne) {
    const float far = 1e5F;
    EXPECT_NEAR(diffuse({0, 0, 1}, {vec3(-far, -far, 1), {far, -far, 1}, {far, far, 1}, {-far, far, 1}}), 1.0F, 2e-5F);
    EXPECT_NEAR(diffuse({1, 0, 0}, {vec3(-far, -far, 1), {far, -far, 1}, {far, far, 1}, {-far, far, 1}}), 0.5F, 2e-5F);
}

TEST(DiffuseQuad, BelowTheHorizonGivesExactlyNothing) {
    std::mt19937 generator(2);
    for (int i = 0; i < 20'000; ++i) {
        Quad q = random_quad(generator);
        const vec3 n(random_direction(generator));
        float top = -1e9F;
        for (const vec3 &v : q) {
            top = std::max(top, dot(v, n));
        }
        for (vec3 &v : q) { // the highest corner touches the horizon from below, but for rounding
            v -= n * (top + 1e-6F);
        }
        EXPECT_EQ(diffuse(n, q), 0.0F);
        EXPECT_EQ(IntegralsText().diffuse_sphere(n, -n * 1.001F, 1.0F), 0.0F);
    }
}

// Corners exactly on the horizon, where a crossing would be computed from both sides.
TEST(DiffuseQuad, HangingFromTheHorizonGivesExactlyNothing) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    for (int i = 0; i < 20'000; ++i) {
        const vec3 a(uniform(generator), uniform(generator), 0.0F);
        const vec3 along(uniform(generator), uniform(generator), i % 2 == 0 ? 0.0F : -1.0F);
        const vec3 down(uniform(generator), uniform(generator), -0.5F);
        EXPECT_EQ(diffuse({0, 0, 1}, {a, a + along, a + along + down, a + down}), 0.0F);
    }
}

TEST(DiffuseQuad, SurvivesWhatHasNoAnswer) {
    const vec3 n(0, 0, 1), o(0.0F), a(1, 0, 0.5F), b(2, 0, 1), c(-1, 0, -0.5F), d(0, 1, 1);
    for (const Quad &q : {Quad{o, o, o, o}, Quad{a, a, a, a}, Quad{a, b, c, a}, Quad{o, a, d, b}, Quad{a, c, a, c},
                          Quad{a, b, d, d}, Quad{vec3(1e-20F), a, b, d}}) {
        EXPECT_TRUE(diffuse(n, q) >= 0.0F && diffuse(n, q) <= 1.0F);
    }
}

TEST(DiffuseSphere, IsItsOutlineAndOneInside) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> uniform(0.001F, 0.999F);
    for (int i = 0; i < 3000; ++i) {
        const vec3 centre(random_direction(generator)), n(random_direction(generator));
        const float radius = uniform(generator);
        EXPECT_NEAR(IntegralsText().diffuse_sphere(n, centre, radius),
                    reference::cosine_power_of_sphere(centre, radius, n, 1.0), 1e-6);
        EXPECT_EQ(IntegralsText().diffuse_sphere(n, centre * (0.99F * radius), radius), 1.0F);
    }
}

// Half of a small sphere above the horizon keeps its relative precision: 2/(3 pi) sigma^3.
TEST(DiffuseSphere, HalfAboveTheHorizonIsPreciseHoweverSmall) {
    for (const float radius : {0.05F, 1e-2F, 1e-3F, 1e-4F}) {
        const double r = double{radius};
        EXPECT_NEAR(IntegralsText().diffuse_sphere({0, 0, 1}, {1, 0, 0}, radius) / (2.0 / (3.0 * PI) * r * r * r), 1.0,
                    r * r + 1e-5);
    }
}

TEST(DiffuseEllipse, IsTheReferenceHorizonOrNot) {
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> uniform(0.02, 1.5);
    int cut = 0;
    for (int i = 0; i < 3000; ++i) {
        const vec3 centre(random_direction(generator) * (0.4 + uniform(generator))), n(random_direction(generator));
        const dvec3 axis = random_direction(generator);
        const dvec3 across = glm::normalize(glm::cross(axis, random_direction(generator)));
        const vec3 u(across * uniform(generator)), v(glm::cross(axis, across) * uniform(generator));
        const double expected = reference::cosine_power_of_ellipse(centre, u, v, n, 1.0);
        EXPECT_NEAR(IntegralsText().diffuse_ellipse(n, centre, u, v), expected, 3e-5);
        cut += std::abs(dot(centre, n)) < std::hypot(dot(u, n), dot(v, n)) ? 1 : 0;
    }
    EXPECT_GT(cut, 500);
}

// A disk seen from above its middle: r^2 / (r^2 + h^2).
TEST(DiffuseEllipse, OfADiskOverheadIsTheTextbooks) {
    for (const float radius : {1e-4F, 1e-2F, 1.0F, 100.0F}) {
        const float expected = radius * radius / (1.0F + radius * radius);
        EXPECT_NEAR(IntegralsText().diffuse_ellipse({0, 0, 1}, {0, 0, 1}, {radius, 0, 0}, {0, radius, 0}) / expected,
                    1.0F, 1e-5F);
        EXPECT_NEAR(IntegralsText().diffuse_ellipse({0, 0, 1}, {0, 0, -1}, {radius, 0, 0}, {0, radius, 0}), 0.0F, 0.0F);
    }
}

// ---- Batches ----

template <typename Number>
struct Batch {
    std::vector<Number> lights, axis, exponent, normal, out;

    void add(const Quad &quad, const dvec3 &r, double n, const dvec3 &horizon) {
        for (const vec3 &v : quad) {
            lights.insert(lights.end(), {Number(v.x), Number(v.y), Number(v.z)});
        }
        for (int i = 0; i < 3; ++i) {
            axis.push_back(Number(float(r[i])));
            normal.push_back(Number(float(horizon[i])));
        }
        exponent.push_back(Number(n));
    }
    LightBatch<Number> view(LobeMethod method) {
        out.assign(exponent.size(), Number(-1));
        LightBatch<Number> batch;
        batch.method = method;
        batch.count = out.size();
        batch.lights = lights.data();
        batch.width = 12;
        batch.axis = {axis.data(), 3};
        batch.exponent = {exponent.data(), 1};
        batch.normal = {normal.data(), 3};
        batch.two_sided = true;
        batch.out = out.data();
        return batch;
    }
};

TEST(Lanes, AgreeWithDoublePrecisionWhateverTheirNumber) {
    std::mt19937 generator(5);
    Batch<float> single;
    Batch<double> precise;
    for (int i = 0; i < 1003; ++i) { // no multiple of any number of lanes
        const Quad q = random_quad(generator);
        const dvec3 r = random_direction(generator) + dvec3(q[std::size_t(i) % 4]), n = random_direction(generator);
        const double exponent = std::round(std::exp(std::uniform_real_distribution<double>(1.4, 6.2)(generator)));
        single.add(q, r, exponent, n);
        precise.add(q, r, exponent, n);
    }
    for (const LobeMethod method : {LobeMethod::DIFFUSE, LobeMethod::POLES, LobeMethod::ARVO}) {
        integrate(precise.view(method));
        for (const InstructionSet &set : instruction_sets()) {
            light_kernels(set).integrate_lights(single.view(method));
            for (std::size_t i = 0; i < single.out.size(); ++i) {
                EXPECT_NEAR(single.out[i], precise.out[i], method == LobeMethod::ARVO ? 3e-5 : 3e-6) << set.name;
            }
        }
    }
}

// Ten million random and adversarial lights: corners, axes and normals that coincide, are parallel, opposite, tiny or
// huge, and lie in each other's planes. In lanes, a few seconds.
TEST(Lanes, NeverLeaveZeroToOne) {
    constexpr std::size_t COUNT = 1 << 16, ROUNDS = 153;
    std::mt19937 generator(6);
    std::vector<float> lights(12 * COUNT), axis(3 * COUNT), normal(3 * COUNT), exponent(COUNT), out(COUNT);
    const auto coordinate = [&generator] {
        const auto bits = static_cast<std::uint32_t>(generator());
        const float value = float(std::int32_t(bits)) * 0x1p-31F;
        const float steps = float(int(bits % 5)) - 2.0F; // exact zeros, ones and twos: everything degenerate is common
        const float size = bits % 61 == 0 ? 1e-12F : bits % 67 == 0 ? 1e9F : 1.0F;
        return (bits >> 8) % 3 == 0 ? steps * size : value * size;
    };
    std::size_t bad = 0;
    for (std::size_t round = 0; round < ROUNDS; ++round) {
        if (round % 8 == 0) {
            std::generate(lights.begin(), lights.end(), coordinate);
        }
        std::generate(axis.begin(), axis.end(), coordinate);
        std::generate(normal.begin(), normal.end(), coordinate);
        for (std::size_t i = 0; i < COUNT; ++i) {
            exponent[i] = std::exp(11.5F * float(i) / COUNT);
            if (i % 7 == 0) { // an axis on a corner, a normal on the axis
                std::copy_n(lights.begin() + std::ptrdiff_t(12 * i), 3, axis.begin() + std::ptrdiff_t(3 * i));
                std::copy_n(axis.begin() + std::ptrdiff_t(3 * i), 3, normal.begin() + std::ptrdiff_t(3 * i));
            }
        }
        LightBatch<float> batch;
        batch.shape = round % 6 == 1 ? LightShape::ELLIPSE : round % 6 == 2 ? LightShape::SPHERE : LightShape::POLYGON;
        batch.method = round % 5 == 0 ? LobeMethod::DIFFUSE : LobeMethod::POLES;
        batch.count = COUNT;
        batch.lights = lights.data();
        batch.width = 12;
        batch.axis = {axis.data(), 3};
        batch.exponent = {exponent.data(), 1};
        batch.normal = {round % 2 == 0 ? normal.data() : nullptr, 3};
        batch.normal.values = batch.method == LobeMethod::DIFFUSE ? normal.data() : batch.normal.values;
        batch.two_sided = true;
        batch.out = out.data();
        integrate(batch);
        bad += std::size_t(std::count_if(out.begin(), out.end(), [](float x) { return !(x >= 0.0F && x <= 1.0F); }));
    }
    EXPECT_EQ(bad, 0U) << "of " << COUNT * ROUNDS;
}

TEST(Fault, NamesWhatIsWrong) {
    const std::vector<dvec3> square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    EXPECT_EQ(fault_of(square), PolygonFault::SOUND);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[1], square[1], square[2]}), PolygonFault::SOUND);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[1], {2, 0, 1}}), PolygonFault::NO_AREA);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[1], {0.2, 0.2, 1}, square[3]}), PolygonFault::NOT_CONVEX);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[2], square[1], {0.5, 3, 1}}), PolygonFault::NOT_CONVEX);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[1], square[2], {0, 1, 1.5}}), PolygonFault::NOT_PLANAR);
    EXPECT_EQ(fault_of(std::vector<dvec3>{square[0], square[1], {NAN, 0, 0}}), PolygonFault::NOT_FINITE);
    std::vector<dvec3> star;
    for (int i = 0; i < 5; ++i) {
        star.emplace_back(std::cos(0.8 * PI * i), std::sin(0.8 * PI * i), 1.0);
    }
    EXPECT_EQ(fault_of(star), PolygonFault::NOT_CONVEX);
}

} // namespace
} // namespace sfumato
