// SPDX-License-Identifier: GPL-3.0-or-later
// A flat polygon of any number of corners as the triangles and quadrilaterals that lights are made of.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// Convex parts of three or four corners each, in the polygon's turn; nothing where its edges cross or touch.
// By clipping of ears (Meisters, "Polygons have ears", 1975), two ears in a row as one where that is convex.
std::optional<std::vector<std::vector<glm::dvec3>>> convex_parts(std::span<const glm::dvec3> polygon);

} // namespace sfumato
