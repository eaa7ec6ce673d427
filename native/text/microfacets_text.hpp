// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by microfacets: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct MicrofacetsText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
// Each after what it needs.
// clang-format off
#include "../../shaders/lights/complex.glsl"
#include "../../shaders/lights/polygon.glsl"
#include "../../shaders/lights/poles.glsl"
#include "../../shaders/surfaces/half_vector.glsl"
#include "../../shaders/surfaces/microfacet.glsl"
#include "../../shaders/surfaces/microfacet_lights.glsl"
// clang-format on
#undef float
};

} // namespace sfumato::text
