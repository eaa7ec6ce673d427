// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals over area lights, as many lights at a time as there are lanes.
#include "lights/area_light_loops.hpp"
#include "lights/light_kernels.hpp"
#include "text/lanes.hpp"

namespace sfumato::SFUMATO_ISA {

void integrate_lights(const LightBatch<float> &batch) {
    AreaLightLoops<Real, Isa, float>().integrate_batch(batch);
}

void reflect_lights(const MicrofacetBatch<float> &batch); // microfacet_lanes.cpp

extern const LightKernels light_kernels{integrate_lights, reflect_lights};

} // namespace sfumato::SFUMATO_ISA
