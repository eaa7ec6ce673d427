// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr int TILE = 4; // the sampling pattern repeats every TILE x TILE pixels; TILE^2 = FILM_TURNS

// Neighbouring pixels get distant turns (the order of Bayer's matrix).
int film_turn(int x, int y) {
    constexpr std::array<int, 16> BAYER = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    return BAYER[static_cast<std::size_t>((y % TILE) * TILE + x % TILE)];
}

// A pixel, or one of `count` samples of it, for what is textured: as wide as a box of the film filter's variance.
// Of 1.5 pixels, Blackman and Harris's is as wide as 1.44.
struct Standing {
    float beside_u, beside_v, pixels;

    Standing(std::size_t count, const Film &film, const Image &image)
        : beside_u(1.0F / static_cast<float>(image.width)), beside_v(1.0F / static_cast<float>(image.height)) {
        constexpr double WIDE = 1.44 / 3.0; // of the filter's diameter
        const double width = film.filter.shape == Filter::Shape::BOX ? 1.0 : WIDE * film.filter.diameter();
        pixels = static_cast<float>(width / std::sqrt(static_cast<double>(count)));
    }

    void put(Packet &packet) const {
        packet.stands_for = pixels;
        packet.beside_u = beside_u;
        packet.beside_v = beside_v;
    }
};

// The first look: every pixel once, through its centre, and either through the middles of the lights or spread over
// them.
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

SkyPixel sky_pixel(const SkyLayers &layers, std::size_t lane) {
    return {sky_part(layers.dull, lane),
            sky_part(layers.gloss, lane),
            {layers.normal[0][lane], layers.normal[1][lane], layers.normal[2][lane]}};
}

void trace_row(const Tracer &tracer, const Film &film, Image &image, int y) {
    const bool spread = film.edge_samples > 1;
    const Standing standing(1, film, image);
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    const auto fill = [&](Packet &packet, std::size_t lane, std::size_t x) {
        const FilmSample look = spread ? first_look(static_cast<int>(x), y) : FilmSample{0.0F, 0.0F, 0.5F, 0.5F};
        packet.u[lane] = (static_cast<float>(x) + 0.5F) / width;
        packet.v[lane] = (static_cast<float>(y) + 0.5F) / height;
        packet.light_u[lane] = look.light_u;
        packet.light_v[lane] = look.light_v;
        // Of a look for light of other surfaces, quarters of the square are divided once more.
        const auto finer = [](float middle, int tile) {
            return middle + (static_cast<float>(tile % 2) - 0.5F) / (2.0F * TILE);
        };
        packet.look_u[lane] = finer(look.light_u, static_cast<int>(x) / TILE);
        packet.look_v[lane] = finer(look.light_v, y / TILE);
        packet.reach = static_cast<float>(film.filter.diameter() / 2.0);
        standing.put(packet);
    };
    tracer.trace(static_cast<std::size_t>(image.width), fill,
                 [&](const Layers &layers, std::size_t lane, std::size_t x) {
                     const std::size_t pixel = image.at(static_cast<int>(x), y);
                     Image::Sample values{};
                     image.read(layers, lane, values);
                     image.set(pixel, values, true);
                     image.surfaces[pixel] = layers.open[lane];
                     image.unshadowed[pixel] = layers.unshadowed[lane];
                     image.seen[pixel] = layers.seen[lane];
                     image.distance[pixel] = layers.distance[lane];
                     if (!image.fine.empty()) {
                         image.fine[pixel] = layers.fine[lane];
                     }
                     if (!image.sky.empty()) {
                         image.sky[pixel] = sky_pixel(layers.sky, lane);
                     }
                 });
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
        }
    });
}

// What of a pixel one sample cannot tell.
enum class Unsure : std::uint8_t { NOTHING, SHADOWS, ALL, FINE }; // fine: it holds what is finer than pixels

// Whether what a compositor is given of surfaces themselves changes between two opposite neighbours.
bool passes_bend(const Image &image, std::size_t before, std::size_t centre, std::size_t after) {
    constexpr float BEND = 0.05F;
    return std::any_of(image.passes.begin(), image.passes.end(), [&](const PassImage &pass) {
        if (pass.kind->layer != Layer::NORMAL && pass.kind->layer != Layer::MIST) {
            return false;
        }
        const std::size_t count = pass.kind->sums;
        for (std::size_t c = 0; c < count; ++c) {
            const auto at = [&](std::size_t pixel) { return pass.values[count * pixel + c]; };
            if (std::abs(at(before) + at(after) - 2.0F * at(centre)) > BEND) {
                return true;
            }
        }
        return false;
    });
}

