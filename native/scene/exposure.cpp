// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/exposure.hpp"

#include <algorithm>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sfumato {

Camera Exposure::at(float time) const {
    const float place = time * static_cast<float>(cameras.size() - 1);
    const std::size_t from = std::min(static_cast<std::size_t>(place), cameras.size() - 1);
    const Camera &a = cameras[from], &b = cameras[std::min(from + 1, cameras.size() - 1)];
    Camera out;
    for (std::size_t i = 0; i < 3; ++i) {
        out.near[i] = glm::mix(a.near[i], b.near[i], place - static_cast<float>(from));
        out.far[i] = glm::mix(a.far[i], b.far[i], place - static_cast<float>(from));
    }
    return out;
}

float Exposure::when(float share) const {
    if (shutter.size() < 2) {
        return share;
    }
    const float place = share * static_cast<float>(shutter.size() - 1);
    const std::size_t from = std::min(static_cast<std::size_t>(place), shutter.size() - 2);
    return glm::mix(shutter[from], shutter[from + 1], place - static_cast<float>(from));
}

// A ray through the lens meets the one through its middle where all is sharp, so it passes every other plane beside
// that by the same in every pixel.
Camera through(const Camera &camera, const Lens &lens, float x, float y) {
    const glm::vec3 right = glm::normalize(camera.near[1]), up = glm::normalize(camera.near[2]);
    const glm::vec3 aside = lens.radius * (x * right + y * up);
    const glm::vec3 axis = glm::normalize(glm::cross(camera.near[1], camera.near[2]));
    const float far = lens.near + std::abs(glm::dot(camera.far[0] - camera.near[0], axis));
    Camera out = camera;
    out.near[0] += aside * (1.0F - lens.near / lens.focus);
    out.far[0] += aside * (1.0F - far / lens.focus);
    return out;
}

} // namespace sfumato
