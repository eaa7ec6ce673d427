// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/blurred.hpp"

#include "frame/eyes.hpp"
#include "frame/looks.hpp"
#include "frame/sample_packet.hpp"
#include "scene/places_in_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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

float mean(const float *rgb) {
    return (rgb[0] + rgb[1] + rgb[2]) * (1.0F / 3.0F);
}

// Whether two samples of a pixel, RGBA, are not as good as one.
bool differ(const float *a, const float *b, float allowed) {
    for (int c = 0; c < 3; ++c) {
        if (std::abs(a[c] - b[c]) > allowed * std::max(std::max(a[c], b[c]), 0.1F * std::max(mean(a), mean(b)))) {
            return true;
        }
    }
    return std::abs(a[3] - b[3]) > allowed;
}

Camera camera_of(const FrameView &view) {
    const auto &c = view.camera;
    return {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
}

// Marks where some eyes see what `sharp` shows in pixels that change: all of the boxes around those places.
void mark_moved(const Tracer &tracer, const Blur &blur, const Image &sharp, std::span<const std::uint8_t> changes,
                std::vector<std::uint8_t> &marked) {
    constexpr double BEYOND = 1.3; // so much further than these eyes may others move it
    constexpr double SHARP = 0.3;  // pixels
    const int width = sharp.width, height = sharp.height;
    std::vector<PlacesInPicture> eyes;
    for (int turn = 0; turn < FILM_TURNS; ++turn) {
        eyes.emplace_back(camera_of(blur.view(first_eye_of(turn, blur.rounds))), width, height);
    }
    const auto &c = tracer.view.camera;
    // How many boxes begin at a corner, less those that end: sums of these say how many a pixel is in.
    const auto corner = [width](int x, int y) { return static_cast<std::size_t>(y) * (width + 1U) + x; };
    std::vector<int> begins(corner(0, height + 1));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (changes[sharp.at(x, y)] == 0) {
                continue;
            }
            const double u = (x + 0.5) / width, v = (y + 0.5) / height;
            const auto on = [&](std::size_t first) {
                return glm::dvec3(c[first]) + u * glm::dvec3(c[first + 1]) + v * glm::dvec3(c[first + 2]);
            };
            const glm::dvec3 place =
                on(0) + glm::normalize(on(3) - on(0)) * static_cast<double>(sharp.distance[sharp.at(x, y)]);
            glm::dvec2 away(0.0);
            for (const PlacesInPicture &eye : eyes) {
                if (eye.along(place) > 0.0) {
                    away = glm::max(away, glm::abs(eye.place(place).pixel - glm::dvec2(x + 0.5, y + 0.5)));
                }
            }
            if (std::max(away.x, away.y) < SHARP) {
                continue;
            }
            const auto edge = [](double at, int most) { return std::clamp(static_cast<int>(at), 0, most); };
            const glm::dvec2 reach = BEYOND * away + 1.0;
            const int x0 = edge(x - reach.x, width), x1 = edge(x + 1.0 + reach.x, width),
                      y0 = edge(y - reach.y, height), y1 = edge(y + 1.0 + reach.y, height);
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

// The sums of what a strip's pixels were found to be, round by round.
class Strip {
public:
    Strip(const Image &image, int first, int last)
        : image_(image), first_(first), sums_(image.sums()), sum_(image.at(0, last - first) * sums_),
          squares_(image.at(0, last - first)), rounds_(image.at(0, last - first)), spread_(rounds_.size()) {}

    void add(const Pixel &pixel, const Image::Sample &values) {
        double *const to = sum_.data() + at(pixel) * sums_;
        for (std::size_t c = 0; c < sums_; ++c) {
            to[c] += static_cast<double>(values[c]);
        }
        const auto brightness = static_cast<double>(mean(values.data()));
        squares_[at(pixel)] += brightness * brightness;
    }

    // How far the mean of n samples is from what it should be: of an edge through well spread ones n^-3/4 of their
    // deviation.
    void end_round(const Pixel &pixel) {
        const std::size_t place = at(pixel);
        const double *const sum = sum_.data() + place * sums_;
        const double count = EYES_A_ROUND * static_cast<double>(++rounds_[place]);
        const double brightness = (sum[0] + sum[1] + sum[2]) / (3.0 * count);
        const double variance = std::max(squares_[place] / count - brightness * brightness, 0.0);
        spread_[place] = static_cast<float>(std::sqrt(variance) * std::pow(count, -0.75) / std::max(brightness, 1e-20));
    }

    // Whether it, or one beside it, is further from that than allowed.
    [[nodiscard]] bool unsettled(const Pixel &pixel, float allowed) const {
        const auto rows = static_cast<int>(spread_.size() / static_cast<std::size_t>(image_.width));
        for (int j = std::max(pixel.y - first_ - 1, 0); j <= std::min(pixel.y - first_ + 1, rows - 1); ++j) {
            for (int i = std::max(pixel.x - 1, 0); i <= std::min(pixel.x + 1, image_.width - 1); ++i) {
                if (spread_[image_.at(i, j)] > allowed) {
                    return true;
                }
            }
        }
        return false;
    }

    [[nodiscard]] Image::Sample result(const Pixel &pixel) const {
        Image::Sample values{};
        const std::size_t place = at(pixel);
        for (std::size_t c = 0; c < sums_; ++c) {
            values[c] =
                static_cast<float>(sum_[place * sums_ + c] / (EYES_A_ROUND * static_cast<double>(rounds_[place])));
        }
        return values;
    }

private:
    [[nodiscard]] std::size_t at(const Pixel &pixel) const { return image_.at(pixel.x, pixel.y - first_); }
    const Image &image_;
    int first_;
    std::size_t sums_;
    std::vector<double> sum_, squares_; // squares of brightness
    std::vector<int> rounds_;
    std::vector<float> spread_; // of what is not blurred 0
};

} // namespace

std::vector<std::uint8_t> blurred_pixels(const Tracer &tracer, const Blur &blur, const Film &film, const Image &sharp,
                                         std::span<const float> looked, std::span<const std::uint8_t> changes) {
    constexpr float ALLOWED = 0.01F;
    constexpr int AROUND = TILE; // as far as all turns have a say
    const Standing standing(1, film, sharp);
    std::vector<std::uint8_t> differs(sharp.distance.size()), blurred(differs.size());
    oneapi::tbb::parallel_for(0, (sharp.height + TILE - 1) / TILE, [&](int strip) {
        const int first = strip * TILE, last = std::min(first + TILE, sharp.height);
        const Turns turns = turns_of(sharp.width, first, last, [](int, int) { return true; });
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            const std::vector<Pixel> &pixels = turns[static_cast<std::size_t>(turn)];
            const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                put_first_look(true, pixels[number].x, pixels[number].y, sharp, packet, lane);
                packet.reach = static_cast<float>(film.filter.diameter() / 2.0);
                standing.put(packet);
            };
            const auto take = [&](const Layers &layers, std::size_t lane, std::size_t number) {
                const std::size_t pixel = sharp.at(pixels[number].x, pixels[number].y);
                std::array<float, 4> seen{};
                for (std::size_t c = 0; c < 4; ++c) {
                    seen[c] = layers.picture[c][lane];
                }
                differs[pixel] = differ(seen.data(), looked.data() + 4 * pixel, ALLOWED) ? 1 : 0;
            };
            from(tracer, blur.view(first_eye_of(turn, blur.rounds))).trace(pixels.size(), fill, take);
        }
    });
    mark_moved(tracer, blur, sharp, changes, blurred);
    oneapi::tbb::parallel_for(0, sharp.height, [&](int y) {
        for (int x = 0; x < sharp.width; ++x) {
            for (int j = std::max(y - AROUND, 0); j <= std::min(y + AROUND, sharp.height - 1); ++j) {
                const auto row = differs.begin() + static_cast<std::ptrdiff_t>(sharp.at(0, j));
                if (std::any_of(row + std::max(x - AROUND, 0), row + std::min(x + AROUND + 1, sharp.width),
                                [](std::uint8_t each) { return each != 0; })) {
                    blurred[sharp.at(x, y)] = 1;
                    break;
                }
            }
        }
    });
    return blurred;
}

