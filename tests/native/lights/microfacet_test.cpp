// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights on rough surfaces: what physics fixes, what the quadratures say, and what rounding may do.
#include "lights/light_kernels.hpp"
#include "lights/microfacet.hpp"
#include "reference/microfacet.hpp"
#include "text/microfacets_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using Precise = text::MicrofacetsText<double>;

using glm::dvec3;
using Pair = std::array<double, 2>;

struct Surface {
    double alpha_x, alpha_y;
    dvec3 view;
};

struct Light {
    LightShape shape;
    std::vector<double> numbers;
};

Light quad(const dvec3 &a, const dvec3 &b, const dvec3 &c, const dvec3 &d) {
    return {LightShape::POLYGON, {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z}};
}

template <typename Number>
std::vector<Number> reflections(LightShape shape, const std::vector<Number> &lights, std::size_t width,
                                const std::vector<Number> &views, const std::vector<Number> &alphas,
                                Brdf brdf = Brdf::GGX, const InstructionSet *set = nullptr) {
    std::vector<Number> out(2 * lights.size() / width);
    MicrofacetBatch<Number> batch;
    batch.shape = shape;
    batch.brdf = brdf;
    batch.count = out.size() / 2;
    batch.lights = lights.data();
    batch.width = width;
    batch.view = {views.data(), 3};
    batch.alpha = {alphas.data(), 2};
    batch.out = out.data();
    if constexpr (std::is_same_v<Number, float>) {
        if (set != nullptr) {
            light_kernels(*set).reflect_lights(batch);
            return out;
        }
    }
    reflect(batch);
    return out;
}

Pair reflection(const Light &light, const Surface &s, Brdf brdf = Brdf::GGX) {
    const auto out = reflections<double>(light.shape, light.numbers, light.numbers.size(),
                                         {s.view.x, s.view.y, s.view.z}, {s.alpha_x, s.alpha_y}, brdf);
    return {out[0], out[1]};
}

reference::RoughSurface judged(const Surface &s, Brdf brdf = Brdf::GGX) {
    return {static_cast<reference::Facets>(brdf), s.alpha_x, s.alpha_y, s.view};
}

std::vector<dvec3> corners(const std::vector<double> &numbers) {
    std::vector<dvec3> out;
    for (std::size_t k = 0; k < numbers.size(); k += 3) {
        out.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
    }
    return out;
}

Surface seen(double alpha_x, double alpha_y, double cosine, double azimuth = 0.7) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    return {alpha_x, alpha_y, {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}};
}

dvec3 mirrored(const dvec3 &v) {
    return {-v.x, -v.y, v.z};
}

// A square of half side `half` across the direction `to`.
Light square_across(const dvec3 &to, double half, double distance = 1.0) {
    const dvec3 u = half * glm::normalize(glm::cross(to, dvec3(0.3, -0.5, 0.8)));
    const dvec3 v = glm::cross(glm::normalize(to), u), c = distance * glm::normalize(to);
    return quad(c - u - v, c + u - v, c + u + v, c - u + v);
}

// Rectangles of all sizes, many through the horizon, half of them near the mirrored view.
struct Cases {
    std::vector<double> quads, views, alphas;
};

Cases random_cases(std::size_t count, unsigned seed, double lowest_view, double lowest_alpha, bool anisotropic) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return dvec3(normal(random), normal(random), normal(random)); };
    Cases cases;
    for (std::size_t k = 0; k < count; ++k) {
        const Surface s = seen(1.0, 1.0, lowest_view + (1.0 - lowest_view) * uniform(random), 6.28 * uniform(random));
        const double x = std::lerp(std::sqrt(lowest_alpha), 1.0, uniform(random));
        const double y = anisotropic ? std::lerp(std::sqrt(lowest_alpha), 1.0, uniform(random)) : x;
        dvec3 c = glm::normalize(uniform(random) < 0.5 ? mirrored(s.view) + 0.5 * vector() : vector());
        c *= 0.5 + 3.5 * uniform(random);
        const dvec3 n = glm::normalize(vector()), u = glm::normalize(glm::cross(n, vector())), v = glm::cross(n, u);
        const double a = std::exp(std::log(0.01) * uniform(random)) * 2.0;
        const double b = std::exp(std::log(0.01) * uniform(random)) * 2.0;
        for (const auto &[i, j] : {std::pair{-a, -b}, {a, -b}, {a, b}, {-a, b}}) {
            const dvec3 p = c + i * u + j * v;
            cases.quads.insert(cases.quads.end(), {p.x, p.y, p.z});
        }
        cases.views.insert(cases.views.end(), {s.view.x, s.view.y, s.view.z});
        cases.alphas.insert(cases.alphas.end(), {x * x, y * y});
    }
    return cases;
}

