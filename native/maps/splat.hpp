// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps of particles and of strands, by splatting.
#pragma once

#include "maps/body.hpp"
#include "media/particles.hpp"

#include <cstddef>
#include <memory>

namespace sfumato {

struct Strands; // scene/scene.hpp

// One of the bodies of puffs. Its columns are optical depths in the strongest colour.
Body body_of(const std::shared_ptr<const Puffs> &puffs, std::size_t number);

// Some strands of two points or more, as optical depths.
Body body_of(const Strands &strands);

} // namespace sfumato
