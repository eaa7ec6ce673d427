// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/map_kernels.hpp"
#include "maps/splat.hpp"
#include "maps/splat_blocks.hpp"
#include "media/strands.hpp"
#include "rays/bins.hpp"
#include "scene/scene.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <oneapi/tbb/parallel_for.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

constexpr double ROOM = 1.5; // texels around a strand that it may touch

// Where strands lie on a map: SplatStrand has both kinds of place.
class StrandPlane {
public:
    explicit StrandPlane(const LightMap &map)
        : radial_(map.radial), low_(map.low), high_(map.high), size_(map.size),
          to_map_(map.radial ? map.world_to_light
                             : glm::scale(glm::dmat4(1.0), glm::dvec3(map.size, 1.0)) * map.world_to_light) {
        per_metre_ = radial_ ? 1.0 : glm::length(glm::dvec3(glm::transpose(to_map_)[0]));
        texel_ = std::max((high_.x - low_.x) / size_.x, (high_.y - low_.y) / size_.y);
    }

    [[nodiscard]] glm::dvec3 place(const glm::dvec3 &world) const { return {to_map_ * glm::dvec4(world, 1.0)}; }
    [[nodiscard]] double size(double metres) const { return metres * per_metre_; }
    // How many texels lie between two places, at most.
    [[nodiscard]] double texels(const glm::dvec3 &a, const glm::dvec3 &b) const {
        return radial_ ? angle(a, b) / texel_ : glm::distance(glm::dvec2(a), glm::dvec2(b));
    }

    [[nodiscard]] Footprint footprint(const glm::dvec3 &a, const glm::dvec3 &b, double radius) const {
        if (!radial_) {
            const double around = radius + ROOM;
            return box(glm::min(glm::dvec2(a), glm::dvec2(b)) - around,
                       glm::max(glm::dvec2(a), glm::dvec2(b)) + around);
        }
        const double nearest = std::max(std::min(glm::length(a), glm::length(b)), 1e-30), wide = angle(a, b);
        const glm::dvec3 middle = a / std::max(glm::length(a), 1e-30) + b / std::max(glm::length(b), 1e-30);
        const glm::dvec3 towards = middle / std::max(glm::length(middle), 1e-30);
        const double cap = 0.5 * wide + radius / nearest + ROOM * texel_;
        // Near a seam of the octahedron, anywhere.
        if (cap > 0.7 || (towards.z < cap && (std::abs(towards.x) < cap || std::abs(towards.y) < cap))) {
            return box(glm::dvec2(0.0), size_);
        }
        const auto on_map = [&](const glm::dvec3 &p) {
            const LightsText::Octahedral at = LightsText().octahedral(glm::vec3(p));
            return (glm::dvec2(at.x, at.y) - glm::dvec2(low_)) / glm::dvec2(high_ - low_) * size_;
        };
        const glm::dvec2 from = on_map(a), to = on_map(b);
        // Between two faces of it a line bends.
        const double around = (radius / nearest + 0.25 * wide) / texel_ + ROOM;
        return box(glm::min(from, to) - around, glm::max(from, to) + around);
    }

private:
    static Footprint box(const glm::dvec2 &low, const glm::dvec2 &high) {
        return {static_cast<float>(low.x), static_cast<float>(high.x), static_cast<float>(low.y),
                static_cast<float>(high.y)};
    }
    static double angle(const glm::dvec3 &a, const glm::dvec3 &b) {
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    }

    bool radial_;
    glm::dvec3 low_, high_;
    glm::dvec2 size_;
    glm::dmat4 to_map_;
    double per_metre_, texel_;
};

// The straight pieces of a run of strands, none of them much longer than a few texels where it bends.
struct Run {
    std::vector<SplatStrand> strands;
    std::vector<Footprint> footprints;

    void add(const StrandShape &shape, std::size_t strand, const StrandPlane &plane, std::vector<StrandPoint> &points) {
        constexpr double LONG = 4.0;
        double longest = 0.0;
        for (std::size_t i = shape.first[strand]; i + 1 < shape.first[strand + 1]; ++i) {
            const glm::dvec3 a = plane.place(glm::dvec3(shape.points[i])),
                             b = plane.place(glm::dvec3(shape.points[i + 1]));
            longest = std::max(longest, plane.texels(a, b));
        }
        const int pieces = shape.smooth ? static_cast<int>(std::clamp(std::ceil(longest / LONG), 1.0, 8.0)) : 1;
        strand_points(shape, strand, pieces, points);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const glm::dvec3 a = plane.place(points[i].place), b = plane.place(points[i + 1].place);
            const double from = plane.size(points[i].radius), to = plane.size(points[i + 1].radius);
            SplatStrand &piece = strands.emplace_back();
            for (int axis = 0; axis < 3; ++axis) {
                piece.from[axis] = static_cast<float>(a[axis]);
                piece.to[axis] = static_cast<float>(b[axis]);
            }
            piece.from_radius = static_cast<float>(from);
            piece.to_radius = static_cast<float>(to);
            footprints.push_back(plane.footprint(a, b, std::max(from, to)));
        }
    }
};

