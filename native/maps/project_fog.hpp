// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps of fog.
#pragma once

#include "maps/body.hpp"
#include "media/fog.hpp"

#include <memory>

namespace sfumato {

// Columns are metres inside, in all of its places. The longer side of its box is so many texels long.
Body body_of(const std::shared_ptr<const Fog> &fog, int texels);

} // namespace sfumato
