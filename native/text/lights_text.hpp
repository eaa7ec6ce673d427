// SPDX-License-Identifier: GPL-3.0-or-later
// How lights fade, and points on them: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct LightsText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/lights/light.glsl"
#undef float
};

} // namespace sfumato::text
