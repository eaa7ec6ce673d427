// SPDX-License-Identifier: GPL-3.0-or-later
#include "opacity.hpp"

#include "glsl.hpp"

#include <cstddef>

namespace sfumato {

void add_to_series(std::span<const float> depth, std::span<const float> tau, float width,
                   std::span<float> coefficients) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const glsl::Harmonic first = glsl::harmonic(1.0F, depth[i]);
        glsl::Harmonic h = first;
        coefficients[0] += 2.0F * tau[i];
        for (std::size_t k = 1; 2 * k < coefficients.size(); ++k) {
            const float thickness = glsl::slab_factor(static_cast<float>(k), width);
            coefficients[2 * k - 1] += glsl::project_cosine(tau[i], h, thickness);
            coefficients[2 * k] += glsl::project_sine(tau[i], h, thickness);
            h = glsl::next_harmonic(h, first);
        }
    }
}

void series_transmittance(std::span<const float> coefficients, std::span<const float> depth, std::span<float> out) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float d = depth[i];
        const glsl::Harmonic first = glsl::harmonic(1.0F, d);
        glsl::Harmonic h = first;
        float tau = glsl::integral_constant(coefficients[0], d);
        for (std::size_t k = 1; 2 * k < coefficients.size(); ++k) {
            tau += glsl::integral_harmonic(coefficients[2 * k - 1], coefficients[2 * k], h, static_cast<float>(k));
            h = glsl::next_harmonic(h, first);
        }
        out[i] = glsl::transmittance_of(glsl::clamp_optical_depth(tau, coefficients[0]));
    }
}

void henyey_greenstein(std::span<const float> cos_theta, float anisotropy, std::span<float> out) {
    for (std::size_t i = 0; i < cos_theta.size(); ++i) {
        out[i] = glsl::henyey_greenstein(cos_theta[i], anisotropy);
    }
}

} // namespace sfumato
