// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/drawn.hpp"

#include "frame/frame.hpp"
#include "scene/scene.hpp"
#include "solids/all_hits.hpp"
#include "text/camera_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// Calls body(first, last) for parts of [0, count), each in one thread.
template <typename Body>
void in_parts(std::size_t count, const Body &body) {
    constexpr std::size_t PART = 256;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, count, PART), [&](const Range &part) { body(part.begin(), part.size()); });
}

// Which way a camera sees places.
class Eye {
public:
    explicit Eye(const Camera &camera) {
        const glm::dvec3 near(camera.near[0]), across(camera.near[1]), up(camera.near[2]);
        const glm::dvec3 along = glm::dvec3(camera.far[0]) - near;
        forward_ = glm::normalize(glm::cross(across, up));
        forward_ = glm::dot(forward_, along) < 0.0 ? -forward_ : forward_;
        const double width = glm::dot(across, across);
        const double growth = glm::dot(glm::dvec3(camera.far[1]) - across, across) / width;
        perspective_ = growth > 1e-9;
        place_ = perspective_ ? near - along / growth : near;
        // Of a pixel on the near plane.
        near_width_ = std::sqrt(width);
        near_ = glm::dot(near - place_, forward_);
    }

    // Of unit length.
    [[nodiscard]] glm::vec3 towards(const glm::vec3 &point) const {
        const glm::dvec3 way = glm::dvec3(point) - place_;
        const double distance = glm::length(way);
        return glm::vec3(perspective_ && distance > 0.0 ? way / distance : forward_);
    }
    [[nodiscard]] float distance(const glm::vec3 &point) const {
        return static_cast<float>(glm::length(glm::dvec3(point) - place_));
    }
    // The share of the picture's width that a length has at a point; of what is not before the eye, as on the near
    // plane.
    [[nodiscard]] double share(double length, const glm::vec3 &point) const {
        const double depth = std::max(glm::dot(glm::dvec3(point) - place_, forward_), near_);
        return length / near_width_ * (perspective_ ? near_ / depth : 1.0);
    }

private:
    bool perspective_ = false;
    glm::dvec3 place_, forward_;
    double near_ = 0.0, near_width_ = 1.0;
};

// What a segment shows in of a picture, whose samples see as far as `reach` pixels around them.
class Strip {
public:
    Strip(const Camera &camera, int width, int height, float reach)
        : camera_(camera), size_(width, height), reach_(reach) {}

    void add(const StrandSegment &s, Triangles &out) const {
        const glm::vec2 from(s.from[0], s.from[1]), to(s.to[0], s.to[1]), way = to - from;
        const float length = glm::length(way);
        const glm::vec2 along = length > 0.0F ? way / length : glm::vec2(1.0F, 0.0F), across(-along.y, along.x);
        struct Corner {
            glm::vec3 place;
            glm::vec2 strip;
        };
        const auto corner = [&](bool start, float side) {
            const float radius = start ? s.from_radius : s.to_radius, away = side * (radius + reach_);
            const glm::vec2 aside = mitred(across, start ? s.from_joint : s.to_joint) * away;
            return Corner{point((start ? from : to) + aside, start ? s.from_distance : s.to_distance), {away, radius}};
        };
        const std::array<Corner, 4> corners{corner(true, -1.0F), corner(true, 1.0F), corner(false, 1.0F),
                                            corner(false, -1.0F)};
        for (const std::size_t i : {0, 1, 2, 0, 2, 3}) {
            out.corners.push_back(corners[i].place);
            out.strip.push_back(corners[i].strip);
        }
        out.opacity.insert(out.opacity.end(), 2, 1.0F);
    }

private:
    // At a joint, along the line on which its neighbour ends, too; where that is far from across, it would be endless.
    static glm::vec2 mitred(const glm::vec2 &across, const float (&joint)[2]) {
        constexpr float SHARPEST = 0.5F;
        const glm::vec2 line(-joint[1], joint[0]);
        const float cosine = glm::dot(line, across);
        return cosine > SHARPEST ? line / cosine : across;
    }

    [[nodiscard]] glm::vec3 point(const glm::vec2 &pixel, float distance) const {
        const auto &n = camera_.near, &f = camera_.far;
        const glm::vec2 uv = pixel / size_;
        const auto ray = text::CameraText<float>().camera_ray(n[0], n[1], n[2], f[0], f[1], f[2], uv.x, uv.y);
        return ray.origin + ray.direction * distance;
    }

    const Camera &camera_;
    glm::vec2 size_;
    float reach_;
};

// One sheet's triangles, each cut into equal ones that are not larger than LONGEST of the picture's width.
class Cut {
public:
    explicit Cut(const Eye &eye) : eye_(eye) {}

    void add(const Surfaces::Sheet &sheet, std::vector<SheetPoint> &points, Triangles &out) const {
        const Shape &shape = *sheet.shape;
        for (std::uint32_t triangle = 0; triangle < shape.triangles.size(); ++triangle) {
            std::array<glm::vec3, 3> corner;
            double longest = 0.0;
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 &vertex = shape.vertices[shape.triangles[triangle][i]];
                corner[static_cast<std::size_t>(i)] = glm::vec3(sheet.to_world * glm::vec4(vertex, 1.0F));
            }
            for (std::size_t i = 0; i < 3; ++i) {
                longest =
                    std::max(longest, eye_.share(double{glm::distance(corner[i], corner[(i + 1) % 3])}, corner[i]));
            }
            const int pieces = static_cast<int>(std::clamp(std::ceil(longest / LONGEST), 1.0, MOST));
            const auto point = [&](int i, int j) {
                const float u = static_cast<float>(i) / static_cast<float>(pieces);
                const float v = static_cast<float>(j) / static_cast<float>(pieces);
                const glm::vec3 place = corner[0] + (corner[1] - corner[0]) * u + (corner[2] - corner[0]) * v;
                points.push_back({place, eye_.towards(place), eye_.distance(place), sheet.place, triangle, u, v});
                out.corners.push_back(place);
                out.strip.emplace_back(0.0F);
            };
            for (int i = 0; i < pieces; ++i) {
                for (int j = 0; i + j < pieces; ++j) {
                    point(i, j), point(i + 1, j), point(i, j + 1);
                    if (i + j + 1 < pieces) {
                        point(i + 1, j), point(i + 1, j + 1), point(i, j + 1);
                    }
                }
            }
        }
    }