std::vector<float> single(const std::vector<double> &values) {
    return {values.begin(), values.end()};
}
std::vector<double> rounded(const std::vector<double> &values) {
    const std::vector<float> floats = single(values);
    return {floats.begin(), floats.end()};
}

// ---- The judge ----

TEST(MicrofacetReference, TheOutlineAndTheAreaAgree) {
    for (const auto facets : {Brdf::GGX, Brdf::BECKMANN, Brdf::BLINN_PHONG}) {
        const Cases cases = random_cases(40, 5, 0.05, 0.01, facets != Brdf::BLINN_PHONG);
        for (std::size_t k = 0; k < 40; ++k) {
            const auto polygon = corners({cases.quads.begin() + 12 * k, cases.quads.begin() + 12 * (k + 1)});
            const reference::RoughSurface s{static_cast<reference::Facets>(facets),
                                            cases.alphas[2 * k],
                                            cases.alphas[2 * k + 1],
                                            {cases.views[3 * k], cases.views[3 * k + 1], cases.views[3 * k + 2]}};
            const Pair outline = reference::reflected_by_outline(s, polygon);
            const Pair area = reference::reflected_by_area(s, polygon);
            EXPECT_NEAR(outline[0], area[0], 1e-5) << k;
            EXPECT_NEAR(outline[1], area[1], 1e-5) << k;
        }
    }
}

TEST(MicrofacetReference, DisksAndSpheresAgreeTooAndAcrossTheHorizon) {
    const Surface s = seen(0.2, 0.35, 0.4);
    for (const double z : {2.0, 0.2, -0.2}) {
        const reference::DiskLight disk{{-1.0, -0.8, z}, {0.3, 0.0, 0.5}, {-0.2, 0.7, 0.12}};
        EXPECT_NEAR(reference::reflected_by_outline(judged(s), disk)[0],
                    reference::reflected_by_area(judged(s), disk)[0], 1e-5);
        const reference::DiskLight ball = reference::disk_of_sphere({-1.0, -0.8, z}, 0.7);
        EXPECT_NEAR(reference::reflected_by_outline(judged(s), ball)[0],
                    reference::reflected_by_area(judged(s), ball)[0], 1e-5);
    }
}

