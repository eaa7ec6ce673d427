// SPDX-License-Identifier: GPL-3.0-or-later
// The lit stretches of rays on a light map. A solid takes the light from all that lies behind it on its texel's ray; a
// ray is followed from column to column of texels, along the axis of the map on which it moves faster, and between the
// two texels beside it in each column light is filtered linearly, as solid_occlusion() does. What lies beside the map
// is lit.
//
// Of light from one place a ray is straight on the map in each octant about the light.
//
// One column after the other it is Algorithm 1 of Yusov, "Practical implementation of light scattering effects using
// epipolar sampling and 1D min/max binary trees", 2013; by the bounds of a tree over 2, 4, 8, ... columns Algorithm 2:
//     for_lit_sections(line_on(map, origin, direction, start, end), start, end, asked, MapHeights(tree, line),
//                      ALL_COLUMNS, [&](Mask which, Real from, Real to, Real share) { ... });
// `which` are lanes that are lit by `share` between two distances; of a lane they come in no order where share < 1.
#pragma once

#include "maps/depth_tree.hpp"
#include "maps/map_view.hpp"
#include "text/dispatch.hpp"
#include "text/lanes.hpp"

#include <algorithm>

namespace sfumato::SFUMATO_ISA {
namespace {

// The columns of a map that a ray crosses, upwards: `m` is the place along them, `n` the one across.
struct Columns {
    Mask along_y, reversed;
    Real m0;        // somewhere on the ray,
    Real n0, slope; // where n is n0 + slope (m - m0)
    Real from, to;  // the distances between which it is on the map
    Real first, last;
    Real across; // texels in a column

    // Where in the middle of a column it is, from the first texel's middle on.
    [[nodiscard]] Real place(Real column) const { return n0 + slope * (column + 0.5F - m0) - 0.5F; }
};

// Two depths, or two distances.
struct Between {
    Real low, high;
};

// A ray on a map that is affine in the world.
struct LineOnMap : Columns {
    Real per_column;  // distance is (m - m0) per_column
    Real z0, z_along; // depth is z0 + z_along distance

    // Where it crosses the edge before a column.
    [[nodiscard]] Real distance(Real edge) const { return clamp((edge - m0) * per_column, from, to); }
    [[nodiscard]] Between depths(Real a, Real b) const {
        const Real za = z0 + z_along * a, zb = z0 + z_along * b;
        return {min(za, zb), max(za, zb)};
    }
    // Between two distances, what lies before a depth.
    [[nodiscard]] Between before(Real z, Real a, Real b) const {
        const Real meets = (z - z0) / z_along;
        return {pick(z_along > 0.0F, a, max(a, meets)), pick(z_along > 0.0F, min(b, meets), b)};
    }
};

// A part of a ray on the map of a light from one place, in one octant about the light: there the octahedron is a plane,
// so that on the map the ray is straight, if not even.
struct ArcOnMap : Columns {
    Real begin, length;         // of the part
    Real m_begin, per_m;        // as a share of its way on the map
    Real s_begin, s_end;        // |x| + |y| + |z| at its ends
    Real foot, away2;           // of the light on the ray, and the square of how far away the light is
    float low_depth, per_metre; // depth is (distance from the light - low_depth) per_metre

