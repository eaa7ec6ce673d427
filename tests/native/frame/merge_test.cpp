// SPDX-License-Identifier: GPL-3.0-or-later
// What is merged against the radiative transfer equation, integrated in small steps.
#include "frame/layers.hpp"
#include "frame/stages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr float END = 8.0F; // metres to the surface

// On one ray: smoke of a grid that is the same between two depths, slices of particles, fragments, and air, which sends
// where light falls into it.
struct Case {
    double grid_from = 0.0, grid_to = 0.0, grid_density = 0.0, grid_sends = 0.0; // per metre
    double first = 0.0, width = 1.0;
    std::vector<double> depth; // of each slice, and what it sends, in each colour
    std::vector<std::array<double, 3>> sent;
    std::vector<Fragment> fragments;
    double air_density = 0.0, air_sends = 0.0, air_lit_from = 0.0, air_lit_to = double{END};
};

struct Result {
    std::array<double, 3> smoke{}, through{1.0, 1.0, 1.0};
};

Result integrated(const Case &ray, double tint = 1.0) {
    constexpr int STEPS = 200000;
    constexpr double DT = double{END} / STEPS;
    std::vector<Fragment> fragments = ray.fragments;
    std::stable_sort(fragments.begin(), fragments.end(),
                     [](const Fragment &a, const Fragment &b) { return a.distance < b.distance; });
    Result out;
    std::size_t next = 0;
    for (int i = 0; i < STEPS; ++i) {
        const double t = (i + 0.5) * DT, slice = std::floor((t - ray.first) / ray.width);
        for (; next < fragments.size() && double{fragments[next].distance} < t; ++next) {
            for (int c = 0; c < 3; ++c) {
                double &through = out.through[static_cast<std::size_t>(c)];
                out.smoke[static_cast<std::size_t>(c)] += through * double{fragments[next].radiance[c]};
                through *= double{fragments[next].left[c]};
            }
        }
        const bool in_grid = t > ray.grid_from && t < ray.grid_to;
        const bool in_slice = slice >= 0.0 && slice < double(ray.depth.size());
        for (std::size_t c = 0; c < 3; ++c) {
            const double colour = c == 0 ? 1.0 : tint; // of all depths
            double taken = in_grid ? ray.grid_density * colour : 0.0, sent = in_grid ? ray.grid_sends : 0.0;
            taken += ray.air_density * colour;
            sent += t > ray.air_lit_from && t < ray.air_lit_to ? ray.air_sends : 0.0;
            if (in_slice) {
                taken += ray.depth[static_cast<std::size_t>(slice)] * colour / ray.width;
                sent += ray.sent[static_cast<std::size_t>(slice)][c] / ray.width;
            }
            out.smoke[c] += out.through[c] * sent * DT * std::exp(-0.5 * taken * DT);
            out.through[c] *= std::exp(-taken * DT);
        }
    }
    return out;
}

// The events of a case on every lane, with the knots that a march of `steps` steps through the grid would leave.
void fill(const Case &ray, int colours, double tint, int steps, Layers &layers) {
    Events &events = *layers.events;
    for (std::size_t lane = 0; lane < MAX_LANES; ++lane) {
        layers.distance[lane] = END;
        for (const Fragment &fragment : ray.fragments) {
            events.add(lane, fragment);
        }
    }
    events.slices.reset(static_cast<int>(ray.depth.size()), colours);
    std::fill_n(events.slices.first, MAX_LANES, static_cast<float>(ray.first));
    std::fill_n(events.slices.width, MAX_LANES, static_cast<float>(ray.width));
    const auto row = [](std::vector<float> &rows, std::size_t number, double value) {
        std::fill_n(rows.begin() + static_cast<std::ptrdiff_t>(number * MAX_LANES), MAX_LANES,
                    static_cast<float>(value));
    };
    const auto channels = static_cast<std::size_t>(colours);
    for (std::size_t s = 0; s < ray.depth.size(); ++s) {
        for (std::size_t c = 0; c < channels; ++c) {
            row(events.slices.depth, channels * s + c, ray.depth[s] * (c == 0 ? 1.0 : tint));
        }
        for (std::size_t c = 0; c < 3; ++c) {
            row(events.slices.sent, 3 * s + c, ray.sent[s][c]);
        }
    }
    const double step = (ray.grid_to - ray.grid_from) / steps;
    for (int k = 0; k < steps && ray.grid_density > 0.0; ++k) {
        const double far = step * (k + 1);
        Knots &knots = events.knots;
        const auto first = static_cast<std::size_t>(knots.count++) * (5 + channels);
        knots.values.resize((first + 5 + channels) * MAX_LANES);
        row(knots.values, first + 4 + channels, step);
        row(knots.values, first, ray.grid_from + far);
        for (std::size_t c = 0; c < 3; ++c) {
            const double density = ray.grid_density * (c == 0 ? 1.0 : tint);
            row(knots.values, first + 1 + c, ray.grid_sends / density * (1.0 - std::exp(-density * far)));
            if (c < channels) {
                row(knots.values, first + 4 + c, density * far);
            }
        }
    }
}

