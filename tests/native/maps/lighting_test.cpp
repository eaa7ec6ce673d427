// SPDX-License-Identifier: GPL-3.0-or-later
// The light volumes of the smoke: what of each light reaches each cell, against the reference.
#include "maps/lighting.hpp"
#include "solids/surfaces.hpp"
#include "support/reference_scenes.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

using reference::testing::area_light;
using reference::testing::KITE;
using reference::testing::oblique_grid;
using reference::testing::parallelogram;
using reference::testing::point_light;
using reference::testing::polygon_in;
using reference::testing::smooth_medium;
using reference::testing::sun_light;
using reference::testing::TRIANGLE;
using reference::testing::WHOLE;

// Smoke, and the light that arrives in it.
struct Lit {
    Solids solids;
    Surfaces surfaces;
    std::vector<CroppedMedium> media;
    bool grey;
    LightParts parts;
    Lighting lighting;

    Lit(const Scene &scene, int samples, const InstructionSet &with = instruction_set())
        : surfaces(scene.meshes, scene.lights, solids), media(cropped(scene)),
          grey(std::all_of(media.begin(), media.end(), [](const CroppedMedium &medium) { return medium.grey(); })),
          lighting(scene.lights, bodies(), surfaces, samples, parts) {
        lighting.build_maps(surfaces, {31, 4.0}, with, parts);
        lighting.fill_volumes(media, grey, with, parts);
    }

    [[nodiscard]] std::vector<Body> bodies() const {
        std::vector<Body> out;
        for (const CroppedMedium &medium : media) {
            out.push_back(body_of(medium));
        }
        return out;
    }

    static std::vector<CroppedMedium> cropped(const Scene &scene) {
        std::vector<CroppedMedium> out;
        for (const Medium &medium : scene.media) {
            out.push_back(crop(medium));
        }
        return out;
    }
};

// Calls visit(place in the world, optical depths towards the light and its share) for every `stride`th cell with smoke
// that one could see.
template <typename Visit>
void for_each_lit_cell(const Lit &lit, std::size_t medium, std::size_t light, int stride, const Visit &visit) {
    const CroppedMedium &smoke = lit.media[medium];
    const glm::ivec3 n = smoke.grid->resolution;
    int cells = 0;
    for (int cell = 0; cell < n.x * n.y * n.z; ++cell) {
        const glm::ivec3 at(cell % n.x, cell / n.x % n.y, cell / n.x / n.y);
        const std::ptrdiff_t place = smoke.grid->place_of(at);
        if (smoke.grid->density[std::size_t(place)] > 1e-3F && cells++ % stride == 0) {
            const float *stored = smoke.light[light]->data() + place * smoke.light_channels;
            std::array<float, 4> values{};
            for (int c = 0; c < smoke.light_channels; ++c) {
                const bool root = c + 1 < smoke.light_channels;
                values[std::size_t(c)] = root ? stored[c] * (stored[c] + 1.0F) : stored[c];
            }
            visit(glm::dvec3(smoke.grid_to_world * glm::dvec4(glm::dvec3(at) + 0.5, 1.0)), values.data());
        }
    }
}

double smallest_cell(const Lit &lit) {
    double cell = lit.media[0].cell_size;
    for (const CroppedMedium &medium : lit.media) {
        cell = std::min(cell, medium.cell_size);
    }
    return cell;
}

