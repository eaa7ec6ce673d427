// SPDX-License-Identifier: GPL-3.0-or-later
// What rays bring home from smoke under a transfer function: ways to step through it, and which of them a ramp needs.
#pragma once

#include "media/preintegration.hpp"

#include <array>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

// The number that a transfer function is one of: x fastest, trilinear between the centres of cells, which lie at
// halves; zero off the grid.
struct DenseCells {
    const float *values = nullptr;
    glm::ivec3 size{0};

    [[nodiscard]] double at(const glm::dvec3 &place) const;
};

// In cells, which are the unit of length.
struct CellRay {
    glm::dvec3 from{0.0}, to{0.0};
};

// In the order of their cost.
enum class Classification : std::uint8_t {
    POST,        // classified in the middle of each step
    MEAN_SOURCE, // exact means between both ends of each step
    FULL,        // a pre-integrated table
    SPLIT,       // each cell's cubic, cut where it meets a stop: no steps
};
constexpr std::size_t STEPPED = 3; // of them take steps

struct Classified {
    Sent sent = CLEAR;
    std::size_t samples = 0; // of the cells that were looked up
};

// `table` is for FULL alone, whose first step is the step. What is left of the ray behind the last whole step is a
// shorter one, for which FULL has a mean source.
Classified classify(const DenseCells &cells, const CellRay &ray, const TransferFunction &transfer, Classification how,
                    double step, const PreintegratedTable *table);

struct ChosenClassification {
    Classification how = Classification::SPLIT;
    std::array<double, STEPPED> errors{}; // of each that steps: root mean square over the rays, by the mean radiance
};

// The cheapest whose error is at most `error` and that is no worse than the best of those that step by more than a
// fiftieth; where there is none, SPLIT, which judges the others. A table has `entries` values between the lowest and
// the highest that the cells hold, and zero.
ChosenClassification choose_classification(const DenseCells &cells, std::span<const CellRay> rays,
                                           const TransferFunction &transfer, double step, double error,
                                           std::size_t entries);

PreintegratedTable table_for(const DenseCells &cells, const Ramp &ramp, double step, std::size_t entries);

} // namespace sfumato