bool picture_bends(const Image &image, std::size_t before, std::size_t centre, std::size_t after) {
    constexpr float CONTRAST = 0.03F;
    const auto mean = [&image](std::size_t pixel) {
        const float *const rgba = image.rgba.data() + 4 * pixel;
        return (rgba[0] + rgba[1] + rgba[2]) * (1.0F / 3.0F);
    };
    const float bend = std::abs(mean(before) + mean(after) - 2.0F * mean(centre));
    return bend > CONTRAST * (mean(centre) + bend);
}

// Whether surfaces or their shadows change around a pixel by more than one sample can tell. Filtering leaves a linear
// ramp as it is, so what counts is how far a pixel is from the middle between two opposite neighbours: of that, what
// shows through the smoke. Where without the shadows of solids nothing would change, and the surface is the same, only
// they are looked at again.
Unsure unsure_of(const Image &image, int x, int y) {
    constexpr float CONTRAST = 0.03F, STEP = 0.02F, LEAST_FINE = 0.005F;
    const auto at = [&image](int i, int j) {
        return image.at(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1));
    };
    const std::size_t centre = at(x, y);
    const float *rgba = image.rgba.data() + 4 * centre;
    const float mean = (rgba[0] + rgba[1] + rgba[2]) * (1.0F / 3.0F);
    // A share in shadow leaves the rest; what a catcher shows is all in its alpha.
    const float brightness =
        image.wanted.shadow() ? 1.0F - mean : std::max(mean, image.surfaces[centre] * image.seen[centre]);
    const bool holds_fine = !image.fine.empty();
    bool fine = false;
    constexpr std::array<std::array<int, 2>, 4> WAYS = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
    Unsure found = Unsure::NOTHING;
    for (const auto &[dx, dy] : WAYS) {
        const std::size_t before = at(x - dx, y - dy), after = at(x + dx, y + dy);
        const auto bend = [&](const std::vector<float> &values) {
            return std::abs(values[before] + values[after] - 2.0F * values[centre]);
        };
        const float seen = std::max({image.seen[before], image.seen[centre], image.seen[after]});
        const float alpha = std::abs(image.rgba[4 * before + 3] - image.rgba[4 * after + 3]);
        const bool rim = (image.distance[before] > 2.0F * image.distance[after] ||
                          image.distance[after] > 2.0F * image.distance[before]) &&
                         alpha > CONTRAST;
        const float change = bend(image.surfaces) * seen, unshadowed = bend(image.unshadowed);
        const bool edge = change > CONTRAST * (brightness + change);
        const bool shadow = unshadowed <= CONTRAST * (image.unshadowed[centre] + unshadowed) &&
                            bend(image.distance) <= STEP * image.distance[centre];
        // What is finer than pixels throws shadows that are.
        fine = fine ||
               (holds_fine && (std::max({image.fine[before], image.fine[centre], image.fine[after]}) > LEAST_FINE ||
                               picture_bends(image, before, centre, after)));
        const bool shaft = image.shafts && picture_bends(image, before, centre, after);
        if (rim || (edge && !shadow) || shaft || passes_bend(image, before, centre, after)) {
            found = Unsure::ALL;
        }
        found = edge ? std::max(found, Unsure::SHADOWS) : found;
    }
    return fine ? Unsure::FINE : found;
}

using Patterns = std::vector<std::vector<FilmSample>>; // of each turn

// What a sample in a pixel has of other surfaces, with what the pixels around it have found of that where they see the
// same surface.
void find_around(const Image &image, int x, int y, const Layers &layers, std::size_t lane, Image::Sample &values) {
    const SkyPixel own = sky_pixel(layers.sky, lane);
    if (own.dull.sent_on() + own.gloss.sent_on() <= 0.0F) {
        return;
    }
    SkyPixel sum;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
            const SkyPixel &other = image.sky[image.at(i, j)];
            if (is_one_surface(own, layers.distance[lane], other, image.distance[image.at(i, j)])) {
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
    }
}

