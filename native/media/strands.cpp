// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/strands.hpp"

#include "scene/places_in_picture.hpp"
#include "scene/scene.hpp"
#include "text/strands_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using StrandsText = text::StrandsText<float>;

struct Vertex {
    StrandPoint point;
    PlacesInPicture::Place place;
};

void copy(const glm::dvec2 &v, float (&to)[2]) {
    to[0] = static_cast<float>(v.x);
    to[1] = static_cast<float>(v.y);
}

void copy(const glm::dvec3 &v, float (&to)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = static_cast<float>(v[axis]);
    }
}

// One strand after another of a run of them.
class Cutter {
public:
    Cutter(const PlacesInPicture &picture, std::vector<StrandSegment> &out) : picture_(picture), out_(out) {}

    void cut(const StrandShape &shape, std::size_t strand, std::int32_t material) {
        straight_ = !shape.smooth;
        strand_points(shape, strand, pieces_for(shape, strand), points_);
        vertices_.clear();
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (i > 0) {
                cross_near_plane(points_[i - 1], points_[i], material);
            }
            if (picture_.along(points_[i].place) > 0.0) {
                add(points_[i], i + 1 == points_.size());
            }
        }
        finish(material);
    }

private:
    static constexpr double SHORTEST = 0.75; // pixels: what is shorter becomes part of its neighbour

    // So many that none of them is much longer than a few pixels.
    [[nodiscard]] int pieces_for(const StrandShape &shape, std::size_t strand) const {
        if (!shape.smooth) {
            return 1;
        }
        double longest = 0.0;
        for (std::size_t i = shape.first[strand]; i + 1 < shape.first[strand + 1]; ++i) {
            const glm::dvec3 a(shape.points[i]), b(shape.points[i + 1]);
            if (picture_.along(a) > 0.0 && picture_.along(b) > 0.0) {
                longest = std::max(longest, glm::distance(picture_.place(a).pixel, picture_.place(b).pixel));
            }
        }
        return static_cast<int>(std::clamp(std::ceil(longest / 4.0), 1.0, 8.0));
    }

    // What lies behind the near plane is left out.
    void cross_near_plane(const StrandPoint &a, const StrandPoint &b, std::int32_t material) {
        const double from = picture_.along(a.place), to = picture_.along(b.place);
        if ((from > 0.0) == (to > 0.0)) {
            return;
        }
        // As far before the plane as rounding asks.
        const double share = std::clamp((1e-9 - from) / (to - from), 0.0, 1.0);
        const StrandPoint between{glm::mix(a.place, b.place, share), glm::mix(a.tangent, b.tangent, share),
                                  glm::mix(a.radius, b.radius, share)};
        add(between, true);
        if (to <= 0.0) {
            finish(material);
        }
    }

    void add(const StrandPoint &point, bool last) {
        const Vertex vertex{point, picture_.place(point.place)};
        if (!vertices_.empty() && glm::distance(vertices_.back().place.pixel, vertex.place.pixel) < SHORTEST) {
            if (!last) {
                return;
            }
            if (vertices_.size() > 1) {
                vertices_.pop_back();
            }
        }
        vertices_.push_back(vertex);
    }

    void finish(std::int32_t material) {
        const std::size_t first = out_.size();
        for (std::size_t i = 0; i + 1 < vertices_.size(); ++i) {
            const Vertex &a = vertices_[i], &b = vertices_[i + 1];
            const glm::dvec2 way = b.place.pixel - a.place.pixel;
            const double length = glm::length(way);
            // Seen along itself a strand is a dot: it keeps a direction.
            const glm::dvec2 direction = length > 1e-9 ? way / length : glm::dvec2(1.0, 0.0);
            const glm::dvec2 across(-direction.y, direction.x);
            StrandSegment &segment = out_.emplace_back();
            copy(a.place.pixel, segment.from);
            copy(b.place.pixel, segment.to);
            segment.from_depth = static_cast<float>(a.place.depth);
            segment.to_depth = static_cast<float>(b.place.depth);
            segment.from_distance = static_cast<float>(a.place.distance);
            segment.to_distance = static_cast<float>(b.place.distance);
            segment.from_radius = static_cast<float>(picture_.pixels(a.point.radius, across, a.place.depth));
            segment.to_radius = static_cast<float>(picture_.pixels(b.point.radius, across, b.place.depth));
            const glm::dvec3 chord = b.point.place - a.point.place;
            const bool own = straight_ && glm::length(chord) > 0.0; // corners stay sharp
            copy(own ? glm::normalize(chord) : a.point.tangent, segment.from_tangent);
            copy(own ? glm::normalize(chord) : b.point.tangent, segment.to_tangent);
            copy(glm::dvec2(0.0), segment.from_joint);
            copy(glm::dvec2(0.0), segment.to_joint);
            segment.width[0] = static_cast<float>(2.0 * a.point.radius);
            segment.width[1] = static_cast<float>(2.0 * b.point.radius);
            segment.material = material;
            if (out_.size() > first + 1) {
                join(out_[out_.size() - 2], segment);
            }
        }
        vertices_.clear();
    }

    static void join(StrandSegment &before, StrandSegment &after) {
        const auto direction = [](const StrandSegment &s) {
            const glm::dvec2 way(s.to[0] - s.from[0], s.to[1] - s.from[1]);
            return way / std::max(glm::length(way), 1e-9);
        };
        const glm::dvec2 sum = direction(before) + direction(after);
        // A strand that turns back lies on itself.
        const glm::dvec2 normal = glm::length(sum) > 1e-3 ? glm::normalize(sum) : direction(after);
        copy(normal, before.to_joint);
        copy(normal, after.from_joint);
    }

    const PlacesInPicture &picture_;
    std::vector<StrandSegment> &out_;
    std::vector<StrandPoint> points_;
    std::vector<Vertex> vertices_;
    bool straight_ = false;
};

