// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of every basis, and of curves: what a frame reads is what the console's functions say of the same ray.
#include "maps/light_map.hpp"
#include "maps/map_kernels.hpp"
#include "rays/curve.hpp"
#include "support/reference_scenes.hpp"

#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::oblique_grid;
using reference::testing::random_medium;
using reference::testing::smooth_medium;
using reference::testing::uniform_medium;

const glm::dvec3 slanting(0.3, 0.2, -0.9);

struct Way {
    const char *name;
    BasisName basis;
    int coefficients;
    bool curved, shared;
};

constexpr Way WAYS[] = {
    {"fourier", FOURIER, 7, false, false},       {"cosine", COSINE, 15, false, false},
    {"piecewise", PIECEWISE, 32, false, false},  {"learned", LEARNED, 9, false, false},
    {"curve", COSINE, 15, true, false},          {"shared_fourier", FOURIER, 15, false, true},
    {"shared_cosine", COSINE, 7, false, true},   {"shared_piecewise", PIECEWISE, 7, false, true},
    {"shared_learned", LEARNED, 7, false, true},
};

LightMapSettings settings_of(const Way &way, double texels_per_cell = 1.0) {
    LightMapSettings settings{way.coefficients, texels_per_cell};
    settings.basis = way.basis;
    settings.curved = way.curved;
    settings.shared = way.shared;
    return settings;
}

// The density between the eight cells around a position in the grid, in double precision.
double density_at(const CroppedMedium &medium, const glm::dvec3 &at) {
    const glm::ivec3 n = medium.grid->resolution;
    std::vector<float> cells(std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z));
    copy_cells(*medium.grid, medium.grid->density, 1, cells);
    const glm::dvec3 p = at - 0.5;
    const glm::ivec3 low = glm::ivec3(glm::floor(p));
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 cell = low + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(cell, n))) {
            continue;
        }
        const glm::dvec3 apart = 1.0 - glm::abs(p - glm::dvec3(cell));
        sum += apart.x * apart.y * apart.z * double{cells[std::size_t((cell.z * n.y + cell.y) * n.x + cell.x)]};
    }
    return sum;
}

// The slices of a texel's ray that hold smoke, as optical depths of a colour.
struct Ray {
    std::vector<float> depth, tau;
    float width;

    [[nodiscard]] Absorbers absorbers() const { return {depth, tau, width}; }
};

glm::dvec3 on_ray(const LightMap &map, int x, int y, double z) {
    const glm::dvec3 place((x + 0.5) / map.size.x, (y + 0.5) / map.size.y, z);
    return glm::dvec3(glm::inverse(map.world_to_light) * glm::dvec4(place, 1.0));
}

Ray ray_of(const LightMap &map, const CroppedMedium &medium, int x, int y, float extinction) {
    Ray ray{{}, {}, 1.0F / float(map.slices)};
    const glm::dmat4 world_to_grid = glm::inverse(medium.grid_to_world);
    for (int s = 0; s < map.slices; ++s) {
        const double z = (s + 0.5) / map.slices;
        const double density = density_at(medium, glm::dvec3(world_to_grid * glm::dvec4(on_ray(map, x, y, z), 1.0)));
        if (density > 1e-6) {
            ray.depth.push_back(float(z));
            ray.tau.push_back(float(density * map.length / map.slices) * extinction);
        }
    }
    return ray;
}

std::vector<float> depths(int count) {
    std::vector<float> out;
    for (int i = 0; i < count; ++i) {
        out.push_back((float(i) + 0.37F) / float(count));
    }
    return out;
}

// The transmittance that the map says at depths of one texel's ray, in a colour.
std::vector<float> looked_up(const LightMap &map, int x, int y, const std::vector<float> &z, float extinction,
                             int colour = 0) {
    std::vector<float> points, columns(z.size());
    for (const float depth : z) {
        const glm::vec3 p(on_ray(map, x, y, double{depth}));
        points.insert(points.end(), {p.x, p.y, p.z});
    }
    map.look_up(points, columns, colour);
    for (float &column : columns) {
        column = std::exp(-column * extinction);
    }
    return columns;
}

class EveryWay : public testing::TestWithParam<Way> {};

