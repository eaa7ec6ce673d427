// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of batches of area lights.
#pragma once

#include "lights/area_light.hpp"
#include "lights/microfacet.hpp"
#include "text/dispatch.hpp"

namespace sfumato {

struct LightKernels {
    void (*integrate_lights)(const LightBatch<float> &);
    void (*reflect_lights)(const MicrofacetBatch<float> &);
};

const LightKernels &light_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