TEST(MicrofacetReference, TheDensityOfNormalsIsOne) {
    // A sky for a view along the normal, without masking, would reflect int D (v.h) dh = 1; with it no more than that.
    const reference::DiskLight sky{{0.0, 0.0, 1e-4}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    for (const auto facets : {reference::Facets::GGX, reference::Facets::BECKMANN, reference::Facets::BLINN_PHONG}) {
        EXPECT_NEAR(reference::reflected_by_outline({facets, 0.02, 0.02, {0.0, 0.0, 1.0}}, sky)[0], 1.0, 2e-3);
        EXPECT_LE(reference::reflected_by_outline({facets, 0.4, 0.4, {0.6, 0.0, 0.8}}, sky)[0], 1.0);
    }
}

// ---- Physics ----

TEST(Microfacet, ASmallLightIsWorthItsSolidAngle) {
    for (const auto brdf : {Brdf::GGX, Brdf::BECKMANN, Brdf::BLINN_PHONG}) {
        for (const double cosine : {0.1, 0.5, 1.0}) {
            const Surface s = seen(0.3, 0.3, cosine);
            const dvec3 to = glm::normalize(mirrored(s.view) + dvec3(0.1, 0.2, 0.15));
            const double half = 1e-3;
            const Pair want = reference::rough_reflection(judged(s, brdf), to);
            const Pair quad_light = reflection(square_across(to, half), s, brdf);
            EXPECT_NEAR(quad_light[0] / (4.0 * half * half), want[0], 2e-3 * want[0]);
            EXPECT_NEAR(quad_light[1] / (4.0 * half * half), want[1], 2e-3 * want[1]);
            const Pair ball = reflection({LightShape::SPHERE, {to.x, to.y, to.z, half}}, s, brdf);
            EXPECT_NEAR(ball[0] / (std::numbers::pi * half * half), want[0], 5e-3 * want[0]);
        }
    }
}

TEST(Microfacet, ASmoothSurfaceIsAMirror) {
    for (const double cosine : {0.5, 0.7, 1.0}) {
        const Surface s = seen(0.01, 0.01, cosine);
        EXPECT_NEAR(reflection(square_across(mirrored(s.view), 0.3), s)[0], 1.0, 0.01);
        const dvec3 aside = glm::normalize(mirrored(s.view) + dvec3(0.5, -0.5, 0.6));
        EXPECT_LT(reflection(square_across(aside, 0.05), s)[0], 2e-3);
    }
}

TEST(Microfacet, AWhiteSkyGivesNoMoreThanItSends) {
    // The directional albedo: what a sky of radiance 1 leaves, below one by what Smith's masking loses.
    for (const double alpha : {0.01, 0.1, 0.3, 0.6, 1.0}) {
        for (const double cosine : {0.0, 0.03, 0.1, 0.4, 0.8, 1.0}) {
            const Surface s = seen(alpha, alpha, cosine);
            const Light sky{LightShape::ELLIPSE, {0.0, 0.0, 1e-3, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0}};
            const double albedo = reflection(sky, s)[0];
            EXPECT_LE(albedo, 1.0 + 4e-3) << alpha << " " << cosine;
            if (cosine >= 0.03) {
                const reference::DiskLight same{{0.0, 0.0, 1e-3}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
                EXPECT_NEAR(albedo, reference::reflected_by_outline(judged(s), same)[0], 0.02)
                    << alpha << " " << cosine;
            }
        }
    }
}

TEST(Microfacet, NothingComesFromBelowTheHorizon) {
    const Surface s = seen(0.6, 0.6, 0.05);
    EXPECT_EQ(reflection(quad({-1, -1, -0.1}, {1, -1, -0.1}, {1, 1, -0.2}, {-1, 1, -0.2}), s)[0], 0.0);
    EXPECT_EQ(reflection({LightShape::SPHERE, {-1.0, 0.0, -0.5, 0.4}}, s)[0], 0.0);
    EXPECT_EQ(reflection({LightShape::ELLIPSE, {-1.0, 0.0, -0.5, 0.2, 0.0, 0.3, 0.0, 1.0, 0.0}}, s)[0], 0.0);
}

TEST(Microfacet, OnlyWhatIsAboveTheHorizonCounts) {
    for (const double alpha : {0.05, 0.4}) {
        const Surface s = seen(alpha, alpha, 0.3);
        const dvec3 to = mirrored(s.view) / s.view.z;
        const dvec3 across = 0.4 * glm::normalize(glm::cross(to, dvec3(0.0, 0.0, 1.0)));
        const dvec3 up(0.0, 0.0, 0.5), base(to.x, to.y, 0.0);
        const Light whole = quad(base - across - up, base + across - up, base + across + up, base - across + up);
        const Light upper = quad(base - across, base + across, base + across + up, base - across + up);
        EXPECT_NEAR(reflection(whole, s)[0], reflection(upper, s)[0], 1e-6);
    }
}

// ---- Symmetries ----

TEST(Microfacet, EitherWindingIsTheSame) {
    const Surface s = seen(0.3, 0.1, 0.5);
    const dvec3 a(-1, -1, 0.5), b(1, -1, 0.4), c(1, 0.3, 0.6), d(-1, 0.3, 0.7);
    EXPECT_NEAR(reflection(quad(a, b, c, d), s)[0], reflection(quad(d, c, b, a), s)[0], 1e-12);
    EXPECT_NEAR(reflection(quad(a, b, c, d), s)[1], reflection(quad(c, d, a, b), s)[1], 1e-12);
}

TEST(Microfacet, IsotropicSurfacesTurnFreely) {
    const double turn = 1.1;
    const auto turned = [&](const dvec3 &p) {
        return dvec3(std::cos(turn) * p.x - std::sin(turn) * p.y, std::sin(turn) * p.x + std::cos(turn) * p.y, p.z);
    };
    const dvec3 a(-1, -1, -0.5), b(1, -1, 0.4), c(1.2, 0.3, 0.6), d(-0.8, 0.3, -0.3);
    for (const double alpha : {0.02, 0.2, 1.0}) {
        const Surface s = seen(alpha, alpha, 0.3), t{alpha, alpha, turned(s.view)};
        EXPECT_NEAR(reflection(quad(a, b, c, d), s)[0],
                    reflection(quad(turned(a), turned(b), turned(c), turned(d)), t)[0], 2e-6);
    }
}

TEST(Microfacet, QuarterTurnsSwapTheRoughnesses) {
    const auto turned = [](const dvec3 &p) { return dvec3(-p.y, p.x, p.z); };
    const dvec3 a(-1, -1, 0.5), b(1, -1, 0.4), c(1.2, 0.3, 0.6), d(-0.8, 0.3, 0.7);
    const Surface s = seen(0.4, 0.05, 0.3), t{0.05, 0.4, turned(s.view)};
    const double here = reflection(quad(a, b, c, d), s)[0];
    EXPECT_NEAR(here, reflection(quad(turned(a), turned(b), turned(c), turned(d)), t)[0], 1e-6);
    EXPECT_GT(std::abs(here - reflection(quad(a, b, c, d), seen(0.05, 0.4, 0.3))[0]), 0.01);
}

TEST(Microfacet, PartsAddUp) {
    // The lobe adds exactly; the means of masking within the method's error.
    const dvec3 a(-1.2, -1, 0.1), b(0.6, -1.2, 0.2), c(0.5, 0.4, 1.3), d(-1.0, 0.5, 1.4);
    for (const double alpha : {0.05, 0.3, 0.8}) {
        const Surface s = seen(alpha, alpha, 0.5, 3.6 - std::numbers::pi);
        const dvec3 e = 0.5 * (a + b), f = 0.5 * (c + d);
        const double whole = reflection(quad(a, b, c, d), s)[0];
        const double parts = reflection(quad(a, e, f, d), s)[0] + reflection(quad(e, b, c, f), s)[0];
        EXPECT_NEAR(whole, parts, 2e-3);
    }
}

// ---- Against the quadratures ----

struct Errors {
    double nrmse = 0.0, highest = 0.0;
};

Errors against_outline(const Cases &cases, Brdf brdf) {
    const auto mine = reflections<double>(LightShape::POLYGON, cases.quads, 12, cases.views, cases.alphas, brdf);
    double square = 0.0, most = 0.0;
    Errors errors;
    const std::size_t count = mine.size() / 2;
    for (std::size_t k = 0; k < count; ++k) {
        const auto polygon = corners({cases.quads.begin() + 12 * k, cases.quads.begin() + 12 * (k + 1)});
        const Surface s{cases.alphas[2 * k],
                        cases.alphas[2 * k + 1],
                        {cases.views[3 * k], cases.views[3 * k + 1], cases.views[3 * k + 2]}};
        const Pair want = reference::reflected_by_outline(judged(s, brdf), polygon);
        const double error = std::abs(mine[2 * k] - want[0]);
        square += error * error;
        most = std::max(most, want[0]);
        errors.highest = std::max(errors.highest, error);
        EXPECT_LE(mine[2 * k + 1], mine[2 * k] + 1e-12);
    }
    errors.nrmse = std::sqrt(square / static_cast<double>(count)) / most;
    return errors;
}

TEST(Microfacet, RectanglesMeetTheirTargets) {
    const Errors ggx = against_outline(random_cases(800, 1, 0.03, 0.01, false), Brdf::GGX);
    EXPECT_LT(ggx.nrmse, 0.002);
    EXPECT_LT(ggx.highest, 0.08);
    EXPECT_LT(against_outline(random_cases(800, 2, 0.03, 0.01, true), Brdf::GGX).nrmse, 0.003);
    EXPECT_LT(against_outline(random_cases(800, 3, 0.03, 0.01, true), Brdf::BECKMANN).nrmse, 0.0075);
}

TEST(Microfacet, GrazingViewsMeetTheirTarget) {
    Cases cases = random_cases(600, 4, 0.03, 0.01, false);
    for (std::size_t k = 0; k < 600; ++k) {
        const double cosine = 0.03 + 0.17 * static_cast<double>(k) / 600.0;
        const Surface s = seen(1.0, 1.0, cosine, static_cast<double>(k));
        std::copy_n(&s.view.x, 3, cases.views.begin() + static_cast<std::ptrdiff_t>(3 * k));
    }
    EXPECT_LT(against_outline(cases, Brdf::GGX).nrmse, 0.008);
}

// Disks and spheres, each in its own plane or with a radius of its own, from random rectangles.
struct Sums {
private:
    double square = 0.0, error = 0.0, light = 0.0;
    int count = 0;

public:
    void add(double mine, double want) {
        square += (mine - want) * (mine - want);
        error += mine - want;
        light += want;
        ++count;
    }
    [[nodiscard]] double rmse() const { return std::sqrt(square / count); }
    [[nodiscard]] double bias() const { return error / light; }
};

Light ellipse(const dvec3 &c, const dvec3 &u, const dvec3 &v) {
    return {LightShape::ELLIPSE, {c.x, c.y, c.z, u.x, u.y, u.z, v.x, v.y, v.z}};
}

TEST(Microfacet, RoundLightsAgreeWithTheOutline) {
    Sums near, far, balls;
    const Cases cases = random_cases(1000, 6, 0.05, 0.01, false);
    for (std::size_t k = 0; k < 1000; ++k) {
        const auto p = corners({cases.quads.begin() + 12 * k, cases.quads.begin() + 12 * (k + 1)});
        const Surface s{cases.alphas[2 * k],
                        cases.alphas[2 * k + 1],
                        {cases.views[3 * k], cases.views[3 * k + 1], cases.views[3 * k + 2]}};
        const dvec3 c = 0.5 * (p[0] + p[2]), u = 0.5 * (p[1] - p[0]), v = 0.5 * (p[3] - p[0]);
        const double radius = std::min(glm::length(u), 0.9 * glm::length(c));
        const bool apart = glm::length(c) > std::max(glm::length(u), glm::length(v));
        (apart ? far : near)
            .add(reflection(ellipse(c, u, v), s)[0],
                 reference::reflected_by_outline(judged(s), reference::DiskLight{c, u, v})[0]);
        balls.add(reflection({LightShape::SPHERE, {c.x, c.y, c.z, radius}}, s)[0],
                  reference::reflected_by_outline(judged(s), reference::disk_of_sphere(c, radius))[0]);
    }
    EXPECT_LT(balls.rmse(), 0.003);
    EXPECT_LT(far.rmse(), 0.001);
    EXPECT_LT(near.rmse(), 0.004);
    EXPECT_LT(std::abs(far.bias()), 0.001);
    EXPECT_LT(std::abs(near.bias()), 0.002);
}

TEST(Microfacet, TheTipsOfADiskSeenEdgeOnAreNotLost) {
    // Where masking hardly varies: what differs is the area. From far, thin as a hair, in all directions about the
    // axis.
    Sums sums;
    const Surface s = seen(0.5, 0.5, 0.9);
    const dvec3 to = glm::normalize(mirrored(s.view)), x = glm::normalize(glm::cross(to, dvec3(0.3, 0.2, 0.9)));
    const dvec3 y = glm::cross(to, x);
    for (const double thin : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) {
        for (int k = 0; k < 16; ++k) {
            const double a = std::numbers::pi * k / 16.0;
            const dvec3 u = 0.1 * (std::cos(a) * x + std::sin(a) * y), across = std::cos(a) * y - std::sin(a) * x;
            const dvec3 v = 0.1 * (thin * across + std::sqrt(1.0 - thin * thin) * to);
            const double want = reference::reflected_by_outline(judged(s), reference::DiskLight{to, u, v})[0];
            const double mine = reflection(ellipse(to, u, v), s)[0];
            EXPECT_NEAR(mine, want, 3e-3 * want) << thin << " " << k;
            sums.add(mine / want, 1.0);
        }
    }
    EXPECT_LT(std::abs(sums.bias()), 2e-4);
}

TEST(Microfacet, AnEllipsesOwnAxesMeanNothing) {
    // Conjugate half axes, turned by any angle, are the same ellipse: also where it is near and cut by the horizon.
    const Surface s = seen(0.1, 0.3, 0.4);
    const dvec3 u(1.0, 0.3, 0.2), v(-0.2, 0.5, 0.9);
    for (const dvec3 &c : {dvec3(-0.5, -0.6, 0.8), dvec3(-1.0, -1.0, 0.1), dvec3(-3.0, -2.0, 2.0)}) {
        const double want = reflection(ellipse(c, u, v), s)[0];
        for (const double turn : {0.3, 1.0, 2.0, 4.0}) {
            const double x = std::cos(turn), y = std::sin(turn);
            EXPECT_NEAR(reflection(ellipse(c, x * u + y * v, x * v - y * u), s)[0], want, 1e-6 * want);
        }
        EXPECT_NEAR(reflection(ellipse(c, v, u), s)[0], want, 1e-6 * want);
    }
}

TEST(Microfacet, SmallSpheresAtGrazingAnglesAgreeWithTheOutline) {
    for (const double alpha : {0.05, 0.3, 0.8}) {
        const Surface s = seen(alpha, alpha, 0.1);
        const dvec3 to = glm::normalize(mirrored(s.view) + dvec3(0.05, 0.1, 0.075));
        for (const double radius : {1e-4, 1e-3, 3e-3, 1e-2}) {
            const double want = reference::reflected_by_outline(judged(s), reference::disk_of_sphere(to, radius))[0];
            const double ball = reflection({LightShape::SPHERE, {to.x, to.y, to.z, radius}}, s)[0];
            EXPECT_NEAR(ball, want, 3e-3 * want) << alpha << " " << radius;
        }
    }
}

TEST(Microfacet, LightsAlongTheHorizonAreNotBlack) {
    // The middle of what they fill in half vectors lies outside of it: masking there is none of theirs.
    const Cases cases = random_cases(3000, 9, 0.03, 0.01, false);
    for (std::size_t k = 0; k < 3000; ++k) {
        const std::vector<double> numbers(cases.quads.begin() + static_cast<std::ptrdiff_t>(12 * k),
                                          cases.quads.begin() + static_cast<std::ptrdiff_t>(12 * (k + 1)));
        const Surface s{cases.alphas[2 * k],
                        cases.alphas[2 * k + 1],
                        {cases.views[3 * k], cases.views[3 * k + 1], cases.views[3 * k + 2]}};
        if (reflection({LightShape::POLYGON, numbers}, s)[0] < 1e-9) {
            EXPECT_LT(reference::reflected_by_outline(judged(s), corners(numbers))[0], 1e-3) << k;
        }
    }
}

// ---- Arcs and lanes ----

TEST(Microfacet, ThePowersOfAnArcAreItsIntegrals) {
    // int s^k / |p|^2 ds by Simpson's rule, over arcs to and from anywhere, as narrow as lobes get. What is
    // left is of peaks that nearly coincide: the cubic's root is good to 3e-8, their distance to its square root.
    std::mt19937 random(12);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto direction = [&] { return glm::normalize(dvec3(normal(random), normal(random), normal(random))); };
    for (int k = 0; k < 200; ++k) {
        const Surface s = seen(1.0, 1.0, 0.03 + 0.97 * uniform(random), 6.28 * uniform(random));
        const dvec3 stretch(1.0 / std::pow(0.03, uniform(random)), 1.0 / std::pow(0.03, uniform(random)), 1.0);
        const Precise::HalfArc arc = Precise().great_arc(s.view, stretch, direction(), direction());
        const auto peaks = Precise().with_angles(arc, Precise().peaks_of(arc));
        const Precise::Powers mine = Precise().powers_of(arc, peaks);
        constexpr int STEPS = 200'000;
        const double step = (arc.high - arc.low) / STEPS;
        std::array<double, 3> want{};
        for (int n = 0; n <= STEPS; ++n) {
            const double at = arc.low + n * step;
            const dvec3 p = arc.p0 + (arc.p1 + arc.p2 * at) * at;
            double part = (n == 0 || n == STEPS ? 1.0 : n % 2 == 1 ? 4.0 : 2.0) * step / 3.0 / glm::dot(p, p);
            for (double &sum : want) {
                sum += part;
                part *= at;
            }
        }
        const double size = std::max(std::abs(arc.low), std::abs(arc.high));
        EXPECT_NEAR(mine.zero, want[0], 1e-3 * want[0]) << k;
        EXPECT_NEAR(mine.one, want[1], 1e-3 * want[0] * size) << k;
        EXPECT_NEAR(mine.two, want[2], 1e-3 * want[0] * size * size) << k;
    }
}

TEST(Microfacet, NoLightDependsOnItsNeighbours) {
    // What no lane needs is left out: lights above the horizon beside such as it cuts, round lobes beside ridges.
    Cases cases = random_cases(512, 13, 0.03, 0.01, true);
    for (std::size_t k = 0; k < 1024; k += 4) {
        cases.alphas[k + 1] = cases.alphas[k];
    }
    for (const InstructionSet &set : instruction_sets()) {
        const auto together = reflections<float>(LightShape::POLYGON, single(cases.quads), 12, single(cases.views),
                                                 single(cases.alphas), Brdf::GGX, &set);
        for (std::size_t k = 0; k < 512; ++k) {
            const auto part = [&](const std::vector<double> &values, std::size_t width) {
                const auto first = values.begin() + static_cast<std::ptrdiff_t>(width * k);
                return single({first, first + static_cast<std::ptrdiff_t>(width)});
            };
            const auto alone = reflections<float>(LightShape::POLYGON, part(cases.quads, 12), 12, part(cases.views, 3),
                                                  part(cases.alphas, 2), Brdf::GGX, &set);
            EXPECT_NEAR(together[2 * k], alone[0], 1e-6) << set.name << " " << k;
            EXPECT_NEAR(together[2 * k + 1], alone[1], 1e-6) << set.name << " " << k;
        }
    }
}

// ---- Rounding ----

TEST(Microfacet, SingleAndDoublePrecisionAgree) {
    const Cases cases = random_cases(20'000, 7, 0.03, 0.01, false);
    const auto exact =
        reflections<double>(LightShape::POLYGON, rounded(cases.quads), 12, rounded(cases.views), rounded(cases.alphas));
    for (const InstructionSet &set : instruction_sets()) {
        const auto mine = reflections<float>(LightShape::POLYGON, single(cases.quads), 12, single(cases.views),
                                             single(cases.alphas), Brdf::GGX, &set);
        std::vector<double> errors;
        for (std::size_t k = 0; k < mine.size(); k += 2) {
            errors.push_back(std::abs(static_cast<double>(mine[k]) - exact[k]));
        }
        std::sort(errors.begin(), errors.end());
        EXPECT_LT(errors[errors.size() * 999 / 1000], 5e-6) << set.name;
        EXPECT_LT(errors.back(), 2e-4) << set.name;
    }
}

TEST(Microfacet, SinglePrecisionIsEnoughForBrushedMetal) {
    // Alphas ten times apart and more: the lobe is a ridge, whose peaks along an edge nearly coincide.
    Cases cases = random_cases(20'000, 10, 0.03, 0.01, false);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (std::size_t k = 0; k < cases.alphas.size(); k += 2) {
        const double fine = 0.01 * std::pow(10.0, uniform(random));
        const double coarse = std::min(fine * std::pow(10.0, 1.0 + uniform(random)), 1.0);
        const bool swap = uniform(random) < 0.5;
        cases.alphas[k] = swap ? coarse : fine;
        cases.alphas[k + 1] = swap ? fine : coarse;
    }
    const auto exact =
        reflections<double>(LightShape::POLYGON, rounded(cases.quads), 12, rounded(cases.views), rounded(cases.alphas));
    for (const InstructionSet &set : instruction_sets()) {
        const auto mine = reflections<float>(LightShape::POLYGON, single(cases.quads), 12, single(cases.views),
                                             single(cases.alphas), Brdf::GGX, &set);
        std::vector<double> errors;
        for (std::size_t k = 0; k < mine.size(); k += 2) {
            errors.push_back(std::abs(static_cast<double>(mine[k]) - exact[k]));
        }
        std::sort(errors.begin(), errors.end());
        EXPECT_LT(errors[errors.size() * 97 / 100], 5e-6) << set.name;
        EXPECT_LT(errors[errors.size() * 999 / 1000], 2e-4) << set.name;
        EXPECT_LT(errors.back(), 1e-2) << set.name;
    }
}

TEST(Microfacet, NoInputMakesANaN) {
    // Corners on the axes and the horizon, at the origin, alike, far, near; views along and below the surface.
    std::mt19937 random(8);
    const std::array<double, 12> values{0.0, -0.0, 1.0, -1.0, 0.5, 1e-8, -1e-8, 1e-30, 1e8, -1e8, 1e-3, 0.7};
    const std::array<double, 6> roughness{0.0, 0.01, 0.1, 0.447, 1.0, 2.0};
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto number = [&] { return random() % 3 == 0 ? uniform(random) : values[random() % values.size()]; };
    constexpr std::size_t COUNT = 1 << 18;
    for (const auto &[shape, width] : {std::pair<LightShape, std::size_t>{LightShape::POLYGON, 12},
                                       {LightShape::SPHERE, 4},
                                       {LightShape::ELLIPSE, 9}}) {
        for (const auto brdf : {Brdf::GGX, Brdf::BECKMANN, Brdf::BLINN_PHONG}) {
            std::vector<float> lights(COUNT * width), views(3 * COUNT), alphas(2 * COUNT);
            std::generate(lights.begin(), lights.end(), [&] { return static_cast<float>(number()); });
            std::generate(views.begin(), views.end(), [&] { return static_cast<float>(number()); });
            std::generate(alphas.begin(), alphas.end(),
                          [&] { return static_cast<float>(roughness[random() % roughness.size()]); });
            for (const InstructionSet &set : instruction_sets()) { // each has a reciprocal of its own
                const auto out = reflections<float>(shape, lights, width, views, alphas, brdf, &set);
                const auto bad = std::find_if(out.begin(), out.end(), [](float x) { return !(x >= 0.0F && x < 1e4F); });
                ASSERT_EQ(bad, out.end()) << *bad << " of shape " << static_cast<int>(shape) << ", light "
                                          << (bad - out.begin()) / 2 << ", " << set.name;
            }
        }
    }
}

TEST(Microfacet, TenMillionRandomLightsAreFiniteAndNoBrighterThanTheirSky) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        const Cases cases = random_cases(20'000, 100 + seed, 0.0, 0.0, true);
        const auto quads = single(cases.quads), views = single(cases.views);
        // Fifty roughnesses each.
        for (int k = 0; k < 50; ++k) {
            std::vector<float> alphas(cases.alphas.size());
            for (std::size_t i = 0; i < alphas.size(); ++i) {
                alphas[i] = static_cast<float>(std::fmod(cases.alphas[i] + 0.02 * k, 1.0));
            }
            for (const float value : reflections<float>(LightShape::POLYGON, quads, 12, views, alphas)) {
                ASSERT_TRUE(value >= 0.0F && value < 1.1F) << value;
            }
        }
    }
}

} // namespace
} // namespace sfumato
