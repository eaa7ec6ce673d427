// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/sky.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr double PI = std::numbers::pi;

// Of a row of a picture: the solid angle of each of its texels, and the height and the radius of the circle in its
// middle.
struct Row {
    Row(const SkyImage &image, int row)
        : solid_angle(2.0 * PI / image.width *
                      (std::cos(PI * row / image.height) - std::cos(PI * (row + 1) / image.height))),
          height(std::cos(PI * (row + 0.5) / image.height)), radius(std::sin(PI * (row + 0.5) / image.height)) {}

    double solid_angle, height, radius;
};

glm::dvec3 towards(const SkyImage &image, int column, const Row &row) {
    const double angle = 2.0 * PI * (0.5 - (column + 0.5) / image.width);
    return {row.radius * std::cos(angle), row.radius * std::sin(angle), row.height};
}

double mean_of(const glm::dvec3 &colour) {
    return (colour.x + colour.y + colour.z) / 3.0;
}

// A picture in at most as many columns and half as many rows: means over solid angles.
SkyImage coarser(const SkyImage &image, int columns) {
    SkyImage out;
    out.width = std::min(columns, image.width);
    out.height = std::clamp(columns / 2, 1, image.height);
    out.radiance.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    // Texels of which a part lies in another's place count there by that part.
    const auto parts = [](int from, int to, int number) {
        const double begin = static_cast<double>(number) * from / to, end = static_cast<double>(number + 1) * from / to;
        return std::pair(begin, end);
    };
    oneapi::tbb::parallel_for(0, out.height, [&](int j) {
        const auto [top, bottom] = parts(image.height, out.height, j);
        for (int i = 0; i < out.width; ++i) {
            const auto [left, right] = parts(image.width, out.width, i);
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (int y = static_cast<int>(top); y < std::min(static_cast<int>(std::ceil(bottom)), image.height); ++y) {
                const double high = std::min(bottom, y + 1.0) - std::max(top, static_cast<double>(y));
                const double solid_angle = Row(image, y).solid_angle * high;
                for (int x = static_cast<int>(left); x < std::min(static_cast<int>(std::ceil(right)), image.width);
                     ++x) {
                    const double wide = std::min(right, x + 1.0) - std::max(left, static_cast<double>(x));
                    sum += glm::dvec3(image.at(x, y)) * (solid_angle * wide);
                    weights += solid_angle * wide;
                }
            }
            out.radiance[static_cast<std::size_t>(j) * static_cast<std::size_t>(out.width) +
                         static_cast<std::size_t>(i)] = glm::vec3(sum / std::max(weights, 1e-300));
        }
    });
    return out;
}

struct Texel {
    glm::dvec3 towards, fluence;
};

std::vector<Texel> texels_of(const SkyImage &image) {
    std::vector<Texel> out;
    out.reserve(image.radiance.size());
    for (int y = 0; y < image.height; ++y) {
        const Row row(image, y);
        for (int x = 0; x < image.width; ++x) {
            out.push_back({towards(image, x, row), glm::dvec3(image.at(x, y)) * row.solid_angle});
        }
    }
    return out;
}

// A picture of means of another: `weight`, by the cosine to the direction, of each texel's; 0 below `least`.
template <typename Weight>
SkyImage averaged(const SkyImage &image, int columns, double least, const Weight &weight) {
    SkyImage out;
    out.width = columns;
    out.height = columns / 2;
    out.radiance.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    const std::vector<Texel> texels = texels_of(image);
    std::vector<double> solid_angles;
    for (int y = 0; y < image.height; ++y) {
        solid_angles.insert(solid_angles.end(), static_cast<std::size_t>(image.width), Row(image, y).solid_angle);
    }
    oneapi::tbb::parallel_for(0, out.height, [&](int j) {
        const Row row(out, j);
        for (int i = 0; i < out.width; ++i) {
            const glm::dvec3 axis = towards(out, i, row);
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (std::size_t k = 0; k < texels.size(); ++k) {
                const double cosine = glm::dot(axis, texels[k].towards);
                if (cosine > least) {
                    const double by = weight(cosine);
                    sum += texels[k].fluence * by;
                    weights += solid_angles[k] * by;
                }
            }
            out.radiance[static_cast<std::size_t>(j) * static_cast<std::size_t>(out.width) +
                         static_cast<std::size_t>(i)] = glm::vec3(sum / std::max(weights, 1e-300));
        }
    });
    return out;
}

// What gloss of an alpha gathers about a direction, seen straight on: GGX's half vectors, and the cosine of the light
// (Karis, "Real shading in Unreal Engine 4", 2013). Beyond a thousandth of the peak nothing.
SkyImage glossy(const SkyImage &image, int columns, double alpha) {
    const double alpha2 = alpha * alpha;
    const double steepest = std::min(std::atan(alpha * std::sqrt(std::sqrt(1000.0) - 1.0)), PI / 4.0);
    return averaged(image, columns, std::cos(2.0 * steepest), [alpha2](double cosine) {
        const double half2 = 0.5 * (1.0 + cosine); // of the half vector, its cosine squared
        const double d = half2 * (alpha2 - 1.0) + 1.0;
        return alpha2 / (d * d) * cosine;
    });
}

} // namespace

SkyImageView view_of(const SkyImage &image) {
    return {image.radiance.empty() ? nullptr : &image.radiance.front().x, image.width, image.height};
}

