// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/microfacet.hpp"

#include "lights/light_kernels.hpp"
#include "lights/microfacet_loops.hpp"

namespace sfumato {
namespace {

template <typename Number>
void mix(std::vector<Number> &out, Number f0) {
    for (std::size_t i = 0; 2 * i < out.size(); ++i) {
        const Number plain = out[2 * i], fresnel = out[2 * i + 1];
        out[i] = f0 * (plain - fresnel) + fresnel;
    }
    out.resize(out.size() / 2);
}

} // namespace

void mix_fresnel(std::vector<float> &out, float f0) {
    mix(out, f0);
}

void mix_fresnel(std::vector<double> &out, double f0) {
    mix(out, f0);
}

void reflect(const MicrofacetBatch<float> &batch) {
    light_kernels().reflect_lights(batch);
}

void reflect(const MicrofacetBatch<double> &batch) {
    MicrofacetLoops<double, text::OneLane, double>().reflect_batch(batch);
}

} // namespace sfumato