// Root mean square error of the light that arrives, over the root mean square of what arrives by the reference, in
// every body of smoke.
double error(const Scene &scene, int samples, unsigned per_axis) {
    const Lit lit(scene, samples);
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light &light = scene.lights[i];
        const LightView view = view_of(light, smallest_cell(lit));
        for (std::size_t m = 0; m < lit.media.size(); ++m) {
            for_each_lit_cell(lit, m, i, 31, [&](const glm::dvec3 &at, const float *values) {
                glm::dvec3 expected(0.0);
                for (const reference::LightSample &sample : reference::light_samples(light, at, per_axis)) {
                    if (sample.irradiance != glm::dvec3(0.0)) {
                        expected +=
                            sample.irradiance * reference::visibility(scene, at, sample.towards, sample.distance);
                    }
                }
                const glm::dvec3 across = at - glm::dvec3(view.position);
                const bool sun = light.kind == Light::Kind::SUN;
                const float falloff = sun ? 1.0F : LightsText().falloff(float(glm::dot(across, across)), view.size2);
                for (int c = 0; c < 3; ++c) {
                    const float share = values[lit.grey ? 1 : 3], depth = values[lit.grey ? 0 : c];
                    const double arriving = double{light.strength[c] * falloff * share * std::exp(-depth)};
                    sum += std::pow(arriving - expected[c], 2);
                    squares += expected[c] * expected[c];
                }
            });
        }
    }
    EXPECT_GT(squares, 0.0);
    return std::sqrt(sum / squares);
}

glm::vec3 in_world(const Medium &medium, const glm::vec3 &share) {
    return {medium.grid_to_world * glm::vec4(share * glm::vec3(medium.resolution), 1.0F)};
}

// Smoke of 1.8 x 3.1 x 4.6 m that lets through a fifth of the light.
Scene smoke() {
    Scene scene;
    scene.media = {smooth_medium({16, 18, 20}, oblique_grid())};
    return scene;
}

// Shines on the middle of the smoke from `from`.
Light aimed(Light light, const Scene &scene, const glm::vec3 &from) {
    const glm::vec3 middle = in_world(scene.media[0], glm::vec3(0.5F)), direction = glm::normalize(middle - from);
    const glm::dmat3 axes = axes_of(direction);
    light.position = from;
    light.direction = direction;
    light.across = glm::length(light.across) * glm::vec3(axes[0]);
    light.up = glm::length(light.up) * glm::vec3(axes[1]);
    return light;
}

// Errors allowed at 1, 4 and 16 samples. Measured: a third less.
struct Case {
    const char *name;
    Light light;
    double errors[3];
};

TEST(LightVolume, IsThatOfTheReferenceForEveryKindOfLight) {
    Scene scene = smoke();
    const glm::vec3 white(1.0F), middle = in_world(scene.media[0], glm::vec3(0.5F));
    const glm::vec3 from = middle + glm::vec3(2.0F, -3.0F, 4.0F), sunwards = glm::normalize(middle - from);
    Light spot = aimed(point_light(from, white), scene, from);
    spot.cone = 0.5F;
    spot.blend = 0.5F;
    Light hard_spot = spot;
    hard_spot.blend = 0.0F;
    Light large_spot = spot;
    large_spot.blend = 0.15F;
    large_spot.radius = 0.3F;
    const auto panel = [&](Light::Kind kind, float spread) {
        Light light = aimed(area_light(kind, from, {1.0F, 0, 0}, {0, 0.5F, 0}, white), scene, from);
        light.spread = spread;
        return light;
    };
    constexpr float EVERYWHERE = 3.1415927F;
    const Light rectangle = panel(Light::Kind::RECTANGLE, EVERYWHERE);
    const Case cases[] = {
        {"sun", sun_light(sunwards, white), {0.001, 0.001, 0.001}},
        {"sun of 10 degrees", sun_light(sunwards, white, glm::radians(10.0F)), {0.0034, 0.0017, 0.001}},
        {"sun of 40 degrees", sun_light(sunwards, white, glm::radians(40.0F)), {0.058, 0.022, 0.005}},
        {"point", point_light(from, white), {0.0015, 0.0015, 0.0015}},
        {"point by the smoke", point_light(in_world(scene.media[0], {0.5F, 0.5F, 1.1F}), white), {0.001, 0.001, 0.001}},
        {"point in the smoke",
         point_light(in_world(scene.media[0], {0.4F, 0.55F, 0.6F}), white),
         {0.023, 0.023, 0.023}},
        {"sphere of 0.1 m", point_light(from, white, 0.1F), {0.0015, 0.0014, 0.0014}},
        {"sphere of 0.5 m", point_light(from, white, 0.5F), {0.0018, 0.0013, 0.0013}},
        {"sphere of 1.5 m", point_light(from, white, 1.5F), {0.017, 0.008, 0.0018}},
        {"spot", spot, {0.0017, 0.0017, 0.0017}},
        {"spot with a hard edge", hard_spot, {0.0016, 0.0016, 0.0016}},
        {"spot of 0.3 m", large_spot, {0.28, 0.14, 0.028}},
        {"rectangle", panel(Light::Kind::RECTANGLE, EVERYWHERE), {0.01, 0.015, 0.004}},
        {"rectangle with a spread", panel(Light::Kind::RECTANGLE, 1.0F), {0.19, 0.042, 0.0095}},
        {"ellipse", panel(Light::Kind::ELLIPSE, EVERYWHERE), {0.009, 0.004, 0.004}},
        {"quadrilateral", polygon_in(rectangle, KITE), {0.01, 0.015, 0.004}},
        {"triangle", polygon_in(rectangle, TRIANGLE), {0.01, 0.015, 0.004}},
        {"ellipse with a spread", panel(Light::Kind::ELLIPSE, 1.0F), {0.145, 0.04, 0.0105}},
    };
    for (const Case &each : cases) {
        scene.lights = {each.light};
        for (std::size_t i = 0; i < 3; ++i) {
            const int samples = i == 0 ? 1 : i == 1 ? 4 : 16;
            EXPECT_LT(error(scene, samples, 8), each.errors[i]) << each.name << ", " << samples;
        }
    }
}