// Of air, at 64 places as far as the surface.
void fill_air(const Case &ray, int colours, double tint, AirKnots &knots) {
    constexpr int STEPS = 64;
    knots.count = ray.air_density > 0.0 ? STEPS + 1 : 0;
    const auto keep = [&knots](double value) {
        knots.values.insert(knots.values.end(), MAX_LANES, static_cast<float>(value));
    };
    for (int k = 0; k < knots.count; ++k) {
        const double t = double{END} * k / STEPS;
        keep(t);
        for (int c = 0; c < 3; ++c) {
            const double density = ray.air_density * (c == 0 ? 1.0 : tint);
            const double from = std::min(ray.air_lit_from, t), to = std::min(ray.air_lit_to, t);
            keep(ray.air_sends / density * (std::exp(-density * from) - std::exp(-density * to)));
        }
        for (int c = 0; c < colours; ++c) {
            keep(ray.air_density * (c == 0 ? 1.0 : tint) * t);
        }
    }
}

void expect_merged(const Case &ray, double tolerance, const char *what) {
    for (const double tint : {1.0, 0.4}) {
        const Result wanted = integrated(ray, tint);
        FrameView frame;
        frame.sorted = true;
        frame.grey = tint == 1.0;
        for (const InstructionSet &with : instruction_sets()) {
            Events events;
            Layers layers;
            layers.events = &events;
            fill(ray, frame.grey ? 1 : 3, tint, 64, layers);
            fill_air(ray, frame.grey ? 1 : 3, tint, events.air);
            const AirView air;
            frame.air = std::span(&air, ray.air_density > 0.0 ? 1 : 0);
            frame_kernels(with).merge(frame, Packet{}, layers);
            for (std::size_t c = 0; c < 3; ++c) {
                for (int lane = 0; lane < with.lanes; ++lane) {
                    EXPECT_NEAR(double{layers.smoke[c][lane]}, wanted.smoke[c], tolerance) << what << with.name << c;
                    EXPECT_NEAR(double{layers.through[c][lane]}, wanted.through[c], tolerance)
                        << what << with.name << c;
                }
            }
        }
    }
}

Case three_fragments() {
    Case ray;
    ray.fragments = {{5.0F, {0.2F, 0.1F, 0.3F}, {0.5F, 0.6F, 0.7F}},
                     {1.0F, {0.4F, 0.0F, 0.1F}, {0.3F, 0.3F, 0.3F}},
                     {3.0F, {0.0F, 0.9F, 0.1F}, {0.8F, 0.1F, 0.8F}}};
    return ray;
}

TEST(Merge, OfNothingIsClear) {
    expect_merged({}, 0.0, "nothing, ");
}

TEST(Merge, SortsFragments) {
    expect_merged(three_fragments(), 1e-6, "fragments, ");
}

TEST(Merge, HidesWhatIsBehindTheSurface) {
    Case ray = three_fragments();
    const Result before = integrated(ray);
    ray.fragments.push_back({END + 0.1F, glm::vec3(1.0F), glm::vec3(0.0F)});
    EXPECT_EQ(integrated(ray).smoke, before.smoke);
    expect_merged(ray, 1e-6, "one behind, ");
}

TEST(Merge, CompositesSlices) {
    Case ray;
    ray.first = 2.0;
    ray.width = 0.5;
    ray.depth = {0.1, 1.5, 0.0, 0.4};
    ray.sent = {{0.1, 0.0, 0.2}, {0.7, 0.7, 0.1}, {0.0, 0.0, 0.0}, {0.2, 0.3, 0.4}};
    expect_merged(ray, 2e-5, "slices, ");
    ray.fragments = three_fragments().fragments; // before, in and behind them
    ray.fragments.push_back({2.75F, glm::vec3(0.3F), glm::vec3(0.5F)});
    expect_merged(ray, 2e-5, "slices and fragments, ");
}

