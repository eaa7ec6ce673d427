// SPDX-License-Identifier: GPL-3.0-or-later
#include "textures/image_kernels.hpp"

namespace sfumato {

SFUMATO_DISPATCH(ImageKernels, image_kernels)

} // namespace sfumato
