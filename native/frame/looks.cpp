// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/looks.hpp"

#include "frame/sample_packet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

SkyPixel::Part sky_part(const SkyLayers::Part &layers, std::size_t lane) {
    SkyPixel::Part out;
    for (std::size_t c = 0; c < 3; ++c) {
        out.light[c] = layers.light[c][lane];
        out.all[c] = layers.all[c][lane];
        out.seen[c] = layers.seen[c][lane];
        out.weight[c] = layers.weight[c][lane];
        out.found[c] = layers.found[c][lane];
    }
    out.open = layers.open[lane];
    return out;
}

// Of each colour of light the share that a few directions find open.
std::array<float, 3> share_of(const SkyPixel::Part &part) {
    std::array<float, 3> out{};
    for (std::size_t c = 0; c < 3; ++c) {
        out[c] = part.all[c] > 0.0F ? part.seen[c] / part.all[c] : 1.0F;
    }
    return out;
}

void add(float weight, const SkyPixel::Part &from, SkyPixel::Part &to) {
    for (std::size_t c = 0; c < 3; ++c) {
        to.all[c] += weight * from.all[c];
        to.seen[c] += weight * from.seen[c];
    }
}

// Of light from other surfaces; in the sum, `weight` counts what is found.
void add_found(float weight, const SkyPixel::Part &from, SkyPixel::Part &to) {
    if (from.sent_on() > 0.0F) {
        for (std::size_t c = 0; c < 3; ++c) {
            to.weight[c] += weight;
            to.found[c] += weight * from.found[c];
        }
    }
}

std::array<float, 3> found_by(const SkyPixel::Part &sum) {
    std::array<float, 3> out{};
    for (std::size_t c = 0; c < 3 && sum.weight[c] > 0.0F; ++c) {
        out[c] = sum.found[c] / sum.weight[c];
    }
    return out;
}

bool is_one_surface(const SkyPixel &a, float distance, const SkyPixel &b, float other) {
    constexpr float FACING = 0.9F, DEEPER = 0.05F;
    float facing = 0.0F;
    for (std::size_t c = 0; c < 3; ++c) {
        facing += a.normal[c] * b.normal[c];
    }
    return facing > FACING && std::abs(other - distance) < DEEPER * distance;
}

// Calls body(other, weight) for the pixels around one that see the same surface, up to `reach` away in both directions:
// the rim counts half, so that each of (2 reach)^2 turns is held as often as any other.
template <typename Body>
void around(const Image &image, int x, int y, int reach, const Body &body) {
    const std::size_t own = image.at(x, y);
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, image.height - 1); ++j) {
        for (int i = std::max(x - reach, 0); i <= std::min(x + reach, image.width - 1); ++i) {
            const std::size_t at = image.at(i, j);
            const SkyPixel &other = image.sky[at];
            if (other.lit() && is_one_surface(image.sky[own], image.distance[own], other, image.distance[at])) {
                body(other, (std::abs(i - x) == reach ? 0.5F : 1.0F) * (std::abs(j - y) == reach ? 0.5F : 1.0F));
            }
        }
    }
}

// Neighbouring pixels look in different directions, TILE^2 of them in all: together those of one surface see as much as
// many looks of each (Keller and Heidrich, "Interleaved sampling", 2001). For light of other surfaces, which changes
// more slowly, it is four times as many.
SkyPixel looks_around(const Image &image, int x, int y) {
    SkyPixel sum;
    around(image, x, y, TILE / 2, [&sum](const SkyPixel &other, float weight) {
        add(weight, other.dull, sum.dull);
        add(weight, other.gloss, sum.gloss);
    });
    const SkyPixel &own = image.sky[image.at(x, y)];
    if (own.dull.sent_on() + own.gloss.sent_on() > 0.0F) {
        around(image, x, y, TILE, [&sum](const SkyPixel &other, float weight) {
            add_found(weight, other.dull, sum.dull);
            add_found(weight, other.gloss, sum.gloss);
        });
    }
    return sum;
}

} // namespace

SkyPixel sky_pixel(const SkyLayers &layers, std::size_t lane) {
    return {sky_part(layers.dull, lane),
            sky_part(layers.gloss, lane),
            {layers.normal[0][lane], layers.normal[1][lane], layers.normal[2][lane]}};
}

void find_around(const Image &image, int x, int y, const Layers &layers, std::size_t lane, Image::Sample &values) {
    const SkyPixel own = sky_pixel(layers.sky, lane);
    if (!own.lit()) {
        return;
    }
    SkyPixel sum;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
            const SkyPixel &other = image.sky[image.at(i, j)];
            if (is_one_surface(own, layers.distance[lane], other, image.distance[image.at(i, j)])) {
                add(1.0F, other.dull, sum.dull);
                add(1.0F, other.gloss, sum.gloss);
                add_found(1.0F, other.dull, sum.dull);
                add_found(1.0F, other.gloss, sum.gloss);
            }
        }
    }
    for (const auto &[part, around] : {std::pair(&own.dull, &sum.dull), std::pair(&own.gloss, &sum.gloss)}) {
        if (around->weight[0] > 0.0F) {
            const std::array<float, 3> found = found_by(*around);
            for (std::size_t c = 0; c < 3; ++c) {
                values[c] += part->weight[c] * (found[c] - part->found[c]);
            }
        }
        if (around->all[0] > 0.0F) {
            const std::array<float, 3> open = share_of(*around), looked = share_of(*part);
            for (std::size_t c = 0; c < 3; ++c) {
                values[c] += part->light[c] * (open[c] - looked[c]);
            }
        }
    }
}

void put_looks_together(Image &image) {
    struct Shares {
        std::array<float, 3> dull, gloss, found_dull, found_gloss;
    };
    std::vector<Shares> shares(image.sky.size());
    oneapi::tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            if (image.sky[image.at(x, y)].lit()) {
                const SkyPixel sum = looks_around(image, x, y);
                shares[image.at(x, y)] = {share_of(sum.dull), share_of(sum.gloss), found_by(sum.dull),
                                          found_by(sum.gloss)};
            }
        }
    });
    oneapi::tbb::parallel_for(std::size_t{0}, image.sky.size(), [&](std::size_t pixel) {
        SkyPixel &sky = image.sky[pixel];
        if (sky.lit()) {
            const auto put = [&](const SkyPixel::Part &part, const std::array<float, 3> &wanted,
                                 const std::array<float, 3> &around) {
                const std::array<float, 3> found = share_of(part);
                float hidden = 0.0F, all = 1e-30F;
                for (std::size_t c = 0; c < 3; ++c) {
                    image.rgba[4 * pixel + c] += (wanted[c] - found[c]) * part.light[c];
                    hidden += (1.0F - found[c]) * part.light[c];
                    all += part.light[c];
                    image.rgba[4 * pixel + c] += (around[c] - part.found[c]) * part.weight[c];
                }
                // What hides a sky has no edges to look for.
                image.surfaces[pixel] += hidden / all * part.open;
            };
            put(sky.dull, shares[pixel].dull, shares[pixel].found_dull);
            put(sky.gloss, shares[pixel].gloss, shares[pixel].found_gloss);
            sky.dull.found = shares[pixel].found_dull;
            sky.gloss.found = shares[pixel].found_gloss;
            sky.dull.all = sky.gloss.all = {1.0F, 1.0F, 1.0F};
            sky.dull.seen = shares[pixel].dull;
            sky.gloss.seen = shares[pixel].gloss;
        }
    });
}

} // namespace sfumato
