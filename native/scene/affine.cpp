// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/affine.hpp"

namespace sfumato {

Affine affine(const glm::dmat4 &m) {
    Affine out;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            out.rows[row][column] = static_cast<float>(m[column][row]);
        }
    }
    return out;
}

} // namespace sfumato
