// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/ray_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(RayKernels, ray_kernels)

} // namespace sfumato
