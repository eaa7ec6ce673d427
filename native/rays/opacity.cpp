// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/opacity.hpp"

#include "rays/basis.hpp"
#include "text/media_text.hpp"

#include <cstddef>

namespace sfumato {
void add_to_series(std::span<const float> depth, std::span<const float> tau, float width,
                   std::span<float> coefficients) {
    project({FOURIER, coefficients.size(), {}}, {depth, tau, width}, {}, coefficients);
}

void series_transmittance(std::span<const float> coefficients, std::span<const float> depth, std::span<float> out) {
    transmittance({FOURIER, coefficients.size(), {}}, coefficients, {}, Evaluator::CLAMP, depth, out);
}

void henyey_greenstein(std::span<const float> cos_theta, float anisotropy, std::span<float> out) {
    for (std::size_t i = 0; i < cos_theta.size(); ++i) {
        out[i] = text::MediaText<float>().henyey_greenstein(cos_theta[i], anisotropy);
    }
}

} // namespace sfumato
