// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat4x4.hpp>

namespace sfumato {

// An affine map by its rows, (x, y, z, translation).
struct Affine {
    float rows[3][4];
};

Affine affine(const glm::dmat4 &m);

} // namespace sfumato
