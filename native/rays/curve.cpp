// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/curve.hpp"

#include "rays/ray_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace sfumato {

std::vector<CurveVertex> exact_curve(const Absorbers &absorbers) {
    struct Event {
        double z, step, slope;
    };
    std::vector<Event> events;
    const double width = absorbers.width;
    for (std::size_t i = 0; i < absorbers.depth.size(); ++i) {
        const double z = absorbers.depth[i], tau = absorbers.tau[i];
        if (!(tau > 0.0)) {
            continue;
        }
        if (width > 0.0) {
            events.push_back({z - 0.5 * width, 0.0, tau / width});
            events.push_back({z + 0.5 * width, 0.0, -tau / width});
        } else {
            events.push_back({z, tau, 0.0});
        }
    }
    std::sort(events.begin(), events.end(), [](const Event &a, const Event &b) {
        return std::tie(a.z, a.step, a.slope) < std::tie(b.z, b.step, b.slope);
    });
    std::vector<CurveVertex> out;
    double z = 0.0, tau = 0.0, slope = 0.0;
    for (const Event &event : events) {
        if (!out.empty() && event.z > z) {
            const double gain = std::max(slope, 0.0) * (event.z - z);
            const int pieces = static_cast<int>(std::clamp(std::ceil(gain / 0.125), 1.0, 128.0));
            for (int piece = 1; piece <= pieces; ++piece) {
                const double share = static_cast<double>(piece) / pieces;
                out.push_back({z + share * (event.z - z), std::exp(-(tau + share * gain))});
            }
            tau += gain;
        } else if (out.empty()) {
            out.push_back({event.z, 1.0});
        }
        z = event.z;
        slope += event.slope;
        if (event.step > 0.0) {
            tau += event.step;
            out.push_back({z, std::exp(-tau)});
        }
    }
    return out;
}

void curve_transmittance(std::span<const std::uint8_t> texels, std::span<const float> depth, std::span<float> out) {
    constexpr std::size_t PIECE = 1024; // texels at a time, in words
    static_assert(CURVE_BYTES == RAY_WORDS * sizeof(std::int32_t));
    const std::size_t rays = texels.size() / CURVE_BYTES, receivers = depth.size() / std::max<std::size_t>(rays, 1);
    std::vector<std::int32_t> words(std::min(rays, PIECE) * RAY_WORDS);
    for (std::size_t first = 0; first < rays; first += PIECE) {
        const std::size_t count = std::min(PIECE, rays - first);
        std::memcpy(words.data(), texels.data() + first * CURVE_BYTES, count * CURVE_BYTES);
        ray_kernels().look_up_texels({words.data(), true, depth.data() + first * receivers,
                                      out.data() + first * receivers, static_cast<int>(receivers),
                                      static_cast<int>(count * receivers)});
    }
}

} // namespace sfumato