    [[nodiscard]] Real at_share(Real share) const {
        const Real front = share * s_begin;
        return begin + length * (front / max(front + (1.0F - share) * s_end, 1e-30F));
    }
    [[nodiscard]] Real distance(Real edge) const {
        return clamp(at_share(clamp((edge - m_begin) * per_m, 0.0F, 1.0F)), from, to);
    }
    [[nodiscard]] Between depths(Real a, Real b) const {
        return {depth(clamp(foot, a, b)), depth(pick(foot - a > b - foot, a, b))};
    }
    [[nodiscard]] Between before(Real z, Real a, Real b) const {
        const Real radius = low_depth + z * (1.0F / per_metre);
        const Real half_chord = sqrt(max(radius * radius - away2, 0.0F));
        return {max(a, foot - half_chord), min(b, foot + half_chord)};
    }

private:
    [[nodiscard]] Real depth(Real t) const {
        return (min(sqrt(away2 + (t - foot) * (t - foot)), 1e30F) - low_depth) * per_metre;
    }
};

constexpr float ALL_COLUMNS = 1e6F; // at once, as many as the tree has

// Of a power of two that is no less than either side: columns that are crossed downwards are counted from there.
inline float columns_of(int width, int height) {
    float columns = static_cast<float>(MAX_LANES);
    while (columns < static_cast<float>(std::max(width, height))) {
        columns *= 2.0F;
    }
    return columns;
}

// Where a coordinate that begins at p and changes by d a distance is between 0 and `size`.
inline void clip(Real p, Real d, Real size, Real &from, Real &to) {
    const Real per = 1.0F / pick(abs(d) < 1e-20F, 1e-20F, d);
    const Real a = (0.0F - p) * per, b = (size - p) * per;
    from = max(from, min(a, b));
    to = min(to, max(a, b));
}

// Which way the columns are crossed is the ray's own affair, or that of the plane in which it lies.
inline LineOnMap line_on(const LightMapView &map, const vec3 &p, const vec3 &d, Mask along_y, Mask reversed, Real start,
                         Real end) {
    const auto width = static_cast<float>(map.width), height = static_cast<float>(map.height);
    const float columns = columns_of(map.width, map.height);
    const Real x = p.x * width, y = p.y * height, dx = d.x * width, dy = d.y * height;
    LineOnMap line;
    line.along_y = along_y;
    line.reversed = reversed;
    line.from = start;
    line.to = end;
    clip(x, dx, width, line.from, line.to);
    clip(y, dy, height, line.from, line.to);
    line.to = max(line.to, line.from); // the same where it never is
    const Real m = pick(along_y, y, x), size = pick(along_y, Real(height), Real(width));
    const Real speed = max(pick(reversed, -1.0F, 1.0F) * pick(along_y, dy, dx), 1e-20F);
    line.m0 = pick(reversed, columns - m, m);
    line.per_column = 1.0F / speed;
    line.n0 = pick(along_y, x, y);
    line.slope = clamp(pick(along_y, dx, dy) * line.per_column, -1.0F, 1.0F);
    line.z0 = p.z;
    line.z_along = pick(abs(d.z) < 1e-12F, 1e-12F, d.z);
    const Real low = pick(reversed, columns - size, 0.0F);
    line.first = clamp(floor(line.m0 + speed * line.from), low, low + size - 1.0F);
    line.last = clamp(floor(line.m0 + speed * line.to), low, low + size - 1.0F);
    line.across = pick(along_y, Real(width), Real(height));
    return line;
}

inline LineOnMap line_on(const LightMapView &map, const vec3 &origin, const vec3 &direction, Real start, Real end) {
    const vec3 p = transform_point(map.world_to_light, origin), d = transform_vector(map.world_to_light, direction);
    const Real dx = d.x * static_cast<float>(map.width), dy = d.y * static_cast<float>(map.height);
    const Mask along_y = abs(dy) > abs(dx);
    return line_on(map, p, d, along_y, pick(along_y, dy, dx) < 0.0F, start, end);
}

// Of a part of a ray between two distances in which neither x, y nor z from the light changes its sign.
inline ArcOnMap arc_on(const LightMapView &map, const vec3 &p, const vec3 &d, Real start, Real end) {
    const auto width = static_cast<float>(map.width), height = static_cast<float>(map.height);
    const vec3 middle = p + d * (0.5F * (start + end));
    const auto sign = [](Real x) { return pick(x < 0.0F, -1.0F, 1.0F); };
    const vec3 signs{sign(middle.x), sign(middle.y), sign(middle.z)};
    struct Texel {
        Real x, y, sum;
    };
    // As octahedral() of lights/light.glsl, on the octant's own side of its edges.
    const auto texel = [&](Real t) -> Texel {
        const vec3 q = p + d * t;
        const Real x = max(q.x * signs.x, 0.0F), y = max(q.y * signs.y, 0.0F), z = max(q.z * signs.z, 0.0F);
        const Real sum = max(x + y + z, 1e-30F), per = 1.0F / sum;
        const Mask folded = signs.z < 0.0F;
        const Real u = signs.x * pick(folded, 1.0F - y * per, x * per);
        const Real v = signs.y * pick(folded, 1.0F - x * per, y * per);
        return {(u - map.low[0]) * (map.scale[0] * width), (v - map.low[1]) * (map.scale[1] * height), sum};
    };
    const Texel a = texel(start), b = texel(end);
    const Real dx = b.x - a.x, dy = b.y - a.y;
    ArcOnMap arc;
    arc.along_y = abs(dy) > abs(dx);
    arc.reversed = pick(arc.along_y, dy, dx) < 0.0F;
    arc.begin = start;
    arc.length = end - start;
    arc.s_begin = a.sum;
    arc.s_end = b.sum;
    arc.foot = -dot(p, d);
    const vec3 away = p + d * arc.foot;
    arc.away2 = dot(away, away);
    arc.low_depth = map.low[2];
    arc.per_metre = map.scale[2];
    Real enters = 0.0F, leaves = 1.0F;
    clip(a.x, dx, width, enters, leaves);
    clip(a.y, dy, height, enters, leaves);
    leaves = max(leaves, enters);
    arc.from = arc.at_share(clamp(enters, 0.0F, 1.0F));
    arc.to = pick(leaves > enters, arc.at_share(clamp(leaves, 0.0F, 1.0F)), arc.from);
    const float columns = columns_of(map.width, map.height);
    const Real m = pick(arc.along_y, a.y, a.x), size = pick(arc.along_y, Real(height), Real(width));
    const Real way = max(abs(pick(arc.along_y, dy, dx)), 1e-20F);
    arc.m_begin = pick(arc.reversed, columns - m, m);
    arc.per_m = 1.0F / way;
    arc.m0 = arc.m_begin;
    arc.n0 = pick(arc.along_y, a.x, a.y);
    arc.slope = clamp(pick(arc.along_y, dx, dy) * arc.per_m, -1.0F, 1.0F);
    const Real low = pick(arc.reversed, columns - size, 0.0F);
    arc.first = clamp(floor(arc.m_begin + way * enters), low, low + size - 1.0F);
    arc.last = clamp(floor(arc.m_begin + way * leaves), low, low + size - 1.0F);
    arc.across = pick(arc.along_y, Real(width), Real(height));
    return arc;
}

// What a ray is tested against in some columns: bounds of the texels beside it, and where it is one column the depths
// in the two of them, of which the second counts `weight`.
struct ColumnNode {
    Real low, high;
    Real depth[2];
    Real weight;
};

// Of a whole map: any ray has a tree there.
class MapHeights {
public:
    MapHeights(const DepthTreeView &tree, const Columns &line)
        : tree_(tree), line_(line), columns_(columns_of(tree.width, tree.height)) {}

