// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by microfacets, as many lights at a time as there are lanes.
#include "lights/microfacet.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {
namespace {

inline Real load(const float *lanes) {
    return Real::load_aligned(lanes);
}
inline void store(Real x, float *lanes) {
    x.store_aligned(lanes);
}

#include "lights/microfacet_loops.inc"

} // namespace

void reflect_lights(const MicrofacetBatch<float> &batch) {
    reflect_batch(batch);
}

} // namespace sfumato::SFUMATO_ISA
