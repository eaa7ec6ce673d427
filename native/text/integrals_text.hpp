// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals over area lights: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct IntegralsText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
// Each after what it needs.
// clang-format off
#include "../../shaders/lights/complex.glsl"
#include "../../shaders/lights/polygon.glsl"
#include "../../shaders/lights/poles.glsl"
#include "../../shaders/lights/edge_integrals.glsl"
#include "../../shaders/lights/ellipse.glsl"
#include "../../shaders/lights/outline.glsl"
// clang-format on
#undef float
};

} // namespace sfumato::text
