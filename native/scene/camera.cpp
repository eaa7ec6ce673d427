// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/camera.hpp"

#include "scene/scene.hpp"

#include <cmath>
#include <stdexcept>

#include <glm/matrix.hpp>

namespace sfumato {

Camera camera_from(const glm::dmat4 &view_projection) {
    const double determinant = glm::determinant(view_projection);
    if (!(std::abs(determinant) > 0.0) || !std::isfinite(determinant)) {
        throw std::invalid_argument("view_projection cannot be inverted: its determinant is " +
                                    std::to_string(determinant));
    }
    const glm::dmat4 inverse = glm::inverse(view_projection);
    // In double, and only here: the far plane is thousands of times as far as the near one.
    const auto corner = [&inverse](double x, double y, double z) {
        const glm::dvec4 p = inverse * glm::dvec4(x, y, z, 1.0);
        return glm::dvec3(p) / p.w;
    };
    const auto plane = [&corner](double z) {
        const glm::dvec3 origin = corner(-1.0, -1.0, z);
        return std::array<glm::vec3, 3>{glm::vec3(origin), glm::vec3(corner(1.0, -1.0, z) - origin),
                                        glm::vec3(corner(-1.0, 1.0, z) - origin)};
    };
    const Camera camera{plane(-1.0), plane(1.0)};
    for (const auto &vectors : {camera.near, camera.far}) {
        for (const glm::vec3 &v : vectors) {
            if (!std::isfinite(v.x + v.y + v.z)) {
                throw std::invalid_argument("view_projection has its near or far plane at infinity");
            }
        }
    }
    return camera;
}

} // namespace sfumato
