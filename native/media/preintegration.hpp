// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of what a step of a ray sends to the eye where a transfer function is read at both its ends.
#pragma once

#include "media/transfer.hpp"

#include <cstdint>

namespace sfumato {

// What of a step's own smoke stands before the rest of it.
enum class SelfAttenuation : std::uint8_t {
    FULL,        // all that lies before it
    MEAN_SOURCE, // as if extinction and emission were mixed: right where their quotient is constant
    NONE,        // nothing
};

// What to make of a step without a table, from its means over all values between its ends, times its length.
Sent from_means(const Emitted &over, SelfAttenuation how);

class PreintegratedTable {
public:
    // Of `entries` values, `low` to `high`, in front and behind, for each of `steps`, the lengths.
    PreintegratedTable(const Ramp &ramp, double low, double high, std::size_t entries, std::vector<double> steps,
                       SelfAttenuation how);

    // As if built from this ramp, to the last bit. Tells how many entries it went through.
    std::size_t rebuild(const Ramp &ramp);

    // (steps, front, back, 4): radiance and opacity.
    [[nodiscard]] const std::vector<float> &values() const { return table; }
    [[nodiscard]] std::size_t entries() const { return count; }
    [[nodiscard]] const std::vector<double> &steps() const { return lengths; }
    // Bilinear; values off the table are those at its edge.
    [[nodiscard]] Sent look_up(double front, double back, std::size_t step) const;

private:
    [[nodiscard]] double value(std::size_t i) const;
    // All of which tell how many entries they made.
    std::size_t build(std::size_t first, std::size_t last); // the slabs that changed, `last` not among them
    std::size_t compose(float *entries, double length, std::size_t first, std::size_t last) const;
    std::size_t from_integrals(float *entries, double length) const;

    TransferFunction transfer;
    double low, high;
    std::size_t count;
    std::vector<double> lengths;
    SelfAttenuation how;
    std::vector<float> table;
};

} // namespace sfumato
