// SPDX-License-Identifier: GPL-3.0-or-later
// The march along view rays: see text.hpp. `Asked` has what the text asks of media and lights.
#pragma once

#include "text/text.hpp"

namespace sfumato::text {

template <class Real, class Isa, class Asked>
struct MarchText : Asked {
#include "text/vocabulary.inc"
    using Colour = typename Asked::Colour;
    using Place = typename Asked::Place;
    using Arriving = typename Asked::Arriving;
    using Asked::along_grid;
    using Asked::anisotropy_of;
    using Asked::classified;
    using Asked::clearance_at;
    using Asked::density_at;
    using Asked::emission_row;
    using Asked::emits;
    using Asked::extinction_of;
    using Asked::glow_at;
    using Asked::grid_size;
    using Asked::is_parallel;
    using Asked::last_part;
    using Asked::last_row;
    using Asked::leave_knot;
    using Asked::light_along;
    using Asked::light_at;
    using Asked::light_concentration;
    using Asked::light_count;
    using Asked::light_direction;
    using Asked::light_position;
    using Asked::light_size2;
    using Asked::light_strength;
    using Asked::longest_step;
    using Asked::MEDIA;
    using Asked::media_count;
    using Asked::note_step;
    using Asked::place_at;
    using Asked::ramp_row;
    using Asked::scattering_at;
    using Asked::scattering_of;
    using Asked::splits;
    using Asked::to_grid;
#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#define bool Mask  // NOLINT(clang-diagnostic-keyword-macro): of each lane
// Each after what it needs.
// clang-format off
#include "../../shaders/camera.glsl"
#include "../../shaders/lights/light.glsl"
#include "../../shaders/media/phase.glsl"
#include "../../shaders/media/medium.glsl"
#include "../../shaders/media/march.glsl"
#include "../../shaders/media/preintegration.glsl"
#include "../../shaders/media/ramp.glsl"
#include "../../shaders/media/ramped_march.glsl"
// clang-format on
#undef bool
#undef float
};

} // namespace sfumato::text