// The same smoke twice, beside each other and the light on their line: each is in the other's shadow.
Scene two_bodies() {
    Scene scene = smoke();
    scene.media.push_back(
        smooth_medium({10, 12, 9}, glm::translate(glm::mat4(1.0F), in_world(scene.media[0], {0.7F, 0.5F, 0.9F})) *
                                       glm::scale(glm::mat4(1.0F), glm::vec3(0.15F))));
    const glm::vec3 first = in_world(scene.media[0], glm::vec3(0.5F)),
                    second = in_world(scene.media[1], glm::vec3(0.5F));
    const glm::vec3 apart = second - first;
    scene.lights = {sun_light(glm::normalize(apart), glm::vec3(1.0F)), point_light(second + apart, glm::vec3(1.0F)),
                    point_light(first + 0.6F * apart, glm::vec3(1.0F)),
                    aimed(area_light(Light::Kind::RECTANGLE, {}, {0.3F, 0, 0}, {0, 0.2F, 0}, glm::vec3(1.0F)), scene,
                          second + 2.0F * apart)};
    return scene;
}

TEST(LightVolume, IsShadedByOtherSmoke) {
    const Scene both = two_bodies();
    for (std::size_t i = 0; i < both.lights.size(); ++i) {
        Scene scene = both;
        scene.lights = {both.lights[i]};
        constexpr double ERRORS[] = {0.0013, 0.0052, 0.0023, 0.0045};
        EXPECT_LT(error(scene, 16, 6), ERRORS[i]) << i;
        Scene alone = scene;
        alone.media.pop_back();
        const Lit one(alone, 16), two(scene, 16);
        double change = 0.0;
        std::vector<float> open;
        for_each_lit_cell(one, 0, 0, 1, [&](const glm::dvec3 &, const float *values) { open.push_back(values[0]); });
        std::size_t cell = 0;
        for_each_lit_cell(two, 0, 0, 1, [&](const glm::dvec3 &, const float *values) {
            EXPECT_GE(values[0], open[cell] - 1e-3F);
            change = std::max(change, double{values[0] - open[cell++]});
        });
        EXPECT_EQ(cell, open.size());
        if (i == 0 || i == 2) { // the sun meets the first body first, and the lamp between them shines both ways
            EXPECT_LT(change, 1e-3) << i;
        } else {
            EXPECT_GT(change, 0.05) << i;
        }
    }
}

