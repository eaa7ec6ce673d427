// SPDX-License-Identifier: GPL-3.0-or-later
// The basis that fits the rays of a scene best: Karhunen and Loeve's, of their cumulative optical depth.
#pragma once

#include "rays/basis.hpp"

namespace sfumato {

// A basis of `count` functions on `cells` depths, from a sample of rays and the range of each. G_0 is the mean shape,
// so that c_0 is the total; the others vanish at both ends. Nothing is taken from chance: equal rays, equal basis.
Series learn_basis(std::span<const Absorbers> rays, std::span<const Range> ranges, std::size_t count,
                   std::size_t cells = 64);

} // namespace sfumato
