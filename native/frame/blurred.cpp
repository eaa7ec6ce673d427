// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/blurred.hpp"

#include "frame/around.hpp"
#include "frame/looks.hpp"
#include "frame/sample_packet.hpp"
#include "scene/places_in_picture.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

struct Pixel {
    int x, y;
};

// By their turns: those of one see from the same eye, in one packet.
using Turns = std::array<std::vector<Pixel>, FILM_TURNS>;

template <typename Wanted>
Turns turns_of(int width, int first, int last, const Wanted &wanted) {
    Turns out;
    for (int y = first; y < last; ++y) {
        for (int x = 0; x < width; ++x) {
            if (wanted(x, y)) {
                out[static_cast<std::size_t>(film_turn(x, y))].push_back({x, y});
            }
        }
    }
    return out;
}

Tracer from(const Tracer &tracer, const FrameView &view) {
    return {tracer.with, view, tracer.wanted, tracer.clock};
}

// How far two samples of a pixel, RGBA, are apart.
float difference(const float *a, const float *b) {
    constexpr float FEW = 0.1F; // of a colour beside the others
    const auto sum = [](const float *rgb) { return rgb[0] + rgb[1] + rgb[2]; };
    const float few = std::max(FEW / 3.0F * std::max(sum(a), sum(b)), 1e-20F);
    float out = std::abs(a[3] - b[3]);
    for (int c = 0; c < 3; ++c) {
        out = std::max(out, std::abs(a[c] - b[c]) / std::max({a[c], b[c], few}));
    }
    return out;
}

// Where the eyes of all turns, in the mean over the tiles that a pixel is in, see something else than the middle one.
// What merely grows from side to side, as light does over most surfaces, they see alike.
void add_other_means(const Image &image, std::span<const float> seen, std::span<const float> sharp,
                     std::vector<std::uint8_t> &differs) {
    constexpr float ALLOWED = 0.005F;
    const auto columns = static_cast<std::size_t>(image.width) + 1;
    const auto corner = [columns](int x, int y) {
        return static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
    };
    // Sums from the corner on, of both.
    std::vector<std::array<double, 8>> sums(corner(0, image.height + 1));
    for (int y = 0; y < image.height; ++y) {
        std::array<double, 8> row{};
        for (int x = 0; x < image.width; ++x) {
            const std::size_t pixel = image.at(x, y);
            for (std::size_t c = 0; c < 4; ++c) {
                row[c] += static_cast<double>(seen[4 * pixel + c]);
                row[4 + c] += static_cast<double>(sharp[4 * pixel + c]);
            }
            for (std::size_t c = 0; c < 8; ++c) {
                sums[corner(x + 1, y + 1)][c] = sums[corner(x + 1, y)][c] + row[c];
            }
        }
    }
    oneapi::tbb::parallel_for(0, std::max(image.height - TILE + 1, 0), [&](int y) {
        for (int x = 0; x + TILE <= image.width; ++x) {
            std::array<float, 8> means{};
            for (std::size_t c = 0; c < 8; ++c) {
                means[c] = static_cast<float>((sums[corner(x + TILE, y + TILE)][c] - sums[corner(x, y + TILE)][c] -
                                               sums[corner(x + TILE, y)][c] + sums[corner(x, y)][c]) /
                                              (TILE * TILE));
            }
            if (difference(means.data(), means.data() + 4) > ALLOWED) {
                differs[image.at(x + TILE / 2, y + TILE / 2)] = 1;
            }
        }
    });
}

