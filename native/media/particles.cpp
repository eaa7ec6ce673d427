// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/particles.hpp"

#include "scene/scene.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>

#include <glm/common.hpp>
#define XXH_INLINE_ALL // a header, not one more library to find
#include <xxhash.h>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

// How many texels a radius needs to be wide, of puffs of an optical depth `depth` of which `overlap` lie on a ray. Of
// texels six times smaller than its radius, interpolated, the column of a puff is off by at most 1 % of that through
// its middle, and the error goes as the square of a texel. Those of many puffs on a ray are independent: where together
// they are off by less than ALLOWED, texels may be larger. FEW puffs lie here and there, where the mean says little.
double details_of_radius(double depth, double overlap) {
    constexpr double FINEST = 6.0, COARSEST = 2.0, ERROR = 0.01, ALLOWED = 0.04, FEW = 12.0;
    const double allowed = std::sqrt(ERROR * depth * std::sqrt(std::max(overlap, 1.0)) / ALLOWED);
    const double mixed = std::pow(FEW / std::max(overlap, FEW), 0.25);
    return std::max(FINEST * std::clamp(allowed, mixed, 1.0), COARSEST);
}

void add_body(const Particles &particles, Puffs &out) {
    Puffs::Body body;
    body.first = out.puffs.size();
    body.low = glm::vec3(std::numeric_limits<float>::max());
    body.high = -body.low;
    double cross_section = 0.0, widths = 0.0, depths = 0.0, discs = 0.0;
    for (std::size_t i = 0; i < particles.points.size(); ++i) {
        const float radius = particles.radius[i], depth = RaysText().optical_depth_of(particles.opacity[i]);
        // What is smaller than a place's own rounding has no size.
        const glm::vec3 far = glm::abs(particles.points[i]);
        const float least = 1e-7F * std::max({1.0F, far.x, far.y, far.z});
        if (!(radius > least && depth > 0.0F)) {
            continue;
        }
        out.puffs.push_back({particles.points[i], radius, depth});
        out.albedo.push_back(particles.albedo[particles.albedo.size() > 1 ? i : 0]);
        body.low = glm::min(body.low, particles.points[i] - radius);
        body.high = glm::max(body.high, particles.points[i] + radius);
        const double takes = double{particles.opacity[i]} * double{radius};
        cross_section += takes;
        widths += takes * double{radius};
        depths += takes * double{depth};
        discs += std::numbers::pi * double{radius} * double{radius};
    }
    body.count = out.puffs.size() - body.first;
    if (body.count == 0) {
        return;
    }
    const glm::dvec3 extent = body.high - body.low;
    const double side = (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x) / 3.0;
    body.detail = widths / cross_section / details_of_radius(depths / cross_section, discs / side);
    body.extinction = particles.extinction;
    body.anisotropy = particles.anisotropy;
    body.visibility = particles.visibility;
    const std::span<const Puff> puffs = out.of(body);
    const XXH128_hash_t hash = XXH3_128bits(puffs.data(), puffs.size_bytes());
    body.content = {hash.low64, hash.high64};
    for (Puff &puff : std::span(out.puffs).subspan(body.first)) {
        puff.body = static_cast<std::int32_t>(out.bodies.size());
    }
    out.bodies.push_back(body);
}

} // namespace

bool Puffs::grey() const {
    return std::all_of(bodies.begin(), bodies.end(), [](const Body &body) {
        const glm::vec3 &e = body.extinction;
        return e.x == e.y && e.y == e.z;
    });
}

std::shared_ptr<const Puffs> puffs_of(std::span<const Particles> particles) {
    auto out = std::make_shared<Puffs>();
    std::size_t count = 0;
    for (const Particles &each : particles) {
        count += each.points.size();
    }
    out->puffs.reserve(count);
    out->albedo.reserve(count);
    for (const bool shown : {true, false}) {
        for (const Particles &each : particles) {
            if ((each.visibility.seen == Seen::SHOWN) == shown) {
                add_body(each, *out);
            }
        }
        out->seen = shown ? out->puffs.size() : out->seen;
    }
    return out->bodies.empty() ? nullptr : out;
}

} // namespace sfumato
