// SPDX-License-Identifier: GPL-3.0-or-later
// Epipolar sampling: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct EpipolarText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/frame/epipolar.glsl"
#undef float
};

} // namespace sfumato::text
