// SPDX-License-Identifier: GPL-3.0-or-later
// Fetches of the lane kernels: grids, clearance and light maps. The GPU has samplers for this; the formulas that use
// what is fetched are shared.
#pragma once

#include "maps/map_view.hpp"
#include "media/medium_view.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"
#include "text/rays_text.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

using LightsText = text::LightsText<Real, Isa>;
using RaysText = text::RaysText<Real, Isa>;

// A position between eight cell centres.
struct Cell {
    Index first; // index of the lowest corner
    Real x, y, z;
};

// The sample below a position among `size` of them, counted from the first one's centre, and how far above it the
// position lies. Outside, the outermost samples answer.
inline Index split(Real position, int size, Real &fraction) {
    const Real inside = clamp(position, 0.0F, static_cast<float>(size - 1));
    const Real whole = min(floor(inside), static_cast<float>(size - 2));
    fraction = inside - whole;
    return truncate(whole);
}

inline Cell locate(const GridView &grid, const vec3 &p) {
    Cell cell;
    const Index i = split(p.x - 0.5F, grid.nx, cell.x);
    const Index j = split(p.y - 0.5F, grid.ny, cell.y);
    const Index k = split(p.z - 0.5F, grid.nz, cell.z);
    if (grid.bricks == nullptr) {
        cell.first = ((k * Index(grid.ny) + j) * Index(grid.nx) + i) * Index(grid.channels);
        return cell;
    }
    const auto brick = [](Index at) { return at >> STORED_BITS; };
    const auto within = [](Index at) { return at & Index(STORED - 1); };
    const Index first =
        gather(grid.bricks, (brick(k) * Index(grid.bricks_y) + brick(j)) * Index(grid.bricks_x) + brick(i));
    cell.first =
        (first + (within(k) * Index(STORED_ROW) + within(j)) * Index(STORED_ROW) + within(i)) * Index(grid.channels);
    return cell;
}

inline Real lerp(Real a, Real b, Real t) {
    return a + (b - a) * t;
}

inline Real sample(const GridView &grid, const Cell &cell, int channel) {
    const float *v = grid.values + channel;
    const int x = grid.channels, y = x * grid.row, z = x * grid.slice;
    const auto row = [&](int offset) {
        return lerp(gather(v + offset, cell.first), gather(v + offset + x, cell.first), cell.x);
    };
    return lerp(lerp(row(0), row(y), cell.y), lerp(row(z), row(z + y), cell.y), cell.z);
}

// Clearance of the brick around a position, see medium_view.hpp.
inline Real clearance_at(const ClearanceView &bricks, const vec3 &p) {
    const auto brick = [](Real coordinate, int size) {
        return truncate(clamp(coordinate * (1.0F / static_cast<float>(BRICK)), 0.0F, static_cast<float>(size) - 0.5F));
    };
    const Index i = brick(p.x, bricks.nx), j = brick(p.y, bricks.ny), k = brick(p.z, bricks.nz);
    return gather(bricks.cells, (k * Index(bricks.ny) + j) * Index(bricks.nx) + i);
}

// Four texels of a light map, and where a point lies between them.
struct Texels {
    Index at[4];
    Real x, y;
};

// By differences, so that four equal values give just that value.
inline Real bilinear(const Texels &texels, const Real values[4]) {
    return lerp(lerp(values[0], values[1], texels.x), lerp(values[2], values[3], texels.x), texels.y);
}

inline Texels locate(const LightMapView &map, Real x, Real y) {
    Texels texels;
    const Index i = split(x * static_cast<float>(map.width) - 0.5F, map.width, texels.x);
    const Index j = split(y * static_cast<float>(map.height) - 0.5F, map.height, texels.y);
    texels.at[0] = j * Index(map.width) + i;
    texels.at[1] = texels.at[0] + Index(1);
    texels.at[2] = texels.at[0] + Index(map.width);
    texels.at[3] = texels.at[2] + Index(1);
    return texels;
}

// Where a point in the world lies on a map: x and y across it, and its depth along the light.
inline vec3 place_on(const LightMapView &map, const vec3 &world) {
    const vec3 p = transform_point(map.world_to_light, world);
    if (!map.radial) {
        return p;
    }
    const LightsText::Octahedral place = LightsText().octahedral(p);
    return {(place.x - map.low[0]) * map.scale[0], (place.y - map.low[1]) * map.scale[1],
            (sqrt(dot(p, p)) - map.low[2]) * map.scale[2]};
}

// The column density between the light and depth z. Before a ray's range it is 0, beyond it the total; sideways of the
// map the outermost texels, which are empty, answer. Each texel's ray has a range of its own, so what is filtered is
// the four column densities, not the coefficients.
inline Real column_density(const LightMapView &map, const Texels &texels, Real z) {
    Index first[4];
    Real columns[4], d[4];
    Mask ready(true); // the constant term is the whole answer: beyond all smoke, where a floor mostly is, or before it
    for (int t = 0; t < 4; ++t) {
        first[t] = texels.at[t] * Index(map.stride());
        columns[t] = gather(map.coefficients, first[t]);
        const Real low = gather(map.coefficients + 1, first[t]);
        d[t] = clamp((z - low) * gather(map.coefficients + 2, first[t]), 0.0F, 1.0F);
        ready = ready & ((d[t] <= 0.0F) | (d[t] >= 1.0F) | (columns[t] <= 0.0F));
    }
    if (xsimd::all(ready)) {
        for (int t = 0; t < 4; ++t) {
            columns[t] = columns[t] * d[t];
        }
        return bilinear(texels, columns);
    }
    for (int t = 0; t < 4; ++t) {
        const Real cosine = cos(0.5F * TWO_PI * d[t]), twice = cosine + cosine;
        Real sum = 0.0F, after = 0.0F;
        for (int k = map.count - 1; k >= 1; --k) {
            const Real next =
                RaysText().clenshaw(gather(map.coefficients + HEAD_FLOATS + k - 1, first[t]), twice, sum, after);
            after = sum;
            sum = next;
        }
        const Real sine = sqrt(max(1.0F - cosine * cosine, 0.0F)); // of an angle in [0, pi]
        columns[t] = clamp(columns[t] * d[t] + sum * sine, 0.0F, columns[t]);
    }
    return bilinear(texels, columns);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
