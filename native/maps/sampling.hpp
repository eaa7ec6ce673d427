// SPDX-License-Identifier: GPL-3.0-or-later
// Fetches of the lane kernels: grids, clearance and light maps. The GPU has samplers for this; the formulas that use
// what is fetched are shared.
#pragma once

#include "maps/exact_rays.hpp"
#include "maps/map_view.hpp"
#include "media/medium_view.hpp"
#include "rays/curve_lanes.hpp"
#include "rays/series_lanes.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"

namespace sfumato::SFUMATO_ISA {

// exact_lanes.cpp
void exact_column(const ExactRays &rays, ExactPacket &packet);
void exact_open(const ExactRays &rays, ExactPacket &packet);
void exact_arriving(const ArrivingAt &at, ExactPacket &packet);

namespace {

using LightsText = text::LightsText<Real, Isa>;

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

// A row of a transfer function, by its number.
inline vec3 ramp_row(const RampView &ramp, const Real &row) {
    const Index at = truncate(row) * Index(3);
    return {gather(ramp.rows, at), gather(ramp.rows + 1, at), gather(ramp.rows + 2, at)};
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

// The numbers of a series in one texel, and between four.
struct TexelNumbers {
    const float *numbers; // number k of the first texel at k
    Index first;

    [[nodiscard]] Real operator()(int k) const { return gather(numbers + k, first); }
    [[nodiscard]] Real operator()(Index k) const { return gather(numbers, first + k); }
};

struct BlendedNumbers {
    const float *numbers;
    const Texels &texels;
    int stride;

    template <typename Number>
    [[nodiscard]] Real operator()(Number k) const {
        Real values[4];
        for (int t = 0; t < 4; ++t) {
            values[t] = TexelNumbers{numbers, texels.at[t] * Index(stride)}(k);
        }
        return bilinear(texels, values);
    }
};

// The columns of four rays as one. Sharp ones are optical depths.
inline Real blended_columns(const LightMapView &map, const Texels &texels, const Real columns[4]) {
    if (!map.sharp) {
        return bilinear(texels, columns);
    }
    Real light[4];
    for (int t = 0; t < 4; ++t) {
        light[t] = exp(-columns[t]);
    }
    return -log(max(bilinear(texels, light), 1e-37F));
}

// Where each texel's ray has a range of its own, what is filtered is the four column densities, not the coefficients.
template <BasisName BASIS>
inline Real own_column(const LightMapView &map, const Texels &texels, Real z) {
    constexpr int HEAD = LightMapView::OWN_HEAD;
    Index first[4];
    Real columns[4], d[4];
    Mask ready(true); // the constant term is the whole answer: beyond all smoke, where a floor mostly is, or before it
    for (int t = 0; t < 4; ++t) {
        first[t] = texels.at[t] * Index(HEAD + map.count - 1);
        columns[t] = gather(map.coefficients, first[t]);
        const Real low = gather(map.coefficients + 1, first[t]);
        d[t] = clamp((z - low) * gather(map.coefficients + 2, first[t]), 0.0F, 1.0F);
        ready = ready & ((d[t] <= 0.0F) | (d[t] >= 1.0F) | (columns[t] <= 0.0F));
    }
    if (xsimd::all(ready)) {
        for (int t = 0; t < 4; ++t) {
            columns[t] = columns[t] * d[t];
        }
        return blended_columns(map, texels, columns);
    }
    for (int t = 0; t < 4; ++t) {
        const TexelNumbers numbers{map.coefficients + HEAD - 1, first[t]};
        columns[t] = integral_of<BASIS>(columns[t], map.count, d[t], numbers, map.tables);
    }
    return blended_columns(map, texels, columns);
}

// Where they share one, filtered coefficients are one series.
template <BasisName BASIS>
inline Real shared_column(const LightMapView &map, const Texels &texels, Real z) {
    const BlendedNumbers numbers{map.coefficients + LightMapView::SHARED_HEAD - 1, texels, map.stride()};
    const Real total = max(numbers(0), 0.0F), d = clamp(z, 0.0F, 1.0F);
    const Mask ready = (d <= 0.0F) | (d >= 1.0F) | (total <= 0.0F);
    return xsimd::all(ready) ? total * d : integral_of<BASIS>(total, map.count, d, numbers, map.tables);
}

// A curve is read as transmittance and filtered as that.
inline Real curve_column(const LightMapView &map, const Texels &texels, Real z, int colour) {
    const int at = std::min(colour, map.colours - 1);
    Real light[4];
    for (int t = 0; t < 4; ++t) {
        const Index curve = texels.at[t] * Index(map.colours) + Index(at);
        light[t] = curve_at(map.curves, curve * Index(RAY_WORDS), z);
    }
    return -log(clamp(bilinear(texels, light), 1e-37F, 1.0F)) * map.per_depth[at];
}

// Not inlined, and with places by value, so that the usual map is read as if there were no other.
[[gnu::noinline]] Real other_column(const LightMapView &map, Real x, Real y, Real z, int colour) {
    const Texels texels = locate(map, x, y);
    if (map.curves != nullptr) {
        return curve_column(map, texels, z, colour);
    }
    const bool own = !map.shared;
    switch (map.basis) {
    case FOURIER:
        return own ? own_column<FOURIER>(map, texels, z) : shared_column<FOURIER>(map, texels, z);
    case COSINE:
        return shared_column<COSINE>(map, texels, z);
    case PIECEWISE:
        return own ? own_column<PIECEWISE>(map, texels, z) : shared_column<PIECEWISE>(map, texels, z);
    case LEARNED:
        return own ? own_column<LEARNED>(map, texels, z) : shared_column<LEARNED>(map, texels, z);
    }
    return 0.0F;
}

// The column density between the light and a place on the map, whose texels are these, as light of a colour meets it.
// Before a ray's range it is 0, beyond it the total; sideways of the map the outermost texels, which are empty, answer.
inline Real column_density(const LightMapView &map, const Texels &texels, const vec3 &place, int colour) {
    const bool usual = map.basis == COSINE && !map.shared && map.curves == nullptr;
    return usual ? own_column<COSINE>(map, texels, place.z) : other_column(map, place.x, place.y, place.z, colour);
}

inline void put(const vec3 &world, ExactPacket &packet) {
    world.x.store_aligned(packet.world[0]);
    world.y.store_aligned(packet.world[1]);
    world.z.store_aligned(packet.world[2]);
}

// Not inlined, as other_column().
[[gnu::noinline]] void add_exact_depth(const ExactRays &rays, Real x, Real y, Real z, const float *extinction,
                                       int colours, Real *depth) {
    ExactPacket packet;
    put({x, y, z}, packet);
    exact_column(rays, packet);
    const Real column = Real::load_aligned(packet.out[0]);
    for (int c = 0; c < colours; ++c) {
        depth[c] = depth[c] + column * extinction[c];
    }
}

// Adds the optical depth between the light and the place in each of the colours.
inline void add_optical_depth(const LightMapView &map, const Texels &texels, const vec3 &place, const float *extinction,
                              int colours, Real *depth) {
    if (map.clear()) {
        if (map.exact != nullptr && map.exact->hides) {
            add_exact_depth(*map.exact, place.x, place.y, place.z, extinction, colours, depth);
        }
        return;
    }
    Real column = column_density(map, texels, place, 0);
    for (int c = 0; c < colours; ++c) {
        if (c > 0 && map.colours > 1) {
            column = column_density(map, texels, place, c);
        }
        depth[c] = depth[c] + column * extinction[c];
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
