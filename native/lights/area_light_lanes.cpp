// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals over area lights, as many lights at a time as there are lanes.
#include "lights/light_kernels.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {

void reflect_lights(const MicrofacetBatch<float> &batch); // microfacet_lanes.cpp

namespace {

inline Real load(const float *lanes) {
    return Real::load_aligned(lanes);
}
inline void store(Real x, float *lanes) {
    x.store_aligned(lanes);
}
inline bool any(Mask mask) {
    return xsimd::any(mask);
}

using Scalar = float;
#include "lights/area_light_loops.inc"

} // namespace

void integrate_lights(const LightBatch<float> &batch) {
    integrate_batch(batch);
}

extern const LightKernels light_kernels{integrate_lights, reflect_lights};

} // namespace sfumato::SFUMATO_ISA