TEST(LightVolume, OfColouredSmokeIsThatOfThreeGreyOnes) {
    Scene scene = two_bodies();
    scene.media[0].scattering = {0.5F, 1.0F, 2.0F};
    scene.media[1].absorption = {0.0F, 0.5F, 0.25F};
    const Lit coloured(scene, 4);
    ASSERT_FALSE(coloured.grey);
    EXPECT_LT(error(scene, 16, 6), 0.0022);
    for (int c = 0; c < 3; ++c) {
        Scene plain = scene;
        for (Medium &medium : plain.media) {
            medium.scattering = glm::vec3(medium.scattering[c]);
            medium.absorption = glm::vec3(medium.absorption[c]);
        }
        const Lit grey(plain, 4);
        ASSERT_TRUE(grey.grey);
        for (std::size_t m = 0; m < 2; ++m) {
            for (std::size_t i = 0; i < scene.lights.size(); ++i) {
                std::vector<float> depths, shares;
                for_each_lit_cell(grey, m, i, 1, [&](const glm::dvec3 &, const float *values) {
                    depths.push_back(values[0]);
                    shares.push_back(values[1]);
                });
                std::size_t cell = 0;
                for_each_lit_cell(coloured, m, i, 1, [&](const glm::dvec3 &, const float *values) {
                    // The strongest colour decides on each ray's range, so the series are not the same.
                    EXPECT_NEAR(values[c], depths[cell], 1e-4F);
                    EXPECT_EQ(values[3], shares[cell++]);
                });
            }
        }
    }
}

// ---- Solids ----

// A wall across the light, in the middle of the smoke: night behind it, before it nothing changes.
TEST(LightVolume, IsDarkBehindAWallAndUnchangedBeforeIt) {
    Scene scene = smoke();
    const glm::vec3 white(1.0F), middle = in_world(scene.media[0], glm::vec3(0.5F));
    const glm::vec3 from = middle + glm::vec3(2.0F, -3.0F, 4.0F), direction = glm::normalize(middle - from);
    const glm::dmat3 axes = axes_of(direction);
    const glm::vec3 across = 20.0F * glm::vec3(axes[0]), up = 20.0F * glm::vec3(axes[1]);
    for (const Light &light :
         {sun_light(direction, white), point_light(from, white), point_light(from, white, 0.3F),
          aimed(area_light(Light::Kind::ELLIPSE, from, {0.5F, 0, 0}, {0, 0.5F, 0}, white), scene, from)}) {
        scene.lights = {light};
        scene.meshes.clear();
        const Lit open(scene, 8);
        scene.meshes = {parallelogram(middle - 0.5F * (across + up), across, up, glm::vec3(0.5F))};
        const Lit shaded(scene, 8);
        std::vector<float> depths, shares;
        for_each_lit_cell(open, 0, 0, 1, [&](const glm::dvec3 &, const float *values) {
            depths.push_back(values[0]);
            shares.push_back(values[1]);
        });
        int before = 0, behind = 0;
        std::size_t cell = 0;
        for_each_lit_cell(shaded, 0, 0, 1, [&](const glm::dvec3 &at, const float *values) {
            const double distance = glm::dot(at - glm::dvec3(middle), glm::dvec3(direction));
            // The rays of a radial map do not cross the wall at a right angle: its texels, half a cell wide, are steps.
            const double margin = light.kind == Light::Kind::SUN ? 1e-4 : 0.06;
            if (distance < -margin) {
                EXPECT_EQ(values[1], shares[cell]);
                ++before;
            } else if (distance > margin) {
                EXPECT_EQ(values[1], 0.0F);
                ++behind;
            }
            if (std::abs(distance) > margin) { // the smoke itself shades as before
                EXPECT_NEAR(values[0], depths[cell], 1e-5F);
            }
            ++cell;
        });
        EXPECT_GT(before, 1000);
        EXPECT_GT(behind, 1000);
    }
}

