// SPDX-License-Identifier: GPL-3.0-or-later
// Camera rays, and where they are inside a box: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct CameraText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/camera.glsl"
#undef float
};

} // namespace sfumato::text
