// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/particles.hpp"

#include "scene/scene.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include <glm/common.hpp>
#define XXH_INLINE_ALL // a header, not one more library to find
#include <xxhash.h>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

// Of texels so many times smaller, interpolated, the column of a puff is off by at most 1 % of that through its middle.
constexpr double DETAILS_OF_RADIUS = 6.0;

void add_body(const Particles &particles, Puffs &out) {
    Puffs::Body body;
    body.first = out.puffs.size();
    body.low = glm::vec3(std::numeric_limits<float>::max());
    body.high = -body.low;
    double cross_section = 0.0, widths = 0.0;
    for (std::size_t i = 0; i < particles.points.size(); ++i) {
        const float radius = particles.radius[i], depth = RaysText().optical_depth_of(particles.opacity[i]);
        if (!(radius > 0.0F && depth > 0.0F)) {
            continue;
        }
        out.puffs.push_back({particles.points[i], radius, depth});
        out.albedo.push_back(particles.albedo[particles.albedo.size() > 1 ? i : 0]);
        body.low = glm::min(body.low, particles.points[i] - radius);
        body.high = glm::max(body.high, particles.points[i] + radius);
        const double takes = double{particles.opacity[i]} * double{radius};
        cross_section += takes;
        widths += takes * double{radius};
    }
    body.count = out.puffs.size() - body.first;
    if (body.count == 0) {
        return;
    }
    body.detail = widths / cross_section / DETAILS_OF_RADIUS;
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
