// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "textures/image.hpp"

#include <string>

namespace sfumato {

// By Python's names. Raises ValueError for others.
Interpolation interpolation_named(const std::string &given);
Extension extension_named(const std::string &given);

} // namespace sfumato
