// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/camera.hpp"

#include "scene/scene.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sfumato {

constexpr double ENDLESS = 1e7; // metres

Camera camera_from(const glm::dmat4 &view_projection) {
    const double determinant = glm::determinant(view_projection);
    if (!(std::abs(determinant) > 0.0) || !std::isfinite(determinant)) {
        throw std::invalid_argument("view_projection cannot be inverted: its determinant is " +
                                    std::to_string(determinant));
    }
    const glm::dmat4 inverse = glm::inverse(view_projection);
    // In double, and only here: the far plane is thousands of times as far as the near one.
    const auto corner = [&inverse](double x, double y, double z) { return inverse * glm::dvec4(x, y, z, 1.0); };
    const auto plane = [](const std::array<glm::dvec3, 3> &corners) {
        return std::array<glm::vec3, 3>{glm::vec3(corners[0]), glm::vec3(corners[1] - corners[0]),
                                        glm::vec3(corners[2] - corners[0])};
    };
    std::array<glm::dvec3, 3> near, far;
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = i == 1 ? 1.0 : -1.0, y = i == 2 ? 1.0 : -1.0;
        const glm::dvec4 from = corner(x, y, -1.0), to = corner(x, y, 1.0);
        near[i] = glm::dvec3(from) / from.w;
        // Where the far plane is 1e8 times as far as the near one, a matrix in single precision has it at infinity, or,
        // rounded, beyond: then the ray has a direction, and no end.
        const bool endless = to.w * from.w <= 1e-12 * from.w * from.w;
        const glm::dvec3 along = glm::dvec3(to) * (from.w < 0.0 ? -1.0 : 1.0);
        far[i] = endless ? near[i] + along * (ENDLESS / glm::length(glm::dvec3(corner(0.0, 0.0, 1.0))))
                         : glm::dvec3(to) / to.w;
    }
    const Camera camera{plane(near), plane(far)};
    for (const auto &vectors : {camera.near, camera.far}) {
        for (const glm::vec3 &v : vectors) {
            if (!std::isfinite(v.x + v.y + v.z)) {
                throw std::invalid_argument("view_projection has its near plane at infinity");
            }
        }
    }
    return camera;
}

} // namespace sfumato