StrandRow row_of(const StrandMaterial &material, LightSets lit_by, std::size_t body) {
    StrandsText text;
    StrandRow row{};
    row.dielectric = material.dielectric;
    for (int c = 0; c < 3; ++c) {
        row.absorption[c] = material.absorption[c];
        row.albedo[c] = material.albedo[c];
        row.highlight[c] = material.highlight[c];
    }
    row.variance = text.fibre_variance(material.longitudinal);
    row.primary = text.fibre_variance(material.primary);
    row.scale = text.fibre_scale(material.azimuthal);
    row.tilt = std::sin(material.tilt);
    row.index = material.index;
    row.highlight_variance = text.fibre_variance(material.roughness);
    row.lit_by = lit_by;
    row.body = static_cast<std::int32_t>(body);
    return row;
}

Footprint footprint_of(const StrandSegment &s, float reach) {
    const float around = std::max(s.from_radius, s.to_radius) + reach;
    return {std::min(s.from[0], s.to[0]) - around, std::max(s.from[0], s.to[0]) + around,
            std::min(s.from[1], s.to[1]) - around, std::max(s.from[1], s.to[1]) + around};
}

} // namespace

void strand_points(const StrandShape &shape, std::size_t strand, int pieces, std::vector<StrandPoint> &out) {
    out.clear();
    const auto begin = static_cast<std::ptrdiff_t>(shape.first[strand]),
               end = static_cast<std::ptrdiff_t>(shape.first[strand + 1]);
    // Beyond its ends a curve goes on as if each end were there twice.
    const auto key = [&](std::ptrdiff_t i) {
        return glm::dvec3(shape.points[static_cast<std::size_t>(std::clamp(i, begin, end - 1))]);
    };
    for (std::ptrdiff_t i = begin; i < end; ++i) {
        const bool last = i + 1 == end;
        for (int piece = 0; piece < (last ? 1 : pieces); ++piece) {
            const double t = static_cast<double>(piece) / pieces, t2 = t * t, t3 = t2 * t;
            const glm::dvec3 before = key(i - 1), a = key(i), b = key(i + 1), after = key(i + 2);
            StrandPoint &point = out.emplace_back();
            // At the last key this is that of the piece before.
            const glm::dvec3 out_of = 0.5 * (b - before), into = 0.5 * (after - a);
            point.place = a * (2.0 * t3 - 3.0 * t2 + 1.0) + out_of * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) +
                          into * (t3 - t2);
            point.tangent = a * (6.0 * t2 - 6.0 * t) + out_of * (3.0 * t2 - 4.0 * t + 1.0) + b * (6.0 * t - 6.0 * t2) +
                            into * (3.0 * t2 - 2.0 * t);
            const auto here = static_cast<std::size_t>(i), next = last ? here : here + 1;
            point.radius = glm::mix(double{shape.radius[here]}, double{shape.radius[next]}, t);
        }
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        // Where keys lie on each other, the way to the neighbours.
        if (!(glm::length(out[i].tangent) > 0.0)) {
            out[i].tangent = out[std::min(i + 1, out.size() - 1)].place - out[i > 0 ? i - 1 : 0].place;
        }
        const double length = glm::length(out[i].tangent);
        out[i].tangent = length > 0.0 ? out[i].tangent / length : glm::dvec3(0.0, 0.0, 1.0);
    }
}

