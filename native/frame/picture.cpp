// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/picture.hpp"

#include "frame/around.hpp"
#include "frame/blurred.hpp"
#include "frame/looks.hpp"
#include "frame/sample_packet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// The first look: every pixel once, through its centre, and either through the middles of the lights or spread over
// them.
void trace_row(const Tracer &tracer, const Film &film, Image &image, int y) {
    const bool spread = film.edge_samples > 1;
    const Standing standing(1, film, image);
    const auto fill = [&](Packet &packet, std::size_t lane, std::size_t x) {
        put_first_look(spread, static_cast<int>(x), y, image, packet, lane);
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

// Samples some pixels of a row: of each its own pattern, in as few packets as hold them all.
void refine_pixels(const Tracer &tracer, const Film &film, const FilmPatterns &patterns, Image &image,
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
            put_sample(s, x, y, image, packet, lane);
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
void refine_shadows(const Tracer &tracer, const Film &film, const FilmPatterns &patterns, Image &image,
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

// Runs body(i) for each i < count on all cores, asking `progress` between chunks of these. False if it was stopped.
template <typename Body>
bool in_chunks(int count, int chunks, double done, double share, const Progress &progress, const Body &body) {
    chunks = progress ? chunks : 1;
    const auto first = [&](int chunk) { return static_cast<int>(std::int64_t{count} * chunk / chunks); };
    for (int chunk = 0; chunk < chunks; ++chunk) {
        if (progress && !progress(done + share * chunk / chunks)) {
            return false;
        }
        oneapi::tbb::parallel_for(first(chunk), first(chunk + 1), body);
    }
    return true;
}

// The same for each row of an image.
template <typename Body>
bool in_rows(const Image &image, double done, double share, const Progress &progress, const Body &body) {
    // Few enough to keep all cores busy, and so many that a stop is not long in coming.
    constexpr std::size_t LEAST = 8, PIXELS = 1U << 16U;
    const auto chunks = static_cast<int>(std::max(LEAST, image.distance.size() / PIXELS));
    return in_chunks(image.height, chunks, done, share, progress, body);
}

// A filter that is wider than 1.5 pixels to a side brings what changes to pixels further away.
int further(const Filter &filter) {
    return std::max(static_cast<int>(std::ceil(filter.diameter() / 2.0 - 0.5)) - 1, 0);
}

// Which pixels one sample cannot tell: settled before any of them changes.
std::vector<Unsure> unsure_pixels(const Film &film, const Image &image) {
    std::vector<Unsure> unsure(image.distance.size());
    oneapi::tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            unsure[image.at(x, y)] = unsure_of(image, x, y);
        }
    });
    if (const int reach = further(film.filter); reach > 0) {
        take_from_around(image.width, image.height, reach, std::greater<>(), unsure);
    }
    return unsure;
}

std::vector<std::uint8_t> changing(std::span<const Unsure> unsure) {
    std::vector<std::uint8_t> out;
    out.reserve(unsure.size());
    std::ranges::transform(unsure, std::back_inserter(out),
                           [](Unsure each) { return each == Unsure::NOTHING ? std::uint8_t{0} : std::uint8_t{1}; });
    return out;
}

// Samples the pixels in which surfaces or their shadows change, but not those that are blurred, of which there may be
// none. False if progress said stop.
bool refine(const Tracer &tracer, const Film &film, double done, double share, const Progress &progress,
            std::span<const Unsure> unsure, std::span<const std::uint16_t> blurred, Image &image) {
    const FilmPatterns patterns = film_patterns(film.edge_samples, film.filter),
                       finer = film_patterns(2 * film.edge_samples, film.filter);
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
    return in_rows(image, done, share, progress, [&](int y) {
        std::vector<int> edges, shadows, fine;
        for (int x = 0; x < image.width; ++x) {
            if (!blurred.empty() && blurred[image.at(x, y)] != 0) {
                continue;
            }
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

std::optional<Image> traced(const Tracer &tracer, const Blur &blur, int width, int height, const Film &film,
                            const Progress &progress) {
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
    // Of the whole, what a first look takes, and a closer one: of what is blurred most is another.
    const double first = !closer ? 1.0 : blur.empty() ? 0.5 : 0.1, second = blur.empty() ? 0.5 : 0.1;
    if (!in_rows(image, 0.0, first, progress, [&](int y) { trace_row(tracer, film, image, y); })) {
        return std::nullopt;
    }
    if (!closer) {
        return image;
    }
    const std::vector<float> looked = blur.empty() ? std::vector<float>() : image.rgba;
    if (!image.sky.empty()) {
        put_looks_together(image);
    }
    const std::vector<Unsure> unsure = unsure_pixels(film, image);
    const std::vector<std::uint16_t> blurred =
        blur.empty() ? std::vector<std::uint16_t>()
                     : blurred_pixels(tracer, blur, film, image, looked, changing(unsure));
    if (!refine(tracer, film, first, second, progress, unsure, blurred, image)) {
        return std::nullopt;
    }
    if (blur.empty()) {
        return image;
    }
    constexpr int STRIPS = 16; // at least, in a chunk
    const int strips = (height + TILE - 1) / TILE;
    Blurring blurring(tracer, blur, film, blurred, image);
    const auto sample = [&](int strip) { blurring.sample(strip * TILE, std::min((strip + 1) * TILE, height)); };
    if (!in_chunks(strips, std::max(strips / STRIPS, 1), first + second, 1.0 - first - second, progress, sample)) {
        return std::nullopt;
    }
    blurring.finish(image);
    return image;
}

} // namespace sfumato