Camera camera_of(const FrameView &view) {
    const auto &c = view.camera;
    return {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
}

glm::dvec3 place_seen(const Camera &camera, double u, double v, double distance) {
    const auto on = [&](const std::array<glm::vec3, 3> &plane) {
        return glm::dvec3(plane[0]) + u * glm::dvec3(plane[1]) + v * glm::dvec3(plane[2]);
    };
    const glm::dvec3 origin = on(camera.near);
    return origin + glm::normalize(on(camera.far) - origin) * distance;
}

// Where in a picture the middle eye's neighbours see a place: those to the right of it and above, each at the rim of
// the lens, and one at the shutter's closing instead of its opening.
class Movements {
public:
    Movements(const Exposure &exposure, int width, int height)
        : middle_(exposure.middle(), width, height), opens_(exposure.at(exposure.when(0.0F)), width, height),
          closes_(exposure.at(exposure.when(1.0F)), width, height), moves_(exposure.cameras.size() > 1) {
        if (exposure.lens.radius > 0.0F) {
            // As far as a disk reaches that is spread as the aperture is: a polygon's variance is R^2 (2 + cos(2 pi /
            // n)) / 12.
            const float corners = static_cast<float>(std::max(exposure.lens.blades, 0));
            const float wide =
                corners < 3.0F ? 1.0F : std::sqrt((2.0F + std::cos(6.28318531F / corners)) * (1.0F / 3.0F));
            right_.emplace(through(exposure.middle(), exposure.lens, wide / exposure.lens.ratio, 0.0F), width, height);
            up_.emplace(through(exposure.middle(), exposure.lens, 0.0F, wide), width, height);
        }
    }

    // Pixels. None where something is behind an eye.
    [[nodiscard]] std::array<glm::vec2, 3> operator()(const glm::dvec3 &place) const {
        std::array<glm::vec2, 3> out{};
        const auto seen = [&place](const PlacesInPicture &eye) {
            return eye.along(place) > 0.0 ? std::optional(eye.place(place).pixel) : std::nullopt;
        };
        const std::optional<glm::dvec2> middle = seen(middle_);
        if (middle && right_) {
            const std::optional<glm::dvec2> right = seen(*right_), up = seen(*up_);
            out[0] = right ? glm::vec2(*right - *middle) : glm::vec2(0.0F);
            out[1] = up ? glm::vec2(*up - *middle) : glm::vec2(0.0F);
        }
        if (moves_) {
            const std::optional<glm::dvec2> before = seen(opens_), after = seen(closes_);
            out[2] = before && after ? glm::vec2(*after - *before) : glm::vec2(0.0F);
        }
        return out;
    }

private:
    PlacesInPicture middle_, opens_, closes_;
    std::optional<PlacesInPicture> right_, up_;
    bool moves_;
};

// Half of what is moved over, pixels.
float width_of(const std::array<glm::vec2, 3> &moves) {
    return std::max({glm::length(moves[0]), glm::length(moves[1]), 0.5F * glm::length(moves[2])});
}

// Marks where some eyes see what `sharp` shows in pixels that change: all of the boxes around those places.
void mark_moved(const Movements &movements, const Camera &camera, const Image &sharp,
                std::span<const std::uint8_t> changes, std::vector<std::uint8_t> &marked) {
    constexpr float SHARP = 0.3F; // pixels
    const int width = sharp.width, height = sharp.height;
    // How many boxes begin at a corner, less those that end: sums of these say how many a pixel is in.
    const auto corner = [width](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width + 1) + static_cast<std::size_t>(x);
    };
    std::vector<int> begins(corner(0, height + 1));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (changes[sharp.at(x, y)] == 0) {
                continue;
            }
            const std::array<glm::vec2, 3> moves = movements(place_seen(
                camera, (x + 0.5) / width, (y + 0.5) / height, static_cast<double>(sharp.distance[sharp.at(x, y)])));
            if (width_of(moves) < SHARP) {
                continue;
            }
            const glm::vec2 reach = glm::abs(moves[0]) + glm::abs(moves[1]) + glm::abs(moves[2]) + 1.0F;
            const auto edge = [](float at, int most) {
                return static_cast<int>(std::clamp(at, 0.0F, static_cast<float>(most)));
            };
            const auto own = glm::vec2(static_cast<float>(x), static_cast<float>(y));
            const int x0 = edge(own.x - reach.x, width), x1 = edge(own.x + 1.0F + reach.x, width),
                      y0 = edge(own.y - reach.y, height), y1 = edge(own.y + 1.0F + reach.y, height);
            ++begins[corner(x0, y0)];
            --begins[corner(x1, y0)];
            --begins[corner(x0, y1)];
            ++begins[corner(x1, y1)];
        }
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x <= width; ++x) {
            int &own = begins[corner(x, y)];
            own += (x > 0 ? begins[corner(x - 1, y)] : 0) + (y > 0 ? begins[corner(x, y - 1)] : 0) -
                   (x > 0 && y > 0 ? begins[corner(x - 1, y - 1)] : 0);
            if (x < width && own > 0) {
                marked[sharp.at(x, y)] = 1;
            }
        }
    }
}