    // The most columns that it has at once.
    [[nodiscard]] float root() const { return static_cast<float>(1 << tree_.levels); }

    // Of `count` columns, 2^level, from a multiple of that.
    [[nodiscard]] ColumnNode node(Real column, Real count, Real per_count, Real level) const {
        const Real most = line_.across - 1.0F;
        const Real a = clamp(line_.place(column), 0.0F, most);
        const Real b = clamp(line_.place(column + count - 1.0F), 0.0F, most);
        const Real below = floor(min(a, b)), above = min(floor(max(a, b)) + 1.0F, most);
        const Real own = column * per_count;
        const Real j = pick(line_.reversed, columns_ * per_count - 1.0F - own, own);
        const Index row = gather(tree_.row, truncate(level)), first = gather(tree_.first, truncate(level));
        const auto at = [&](Real k) {
            return first + truncate(pick(line_.along_y, j, k)) * row + truncate(pick(line_.along_y, k, j));
        };
        const Index at0 = at(floor(below * per_count)), at1 = at(floor(above * per_count));
        ColumnNode node;
        node.depth[0] = gather(tree_.low, at0);
        node.depth[1] = gather(tree_.low, at1);
        node.low = min(node.depth[0], node.depth[1]);
        node.high = max(gather(tree_.high, at0), gather(tree_.high, at1));
        node.weight = a - below;
        return node;
    }

private:
    const DepthTreeView &tree_;
    const Columns &line_;
    float columns_;
};

// Calls found() for each lit stretch of the asked lanes between `start` and `end`; never tests more than `most` columns
// at once: 1 is Algorithm 1. Returns how many nodes each lane was tested against.
template <typename Line, typename Heights, typename Found>
Real for_lit_sections(const Line &line, Real start, Real end, Mask asked, const Heights &heights, float most,
                      const Found &found) {
    Mask on = asked & (line.from < line.to), arrived = on;
    Mask lit = asked & (!on | (line.from > start)); // before it comes to the map, if it does
    Real since = start, column = line.first, count = 1.0F, per_count = 1.0F, level = 0.0F, tested = 0.0F;
    const float root = std::min(most, heights.root());
    while (xsimd::any(on)) {
        const Real pairs = column * (0.5F * per_count);
        const Mask rises = arrived & (floor(pairs) == pairs) & (count * 2.0F <= root);
        count = pick(rises, count * 2.0F, count);
        per_count = pick(rises, per_count * 0.5F, per_count);
        level = pick(rises, level + 1.0F, level);
        column = min(column, line.last); // also where a lane is done, and looks no more
        const Real a = line.distance(column), b = line.distance(column + count);
        const Between z = line.depths(a, b);
        const ColumnNode node = heights.node(column, count, per_count, level);
        const Mask bright = z.high < node.low, dark = z.low >= node.high, single = count < 1.5F;
        arrived = on & (bright | dark | single);
        const Mask ends = arrived & lit & !bright;
        if (xsimd::any(ends)) {
            found(ends, since, a, Real(1.0F));
            lit = lit & !ends;
        }
        const Mask begins = arrived & bright & !lit;
        since = pick(begins, a, since);
        lit = lit | begins;
        const Mask partly = arrived & !bright & !dark;
        if (xsimd::any(partly)) {
            for (int side = 0; side < 2; ++side) {
                const Between lit_part = line.before(node.depth[side], a, b);
                found(partly & (lit_part.low < lit_part.high), lit_part.low, lit_part.high,
                      side == 0 ? 1.0F - node.weight : node.weight);
            }
        }
        tested = tested + pick(on, 1.0F, 0.0F);
        column = pick(arrived, column + count, column);
        const Mask falls = on & !arrived;
        count = pick(falls, count * 0.5F, count);
        per_count = pick(falls, per_count * 2.0F, per_count);
        level = pick(falls, level - 1.0F, level);
        on = on & (column <= line.last);
    }
    const Mask beyond = asked & !lit & (line.to < end);
    since = pick(beyond, line.to, since);
    lit = lit | beyond;
    if (xsimd::any(lit)) {
        found(lit, since, end, Real(1.0F));
    }
    return tested;
}

// Of any map that has a tree, by that.
template <typename Found>
void for_lit_sections(const LightMapView &map, const vec3 &origin, const vec3 &direction, Real start, Real end,
                      Mask asked, const Found &found) {
    if (!map.radial) {
        const LineOnMap line = line_on(map, origin, direction, start, end);
        for_lit_sections(line, start, end, asked, MapHeights(map.tree, line), ALL_COLUMNS, found);
        return;
    }
    const vec3 p = transform_point(map.world_to_light, origin), d = transform_vector(map.world_to_light, direction);
    Real cuts[5] = {start, start, start, start, end};
    for (int axis = 0; axis < 3; ++axis) {
        const Real along = pick(abs(d[axis]) < 1e-20F, 1e-20F, d[axis]);
        cuts[axis + 1] = clamp(-p[axis] / along, start, max(start, end));
    }
    const auto sort = [&cuts](int a, int b) {
        const Real low = min(cuts[a], cuts[b]);
        cuts[b] = max(cuts[a], cuts[b]);
        cuts[a] = low;
    };
    sort(1, 2);
    sort(2, 3);
    sort(1, 2);
    for (int part = 0; part < 4; ++part) {
        const Mask within = asked & (cuts[part] < cuts[part + 1]);
        if (xsimd::any(within)) {
            const ArcOnMap arc = arc_on(map, p, d, cuts[part], cuts[part + 1]);
            for_lit_sections(arc, cuts[part], cuts[part + 1], within, MapHeights(map.tree, arc), ALL_COLUMNS, found);
        }
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
