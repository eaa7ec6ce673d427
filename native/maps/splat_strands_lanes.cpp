// SPDX-License-Identifier: GPL-3.0-or-later
// Where the rays of light maps cross strands. A texel is as wide as its ray: a strand takes the share of light that it
// covers of it, so that several of them take what they would if they lay anywhere in it.
#include "maps/splat_loops.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

// The part of [low, high] that lies within half a texel.
Real within_texel(Real low, Real high) {
    return max(min(high, 0.5F) - max(low, -0.5F), 0.0F);
}

// A strand's ends across the light, in texels from the middle of a ray's; and in the map's depth.
struct Ends {
    vec3 from, to;
    Real from_depth, to_depth, from_size, to_size; // size: the radius, texels
    Mask before;
};

Ends ends_of(const SplatStrand &strand, const TexelRays &rays) {
    const vec3 a{Real(strand.from[0]), Real(strand.from[1]), Real(strand.from[2])};
    const vec3 b{Real(strand.to[0]), Real(strand.to[1]), Real(strand.to[2])};
    if (!rays.map.radial) {
        const vec3 ray{rays.x, rays.y, Real(0.0F)};
        return {{a.x - ray.x, a.y - ray.y, Real(0.0F)},
                {b.x - ray.x, b.y - ray.y, Real(0.0F)},
                a.z,
                b.z,
                Real(strand.from_radius),
                Real(strand.to_radius),
                Mask(true)};
    }
    const vec3 &ray = rays.direction;
    const LightMapView &map = rays.map;
    // On a face of the octahedron texels see more the nearer they are to its middle.
    const Real sum = abs(ray.x) + abs(ray.y) + abs(ray.z);
    const float texel = std::max(1.0F / (map.scale[0] * static_cast<float>(map.width)),
                                 1.0F / (map.scale[1] * static_cast<float>(map.height)));
    const Real per_texel = 1.0F / (texel * sum * sqrt(sum));
    const Real along_a = dot(a, ray), along_b = dot(b, ray);
    const Real per_a = 1.0F / max(along_a, 1e-9F), per_b = 1.0F / max(along_b, 1e-9F);
    const auto depth = [&map](const vec3 &p) { return (sqrt(dot(p, p)) - map.low[2]) * map.scale[2]; };
    return {(a * per_a - ray) * per_texel,
            (b * per_b - ray) * per_texel,
            depth(a),
            depth(b),
            strand.from_radius * per_a * per_texel,
            strand.to_radius * per_b * per_texel,
            (along_a > 1e-9F) & (along_b > 1e-9F)};
}

Crossing cross(const SplatStrand &strand, const TexelRays &rays) {
    const Ends ends = ends_of(strand, rays);
    const vec3 way = ends.to - ends.from;
    const Real length = sqrt(dot(way, way)), per_length = 1.0F / max(length, 1e-6F);
    const Real forth = -dot(ends.from, way) * per_length, share = clamp(forth * per_length, 0.0F, 1.0F);
    const vec3 foot = ends.from + way * (forth * per_length);
    const Real aside = sqrt(dot(foot, foot)), radius = ends.from_size + (ends.to_size - ends.from_size) * share;
    const Real across = within_texel(aside - radius, aside + radius);
    const Real along = within_texel(-forth, length - forth);
    // So a strand's pieces add up to what it is in one.
    const Real column = -log(1.0F - min(across, 1.0F - 9.5367432e-7F)) * along;
    const Real half = max(0.5F * abs(ends.to_depth - ends.from_depth) * along * per_length, 1e-5F);
    const Mask met = ends.before & (column > 0.0F);
    return {pick(met, column, 0.0F), ends.from_depth + (ends.to_depth - ends.from_depth) * share, half, met};
}

} // namespace

void splat_strands(const Splat<SplatStrand> &splat, int column, int row) {
    splat_block(splat, column, row);
}

void meet_strands(const Splat<SplatStrand> &splat, int column, int row, int packet, SplatAbsorbers &out) {
    meet_block(splat, column, row, packet, out);
}

} // namespace sfumato::SFUMATO_ISA
