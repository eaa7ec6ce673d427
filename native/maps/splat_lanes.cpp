// SPDX-License-Identifier: GPL-3.0-or-later
// Where the rays of light maps cross puffs: see splat_loops.hpp.
#include "maps/splat_loops.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

// 1 - q^2 at the share q of the puff's radius.
Real inside_of(const SplatPuff &puff, const Real &x, const Real &y) {
    const Real dx = (x - puff.x) * puff.per_radius, dy = (y - puff.y) * puff.per_radius;
    return 1.0F - dx * dx - dy * dy;
}

void shares_of_column(const SplatPuff &puff, const TexelRays &rays, Real (&shares)[GROUP]) {
    const Real dx = (rays.x - puff.x) * puff.per_radius, beside = 1.0F - dx * dx;
    Real dy = (rays.y - puff.y) * puff.per_radius;
    for (Real &share : shares) {
        share = MediaText().puff_column(max(beside - dy * dy, 0.0F));
        dy = dy + float{ROWS} * puff.per_radius;
    }
}

Crossing cross(const SplatPuff &puff, const TexelRays &rays) {
    if (!rays.map.radial) {
        const Real inside = max(inside_of(puff, rays.x, rays.y), 0.0F);
        return {puff.column * MediaText().puff_column(inside), puff.z, puff.half * sqrt(inside), inside > 0.0F};
    }
    const vec3 middle{Real(puff.x), Real(puff.y), Real(puff.z)};
    const Real along = dot(middle, rays.direction);
    const vec3 across = middle - rays.direction * along;
    const Real inside = max(1.0F - dot(across, across) * (puff.per_radius * puff.per_radius), 0.0F);
    const Real half = puff.half * sqrt(inside);
    const float scale = rays.map.scale[2];
    Crossing at{puff.column * MediaText().puff_column(inside), (along - rays.map.low[2]) * scale, half * scale,
                (inside > 0.0F) & (along + half > 0.0F)};
    if (xsimd::any(at.met & (along < half))) { // around the light
        const Real near = max(along - half, 0.0F), far = along + half;
        const Real behind = MediaText().puff_before(-along / max(half, 1e-20F));
        at.column = pick(at.met, at.column * (1.0F - behind), 0.0F);
        at.depth = (0.5F * (near + far) - rays.map.low[2]) * scale;
        at.half = 0.5F * max(far - near, 0.0F) * scale;
    }
    return at;
}

} // namespace

void splat_puffs(const Splat<SplatPuff> &splat, int column, int row) {
    splat_block(splat, column, row);
}

void meet_puffs(const Splat<SplatPuff> &splat, int column, int row, int packet, SplatAbsorbers &out) {
    meet_block(splat, column, row, packet, out);
}

} // namespace sfumato::SFUMATO_ISA