LightMap splatted_strands(LightMap map, const StrandShape &shape, const InstructionSet &with) {
    constexpr std::size_t RUN = 512;
    map.sharp = true; // one ray meets a strand, the next none
    const StrandPlane plane(map);
    const std::size_t count = shape.first.size() - 1;
    std::vector<Run> runs((count + RUN - 1) / RUN);
    oneapi::tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
        std::vector<StrandPoint> points;
        for (std::size_t strand = i * RUN; strand < std::min((i + 1) * RUN, count); ++strand) {
            if (shape.first[strand + 1] - shape.first[strand] > 1) {
                runs[i].add(shape, strand, plane, points);
            }
        }
    });
    Run all;
    for (Run &run : runs) {
        all.strands.insert(all.strands.end(), run.strands.begin(), run.strands.end());
        all.footprints.insert(all.footprints.end(), run.footprints.begin(), run.footprints.end());
        run = {};
    }
    const Bins bins(all.footprints, {}, map.size.x, map.size.y);
    Splat<SplatStrand> splat;
    splat.map = map.view();
    splat.bins = bins.view();
    splat.primitives = all.strands.data();
    const MapKernels &kernels = map_kernels(with);
    return splatted(std::move(map), splat, kernels.splat_strands, kernels.meet_strands, with);
}

// The width of most of a shape's strands, metres: of the mean over their length.
double width_of(const StrandShape &shape) {
    double area = 0.0, length = 0.0;
    for (std::size_t strand = 0; strand + 1 < shape.first.size(); ++strand) {
        for (std::size_t i = shape.first[strand]; i + 1 < shape.first[strand + 1]; ++i) {
            const double way = glm::distance(glm::dvec3(shape.points[i]), glm::dvec3(shape.points[i + 1]));
            area += way * (double{shape.radius[i]} + double{shape.radius[i + 1]});
            length += way;
        }
    }
    return length > 0.0 ? area / length : 0.0;
}

} // namespace

Body body_of(const Strands &strands) {
    constexpr double STRANDS_WIDE = 4.0, LEAST_SHARE = 1.0 / 256.0; // of a cell
    const StrandShape &shape = *strands.shape;
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (std::size_t i = 0; i < shape.points.size(); ++i) {
        // A smooth curve may leave the box of its keys by an eighth of their distance.
        const double around =
            double{shape.radius[i]} + 1e-6 * (1.0 + glm::length(glm::dvec3(shape.points[i]))) + // a box is never flat
            (i > 0 && shape.smooth ? 0.25 * glm::distance(glm::dvec3(shape.points[i]), glm::dvec3(shape.points[i - 1]))
                                   : 0.0);
        low = glm::min(low, glm::dvec3(shape.points[i]) - around);
        high = glm::max(high, glm::dvec3(shape.points[i]) + around);
    }
    const double size = glm::length(high - low);
    Body body;
    body.cell_size = std::max({STRANDS_WIDE * width_of(shape), LEAST_SHARE * size, 1e-9});
    body.cells = (high - low) / body.cell_size;
    body.cells_to_world = glm::scale(glm::translate(glm::dmat4(1.0), low), glm::dvec3(body.cell_size));
    body.extinction = glm::vec3(1.0F);
    body.visibility = strands.visibility;
    body.scatters = false;
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    XXH3_128bits_update(&state, shape.points.data(), shape.points.size() * sizeof(glm::vec3));
    XXH3_128bits_update(&state, shape.radius.data(), shape.radius.size() * sizeof(float));
    XXH3_128bits_update(&state, shape.first.data(), shape.first.size() * sizeof(std::uint32_t));
    const XXH128_hash_t hash = XXH3_128bits_digest(&state);
    body.identify = [hash, smooth = shape.smooth](Key &key) {
        key.number(static_cast<std::uint64_t>(hash.low64), static_cast<std::uint64_t>(hash.high64), smooth);
    };
    body.project = [shared = strands.shape](LightMap plan, const InstructionSet &with) {
        return splatted_strands(std::move(plan), *shared, with);
    };
    return body;
}

} // namespace sfumato
