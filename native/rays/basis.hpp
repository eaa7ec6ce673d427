// SPDX-License-Identifier: GPL-3.0-or-later
// Absorption along a light ray as coefficients of a basis: shaders/rays/basis.glsl for batches of rays.
// A new basis is a piece of shared text, a row in the table BASES, and a case wherever the kinds are told apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sfumato {

// Optical depths of absorbers along one ray, at depths in [0, 1], in any order. `width` is the extent in depth of each,
// centred on its depth (0: flat).
struct Absorbers {
    std::span<const float> depth;
    std::span<const float> tau;
    float width = 0.0F;
};

// Before `low` nothing is absorbed, behind `high` everything is.
struct Range {
    float low = 0.0F;
    float high = 1.0F;
};

// F_k and G_k of a learned basis as tables of `coefficients` rows each. F steps, with `cells` values a row; G is a
// polygon from 0, with cells + 1 values a row. Empty for the other bases.
struct Tables {
    std::size_t cells = 0;
    std::vector<float> f, g;
};

// The same for kernels.
struct TablesView {
    int cells = 0;
    const float *g = nullptr;
};

struct Basis {
    const char *name;
    bool odd;     // a constant and pairs
    bool leading; // coefficient 0 alone carries the total; else all of them together
    // F_k(z) for an absorber of unit optical depth, averaged over its width.
    void (*density)(float z, float width, std::span<float> f, const Tables &tables);
    void (*integral)(float d, std::span<float> g, const Tables &tables); // G_k(d)
};

enum BasisName : std::uint8_t { FOURIER, COSINE, PIECEWISE, LEARNED };
extern const std::array<Basis, 4> BASES;

// A basis and its tables: what coefficients need beside them to mean something.
struct Series {
    BasisName name = FOURIER;
    std::size_t count = 7;
    Tables tables;

    [[nodiscard]] const Basis &basis() const { return BASES[name]; }
};

// Adds absorbers to the coefficients of a ray.
void project(const Series &series, const Absorbers &absorbers, const Range &range, std::span<float> coefficients);

enum class Evaluator : std::uint8_t {
    CLAMP,   // the optical depth kept within [0, total]
    MONOTONE // the mean of its running maximum and its running minimum from behind, on a table of 128 cells
};

// The optical depth behind everything.
float total_of(const Series &series, std::span<const float> coefficients);

// The transmittance of rays: within [0, 1], exact before and behind the range.
class RayEvaluator {
public:
    RayEvaluator(const Series &of, Evaluator how);

    // At each of `depth` along one ray.
    void operator()(std::span<const float> coefficients, const Range &range, std::span<const float> depth,
                    std::span<float> out) const;

private:
    void monotone(std::span<const float> coefficients, const Range &range, std::span<const float> depth,
                  std::span<float> out) const;

    Series series;
    Evaluator evaluator;
    std::vector<float> edges; // MONOTONE: G_k at the edges of the table's cells, a row for each k
};

// One ray alone.
void transmittance(const Series &series, std::span<const float> coefficients, const Range &range, Evaluator evaluator,
                   std::span<const float> depth, std::span<float> out);

// The transmittance in front of each receiver that is itself among the absorbers of the ray, without its own share.
void transmittance_before(const Series &series, std::span<const float> coefficients, const Range &range,
                          const Absorbers &receivers, std::span<float> out);

// ---- Ranges ----

enum class RangeKind : std::uint8_t { WHOLE, MINMAX, MOMENTS, BOTH, TRIMMED };

// The range that holds a ray's absorbers: padded_range(), moment_range() with q, what the two have in common, or
// padded_range() of the ray without its thin ends (trimmed_before(), trimmed_behind());
// rounded outwards to what a texel can hold: the range of the projection must be that of the evaluation.
Range depth_range(const Absorbers &absorbers, RangeKind kind, float q);

// ---- Storage ----
// A texel of the series: low and high in 16 bits each, the total as a half float, then each coefficient in 8 bits; the
// first coefficient is left out where the total tells it.

std::size_t texel_bytes(const Series &series);
// How many coefficients of a basis fit into `bytes`, range and total included.
std::size_t coefficients_in(BasisName name, std::size_t bytes);
void pack(const Series &series, std::span<const float> coefficients, const Range &range, std::span<std::uint8_t> texel);
Range unpack(const Series &series, std::span<const std::uint8_t> texel, std::span<float> coefficients);

Range storable(const Range &range);

// The first six bytes, which a curve (curve.hpp) has too.
struct TexelHead {
    Range range;
    float total = 0.0F;
};
constexpr std::size_t HEAD_BYTES = 6;
TexelHead write_head(const Range &range, float total, std::span<std::uint8_t> texel);
TexelHead read_head(std::span<const std::uint8_t> texel);

} // namespace sfumato
