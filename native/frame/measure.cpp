// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/measure.hpp"

#include "frame/frame.hpp"
#include "maps/exact_lights.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// Each pixel is sampled twice as often as this, in two halves that know nothing of each other: the product of what both
// find wrong is, in the mean, the square of what is wrong, however noisy each is.
// One step of as many asks the lights, each sample another, so that together they ask in all.
constexpr int SAMPLES = 32, EDGE_SAMPLES = 128;
constexpr int LOOKS = 4;               // of each at the shadows of solids
constexpr std::size_t GROUP = 8;       // pixels that share the points on lights
constexpr double STEPS_PER_CELL = 3.0; // of the march

// SplitMix64 (Steele, Lea and Flood 2014) of numbers that tell what a number is for.
std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

struct Random {
    std::uint64_t state;

    Random(std::uint64_t seed, std::uint64_t subject, std::uint64_t number)
        : state(mixed(mixed(mixed(seed) ^ subject) ^ number)) {}
    double operator()() { // in [0, 1)
        state = mixed(state);
        return static_cast<double>(state >> 11U) * 0x1p-53;
    }
};

enum Subject : std::uint64_t { PLACES = 1, LIGHTS = 2, PIXELS = 3 };

double part(double x) {
    return x - std::floor(x);
}

// Points that share a cube of N dimensions evenly, from a random one on: Roberts' lattice, of powers of the root of
// x^(N+1) = x + 1.
template <std::size_t N>
class Lattice {
public:
    explicit Lattice(Random &random) {
        double root = 1.5;
        for (int i = 0; i < 64; ++i) {
            root = std::pow(1.0 + root, 1.0 / (N + 1.0));
        }
        double power = 1.0;
        for (std::size_t i = 0; i < N; ++i) {
            power /= root;
            step_[i] = power;
            first_[i] = random();
        }
    }
    [[nodiscard]] std::array<double, N> operator[](int number) const {
        std::array<double, N> out;
        for (std::size_t i = 0; i < N; ++i) {
            out[i] = part(first_[i] + number * step_[i]);
        }
        return out;
    }

private:
    std::array<double, N> step_, first_;
};

// filter_quantile() at even steps.
class Quantiles {
public:
    explicit Quantiles(const Filter &filter) {
        for (std::size_t i = 0; i <= STEPS; ++i) {
            at_[i] = filter_quantile(filter, static_cast<float>(i) / STEPS);
        }
    }
    [[nodiscard]] float operator()(double u) const {
        const double place = u * STEPS;
        const auto below = std::min(static_cast<std::size_t>(place), STEPS - 1);
        const auto share = static_cast<float>(place - static_cast<double>(below));
        return at_[below] + (at_[below + 1] - at_[below]) * share;
    }

private:
    static constexpr std::size_t STEPS = 512;
    std::array<float, STEPS + 1> at_{};
};

// What two halves of the samples find of a pixel, sums of RGB.
using Found = std::array<std::array<double, 3>, 2>;

// Two-sided, of 97.5 %, of Student's distribution: the first terms of Cornish and Fisher's expansion (Abramowitz and
// Stegun 26.7.5).
double student(double freedom) {
    constexpr double Z = 2.241403, Z3 = Z * Z * Z, Z5 = Z3 * Z * Z, Z7 = Z5 * Z * Z;
    return Z + (Z3 + Z) / (4.0 * freedom) + (5.0 * Z5 + 16.0 * Z3 + 3.0 * Z) / (96.0 * freedom * freedom) +
           (3.0 * Z7 + 19.0 * Z5 + 17.0 * Z3 - 15.0 * Z) / (384.0 * freedom * freedom * freedom);
}

// The mean of a picture's colours.
double brightness(std::span<const float> picture) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); i += 4) {
        sum += double{picture[i]} + double{picture[i + 1]} + double{picture[i + 2]};
    }
    return std::max(sum / (0.75 * static_cast<double>(picture.size())), 1e-30);
}

// How wrong a pixel may be: where it differs from those around it by a part of that, and a little of what it is.
class Doubt {
public:
    Doubt(std::span<const float> picture, int width, int height) : picture_(picture), width_(width), height_(height) {}
    [[nodiscard]] double operator()(int x, int y) const {
        constexpr double OF_CONTRAST = 0.1, OF_ITSELF = 0.01;
        double contrast = 0.0;
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height_ - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width_ - 1); ++i) {
                contrast = std::max(contrast, std::abs(at(i, j) - at(x, y)));
            }
        }
        return OF_CONTRAST * contrast + OF_ITSELF * std::abs(at(x, y));
    }

private:
    [[nodiscard]] double at(int x, int y) const {
        const float *const rgba =
            picture_.data() +
            4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
        return (double{rgba[0]} + double{rgba[1]} + double{rgba[2]}) / 3.0;
    }
    std::span<const float> picture_;
    int width_, height_;
};

} // namespace

