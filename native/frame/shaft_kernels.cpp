// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/shaft_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(ShaftKernels, shaft_kernels)

} // namespace sfumato
