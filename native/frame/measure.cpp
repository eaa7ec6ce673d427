// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/measure.hpp"

#include "frame/frame.hpp"
#include "frame/measured_pixels.hpp"
#include "frame/random.hpp"
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
// At edges of what is seen more of them are needed, and where lights are large enough to blur their shadows.
constexpr int SAMPLES = 16, SOFT_SAMPLES = 32, EDGE_SAMPLES = 64;
constexpr int LOOKS = 4;               // of each at the shadows of solids
constexpr std::size_t GROUP = 16;      // pixels that share the points on lights
constexpr double STEPS_PER_CELL = 2.0; // of the march, at least, and no step of more optical depth than this:
constexpr double DEEPEST = 0.25, MOST_STEPS = 16.0;
constexpr int ASKS_EVERY = 2; // in one of so many steps all samples of a half together ask the lights

// What is looked at at once, of one list of pixels.
struct PixelGroup {
    std::size_t first, count;
    int samples; // of each half
};

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

// Light that is not the same at both ends of a step is asked in its middle, which is wrong where smoke is dense.
double steps_per_cell(std::span<const CroppedMedium> media) {
    double most = STEPS_PER_CELL;
    for (const CroppedMedium &medium : media) {
        if (medium.ramp == nullptr && !medium.grid->density.empty()) {
            const float densest = *std::max_element(medium.grid->density.begin(), medium.grid->density.end());
            const double depth = double{densest} * double{medium.strongest()} * medium.cell_size;
            most = std::max(most, std::min(depth / DEEPEST, MOST_STEPS));
        }
    }
    return most;
}

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
    Views seen = views(camera, width, height, PICTURE, 1.0 / steps_per_cell(content_.media));
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
    std::vector<std::size_t> pixels_of_all; // class by class, what is at edges last
    std::vector<PixelGroup> groups;
    int samples = SAMPLES;
    for (const LightView &light : content_.lighting.views()) {
        samples = light.samples.size() > 1 ? SOFT_SAMPLES : samples;
    }
    for (const PixelClass &own : classes) {
        const std::size_t first = pixels_of_all.size();
        pixels_of_all.insert(pixels_of_all.end(), own.chosen.begin(), own.chosen.end());
        const int count = own.edges ? EDGE_SAMPLES : samples;
        for (std::size_t at = first; at < pixels_of_all.size(); ++at) {
            if (groups.empty() || groups.back().samples != count || groups.back().count == GROUP) {
                groups.push_back({at, 0, count});
            }
            ++groups.back().count;
        }
    }
    std::vector<Found> found(pixels_of_all.size(), Found{});
    const Quantiles quantile(filter);
    StageClock clock;
    const auto look_at = [&](std::size_t group) {
        const std::span<const std::size_t> own =
            std::span(pixels_of_all).subspan(groups[group].first, groups[group].count);
        const int count = groups[group].samples, every = ASKS_EVERY * count;
        for (int half = 0; half < 2; ++half) {
            const std::uint64_t number = 2 * group + static_cast<std::uint64_t>(half);
            Random random(seed, LIGHTS, number);
            const Lattice<2> points(random);
            const auto first_step = static_cast<int>(random() * every);
            std::vector<Lattice<4>> lattices; // of each pixel: on the film, and on lights
            for (const std::size_t pixel : own) {
                Random each(seed, PIXELS, 2 * pixel + static_cast<std::uint64_t>(half));
                lattices.emplace_back(each);
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
                    frame.asks_every = every;
                    // Evenly along the ray, far ones after each other.
                    frame.asks_first = (first_step + ASKS_EVERY * (13 * k % count)) % every;
                }
                const Tracer tracer{*instruction_set_, frame, PICTURE, clock};
                const auto fill = [&](Packet &packet, std::size_t lane, std::size_t i) {
                    const auto x = static_cast<float>(own[i] % static_cast<std::size_t>(width));
                    const auto y = static_cast<float>(own[i] / static_cast<std::size_t>(width));
                    const std::array<double, 4> at = lattices[i][k];
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
    // What both halves find wrong of a pixel, multiplied.
    const double scale = brightness(picture);
    std::vector<double> squares;
    for (const PixelGroup &group : groups) {
        for (std::size_t i = group.first; i < group.first + group.count; ++i) {
            double sum = 0.0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = double{picture[4 * pixels_of_all[i] + c]};
                const auto off = [&](std::size_t half) { return (found[i][half][c] / group.samples - value) / scale; };
                sum += off(0) * off(1) / 3.0;
            }
            squares.push_back(sum);
        }
    }
    // Of each class the mean of its pixels, and the variance of that (Neyman 1934).
    double known = 0.0;
    std::size_t first = 0;
    std::vector<double> away_from; // of each pixel, what it adds to the mean's error
    for (const PixelClass &own : classes) {
        const std::span<const double> values = std::span(squares).subspan(first, own.chosen.size());
        first += own.chosen.size();
        const auto count = static_cast<double>(values.size());
        const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
        double away = 0.0;
        for (const double value : values) {
            away += (value - mean) * (value - mean);
        }
        const double weight = 4.0 * static_cast<double>(own.count) / static_cast<double>(picture.size());
        const double variance = weight * weight * (count > 1.0 ? away / (count * (count - 1.0)) : mean * mean);
        for (const double value : values) {
            away_from.push_back(weight * (value - mean) / count);
        }
        out.mean += weight * mean;
        out.variance += variance;
        known += variance * variance / std::max(count - 1.0, 1.0);
    }
    out.freedom = known > 0.0 ? out.variance * out.variance / known : 1.0;
    // What is random about lights is the same for all of a group.
    double of_groups = 0.0;
    for (const PixelGroup &group : groups) {
        const auto begin = away_from.begin() + static_cast<std::ptrdiff_t>(group.first);
        const double sum = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(group.count), 0.0);
        of_groups += sum * sum;
    }
    const auto several = static_cast<double>(groups.size());
    if (several > 1.0 && of_groups * several / (several - 1.0) > out.variance) {
        out.variance = of_groups * several / (several - 1.0);
        out.freedom = std::min(out.freedom, several - 1.0);
    }
    out.pixels = pixels_of_all.size();
    out.frames = 1;
    out.summarise();
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

} // namespace sfumato
