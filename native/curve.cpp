// SPDX-License-Identifier: GPL-3.0-or-later
#include "curve.hpp"

#include "glsl.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

void curve_transmittance(std::span<const std::uint8_t> texel, std::span<const float> depth, std::span<float> out) {
    const TexelHead head = read_head(texel);
    const float total = glsl::transmittance_of(head.total);
    glsl::DepthRange range;
    range.low = head.range.low;
    range.high = head.range.high;
    std::array<float, CURVE_KNOTS + 2> z{}, lost{}; // z from 0 to 1, the light lost from 0 to 1 - total
    z.back() = 1.0F;
    lost.back() = 1.0F - total;
    float share = 0.0F;
    for (std::size_t k = 0; k < CURVE_KNOTS; ++k) {
        z[k + 1] = glsl::next_knot(z[k], static_cast<float>(texel[HEAD_BYTES + k]) / 255.0F);
        share = glsl::next_knot(share, static_cast<float>(texel[HEAD_BYTES + CURVE_KNOTS + k]) / 255.0F);
        lost[k + 1] = (1.0F - total) * share;
    }
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float d = glsl::relative_depth(range, depth[i]);
        float inside = 1.0F;
        for (std::size_t k = 0; k + 1 < z.size(); ++k) {
            inside -= glsl::line_drop(d, z[k], z[k + 1], lost[k + 1] - lost[k]);
        }
        out[i] = glsl::curve_transmittance(depth[i], range, inside, total);
    }
}

} // namespace sfumato