private:
    static constexpr double LONGEST = 1.0 / 24.0, MOST = 24.0;

    const Eye &eye_;
};

// What pieces of sheets hide, three points each: the mean of what these do, of which glass lets the less through the
// more it is seen from aside.
void add_opacities(const FrameView &frame, std::span<const SheetPoint> points, const InstructionSet &with,
                   std::vector<float> &out) {
    std::vector<Hit> hits;
    std::vector<glm::vec3> origins, directions, through;
    for (const SheetPoint &point : points) {
        hits.push_back({static_cast<int>(hits.size()), point.distance, point.place, point.triangle, point.u, point.v});
        origins.push_back(point.point - point.direction * point.distance);
        directions.push_back(point.direction);
    }
    transmittances_of(frame.surfaces, hits, origins, directions, through, with);
    for (std::size_t i = 0; i + 2 < through.size(); i += 3) {
        out.push_back(1.0F - (through[i].x + through[i + 1].x + through[i + 2].x) / 3.0F);
    }
}

} // namespace

bool Frame::drawable() const {
    return content_.media.empty() && content_.air.empty() && content_.grey && content_.surfaces->dims_greyly() &&
           covers();
}

Sprites Frame::sprites(const Camera &camera, bool past_smoke) const {
    Sprites out;
    if (!particles()) {
        return out;
    }
    Views seen = views(camera, 1, 1, Layer::RADIANCE, step_length_);
    show_particles(seen.frame.particles);
    const std::span<const Puff> puffs = std::span(content_.puffs->puffs).first(content_.puffs->seen);
    const Eye eye(camera);
    out.colour.resize(puffs.size());
    out.points.resize(puffs.size());
    prepared_->arena.execute([&] {
        in_parts(puffs.size(), [&](std::size_t first, std::size_t count) {
            std::vector<glm::vec3> directions(count);
            for (std::size_t i = 0; i < count; ++i) {
                out.points[first + i] = puffs[first + i].middle;
                directions[i] = eye.towards(puffs[first + i].middle);
            }
            const std::span<glm::vec3> colours = std::span(out.colour).subspan(first, count);
            frame_kernels(*instruction_set_)
                .drawn.puffs(seen.frame, puffs.subspan(first, count), directions, past_smoke, colours);
            for (std::size_t i = 0; i < count; ++i) {
                colours[i] *= content_.puffs->albedo[first + i];
            }
        });
    });
    for (const Puff &puff : puffs) {
        out.radius.push_back(puff.radius);
        out.opacity.push_back(-std::expm1(-puff.depth));
    }
    return out;
}

Triangles Frame::triangles(const Camera &camera, int width, int height) const {
    const double reach = Filter().diameter() / 2.0; // pixels
    Triangles out;
    Views seen = views(camera, width, height, Layer::RADIANCE, step_length_);
    if (!content_.strands.empty()) {
        see_strands(camera, width, height, reach, seen);
    }
    const std::vector<StrandSegment> &segments = seen.strands.segments;
    const Strip strip(camera, width, height, static_cast<float>(reach));
    for (const StrandSegment &segment : segments) {
        strip.add(segment, out);
    }
    const std::size_t strips = out.opacity.size();
    std::vector<SheetPoint> points;
    const Eye eye(camera);
    const Cut cut(eye);
    for (const Surfaces::Sheet &sheet : content_.surfaces->sheet_places()) {
        cut.add(sheet, points, out);
    }
    add_opacities(seen.frame, points, *instruction_set_, out.opacity);
    std::vector<glm::vec3> light(segments.size());
    out.colour.resize(out.corners.size());
    const std::span<glm::vec3> sheets = std::span(out.colour).subspan(3 * strips);
    const DrawnKernels &kernels = frame_kernels(*instruction_set_).drawn;
    prepared_->arena.execute([&] {
        in_parts(segments.size(), [&](std::size_t first, std::size_t count) {
            kernels.strands(seen.frame, std::span(segments).subspan(first, count),
                            std::span(light).subspan(first, count));
        });
        in_parts(points.size(), [&](std::size_t first, std::size_t count) {
            kernels.sheets(seen.frame, std::span(points).subspan(first, count), sheets.subspan(first, count));
        });
    });
    for (std::size_t corner = 0; corner < 3 * strips; ++corner) {
        out.colour[corner] = light[corner / 6];
    }
    // What a sheet sends is its own already; where it hides nothing, as clear glass that mirrors, it is still drawn.
    constexpr float LEAST = 1e-3F;
    for (std::size_t i = strips; i < out.opacity.size(); ++i) {
        out.opacity[i] = std::max(out.opacity[i], LEAST);
        for (std::size_t corner = 3 * i; corner < 3 * i + 3; ++corner) {
            out.colour[corner] /= out.opacity[i];
        }
    }
    return out;
}

} // namespace sfumato
