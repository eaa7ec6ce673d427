// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke whose extinction and emission are functions of one number: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct PreintegrationText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/media/preintegration.glsl"
#undef float
};

} // namespace sfumato::text
