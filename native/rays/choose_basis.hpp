// SPDX-License-Identifier: GPL-3.0-or-later
// Which representation a scene's light rays call for, measured on a sample of them.
#pragma once

#include "rays/basis.hpp"

namespace sfumato {

struct Choice {
    bool curve = false; // a resolved curve (curve.hpp), else the series below
    Series series;
    RangeKind range = RangeKind::WHOLE;
    Evaluator evaluator = Evaluator::MONOTONE;
    float error = 0.0F; // root mean square of T over the sample, at 65 depths of each ray's range, as stored
    std::string reason;

    [[nodiscard]] std::string name() const;
    [[nodiscard]] std::size_t bytes() const; // a texel
};

// One ray to a texel, and the transmittance of as many as there are texels back, each at its share of `depth`.
void store(const Choice &choice, const Absorbers &ray, std::span<std::uint8_t> texel);
void look_up(const Choice &choice, std::span<const std::uint8_t> texels, std::span<const float> depth,
             std::span<float> out);

// What every candidate makes of the sample in at most `bytes` a texel decides; all have the ray's own range, without
// which light swings when smoke moves. `additive`: only series, whose maps add
// and filter. Half of the rays teach the learned bases and the other half judges all candidates alike. Equal samples,
// equal choices.
Choice choose_basis(std::span<const Absorbers> rays, std::size_t bytes, bool additive);

} // namespace sfumato
