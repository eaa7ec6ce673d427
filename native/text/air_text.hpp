// SPDX-License-Identifier: GPL-3.0-or-later
// Air and the light in it: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct AirText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/media/air.glsl"
#include "../../shaders/media/phase.glsl"
#undef float
};

} // namespace sfumato::text
