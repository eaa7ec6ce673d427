// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/preintegration_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(PreintegrationKernels, preintegration_kernels)

} // namespace sfumato
