// SPDX-License-Identifier: GPL-3.0-or-later
// Fourier opacity along single rays: batches for the console and for tests, from the shared text.
#pragma once

#include <span>

namespace sfumato {

// Adds slabs of optical depth `tau`, centred on `depth` in [0, 1] and `width` wide (0: a flat particle), to the
// coefficients (a0, a1, b1, ...): eqs 1-2 and 5-6 of Jansen and Bavoil (2010).
void add_to_series(std::span<const float> depth, std::span<const float> tau, float width,
                   std::span<float> coefficients);

// The transmittance at each of `depth`: eq 3, with the optical depth clamped to [0, total].
void series_transmittance(std::span<const float> coefficients, std::span<const float> depth, std::span<float> out);

// Henyey and Greenstein's phase function at each cosine.
void henyey_greenstein(std::span<const float> cos_theta, float anisotropy, std::span<float> out);

} // namespace sfumato