// What is BRIGHTER times as bright as the rest is on the average stands out. Where enough of it is in one place, it is
// taken from there, and makes one sun, as large as what is taken spreads.
void Sky::take_suns(SkyImage &rest) {
    constexpr double BRIGHTER = 4.0, LEAST = 0.01, CLOSE = 0.97; // 14 degrees
    constexpr int MOST = 8;
    const SkyImage small = coarser(rest, 128);
    const std::vector<Texel> texels = texels_of(small);
    double all = 0.0, limit = std::numeric_limits<double>::infinity();
    for (const Texel &texel : texels) {
        all += mean_of(texel.fluence);
    }
    for (int round = 0; round < 8; ++round) {
        double sum = 0.0;
        for (int y = 0; y < small.height; ++y) {
            for (int x = 0; x < small.width; ++x) {
                sum += std::min(mean_of(small.at(x, y)), limit) * Row(small, y).solid_angle;
            }
        }
        limit = BRIGHTER * sum / (4.0 * PI);
    }
    const auto excess = [&rest, limit](std::size_t at) {
        const glm::dvec3 colour(rest.radiance[at]);
        return colour * std::max(1.0 - limit / std::max(mean_of(colour), 1e-300), 0.0);
    };
    // A texel of the full picture, by number, that stands out.
    struct Bright {
        std::size_t at;
        glm::dvec3 towards, fluence;
    };
    std::vector<Bright> bright;
    for (int y = 0; y < rest.height; ++y) {
        const Row row(rest, y);
        for (int x = 0; x < rest.width; ++x) {
            const std::size_t at =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(rest.width) + static_cast<std::size_t>(x);
            const glm::dvec3 more = excess(at);
            if (mean_of(more) > 0.0) {
                bright.push_back({at, sfumato::towards(rest, x, row), more * row.solid_angle});
            }
        }
    }
    // What one texel spreads, for which it stands: of a square its width, along both axes.
    const double texel = PI / rest.height, texel2 = texel * texel / 6.0;
    while (static_cast<int>(suns_.size()) < MOST && !bright.empty()) {
        const auto brightest =
            std::ranges::max_element(bright, {}, [](const Bright &one) { return mean_of(one.fluence); });
        const std::size_t first = brightest->at;
        glm::dvec3 middle = brightest->towards;
        const auto is_close = [&middle](const Bright &one) { return glm::dot(one.towards, middle) > CLOSE; };
        for (int round = 0; round < 3; ++round) {
            glm::dvec3 moment(0.0);
            for (const Bright &one : bright) {
                if (is_close(one)) {
                    moment += one.towards * mean_of(one.fluence);
                }
            }
            middle = glm::normalize(moment);
        }
        const auto taken = std::partition(bright.begin(), bright.end(), [&](const Bright &b) { return !is_close(b); });
        glm::dvec3 fluence(0.0);
        double spread2 = 0.0;
        for (auto one = taken; one != bright.end(); ++one) {
            const glm::dvec3 away = one->towards - middle;
            fluence += one->fluence;
            spread2 += glm::dot(away, away) * mean_of(one->fluence);
        }
        if (mean_of(fluence) >= LEAST * all) {
            // Taken for a disk, evenly bright: half the square of its radius is the mean square of the distance.
            const double radius = std::sqrt(2.0 * (spread2 / mean_of(fluence) + texel2));
            suns_.push_back({glm::vec3(middle), glm::vec3(fluence), static_cast<float>(2.0 * radius)});
            for (auto one = taken; one != bright.end(); ++one) {
                rest.radiance[one->at] = glm::vec3(glm::dvec3(rest.radiance[one->at]) - excess(one->at));
            }
        }
        bright.erase(taken, bright.end()); // else it stays in the rest
        // One that lies out of the way of a brighter patch stays there, too.
        std::erase_if(bright, [first](const Bright &one) { return one.at == first; });
    }
}

Sky::Sky(const SkyImage &image) {
    SkyImage &rest = gloss_[0] = image;
    take_suns(rest);
    coarse_ = coarser(rest, 64);
    glm::dvec3 sum(0.0);
    for (const Texel &texel : texels_of(coarse_)) {
        sum += texel.fluence;
    }
    mean_ = glm::vec3(sum / (4.0 * PI));
    dull_ = averaged(coarse_, 64, 0.0, [](double cosine) { return cosine; });
    double alpha = FIRST_ALPHA;
    for (int level = 1; level < GLOSS_LEVELS; ++level, alpha *= 2.0) {
        // No lobe is narrower than two of the texels that it is made of.
        const int from = level == 1 ? 256 : level == 2 ? 128 : 64;
        gloss_[static_cast<std::size_t>(level)] = glossy(coarser(rest, from), level <= 2 ? 128 : 64, alpha);
    }
}

std::vector<glm::dvec3> Sky::fluence(std::span<const glm::dvec3> towards) const {
    std::vector<glm::dvec3> out(towards.size(), glm::dvec3(0.0));
    for (const Texel &texel : texels_of(coarse_)) {
        const auto nearest = std::ranges::max_element(
            towards, {}, [&](const glm::dvec3 &direction) { return glm::dot(direction, texel.towards); });
        out[static_cast<std::size_t>(nearest - towards.begin())] += texel.fluence;
    }
    return out;
}

} // namespace sfumato
