// SPDX-License-Identifier: GPL-3.0-or-later
// A picture at a glance, for a camera that moves: few pixels are traced, and the rest lies between them.
#pragma once

#include "frame/stages.hpp"

#include <vector>

namespace sfumato {

// Every `spacing`-th pixel is traced once, through its centre and the middles of the lights, and where these bend the
// pixels between them, down to all pixels at edges (Whitted, "An improved illumination model for shaded display",
// 1980). The rest is interpolated. What is traced at an edge is filtered with its neighbours, nearly as F12's samples
// are.
//
// The PICTURE is premultiplied RGBA; an overlay two such images, one behind the other: the smoke's radiance and 0; the
// share it leaves of what lies behind, shadows included, and whether that is a surface. One layer is RGB and the
// distance to the first surface. Row 0 at the bottom.
std::vector<float> glance(const Tracer &tracer, int width, int height, int spacing);

} // namespace sfumato
