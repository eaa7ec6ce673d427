// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of single light rays (basis.hpp, curve.hpp), and the plain views that they read.
#pragma once

#include "text/dispatch.hpp"

#include <cstddef>
#include <cstdint>

namespace sfumato {

// The sums over absorbers of tau cos(2 pi k f z) for k = 0, 1, ..., harmonics, each but the first followed by that of
// tau sin(2 pi k f z) unless `half`. z is the depth relative to the range, within [0, 1].
struct HarmonicSums {
    const float *depth = nullptr, *tau = nullptr;
    std::size_t absorbers = 0;
    float low = 0.0F, high = 1.0F;
    bool half = false; // f is 1/2 and there are no sines, else 1
    std::size_t harmonics = 0;
    float *sums = nullptr; // added to
};

// out[i] = sum over k of weights[k] * rows[k * width + i]; the width is a multiple of MAX_LANES.
struct WeightedRows {
    const float *rows = nullptr, *weights = nullptr;
    std::size_t count = 0, width = 0;
    float *out = nullptr;
};

// Receiver i at `depth[i]` reads ray i / receivers. out: transmittance, its optical depth kept within [0, total].
struct SeriesLookUp {
    const float *coefficients = nullptr; // of ray r from r * count
    const float *ranges = nullptr;       // low and high of ray r from 2 r
    int count = 1;
    bool half = false; // the cosine basis, else Fourier's
    const float *depth = nullptr;
    float *out = nullptr;
    int receivers = 1, total = 0;
};

// The same from texels of RAY_WORDS * 4 bytes, little end first: 15 cosine coefficients (basis.hpp) or the curve.
constexpr int RAY_WORDS = 5;
struct TexelLookUp {
    const std::int32_t *texels = nullptr;
    bool curve = false;
    const float *depth = nullptr;
    float *out = nullptr;
    int receivers = 1, total = 0;
};

struct RayKernels {
    void (*harmonic_sums)(const HarmonicSums &);
    void (*weigh_rows)(const WeightedRows &);
    void (*look_up_series)(const SeriesLookUp &);
    void (*look_up_texels)(const TexelLookUp &);
};

const RayKernels &ray_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
