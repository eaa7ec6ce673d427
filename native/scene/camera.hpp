// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat4x4.hpp>

namespace sfumato {

struct Camera;

// The rays of a projection from world space to OpenGL's clip space, in which depth runs from -1 to 1.
// Throws std::invalid_argument if the matrix cannot be inverted or a ray has no end.
Camera camera_from(const glm::dmat4 &view_projection);

} // namespace sfumato
