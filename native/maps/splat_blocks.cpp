// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/splat_blocks.hpp"

#include "text/rays_text.hpp"

#include <array>
#include <limits>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

} // namespace

// One ray of what a packet meets. A chord's density is that of three flat absorbers (Gauss and Legendre's rule with the
// density for a weight).
void take_ray(const SplatAbsorbers &met, bool shared, std::size_t lane, std::size_t lanes, ColumnRay &ray) {
    constexpr std::array<std::array<float, 2>, 3> NODES = {
        {{-0.654653671F, 7.0F / 30.0F}, {0.0F, 16.0F / 30.0F}, {0.654653671F, 7.0F / 30.0F}}};
    ray.depth.clear();
    ray.column.clear();
    ray.total = 0.0F;
    float low = std::numeric_limits<float>::max(), high = -low;
    for (std::size_t i = lane; i < met.count * lanes; i += lanes) {
        const float column = met.column[i], depth = met.depth[i], half = met.half[i];
        if (!(column > 0.0F)) {
            continue;
        }
        for (const auto &[place, share] : NODES) {
            ray.depth.push_back(std::clamp(depth + place * half, 0.0F, 1.0F));
            ray.column.push_back(column * share);
        }
        ray.total += column;
        low = std::min(low, depth - half);
        high = std::max(high, depth + half);
    }
    const bool own = ray.total > 0.0F && !shared;
    const RaysText::DepthRange range = own ? RaysText().padded_range(low, high) : RaysText::DepthRange{0.0F, 1.0F};
    ray.range.low = std::max(range.low, 0.0F);
    ray.range.high = std::max(std::min(range.high, 1.0F), ray.range.low + 1e-4F);
}

} // namespace sfumato
