// SPDX-License-Identifier: GPL-3.0-or-later
// Transparent fragments of a pixel: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct OitText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
// Each after what it needs.
// clang-format off
#include "../../shaders/rays/opacity.glsl"
#include "../../shaders/rays/basis.glsl"
#include "../../shaders/frame/oit.glsl"
// clang-format on
#undef float
};

} // namespace sfumato::text
