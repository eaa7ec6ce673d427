// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/trace.hpp"

namespace sfumato {

SFUMATO_DISPATCH(FrameKernels, frame_kernels)

} // namespace sfumato
