// SPDX-License-Identifier: GPL-3.0-or-later
// Light leaving strands of hair: see text.hpp.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct StrandsText {
#include "text/vocabulary.inc"
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "../../shaders/media/strand.glsl"
#undef float
};

} // namespace sfumato::text
