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
constexpr int SAMPLES = 32;
constexpr int LOOKS = 4;               // of each at the shadows of solids
constexpr std::size_t GROUP = 16;      // pixels that share the points on lights
constexpr double STEPS_PER_CELL = 3.0; // of the march,
constexpr int ASKS_EVERY = 32;         // in one of so many of which the lights are asked

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

enum Subject : std::uint64_t { PLACES = 1, ORDER = 2, LIGHTS = 3, PIXELS = 4 };

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

// Two-sided, of 95 %, of Student's distribution: the first terms of Cornish and Fisher's expansion (Abramowitz and
// Stegun 26.7.5).
double student(double freedom) {
    constexpr double Z = 1.959964, Z3 = Z * Z * Z, Z5 = Z3 * Z * Z, Z7 = Z5 * Z * Z;
    return Z + (Z3 + Z) / (4.0 * freedom) + (5.0 * Z5 + 16.0 * Z3 + 3.0 * Z) / (96.0 * freedom * freedom) +
           (3.0 * Z7 + 19.0 * Z5 + 17.0 * Z3 - 15.0 * Z) / (384.0 * freedom * freedom * freedom);
}

} // namespace

std::vector<int> measured_pixels(int width, int height, int count, std::uint64_t seed) {
    // No more parts along a side than pixels.
    const double across = std::sqrt(static_cast<double>(count) * width / height);
    const int columns = std::clamp(static_cast<int>(std::lround(across)), 1, width);
    const int rows = std::clamp((count + columns - 1) / columns, 1, height);
    Random random(seed, PLACES, 0);
    std::vector<int> out;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            out.push_back(std::min(static_cast<int>((i + random()) * width / columns), width - 1));
            out.push_back(std::min(static_cast<int>((j + random()) * height / rows), height - 1));
        }
    }
    return out;
}

void summarise(Measured &measured) {
    const std::vector<double> &groups = measured.groups;
    const auto count = static_cast<double>(groups.size());
    const double mean = std::accumulate(groups.begin(), groups.end(), 0.0) / std::max(count, 1.0);
    double square = 0.0;
    for (const double group : groups) {
        square += (group - mean) * (group - mean);
    }
    const double deviation = count > 1.0 ? std::sqrt(square / (count * (count - 1.0))) : std::abs(mean);
    const double away = student(std::max(count - 1.0, 1.0)) * deviation;
    measured.reported = std::sqrt(std::max(mean, 0.0));
    // What is squared is never below 0, and its logarithm is nearer to a bell; but not of what drowns in noise.
    const bool clear = mean > 0.0 && away < 2.0 * mean;
    measured.low = clear ? std::sqrt(mean * std::exp(-away / mean)) : 0.0;
    measured.high = std::sqrt(clear ? mean * std::exp(away / mean) : std::max(mean, 0.0) + away);
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
    // Groups of pixels from anywhere.
    const std::vector<int> places = measured_pixels(width, height, pixels, seed);
    std::vector<std::size_t> order(places.size() / 2);
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random shuffling(seed, ORDER, 0);
    for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[static_cast<std::size_t>(shuffling() * static_cast<double>(i))]);
    }
    const std::size_t groups = std::max<std::size_t>(order.size() / GROUP, std::min<std::size_t>(order.size(), 4));
    const auto first_of = [&](std::size_t group) { return group * order.size() / groups; };
    std::vector<Found> found(order.size(), Found{});
    const Quantiles quantile(filter);
    StageClock clock;
    const auto look_at = [&](std::size_t group) {
        const std::span<const std::size_t> own =
            std::span(order).subspan(first_of(group), first_of(group + 1) - first_of(group));
        for (int half = 0; half < 2; ++half) {
            const std::uint64_t number = 2 * group + static_cast<std::uint64_t>(half);
            Random random(seed, LIGHTS, number);
            const Lattice<2> points(random);
            const auto first_step = static_cast<int>(random() * ASKS_EVERY);
            std::vector<Lattice<4>> samples; // of each pixel: on the film, and on lights
            for (const std::size_t pixel : own) {
                Random each(seed, PIXELS, 2 * pixel + static_cast<std::uint64_t>(half));
                samples.emplace_back(each);
            }
            for (int k = 0; k < SAMPLES; ++k) {
                FrameView frame = seen.frame;
                ExactLights::Choice choice;
                if (lights) {
                    const auto [u, v] = points[k];
                    choice = lights->choose(u, v);
                    frame.lights = choice.views;
                }
                if (maps) {
                    frame.asks_every = ASKS_EVERY;
                    // All steps in turn, far ones after each other.
                    frame.asks_first = (first_step + 13 * k) % ASKS_EVERY;
                }
                const Tracer tracer{*instruction_set_, frame, PICTURE, clock};
                const auto fill = [&](Packet &packet, std::size_t lane, std::size_t i) {
                    const auto x = static_cast<float>(places[2 * own[i]]),
                               y = static_cast<float>(places[2 * own[i] + 1]);
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
                    packet.stands_for = 1.0F / std::sqrt(static_cast<float>(2 * SAMPLES));
                    packet.reach = static_cast<float>(filter.diameter() / 2.0) * packet.stands_for;
                };
                tracer.trace(
                    own.size(), fill,
                    [&](const Layers &layers, std::size_t lane, std::size_t i) {
                        for (std::size_t c = 0; c < 3; ++c) {
                            found[own[i]][static_cast<std::size_t>(half)][c] += double{layers.picture[c][lane]};
                        }
                    },
                    LOOKS);
            }
        }
    };
    prepared_->arena.execute([&] { oneapi::tbb::parallel_for(std::size_t{0}, groups, look_at); });
    double mean = 0.0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        mean += i % 4 < 3 ? double{picture[i]} : 0.0;
    }
    mean /= 3.0 * static_cast<double>(width) * static_cast<double>(height);
    for (std::size_t group = 0; group < groups; ++group) {
        double sum = 0.0;
        for (std::size_t i = first_of(group); i < first_of(group + 1); ++i) {
            const std::size_t pixel = order[i];
            const auto at = 4 * (static_cast<std::size_t>(places[2 * pixel + 1]) * static_cast<std::size_t>(width) +
                                 static_cast<std::size_t>(places[2 * pixel]));
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = picture[at + c];
                sum += (found[pixel][0][c] / SAMPLES - value) * (found[pixel][1][c] / SAMPLES - value);
            }
        }
        const auto count = static_cast<double>(first_of(group + 1) - first_of(group));
        out.groups.push_back(sum / (3.0 * count * std::max(mean * mean, 1e-30)));
    }
    out.pixels = order.size();
    out.frames = 1;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    summarise(out);
    return out;
}

} // namespace sfumato
