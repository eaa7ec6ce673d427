// SPDX-License-Identifier: GPL-3.0-or-later
// A light map of primitives of any kind, block by block.
#pragma once

#include "maps/column_rays.hpp"
#include "maps/map_kernels.hpp"
#include "text/dispatch.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {

// One ray of what a packet meets. A chord's density is that of three flat absorbers (Gauss and Legendre's rule with the
// density for a weight).
void take_ray(const SplatAbsorbers &met, bool shared, std::size_t lane, std::size_t lanes, ColumnRay &ray);

inline int blocks(int texels) {
    return (texels + Bins::EDGE - 1) / Bins::EDGE;
}

// The plan of `splat`, with what the kernels for its primitives make of it.
template <typename Primitive>
LightMap splatted(LightMap map, Splat<Primitive> splat, void (*whole)(const Splat<Primitive> &, int, int),
                  void (*meet)(const Splat<Primitive> &, int, int, int, SplatAbsorbers &), const InstructionSet &with) {
    const int columns = blocks(map.size.x), rows = blocks(map.size.y);
    if (map.harmonic()) {
        map.coefficients.resize(map.texels() * static_cast<std::size_t>(map.view().stride()));
        splat.coefficients = map.coefficients.data();
        oneapi::tbb::parallel_for(0, columns * rows,
                                  [&](int block) { whole(splat, block % columns, block / columns); });
        blur(map);
        return map;
    }
    ColumnRays rays;
    rays.strips = columns * rows;
    rays.for_rays = [&, lanes = static_cast<std::size_t>(with.lanes), size = map.size](int block, const UseRay &use) {
        SplatAbsorbers met;
        ColumnRay ray;
        const int packets = Bins::EDGE * Bins::EDGE / with.lanes;
        for (int packet = 0; packet < packets; ++packet) {
            meet(splat, block % columns, block / columns, packet, met);
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const int number = packet * with.lanes + static_cast<int>(lane);
                const int x = block % columns * Bins::EDGE + number % Bins::EDGE;
                const int y = block / columns * Bins::EDGE + number / Bins::EDGE;
                if (x < size.x && y < size.y) {
                    take_ray(met, map.shared, lane, lanes, ray);
                    use(static_cast<std::size_t>(y * size.x + x), ray);
                }
            }
        }
    };
    fill(map, rays);
    return map;
}

} // namespace sfumato