// Samples some pixels of a row: of each its own pattern, in as few packets as hold them all.
void refine_pixels(const Tracer &tracer, const Film &film, const Patterns &patterns, Image &image,
                   std::span<const int> columns, int y) {
    const std::size_t count = patterns.front().size(), sums = image.sums();
    const Standing standing(count, film, image);
    const auto reach = static_cast<float>(film.filter.diameter() / (2.0 * std::sqrt(static_cast<double>(count))));
    std::vector<double> sum(columns.size() * sums);
    // In air the samples of a pixel share those of the lights, each of its rows and columns all of them.
    const std::size_t turns = tracer.view.air.empty() || count % 4 != 0 ? 1 : 4, each = count / turns;
    for (std::size_t turn = 0; turn < turns; ++turn) {
        const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
            const int x = columns[number / each];
            const std::size_t i = number % each, k = turns * i + (turn + (turns - 1) * i) % turns;
            const FilmSample &s = patterns[static_cast<std::size_t>(film_turn(x, y))][k];
            packet.u[lane] = (static_cast<float>(x) + 0.5F + s.x) / static_cast<float>(image.width);
            packet.v[lane] = (static_cast<float>(y) + 0.5F + s.y) / static_cast<float>(image.height);
            packet.light_u[lane] = s.light_u;
            packet.light_v[lane] = s.light_v;
            packet.look_u[lane] = s.light_u;
            packet.look_v[lane] = s.light_v;
            packet.reach = reach;
            standing.put(packet);
            packet.turn = turn;
            packet.turns = turns;
            packet.looks = 2;
        };
        tracer.trace(columns.size() * each, fill, [&](const Layers &layers, std::size_t lane, std::size_t number) {
            Image::Sample values{};
            image.read(layers, lane, values);
            if (!image.sky.empty()) {
                find_around(image, columns[number / each], y, layers, lane, values);
            }
            for (std::size_t c = 0; c < sums; ++c) {
                sum[number / each * sums + c] += static_cast<double>(values[c]);
            }
        });
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
        Image::Sample values{};
        for (std::size_t c = 0; c < sums; ++c) {
            values[c] = static_cast<float>(sum[i * sums + c] / static_cast<double>(count));
        }
        image.set(image.at(columns[i], y), values, false);
    }
}

// The same where it is only shadows that change: one ray a pixel, with as many looks at them.
void refine_shadows(const Tracer &tracer, const Film &film, const Patterns &patterns, Image &image,
                    std::span<const int> columns, int y) {
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    const Standing standing(1, film, image);
    const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
        const int x = columns[number];
        const float column = static_cast<float>(x) + 0.5F, row = static_cast<float>(y) + 0.5F;
        packet.u[lane] = column / width;
        packet.v[lane] = row / height;
        standing.put(packet);
        packet.look_u[lane] = packet.look_v[lane] = 0.5F; // of what is sharp
        packet.looks = image.sky.empty() ? packet.looks : 0;
        const std::vector<FilmSample> &pattern = patterns[static_cast<std::size_t>(film_turn(x, y))];
        for (std::size_t k = 0; k < pattern.size(); ++k) {
            packet.shadows[k].u[lane] = (column + pattern[k].x) / width;
            packet.shadows[k].v[lane] = (row + pattern[k].y) / height;
            packet.shadows[k].light_u[lane] = pattern[k].light_u;
            packet.shadows[k].light_v[lane] = pattern[k].light_v;
        }
    };
    const auto take = [&](const Layers &layers, std::size_t lane, std::size_t number) {
        Image::Sample values{};
        image.read(layers, lane, values);
        const std::size_t pixel = image.at(columns[number], y);
        for (std::size_t c = 0; c < 3 && !image.sky.empty(); ++c) {
            values[c] += layers.sky.dull.weight[c][lane] * image.sky[pixel].dull.found[c] +
                         layers.sky.gloss.weight[c][lane] * image.sky[pixel].gloss.found[c];
        }
        image.set(pixel, values, true);
    };
    tracer.trace(columns.size(), fill, take, patterns.front().size());
}

// Runs body(y) for each row of an image on all cores, asking `progress` between chunks of rows. False if it was
// stopped.
template <typename Body>
bool in_chunks(const Image &image, double done, double share, const Progress &progress, const Body &body) {
    // Few enough to keep all cores busy, and so many that a stop is not long in coming.
    constexpr std::size_t LEAST = 8, PIXELS = 1U << 16U;
    const auto chunks = progress ? static_cast<int>(std::max(LEAST, image.distance.size() / PIXELS)) : 1;
    const auto first = [&](int chunk) { return static_cast<int>(std::int64_t{image.height} * chunk / chunks); };
    for (int chunk = 0; chunk < chunks; ++chunk) {
        if (progress && !progress(done + share * chunk / chunks)) {
            return false;
        }
        oneapi::tbb::parallel_for(first(chunk), first(chunk + 1), body);
    }
    return true;
}