// How a sample's surroundings move, as far as that is known: not where smoke in front of it moves otherwise.
std::array<glm::vec2, 3> moves_of(const Tracer &tracer, const Blur &blur, const Movements &movements,
                                  const Layers &layers, const Packet &packet, std::size_t lane) {
    constexpr float CLEAR = 0.98F;
    if ((layers.events != nullptr && layers.events->any()) ||
        (!tracer.view.strands.empty() && layers.fine[lane] > 0.0F)) {
        return {};
    }
    const Camera camera = camera_of(tracer.view);
    const auto at = [&](float distance) {
        return movements(place_seen(camera, static_cast<double>(packet.u[lane]), static_cast<double>(packet.v[lane]),
                                    static_cast<double>(distance)));
    };
    const float distance = layers.distance[lane];
    std::array<glm::vec2, 3> out = at(distance);
    const bool smoke = tracer.wanted.has(Layer::SMOKE) && !tracer.view.seen_media.empty();
    if (smoke && std::min({layers.through[0][lane], layers.through[1][lane], layers.through[2][lane]}) < CLEAR) {
        const float begins = std::min(blur.smoke_begins, distance), ends = std::min(blur.smoke_ends, distance);
        const Lens &lens = blur.exposure.lens;
        if (lens.radius > 0.0F && begins < lens.focus && ends > 0.9F * lens.focus) {
            return {};
        }
        for (const float other : {begins, ends}) {
            const std::array<glm::vec2, 3> moves = at(other);
            out = width_of(moves) < width_of(out) ? moves : out;
        }
    }
    return out;
}

constexpr int TAPS = 16; // where a sample is laid

} // namespace

MovedViews::MovedViews(const FrameView &middle, const Surfaces &surfaces) {
    // By the memory of places.
    constexpr std::size_t MOST = 32, LEAST = 4, PLACES = 1 << 20;
    const std::size_t count = std::clamp(PLACES / std::max(surfaces.place_count(), std::size_t{1}), LEAST, MOST);
    for (std::size_t i = 0; i < count; ++i) {
        const float time = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
        FrameView &view = views_.emplace_back(middle);
        places_.push_back(surfaces.places_at(time));
        view.surfaces.places = places_.back().data();
    }
}

FrameView MovedViews::at(float time, std::vector<LightView> &lights) const {
    const auto number = static_cast<std::size_t>(std::max(time, 0.0F) * static_cast<float>(views_.size()));
    FrameView view = views_[std::min(number, views_.size() - 1)];
    for (RayScene *scene : {&view.surfaces.all, &view.surfaces.seen, &view.surfaces.sheets, &view.surfaces.catchers}) {
        scene->time = time;
    }
    lights.assign(view.lights.begin(), view.lights.end());
    for (LightView &light : lights) {
        light.solids.time = light.sheets.time = time;
    }
    view.lights = lights;
    return view;
}

// The variances of the two add: that of a narrower lens, and that of what a sample stands for.
float narrowed(int count) {
    return std::sqrt(1.0F - 1.0F / static_cast<float>(count));
}

