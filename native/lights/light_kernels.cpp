// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(LightKernels, light_kernels)

} // namespace sfumato