TEST(Merge, LaysFragmentsIntoTheSmokeOfGrids) {
    Case ray = three_fragments();
    ray.grid_from = 2.0;
    ray.grid_to = 6.0;
    ray.grid_density = 0.7;
    ray.grid_sends = 0.3;
    expect_merged(ray, 1e-4, "grid, ");
}

// The slices are thin: where two media are in one place, each shades the other on the mean over a slice.
TEST(Merge, MixesParticlesWithTheSmokeOfGrids) {
    Case ray = three_fragments();
    ray.grid_from = 2.5;
    ray.grid_to = 5.5;
    ray.grid_density = 0.6;
    ray.grid_sends = 0.5;
    ray.first = 2.0;
    ray.width = 0.125;
    std::mt19937 random(1); // NOLINT(cert-msc51-cpp): the same at each run
    std::uniform_real_distribution<double> share(0.0, 0.3);
    for (int s = 0; s < 24; ++s) {
        ray.depth.push_back(share(random));
        ray.sent.push_back({share(random), share(random), share(random)});
    }
    expect_merged(ray, 1e-3, "all three, ");
}

TEST(Merge, DimsNothingThatGridsSendBeforeParticles) {
    Case ray;
    ray.grid_from = 0.5;
    ray.grid_to = 1.5;
    ray.grid_density = 0.6;
    ray.grid_sends = 0.5;
    ray.first = 2.0;
    ray.width = 0.5;
    ray.depth = {1.5, 0.0, 0.8};
    ray.sent = {{0.7, 0.7, 0.1}, {0.0, 0.0, 0.0}, {0.2, 0.3, 0.4}};
    expect_merged(ray, 1e-4, "a grid before slices, ");
    ray.grid_from = 2.5;
    ray.grid_to = 3.0;
    expect_merged(ray, 1e-4, "a grid between slices, ");
}

TEST(Merge, MixesAirWithAllElse) {
    Case ray;
    ray.air_density = 0.3;
    ray.air_sends = 0.2;
    ray.air_lit_from = 1.5;
    ray.air_lit_to = 4.0;
    expect_merged(ray, 2e-5, "air, ");
    ray.fragments = three_fragments().fragments;
    expect_merged(ray, 2e-5, "air and fragments, ");
    ray.grid_from = 2.5;
    ray.grid_to = 5.5;
    ray.grid_density = 1.6;
    ray.grid_sends = 0.5;
    expect_merged(ray, 2e-4, "air, a grid and fragments, ");
    ray.first = 2.0;
    ray.width = 0.125;
    std::mt19937 random(1); // NOLINT(cert-msc51-cpp): the same at each run
    std::uniform_real_distribution<double> share(0.0, 0.3);
    for (int s = 0; s < 24; ++s) {
        ray.depth.push_back(share(random));
        ray.sent.push_back({share(random), share(random), share(random)});
    }
    expect_merged(ray, 1e-3, "all four, ");
}

TEST(Merge, DoesNotDependOnTheOrderInWhichFragmentsCome) {
    std::mt19937 random(2); // NOLINT(cert-msc51-cpp)
    std::uniform_real_distribution<float> share(0.0F, 1.0F);
    std::vector<Fragment> fragments;
    for (int i = 0; i < 20000; ++i) { // many more than a lane keeps
        const float alpha = 0.002F * share(random);
        fragments.push_back({END * share(random), glm::vec3(alpha * share(random)), glm::vec3(1.0F - alpha)});
    }
    FrameView frame;
    frame.sorted = true;
    Case ray;
    ray.fragments = fragments;
    const Result wanted = integrated(ray);
    for (int turn = 0; turn < 3; ++turn) {
        Events events;
        Layers layers;
        layers.events = &events;
        std::shuffle(fragments.begin(), fragments.end(), random);
        for (std::size_t lane = 0; lane < MAX_LANES; ++lane) {
            layers.distance[lane] = END;
        }
        for (const Fragment &fragment : fragments) {
            events.add(0, fragment);
        }
        EXPECT_LE(events.fragments[0].size(), Events::MOST);
        frame_kernels().merge(frame, Packet{}, layers);
        EXPECT_NEAR(double{layers.through[0][0]}, wanted.through[0], 1e-5);
        EXPECT_NEAR(double{layers.smoke[0][0]}, wanted.smoke[0], 5e-3);
    }
}

} // namespace
} // namespace sfumato