std::vector<std::uint16_t> blurred_pixels(const Tracer &tracer, const Blur &blur, const Film &film, const Image &sharp,
                                          std::span<const float> looked, std::span<const std::uint8_t> changes) {
    constexpr int AROUND = TILE; // as far as all turns have a say
    // Pixels: blurred so widely that of those over which few samples are laid each has as many as others by themselves.
    const float wide = std::sqrt(static_cast<float>(blur.many.count) * 0.318309886F);
    constexpr float FAR = 0.06F; // what is so far from what the middle eye sees matters by itself
    const Standing standing(1, film, sharp);
    const Movements movements(blur.exposure, sharp.width, sharp.height);
    std::vector<std::uint8_t> differs(sharp.distance.size()), blurred(differs.size());
    std::vector<float> seen(4 * differs.size());
    std::vector<float> widths(differs.size()); // the least that is moved over
    oneapi::tbb::parallel_for(0, (sharp.height + TILE - 1) / TILE, [&](int strip) {
        const int first = strip * TILE, last = std::min(first + TILE, sharp.height);
        const Turns turns = turns_of(sharp.width, first, last, [](int, int) { return true; });
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            const std::vector<Pixel> &pixels = turns[static_cast<std::size_t>(turn)];
            const Tracer own = from(tracer, blur.many.view(first_eye_of(turn)));
            const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                put_first_look(true, pixels[number].x, pixels[number].y, sharp, packet, lane);
                packet.reach = static_cast<float>(film.filter.diameter() / 2.0);
                standing.put(packet);
            };
            const auto take = [&](const Layers &layers, const Packet &packet, std::size_t lane, std::size_t number) {
                const std::size_t pixel = sharp.at(pixels[number].x, pixels[number].y);
                for (std::size_t c = 0; c < 4; ++c) {
                    seen[4 * pixel + c] = layers.picture[c][lane];
                }
                differs[pixel] = difference(seen.data() + 4 * pixel, looked.data() + 4 * pixel) > FAR ? 1 : 0;
                widths[pixel] =
                    std::min(width_of(moves_of(own, blur, movements, layers, packet, lane)),
                             width_of(movements(place_seen(camera_of(tracer.view), static_cast<double>(packet.u[lane]),
                                                           static_cast<double>(packet.v[lane]),
                                                           static_cast<double>(sharp.distance[pixel])))));
            };
            own.trace(pixels.size(), fill, take);
        }
    });
    add_other_means(sharp, seen, looked, differs);
    mark_moved(movements, camera_of(tracer.view), sharp, changes, blurred);
    take_from_around(sharp.width, sharp.height, AROUND, std::less<>(), widths);
    take_from_around(sharp.width, sharp.height, AROUND, std::greater<>(), differs);
    std::vector<std::uint16_t> samples(differs.size());
    for (std::size_t pixel = 0; pixel < samples.size(); ++pixel) {
        if (blurred[pixel] != 0 || differs[pixel] != 0) {
            const Eyes &eyes = widths[pixel] > wide ? blur.few : blur.many;
            samples[pixel] = static_cast<std::uint16_t>(eyes.count);
        }
    }
    return samples;
}

Blurring::Blurring(const Tracer &tracer, const Blur &blur, const Film &film, std::span<const std::uint16_t> samples,
                   const Image &image)
    : tracer_(tracer), blur_(blur), film_(film), samples_(samples), image_(image), sums_(image.sums() + 1),
      sum_(sums_ * samples.size()), few_(film_patterns(blur.few.count, film.filter)),
      many_(film_patterns(blur.many.count, film.filter)) {}

void Blurring::sample(int first, int last) {
    sample(blur_.many, many_, first, last);
    if (blur_.few.count != blur_.many.count) {
        sample(blur_.few, few_, first, last);
    }
}