// A filter that is wider than 1.5 pixels to a side brings what changes to pixels further away.
int further(const Filter &filter) {
    return std::max(static_cast<int>(std::ceil(filter.diameter() / 2.0 - 0.5)) - 1, 0);
}

// Of each pixel the most unsure of those that are up to `reach` pixels away.
void spread_unsure(const Image &image, int reach, std::vector<Unsure> &unsure) {
    const auto along = [&](int count, int others, auto at) {
        oneapi::tbb::parallel_for(0, others, [&](int other) {
            std::vector<Unsure> line(static_cast<std::size_t>(count));
            for (int i = 0; i < count; ++i) {
                for (int j = std::max(i - reach, 0); j <= std::min(i + reach, count - 1); ++j) {
                    line[static_cast<std::size_t>(i)] =
                        std::max(line[static_cast<std::size_t>(i)], unsure[at(j, other)]);
                }
            }
            for (int i = 0; i < count; ++i) {
                unsure[at(i, other)] = line[static_cast<std::size_t>(i)];
            }
        });
    };
    along(image.width, image.height, [&image](int x, int y) { return image.at(x, y); });
    along(image.height, image.width, [&image](int y, int x) { return image.at(x, y); });
}

// Samples the pixels in which surfaces or their shadows change. False if progress said stop.
bool refine(const Tracer &tracer, const Film &film, const Progress &progress, Image &image) {
    const auto patterns_of = [&film](int count) {
        Patterns patterns;
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            patterns.push_back(film_samples(count, turn, film.filter));
        }
        return patterns;
    };
    const Patterns patterns = patterns_of(film.edge_samples), finer = patterns_of(2 * film.edge_samples);
    // Which pixels are edges is settled before any of them changes.
    std::vector<Unsure> unsure(image.distance.size());
    oneapi::tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            unsure[image.at(x, y)] = unsure_of(image, x, y);
        }
    });
    if (const int reach = further(film.filter); reach > 0) {
        spread_unsure(image, reach, unsure);
    }
    // A pixel and its eight neighbours may all miss a thin shadow or a corner of a light; their neighbours' do not.
    const auto beside_shadow = [&](int x, int y) {
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
                if (unsure[image.at(i, j)] == Unsure::SHADOWS) {
                    return true;
                }
            }
        }
        return false;
    };
    return in_chunks(image, 0.5, 0.5, progress, [&](int y) {
        std::vector<int> edges, shadows, fine;
        for (int x = 0; x < image.width; ++x) {
            if (unsure[image.at(x, y)] == Unsure::FINE) {
                fine.push_back(x);
            } else if (unsure[image.at(x, y)] == Unsure::ALL) {
                edges.push_back(x);
            } else if (beside_shadow(x, y)) {
                shadows.push_back(x);
            }
        }
        refine_pixels(tracer, film, patterns, image, edges, y);
        refine_pixels(tracer, film, finer, image, fine, y);
        refine_shadows(tracer, film, patterns, image, shadows, y);
    });
}

} // namespace

std::optional<Image> traced(const Tracer &tracer, int width, int height, const Film &film, const Progress &progress) {
    Image image(tracer.wanted, width, height);
    if (tracer.wanted.has(Layer::RADIANCE) && !tracer.view.strands.empty()) {
        image.fine.resize(image.distance.size());
    }
    const bool bounces = tracer.view.bounces.gloss || tracer.view.bounces.diffuse;
    if (tracer.wanted.has(Layer::RADIANCE) &&
        (bounces || std::any_of(tracer.view.lights.begin(), tracer.view.lights.end(),
                                [](const LightView &light) { return light.surrounds(); }))) {
        image.sky.resize(image.distance.size());
    }
    image.shafts = tracer.wanted.has(Layer::RADIANCE) && !tracer.view.air.empty();
    const bool closer = film.edge_samples > 1;
    if (!in_chunks(image, 0.0, closer ? 0.5 : 1.0, progress, [&](int y) { trace_row(tracer, film, image, y); })) {
        return std::nullopt;
    }
    if (!image.sky.empty() && closer) {
        put_looks_together(image);
    }
    if (closer && !refine(tracer, film, progress, image)) {
        return std::nullopt;
    }
    return image;
}

} // namespace sfumato