TEST_P(EveryWay, AgreesWithTheConsoleOnTheSameRay) {
    const Way &way = GetParam();
    Medium smoke = smooth_medium({14, 12, 10}, oblique_grid());
    smoke.absorption = {0.5F, 1.0F, 2.0F};
    const CroppedMedium medium = crop(smoke);
    const LightMap map = build_parallel_map(medium, slanting, settings_of(way));
    const MapSeries series = series_of(map);
    const std::vector<float> z = depths(33);
    for (const int colour : {0, 2}) {
        const float extinction = medium.extinction[colour];
        for (int y = 1; y < map.size.y; y += 3) {
            for (int x = 2; x < map.size.x; x += 3) {
                const Ray ray = ray_of(map, medium, x, y, extinction);
                std::vector<float> expected(z.size(), 1.0F);
                const auto texel = std::size_t(y * map.size.x + x);
                if (way.curved) {
                    std::vector<std::uint8_t> curve(CURVE_BYTES);
                    fit_curve(exact_curve(ray.absorbers()), curve);
                    curve_transmittance(curve, z, expected);
                } else {
                    std::vector<float> c(map.series.count, 0.0F);
                    project(map.series, ray.absorbers(), series.ranges[texel], c);
                    transmittance(map.series, c, series.ranges[texel], Evaluator::CLAMP, z, expected);
                    // The map's own coefficients are the same, as optical depths.
                    for (std::size_t k = 0; k < c.size(); ++k) {
                        const float found = series.coefficients[texel * c.size() + k] * extinction;
                        EXPECT_NEAR(found, c[k], 2e-5F * std::max(1.0F, c[0])) << k;
                    }
                }
                const std::vector<float> found = looked_up(map, x, y, z, extinction, colour);
                for (std::size_t i = 0; i < z.size(); ++i) {
                    // A curve's levels may round the other way for a last digit of the density.
                    EXPECT_NEAR(found[i], expected[i], way.curved ? 4e-3 : 1e-5) << x << ", " << y << " at " << z[i];
                }
            }
        }
    }
}

TEST_P(EveryWay, KeepsTransmittanceBetweenOneAndTheTotal) {
    const Way &way = GetParam();
    const CroppedMedium medium = crop(random_medium({9, 8, 7}, oblique_grid(), 3));
    const LightMap map = build_parallel_map(medium, slanting, settings_of(way, 2.0));
    std::vector<float> z = depths(40);
    z.push_back(1.5F);
    for (int y = 0; y < map.size.y - 1; y += 2) {
        const std::vector<float> found = looked_up(map, map.size.x / 2, y, z, 1.0F);
        for (const float light : found) {
            EXPECT_LE(light, 1.0F);
            EXPECT_GE(light, found.back() * (1.0F - 1e-4F));
        }
    }
}

double error_of(const Way &way, const CroppedMedium &medium, const LightMap &judge) {
    const LightMap map = build_parallel_map(medium, slanting, settings_of(way));
    double sum = 0.0;
    int count = 0;
    const std::vector<float> z = depths(25);
    for (int y = 2; y < map.size.y; y += 3) {
        for (int x = 2; x < map.size.x; x += 3) {
            const std::vector<float> found = looked_up(map, x, y, z, 1.0F), exact = looked_up(judge, x, y, z, 1.0F);
            for (std::size_t i = 0; i < z.size(); ++i) {
                sum += std::pow(double{found[i]} - double{exact[i]}, 2);
                ++count;
            }
        }
    }
    return std::sqrt(sum / count);
}

TEST_P(EveryWay, FallsInErrorAsCoefficientsGrow) {
    Way way = GetParam();
    const CroppedMedium medium = crop(smooth_medium({16, 16, 16}, oblique_grid()));
    const LightMap judge = build_parallel_map(medium, slanting, {63, 1.0});
    if (way.curved) { // seven knots, whatever is asked for
        EXPECT_LT(error_of(way, medium, judge), 5e-3);
        return;
    }
    double last = 1.0;
    for (const int coefficients : {1, 5, 15, 45}) {
        way.coefficients = coefficients;
        const double error = error_of(way, medium, judge);
        EXPECT_LT(error, std::max(0.75 * last, 5e-4)) << coefficients;
        last = error;
    }
    EXPECT_LT(last, 2e-3);
}

