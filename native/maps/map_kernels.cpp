// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/map_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(MapKernels, map_kernels)

} // namespace sfumato
