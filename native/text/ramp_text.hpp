// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions as the kernels read them: see text.hpp. `Asked` has their rows.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa, class Asked>
struct RampText : Asked {
#include "text/vocabulary.inc"
    using Colour = Real;
    using Asked::last_part;
    using Asked::ramp_row;
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#define bool Mask  // NOLINT(clang-diagnostic-keyword-macro): of each lane
// Each after what it needs.
// clang-format off
#include "../../shaders/media/preintegration.glsl"
#include "../../shaders/media/ramp.glsl"
// clang-format on
#undef bool
#undef float
};

} // namespace sfumato::text