std::vector<PixelClass> measured_pixels(std::span<const float> picture, int width, int height, int count,
                                        std::uint64_t seed) {
    constexpr std::size_t EDGES = 5; // from this class on, pixels differ much from those around them
    constexpr int CLASSES = 8;       // each of doubts twice as large as those before it, or more
    const double least = 0.003 * brightness(picture);
    const Doubt doubt(picture, width, height);
    std::vector<double> doubts(picture.size() / 4);
    oneapi::tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            doubts[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                doubt(x, y);
        }
    });
    std::array<std::vector<std::pair<std::uint64_t, std::size_t>>, CLASSES> all;
    std::array<double, CLASSES> sums{};
    double sum = 0.0;
    for (std::size_t pixel = 0; pixel < doubts.size(); ++pixel) {
        const double own = doubts[pixel] + 0.25 * least;
        const int octave = own < least ? 0 : 1 + std::min(static_cast<int>(std::log2(own / least)), CLASSES - 2);
        const auto at = static_cast<std::size_t>(octave);
        all[at].emplace_back(mixed(mixed(mixed(seed) ^ PLACES) ^ pixel), pixel);
        sums[at] += own;
        sum += own;
    }
    std::vector<PixelClass> out;
    for (std::size_t i = 0; i < CLASSES; ++i) {
        if (all[i].empty()) {
            continue;
        }
        PixelClass &own = out.emplace_back();
        own.count = all[i].size();
        own.samples = i < EDGES ? SAMPLES : EDGE_SAMPLES;
        const auto share = static_cast<std::size_t>(std::ceil(count * sums[i] / sum / GROUP)) * GROUP;
        const std::size_t chosen = std::min(std::max(share, 2 * GROUP), own.count);
        std::nth_element(all[i].begin(), all[i].begin() + static_cast<std::ptrdiff_t>(chosen - 1), all[i].end());
        std::sort(all[i].begin(), all[i].begin() + static_cast<std::ptrdiff_t>(chosen));
        for (std::size_t k = 0; k < chosen; ++k) {
            own.chosen.push_back(all[i][k].second);
        }
    }
    return out;
}

void Measured::add(const Measured &earlier) {
    const auto own = static_cast<double>(frames), other = static_cast<double>(earlier.frames), both = own + other;
    const double part = variance * own * own / (both * both), rest = earlier.variance * other * other / (both * both);
    mean = (mean * own + earlier.mean * other) / both;
    variance = part + rest;
    // Welch's and Satterthwaite's.
    freedom = variance > 0.0 ? variance * variance / (part * part / freedom + rest * rest / earlier.freedom)
                             : freedom + earlier.freedom;
    pixels += earlier.pixels;
    frames += earlier.frames;
    summarise();
}

void Measured::summarise() {
    const double away = student(std::max(freedom, 1.0)) * std::sqrt(variance);
    reported = std::sqrt(std::max(mean, 0.0));
    // What is squared is never below 0, and its logarithm is nearer to a bell; but not of what drowns in noise.
    const bool clear = mean > 0.0 && away < 2.0 * mean;
    low = clear ? std::sqrt(mean * std::exp(-away / mean)) : 0.0;
    high = std::sqrt(clear ? mean * std::exp(away / mean) : std::max(mean, 0.0) + away);
}

