// SPDX-License-Identifier: GPL-3.0-or-later
// Scattering in smoke: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct MediaText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
// Each after what it needs.
// clang-format off
#include "../../shaders/media/phase.glsl"
#include "../../shaders/media/medium.glsl"
#include "../../shaders/media/puff.glsl"
// clang-format on
#undef float
};

} // namespace sfumato::text