StrandsView SeenStrands::view() const {
    if (segments.empty()) {
        return {};
    }
    return {segments.data(), rows.data(), bins.view(), width, height};
}

SeenStrands seen_strands(std::span<const Strands> strands, const Camera &camera, int width, int height, double reach) {
    SeenStrands out;
    out.width = static_cast<float>(width);
    out.height = static_cast<float>(height);
    const PlacesInPicture picture(camera, width, height);
    // Runs of strands, cut one beside the other.
    constexpr std::size_t RUN = 512;
    struct Run {
        const Strands *strands;
        std::size_t first, last;
        std::int32_t row;
        std::vector<StrandSegment> segments;
    };
    std::vector<Run> runs;
    for (std::size_t body = 0; body < strands.size(); ++body) {
        const Strands &each = strands[body];
        if (each.visibility.seen != Seen::SHOWN) {
            continue;
        }
        const auto row = static_cast<std::int32_t>(out.rows.size());
        for (const StrandMaterial &material : each.materials) {
            out.rows.push_back(row_of(material, each.visibility.lit_by, body));
        }
        const std::size_t count = each.shape->first.size() - 1;
        for (std::size_t first = 0; first < count; first += RUN) {
            runs.push_back({&each, first, std::min(first + RUN, count), row, {}});
        }
    }
    oneapi::tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
        Run &run = runs[i];
        const StrandShape &shape = *run.strands->shape;
        Cutter cutter(picture, run.segments);
        for (std::size_t strand = run.first; strand < run.last; ++strand) {
            if (shape.first[strand + 1] - shape.first[strand] > 1) {
                const std::uint32_t material = run.strands->material.empty() ? 0 : run.strands->material[strand];
                cutter.cut(shape, strand, run.row + static_cast<std::int32_t>(material));
            }
        }
    });
    std::size_t count = 0;
    for (const Run &run : runs) {
        count += run.segments.size();
    }
    out.segments.reserve(count);
    for (Run &run : runs) {
        out.segments.insert(out.segments.end(), run.segments.begin(), run.segments.end());
        run.segments = {};
    }
    if (out.segments.empty()) {
        return out;
    }
    std::vector<Footprint> footprints;
    std::vector<float> depths;
    footprints.reserve(count);
    depths.reserve(count);
    for (const StrandSegment &segment : out.segments) {
        footprints.push_back(footprint_of(segment, static_cast<float>(reach)));
        depths.push_back(std::min(segment.from_distance, segment.to_distance));
    }
    out.bins = Bins(footprints, depths, width, height);
    return out;
}

} // namespace sfumato