Measured Frame::measure(const Camera &camera, int width, int height, std::span<const float> picture,
                        const Filter &filter, int pixels, std::uint64_t seed) const {
    const auto start = std::chrono::steady_clock::now();
    Measured out;
    Views seen = views(camera, width, height, PICTURE, 1.0 / STEPS_PER_CELL);
    see_bounces(camera, false, seen);
    const bool ramped = std::ranges::any_of(content_.media, [](const CroppedMedium &m) { return m.ramp != nullptr; });
    const bool maps = !content_.lighting.bodies().empty() && !ramped;
    std::optional<ExactLights> lights;
    if (!ramped) {
        lights.emplace(content_.lighting, content_.media, seen.frame.surfaces);
    }
    if (ramped) {
        out.unmeasured.emplace_back("light on smoke under a transfer function");
    }
    if (content_.lighting.bodies().size() > content_.media.size()) {
        out.unmeasured.emplace_back("shadows of particles, hair and fog, shafts, and at how many points lights are "
                                    "sampled for these");
    }
    if (bounces_.diffuse > 0) {
        out.unmeasured.emplace_back("light that surfaces keep of each other");
    }
    std::vector<PixelClass> classes;
    prepared_->arena.execute([&] { classes = measured_pixels(picture, width, height, pixels, seed); });
    // Groups of pixels of one class, from anywhere.
    struct Group {
        std::size_t of, first, count; // its class, and which of all pixels
    };
    std::vector<Group> groups;
    std::vector<std::size_t> pixels_of_all;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        for (std::size_t k = 0; k < classes[i].chosen.size(); k += GROUP) {
            groups.push_back({i, pixels_of_all.size() + k, std::min(GROUP, classes[i].chosen.size() - k)});
        }
        pixels_of_all.insert(pixels_of_all.end(), classes[i].chosen.begin(), classes[i].chosen.end());
    }
    std::vector<Found> found(pixels_of_all.size(), Found{});
    const Quantiles quantile(filter);
    StageClock clock;
    const auto look_at = [&](std::size_t group) {
        const std::span<const std::size_t> own =
            std::span(pixels_of_all).subspan(groups[group].first, groups[group].count);
        const int count = classes[groups[group].of].samples;
        for (int half = 0; half < 2; ++half) {
            const std::uint64_t number = 2 * group + static_cast<std::uint64_t>(half);
            Random random(seed, LIGHTS, number);
            const Lattice<2> points(random);
            const auto first_step = static_cast<int>(random() * count);
            std::vector<Lattice<4>> samples; // of each pixel: on the film, and on lights
            for (const std::size_t pixel : own) {
                Random each(seed, PIXELS, 2 * pixel + static_cast<std::uint64_t>(half));
                samples.emplace_back(each);
            }
            for (int k = 0; k < count; ++k) {
                FrameView frame = seen.frame;
                ExactLights::Choice choice;
                if (lights) {
                    const auto [u, v] = points[k];
                    choice = lights->choose(u, v);
                    frame.lights = choice.views;
                }
                if (maps) {
                    frame.asks_every = count;
                    // All steps in turn, far ones after each other.
                    frame.asks_first = (first_step + 13 * k) % count;
                }
                const Tracer tracer{*instruction_set_, frame, PICTURE, clock};
                const auto fill = [&](Packet &packet, std::size_t lane, std::size_t i) {
                    const auto x = static_cast<float>(own[i] % static_cast<std::size_t>(width));
                    const auto y = static_cast<float>(own[i] / static_cast<std::size_t>(width));
                    const std::array<double, 4> at = samples[i][k];
                    const auto across = static_cast<float>(width), up = static_cast<float>(height);
                    packet.u[lane] = (x + 0.5F + quantile(at[0])) / across;
                    packet.v[lane] = (y + 0.5F + quantile(at[1])) / up;
                    packet.light_u[lane] = packet.look_u[lane] = static_cast<float>(at[2]);
                    packet.light_v[lane] = packet.look_v[lane] = static_cast<float>(at[3]);
                    for (int look = 0; look < LOOKS; ++look) {
                        ShadowSample &shadow = packet.shadows[static_cast<std::size_t>(look)];
                        shadow.u[lane] = packet.u[lane];
                        shadow.v[lane] = packet.v[lane];
                        shadow.light_u[lane] = static_cast<float>(part(at[2] + 0.5 * (look % 2)));
                        shadow.light_v[lane] = static_cast<float>(part(at[3] + 0.5 * (look / 2)));
                    }
                    packet.beside_u = 1.0F / across;
                    packet.beside_v = 1.0F / up;
                    packet.stands_for = 1.0F / std::sqrt(static_cast<float>(2 * count));
                    packet.reach = static_cast<float>(filter.diameter() / 2.0) * packet.stands_for;
                };
                tracer.trace(
                    own.size(), fill,
                    [&](const Layers &layers, std::size_t lane, std::size_t i) {
                        for (std::size_t c = 0; c < 3; ++c) {
                            found[groups[group].first + i][static_cast<std::size_t>(half)][c] +=
                                double{layers.picture[c][lane]};
                        }
                    },
                    LOOKS);
            }
        }
    };
    prepared_->arena.execute([&] { oneapi::tbb::parallel_for(std::size_t{0}, groups.size(), look_at); });
    // Of each class the mean of its groups, and the variance of that.
    const double scale = brightness(picture);
    double squares = 0.0; // of the classes' variances, over their degrees of freedom
    for (std::size_t first = 0; first < groups.size();) {
        const std::size_t of = groups[first].of, total = classes[of].chosen.size();
        std::vector<double> sums;
        double sum = 0.0;
        std::size_t end = first;
        for (; end < groups.size() && groups[end].of == of; ++end) {
            sums.push_back(0.0);
            for (std::size_t i = groups[end].first; i < groups[end].first + groups[end].count; ++i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const double value = double{picture[4 * pixels_of_all[i] + c]} / scale;
                    const auto off = [&](std::size_t half) {
                        return found[i][half][c] / (classes[of].samples * scale) - value;
                    };
                    sums.back() += off(0) * off(1) / 3.0;
                }
            }
            sum += sums.back();
        }
        const double mean = sum / static_cast<double>(total);
        double square = 0.0;
        for (std::size_t g = first; g < end; ++g) {
            const double away = sums[g - first] - mean * static_cast<double>(groups[g].count);
            square += away * away;
        }
        const auto count = static_cast<double>(end - first);
        const double weight = static_cast<double>(classes[of].count) / (static_cast<double>(picture.size()) / 4.0);
        // Groups of one size but the last: what each is away from what it should be, summed.
        const double variance = count > 1.0 ? weight * weight * square * count / (count - 1.0) /
                                                  (static_cast<double>(total) * static_cast<double>(total))
                                            : weight * weight * mean * mean;
        out.mean += weight * mean;
        out.variance += variance;
        squares += variance * variance / std::max(count - 1.0, 1.0);
        first = end;
    }
    out.freedom = squares > 0.0 ? out.variance * out.variance / squares : 1.0;
    out.pixels = pixels_of_all.size();
    out.frames = 1;
    out.summarise();
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

} // namespace sfumato
