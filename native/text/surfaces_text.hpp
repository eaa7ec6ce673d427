// SPDX-License-Identifier: GPL-3.0-or-later
// What surfaces reflect diffusely: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct SurfacesText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/surfaces/surface.glsl"
#undef float
};

} // namespace sfumato::text
