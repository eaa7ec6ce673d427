// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by microfacets, as many lights at a time as there are lanes.
#include "lights/microfacet_loops.hpp"
#include "text/lanes.hpp"

namespace sfumato::SFUMATO_ISA {

void reflect_lights(const MicrofacetBatch<float> &batch) {
    MicrofacetLoops<Real, Isa, float>().reflect_batch(batch);
}

} // namespace sfumato::SFUMATO_ISA