// A wall that stands well before the smoke shades it all, one behind it nothing.
TEST(LightVolume, MindsSolidsOutsideTheSmoke) {
    Scene scene = smoke();
    const glm::vec3 white(1.0F), middle = in_world(scene.media[0], glm::vec3(0.5F));
    const glm::vec3 from = middle + glm::vec3(20.0F, -30.0F, 40.0F), direction = glm::normalize(middle - from);
    const glm::dmat3 axes = axes_of(direction);
    const glm::vec3 across = 40.0F * glm::vec3(axes[0]), up = 40.0F * glm::vec3(axes[1]);
    for (const Light &light : {sun_light(direction, white), point_light(from, white)}) {
        for (const float distance : {-30.0F, 30.0F}) {
            const glm::vec3 corner = middle + distance * direction - 0.5F * (across + up);
            scene.lights = {light};
            scene.meshes = {parallelogram(corner, across, up, glm::vec3(0.5F))};
            const Lit lit(scene, 1);
            for_each_lit_cell(lit, 0, 0, 1, [&](const glm::dvec3 &, const float *values) {
                EXPECT_NEAR(values[1], distance > 0.0F ? 1.0F : 0.0F, 1e-6F);
            });
        }
    }
}

// A wall before one of two bodies leaves the other in the light: each has its own map, with its own solids.
TEST(LightVolume, HasItsOwnSolids) {
    Scene scene = two_bodies();
    scene.media[1].grid_to_world =
        glm::translate(glm::mat4(1.0F), glm::vec3(8.0F, 0.0F, 0.0F)) * scene.media[1].grid_to_world;
    const glm::vec3 first = in_world(scene.media[0], glm::vec3(0.5F)),
                    second = in_world(scene.media[1], glm::vec3(0.5F));
    const glm::vec3 from = 0.5F * (first + second) + glm::vec3(0.0F, 12.0F, 0.0F);
    for (const Light &light :
         {sun_light({0.0F, -1.0F, 0.0F}, glm::vec3(1.0F)), point_light(from, glm::vec3(1.0F), 0.05F)}) {
        scene.lights = {light};
        for (const std::size_t hidden : {0U, 1U}) {
            const glm::vec3 &middle = hidden == 0 ? first : second, &other = hidden == 0 ? second : first;
            // As wide as half the space, on the side of the hidden body.
            const glm::vec3 border = 0.5F * (first + second) + glm::vec3(0.0F, 6.0F, 0.0F);
            glm::vec3 aside = middle - other;
            aside.y = 0.0F;
            aside = 50.0F * glm::normalize(aside);
            const glm::vec3 up = glm::cross(aside, glm::vec3(0.0F, 1.0F, 0.0F));
            scene.meshes = {parallelogram(border - up, aside, 2.0F * up, glm::vec3(0.5F))};
            const Lit lit(scene, 4);
            double most[2] = {0.0, 0.0};
            for (std::size_t m = 0; m < 2; ++m) {
                for_each_lit_cell(lit, m, 0, 1, [&](const glm::dvec3 &, const float *values) {
                    EXPECT_NEAR(values[1], m == hidden ? 0.0F : 1.0F, 0.01F) << m;
                    most[m] = std::max(most[m], double{values[1]});
                });
            }
            EXPECT_GT(most[1 - hidden], 0.9);
        }
    }
}

// The mesh that a light is a part of does not shade its light, on either side, and other meshes do.
TEST(Lighting, OfAPolygonInItsOwnMeshIsThatWithoutTheMesh) {
    Scene scene = two_bodies();
    const glm::vec3 first = in_world(scene.media[0], glm::vec3(0.5F)),
                    second = in_world(scene.media[1], glm::vec3(0.5F));
    const Light panel = area_light(Light::Kind::RECTANGLE, 0.5F * (first + second), {0.3F, 0.1F, 0.2F},
                                   {-0.1F, 0.3F, 0}, glm::vec3(1.0F));
    scene.lights = {polygon_in(panel, WHOLE)};
    const Lit open(scene, 16);
    const std::array<glm::vec3, 4> &corners = scene.lights[0].corners;
    scene.meshes = {parallelogram(corners[0], corners[1] - corners[0], corners[3] - corners[0], glm::vec3(0.0F))};
    const Lit own(scene, 16);
    for (std::size_t m = 0; m < 2; ++m) {
        const std::vector<float> &a = *open.media[m].light[0], &b = *own.media[m].light[0];
        double most = 0.0, apart = 0.0;
        for (std::size_t i = 1; i < a.size(); i += 2) {
            most = std::max(most, double{a[i]});
            apart = std::max(apart, double{std::abs(a[i] - b[i])});
        }
        EXPECT_GT(most, 0.1) << m;
        EXPECT_LT(apart, 3e-3 * most) << m; // in the plane of the mesh, half of a texel sees the other side
    }
}

