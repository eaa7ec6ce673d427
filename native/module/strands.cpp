// SPDX-License-Identifier: GPL-3.0-or-later
// Strands of hair: what Python hands over, checked.
#include "module/scene_parts.hpp"

#include <string>
#include <utility>

namespace sfumato {

using namespace arguments;

namespace {

// Eight numbers a row, of a dielectric; or seven.
std::vector<StrandMaterial> strand_materials(const std::optional<Floats> &fibre, const std::optional<Floats> &matt) {
    if (fibre && matt) {
        throw py::value_error("fibre is given beside matt, but strands are of one model");
    }
    if (!fibre && !matt) {
        StrandMaterial brown;
        brown.absorption = {0.66F, 1.09F, 2.15F};
        return {brown};
    }
    const Floats &rows = fibre ? *fibre : *matt;
    const std::string name = fibre ? "fibre" : "matt";
    require_shape(rows, {-1, fibre ? 8 : 7}, name);
    std::vector<StrandMaterial> out;
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
        const float *const row = rows.data(i, 0);
        const auto number = [&](int column, float low, float high) {
            if (!(row[column] >= low && row[column] <= high)) {
                throw py::value_error(name + " holds " + text(row[column]) + " at flat index " +
                                      text(i * rows.shape(1) + column) + ", which must lie between " + text(low) +
                                      " and " + text(high));
            }
            return row[column];
        };
        const auto colour = [&](int column, float high) {
            return glm::vec3(number(column, 0.0F, high), number(column + 1, 0.0F, high),
                             number(column + 2, 0.0F, high));
        };
        StrandMaterial &material = out.emplace_back();
        material.dielectric = fibre.has_value();
        constexpr float SMOOTHEST = 1e-3F;
        if (fibre) {
            material.absorption = colour(0, 1e6F);
            material.longitudinal = number(3, SMOOTHEST, 1.0F);
            material.azimuthal = number(4, SMOOTHEST, 1.0F);
            material.primary = number(5, SMOOTHEST, 1.0F);
            material.tilt = number(6, -1.5707964F, 1.5707964F);
            material.index = number(7, 1.0F, 1000.0F);
        } else {
            material.albedo = colour(0, 1.0F);
            material.highlight = colour(3, 1.0F);
            material.roughness = number(6, SMOOTHEST, 1.0F);
        }
    }
    if (out.empty()) {
        throw py::value_error(name + " has shape " + shape_of(rows) + ", but strands have a material");
    }
    return out;
}

} // namespace

std::size_t add_strands(ConsoleScene &scene, const Floats &points, const Floats &radius, const Doubles &first,
                        const std::optional<Floats> &fibre, const std::optional<Floats> &matt,
                        const std::optional<Doubles> &material, bool smooth,
                        const std::optional<Visibility> &visibility) {
    require_shape(points, {-1, 3}, "points");
    require_range(points, -1e15F, 1e15F, "points");
    require_shape(radius, {points.shape(0)}, "radius");
    require_range(radius, 0.0F, 1e15F, "radius");
    require_shape(first, {-1}, "first");
    auto shape = std::make_shared<StrandShape>();
    shape->first = indices(first, points.shape(0) + 1, "first");
    if (shape->first.empty() || shape->first.front() != 0 ||
        static_cast<py::ssize_t>(shape->first.back()) != points.shape(0)) {
        throw py::value_error("first has shape " + shape_of(first) + ", but must begin with 0 and end with the " +
                              text(points.shape(0)) + " rows of points");
    }
    std::size_t alone = 0;
    for (std::size_t i = 1; i < shape->first.size(); ++i) {
        if (shape->first[i] < shape->first[i - 1]) {
            throw py::value_error("first holds " + text(shape->first[i]) + " at flat index " + text(i) +
                                  ", which is less than the one before");
        }
        alone += shape->first[i] - shape->first[i - 1] < 2 ? 1 : 0;
    }
    Strands strands;
    strands.materials = strand_materials(fibre, matt);
    if (material) {
        require_shape(*material, {first.shape(0) - 1}, "material");
        strands.material = indices(*material, static_cast<py::ssize_t>(strands.materials.size()), "material");
    }
    strands.visibility = visibility.value_or(Visibility{});
    if (strands.visibility.seen != Seen::SHOWN && strands.visibility.seen != Seen::UNSEEN) {
        throw py::value_error(
            "visibility.seen must be 'shown' or 'unseen': strands are no holdout, and catch no shadow");
    }
    shape->smooth = smooth;
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        shape->points.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
    }
    shape->radius.assign(radius.data(), radius.data() + radius.size());
    strands.shape = std::move(shape);
    scene.strands.push_back(std::move(strands));
    return alone;
}

} // namespace sfumato