void refine_blurred(const Tracer &tracer, const Blur &blur, const Film &film, std::span<const std::uint8_t> blurred,
                    int first, int last, Image &image) {
    constexpr float SETTLED = 0.01F;
    constexpr int APART = 5; // rounds take the patterns of turns that lie so far apart
    const Standing standing(EYES_A_ROUND, film, image);
    std::array<std::vector<FilmSample>, FILM_TURNS> patterns;
    for (int turn = 0; turn < FILM_TURNS; ++turn) {
        patterns[static_cast<std::size_t>(turn)] = film_samples(EYES_A_ROUND, turn, film.filter);
    }
    Strip strip(image, first, last);
    Turns turns = turns_of(image.width, first, last, [&](int x, int y) { return blurred[image.at(x, y)] != 0; });
    const Turns all = turns;
    for (int round = 0; round < blur.rounds; ++round) {
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            const std::vector<Pixel> &pixels = turns[static_cast<std::size_t>(turn)];
            const std::vector<FilmSample> &pattern =
                patterns[static_cast<std::size_t>((turn + APART * round) % FILM_TURNS)];
            for (int k = 0; k < EYES_A_ROUND && !pixels.empty(); ++k) {
                const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                    put_sample(pattern[static_cast<std::size_t>(k)], pixels[number].x, pixels[number].y, image, packet,
                               lane);
                    packet.reach = static_cast<float>(film.filter.diameter() / (2.0 * std::sqrt(EYES_A_ROUND)));
                    standing.put(packet);
                    packet.turns = tracer.view.air.empty() ? 1 : 4;
                    packet.turn = static_cast<std::size_t>(k) % packet.turns;
                    packet.looks = 2;
                };
                const auto take = [&](const Layers &layers, std::size_t lane, std::size_t number) {
                    Image::Sample values{};
                    image.read(layers, lane, values);
                    if (!image.sky.empty()) {
                        find_around(image, pixels[number].x, pixels[number].y, layers, lane, values);
                    }
                    strip.add(pixels[number], values);
                };
                from(tracer, blur.view(eye_of(turn, round, k, blur.rounds))).trace(pixels.size(), fill, take);
            }
            for (const Pixel &pixel : pixels) {
                strip.end_round(pixel);
            }
        }
        for (std::vector<Pixel> &pixels : turns) {
            std::erase_if(pixels, [&](const Pixel &pixel) { return !strip.unsettled(pixel, SETTLED); });
        }
    }
    for (const std::vector<Pixel> &pixels : all) {
        for (const Pixel &pixel : pixels) {
            image.set(image.at(pixel.x, pixel.y), strip.result(pixel), false);
        }
    }
}

} // namespace sfumato