// ---- What is left out ----

TEST(Lighting, SkipsMapsWhereALightCannotMeetTheSmoke) {
    Scene scene = two_bodies();
    const glm::vec3 first = in_world(scene.media[0], glm::vec3(0.5F)),
                    apart = in_world(scene.media[1], glm::vec3(0.5F)) - first;
    const glm::vec3 from = first - 2.0F * apart;
    for (const bool towards : {false, true}) {
        for (const Light::Kind kind : {Light::Kind::SPHERE, Light::Kind::RECTANGLE, Light::Kind::ELLIPSE}) {
            Light light = aimed(area_light(kind, from, {0.2F, 0, 0}, {0, 0.2F, 0}, glm::vec3(1.0F)), scene, from);
            light.cone = 1.0F;
            light.direction = towards ? light.direction : -light.direction;
            scene.lights = {light};
            const Lit lit(scene, 1);
            for (std::size_t m = 0; m < 2; ++m) {
                EXPECT_EQ(lit.lighting.map(0, 0, m) != nullptr, towards);
                double most = 0.0;
                for_each_lit_cell(lit, m, 0, 1, [&](const glm::dvec3 &, const float *values) {
                    most = std::max(most, double{values[1]});
                });
                EXPECT_EQ(most > 0.0, towards);
            }
        }
    }
    EXPECT_EQ(Lit(scene, 1).lighting.map(1, 0, 0), nullptr);
    EXPECT_EQ(Lit(scene, 1).lighting.map(0, 1, 0), nullptr);
    EXPECT_EQ(Lit(scene, 1).lighting.map(0, 0, 2), nullptr);
}

TEST(Lighting, TakesNoMoreSamplesThanTheShadowOfTheSmokeAsksFor) {
    Scene scene = smoke();
    const Lit lit(scene, 1);
    const auto count = [&](const Light &light) {
        return light_samples(view_of(light, 0.1), lit.lighting.bodies(), 16, false).size();
    };
    const glm::vec3 white(1.0F), far(0.0F, 0.0F, 100.0F);
    EXPECT_EQ(count(sun_light({0, 0, -1}, white)), 1U);
    EXPECT_EQ(count(sun_light({0, 0, -1}, white, 0.009F)), 1U);
    EXPECT_EQ(count(sun_light({0, 0, -1}, white, 0.3F)), 16U);
    EXPECT_EQ(count(point_light(far, white)), 1U);
    EXPECT_EQ(count(point_light(far, white, 0.5F)), 1U);
    EXPECT_EQ(count(point_light({0, 0, 6}, white, 1.0F)), 16U);
}