void Blurring::sample(const Eyes &eyes, const FilmPatterns &patterns, int first, int last) {
    const int count = eyes.count;
    const Standing standing(static_cast<std::size_t>(count), film_, image_);
    const Movements movements(blur_.exposure, image_.width, image_.height);
    const auto share = static_cast<float>(1.0 / std::sqrt(static_cast<double>(count)));
    const Turns turns =
        turns_of(image_.width, first, last, [&](int x, int y) { return samples_[image_.at(x, y)] == count; });
    for (int turn = 0; turn < FILM_TURNS; ++turn) {
        const std::vector<Pixel> &pixels = turns[static_cast<std::size_t>(turn)];
        if (pixels.empty()) {
            continue;
        }
        const std::vector<FilmSample> &pattern = patterns[static_cast<std::size_t>(turn)];
        for (int k = 0; k < count; ++k) {
            const std::size_t eye = eye_of(turn, k, count);
            const Tracer own = from(tracer_, eyes.view(eye));
            const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                put_sample(pattern[static_cast<std::size_t>(k)], pixels[number].x, pixels[number].y, image_, packet,
                           lane);
                packet.reach = static_cast<float>(film_.filter.diameter() / 2.0) * share;
                standing.put(packet);
                packet.turns = tracer_.view.air.empty() ? 1 : 4;
                packet.turn = static_cast<std::size_t>(k) % packet.turns;
                packet.looks = 2;
                packet.sky_looks = 1; // its neighbours have looked
            };
            const auto take = [&](const Layers &layers, const Packet &packet, std::size_t lane, std::size_t number) {
                const auto [x, y] = pixels[number];
                Image::Sample values{};
                image_.read(layers, lane, values);
                if (!image_.sky.empty()) {
                    find_around(image_, x, y, layers, lane, values);
                }
                std::array<glm::vec2, 3> moves = moves_of(own, blur_, movements, layers, packet, lane);
                for (glm::vec2 &each : moves) {
                    each *= share;
                }
                lay(x, y, values, moves, eye);
            };
            own.trace(pixels.size(), fill, take);
        }
    }
}

void Blurring::lay(int x, int y, const Image::Sample &values, const std::array<glm::vec2, 3> &moves, std::size_t seed) {
    constexpr float OWN = 0.5F; // pixels: what is moved less stays
    if (width_of(moves) < OWN) {
        add(x, y, values, TAPS);
        return;
    }
    // A lattice of the golden ratio's kind in three dimensions (Roberts 2018), begun elsewhere in each pixel and
    // sample.
    constexpr std::array<double, 3> STEPS = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    const auto begin = static_cast<double>(
        (seed * 37U + static_cast<std::size_t>(x) * 113U + static_cast<std::size_t>(y) * 241U) % 4096U);
    for (int tap = 0; tap < TAPS; ++tap) {
        std::array<float, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double place = 0.5 + (begin + tap) * STEPS[axis];
            at[axis] = static_cast<float>(place - std::floor(place));
        }
        const float radius = std::sqrt(at[0]), angle = 6.28318531F * at[1];
        const glm::vec2 move =
            radius * (std::cos(angle) * moves[0] + std::sin(angle) * moves[1]) + (at[2] - 0.5F) * moves[2];
        const int i = x + static_cast<int>(std::lround(move.x)), j = y + static_cast<int>(std::lround(move.y));
        // What would be laid elsewhere stays, as if as much came back from there.
        const bool taken = i >= 0 && j >= 0 && i < image_.width && j < image_.height && samples_[image_.at(i, j)] > 0;
        add(taken ? i : x, taken ? j : y, values, 1);
    }
}

void Blurring::add(int x, int y, const Image::Sample &values, std::int64_t weight) {
    constexpr float UNIT = 0x1p24F, MOST = 1e7F; // of which all sums have room
    std::int64_t *const to = sum_.data() + image_.at(x, y) * sums_;
    const auto put = [](std::int64_t &sum, std::int64_t what) {
        std::atomic_ref(sum).fetch_add(what, std::memory_order_relaxed);
    };
    for (std::size_t c = 0; c + 1 < sums_; ++c) {
        const float value = std::isnan(values[c]) ? 0.0F : std::clamp(values[c], -MOST, MOST);
        put(to[c], weight * std::llrint(static_cast<double>(value) * UNIT));
    }
    put(to[sums_ - 1], weight);
}

void Blurring::finish(Image &image) const {
    constexpr double UNIT = 0x1p24;
    oneapi::tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const std::size_t pixel = image.at(x, y);
            const std::int64_t *const sum = sum_.data() + pixel * sums_;
            if (sum[sums_ - 1] > 0) {
                Image::Sample values{};
                for (std::size_t c = 0; c + 1 < sums_; ++c) {
                    values[c] =
                        static_cast<float>(static_cast<double>(sum[c]) / (UNIT * static_cast<double>(sum[sums_ - 1])));
                }
                image.set(pixel, values, false);
            }
        }
    });
}

} // namespace sfumato