TEST_P(EveryWay, IsTheSameOnEveryInstructionSet) {
    const Way &way = GetParam();
    const CroppedMedium medium = crop(random_medium({12, 14, 11}, oblique_grid(), 35));
    for (const bool radial : {false, true}) {
        const auto build = [&](const InstructionSet &with) {
            return radial ? build_radial_map(medium, {3.0, -4.0, 9.0}, settings_of(way), with)
                          : build_parallel_map(medium, slanting, settings_of(way), with);
        };
        const LightMap map = build(instruction_set());
        std::vector<float> points;
        for (int i = 0; i < 203; ++i) {
            const glm::dvec3 cell(12.0 * (i % 7) / 6.0, 14.0 * (i % 11) / 10.0, 11.0 * (i % 13) / 12.0);
            const glm::vec3 p(medium.grid_to_world * glm::dvec4(cell, 1.0));
            points.insert(points.end(), {p.x, p.y, p.z});
        }
        for (const InstructionSet &set : instruction_sets()) {
            const LightMap other = build(set);
            std::vector<float> columns(203), others(203);
            map_kernels(instruction_set()).look_up(map.view(), points.data(), columns.data(), 203, 0);
            map_kernels(set).look_up(other.view(), points.data(), others.data(), 203, 0);
            for (std::size_t i = 0; i < columns.size(); ++i) {
                EXPECT_NEAR(std::exp(-others[i]), std::exp(-columns[i]), way.curved ? 4e-3 : 2e-5)
                    << set.name << ", point " << i;
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Ways, EveryWay, testing::ValuesIn(WAYS),
                         [](const auto &way) { return std::string(way.param.name); });

// Even smoke is a straight line of optical depth. What the padding of its range makes of it rings, the more the fewer
// coefficients there are.
TEST(OwnRanges, RiseEvenlyInEvenSmoke) {
    const CroppedMedium medium = crop(uniform_medium({8, 8, 8}, 0.5F, glm::mat4(1.0F)));
    for (const Way &way : WAYS) {
        const LightMap map = build_parallel_map(medium, {0.0, 0.0, -1.0}, settings_of(way));
        for (const float z : {-1.0F, 2.0F, 4.0F, 5.0F, 9.0F}) {
            const glm::vec3 point(4.0F, 4.0F, z);
            float column = -1.0F;
            map.look_up({&point.x, 3}, {&column, 1});
            const bool outside = z < 0.0F || z > 8.0F;
            if (outside || !way.shared) {
                EXPECT_NEAR(column, 0.5 * std::clamp(8.0 - double{z}, 0.0, 8.0), outside ? 5e-3 : 0.12)
                    << way.name << " at " << z;
            }
        }
    }
}

// What a filter spreads it neither makes nor loses.
TEST(SharedMap, KeepsTheMassOfTheSmokeWhenItIsBlurred) {
    const CroppedMedium medium = crop(smooth_medium({16, 16, 16}, oblique_grid()));
    for (const Way &way : WAYS) {
        LightMapSettings settings = settings_of(way);
        if (!way.shared) {
            continue;
        }
        double sharp = 0.0, sharpest = 0.0;
        for (const double blur : {0.0, 1.0, 3.0}) {
            settings.blur = blur * medium.cell_size;
            const LightMap map = build_parallel_map(medium, slanting, settings);
            const auto stride = std::size_t(map.view().stride());
            double sum = 0.0, peak = 0.0;
            for (std::size_t at = 0; at < map.coefficients.size(); at += stride) {
                sum += double{map.coefficients[at]};
                peak = std::max(peak, double{map.coefficients[at]});
            }
            sharp = blur > 0.0 ? sharp : sum;
            sharpest = blur > 0.0 ? sharpest : peak;
            EXPECT_NEAR(sum, sharp, 1e-4 * sharp) << way.name << " " << blur;
            EXPECT_LE(peak, blur > 0.0 ? 0.99 * sharpest : sharpest) << way.name << " " << blur;
        }
    }
}

} // namespace
} // namespace sfumato