// Samples stand for their light: their mean is its middle, and their spread is that of the light.
TEST(Lighting, SpreadsSamplesEvenlyOverALight) {
    const Lit lit(smoke(), 1);
    const glm::vec3 position(0.0F, 0.0F, 6.0F), white(1.0F);
    const Light lights[] = {point_light(position, white, 2.0F),
                            area_light(Light::Kind::RECTANGLE, position, {2, 0, 0}, {0, 3, 0}, white),
                            area_light(Light::Kind::ELLIPSE, position, {2, 0, 0}, {0, 3, 0}, white)};
    for (const Light &light : lights) {
        // Of a square's side the variance is a third of the half, of a disk's a quarter.
        const double share = light.kind == Light::Kind::RECTANGLE ? 1.0 / 3.0 : 1.0 / 4.0;
        const double expected = share * (light.kind == Light::Kind::SPHERE ? 4.0 + 4.0 : 4.0 + 9.0);
        for (const int most : {2, 3, 16, 64}) {
            const std::vector<glm::vec3> samples =
                light_samples(view_of(light, 0.1), lit.lighting.bodies(), most, false);
            ASSERT_EQ(samples.size(), std::size_t(most));
            glm::dvec3 mean(0.0);
            double variance = 0.0;
            for (const glm::vec3 &sample : samples) {
                mean += glm::dvec3(sample - position) / double(most);
                variance += double{glm::dot(sample - position, sample - position)} / double(most);
            }
            EXPECT_LT(glm::length(mean), 1e-5) << most;
            EXPECT_NEAR(variance, expected, (most < 16 ? 0.7 : 0.06) * expected) << most;
        }
    }
    const auto middle = [&](const Light &light, int most) {
        glm::vec3 sum(0.0F);
        for (const glm::vec3 &sample : light_samples(view_of(light, 0.1), lit.lighting.bodies(), most, false)) {
            sum += sample / static_cast<float>(most);
        }
        return sum;
    };
    for (const auto &corners : {WHOLE, KITE, TRIANGLE}) {
        const Light light = polygon_in(lights[1], corners);
        const glm::vec3 centroid = view_of(light, 0.1).position;
        EXPECT_LT(glm::distance(middle(light, 16), centroid), 0.1F);
        EXPECT_LT(glm::distance(middle(light, 256), centroid), 0.02F);
        EXPECT_GT(glm::distance(centroid, position), corners == WHOLE ? -1.0F : 0.1F);
    }
}

TEST(Kernels, FillTheSameLightVolumes) {
    Scene scene = two_bodies();
    scene.media[0].scattering = {0.5F, 1.0F, 2.0F};
    scene.meshes = {parallelogram({-1, -1, 0.5F}, {2, 0, 0}, {0, 1, 0}, glm::vec3(0.5F))};
    const glm::vec3 middle = in_world(scene.media[0], glm::vec3(0.5F)), from = middle + glm::vec3(2.0F, -3.0F, 4.0F);
    Light spot = aimed(point_light(from, glm::vec3(1.0F), 0.1F), scene, from);
    spot.cone = 0.5F;
    spot.blend = 0.5F;
    scene.lights.push_back(spot);
    Light ellipse =
        aimed(area_light(Light::Kind::ELLIPSE, from, {0.3F, 0, 0}, {0, 0.2F, 0}, glm::vec3(1.0F)), scene, from);
    ellipse.spread = 1.5F;
    scene.lights.push_back(ellipse);
    // A texel's place rounds to 1e-5 of a texel, and over one texel a solid's shadow rises from nothing to all.
    for (const bool with_wall : {false, true}) {
        scene.meshes.resize(with_wall ? 1 : 0);
        const Lit lit(scene, 4);
        for (const InstructionSet &set : instruction_sets()) {
            const Lit other(scene, 4, set);
            for (std::size_t m = 0; m < 2; ++m) {
                ASSERT_EQ(lit.media[m].light.size(), other.media[m].light.size());
                double worst = 0.0;
                for (std::size_t light = 0; light < scene.lights.size(); ++light) {
                    const std::vector<float> &a = *lit.media[m].light[light], &b = *other.media[m].light[light];
                    ASSERT_EQ(a.size(), b.size());
                    for (std::size_t cell = 0; cell < a.size(); cell += 4) {
                        for (std::size_t c = 0; c < 3; ++c) {
                            const float arriving = a[cell + 3] * std::exp(-a[cell + c] * (a[cell + c] + 1.0F));
                            const float others = b[cell + 3] * std::exp(-b[cell + c] * (b[cell + c] + 1.0F));
                            worst = std::max(worst, double{std::abs(arriving - others)});
                        }
                    }
                }
                EXPECT_LT(worst, with_wall ? 5e-5 : 1e-5) << set.name;
            }
        }
    }
}

} // namespace
} // namespace sfumato
