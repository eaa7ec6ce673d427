// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions for tests, and the judge's view of them.
#pragma once

#include "media/transfer.hpp"
#include "reference/preintegration.hpp"

#include <cmath>
#include <random>

namespace sfumato::testing {

inline Ramp ramp_of(std::vector<double> stops, std::vector<double> extinction, bool linear = true,
                    bool associated = false) {
    Ramp ramp{std::move(stops), std::move(extinction), {}, linear, associated};
    for (const double s : ramp.stops) {
        ramp.colour.emplace_back(1.0 + 0.5 * std::sin(9.0 * s), 0.5 + 0.5 * std::cos(5.0 * s), s);
    }
    return ramp;
}

// Extinction is at most 1.
inline Ramp smooth_ramp(bool associated = false) {
    std::vector<double> stops, extinction;
    for (int i = 0; i <= 8; ++i) {
        stops.push_back(i / 8.0);
        extinction.push_back(i * i / 64.0);
    }
    return ramp_of(stops, extinction, true, associated);
}

inline Ramp peaks(bool associated = false) {
    return ramp_of({0.0, 0.17, 0.2, 0.23, 0.37, 0.4, 0.43, 0.57, 0.6, 0.63, 0.77, 0.8, 0.83, 1.0},
                   {0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0}, true, associated);
}

inline Ramp steps() {
    return ramp_of({0.1, 0.42, 0.66}, {0.0, 1.0, 0.17}, false);
}

// Emission where there is no extinction, and edges narrower than any table resolves.
inline Ramp edges() {
    return ramp_of({0.0, 0.3, 0.30001, 0.7, 0.70001, 1.0}, {0.0, 0.0, 1.0, 1.0, 0.2, 0.9}, true, true);
}

// Stops as close as numbers are.
inline Ramp cliffs() {
    return ramp_of({0.0, 0.3, std::nextafter(0.3, 1.0), 0.7, 0.7 + 1e-12, 1.0}, {0.0, 0.0, 1.0, 1.0, 0.0, 0.5});
}

inline Ramp times(Ramp ramp, double factor) {
    for (std::size_t i = 0; i < ramp.stops.size(); ++i) {
        ramp.extinction[i] *= factor;
        ramp.colour[i] *= ramp.associated ? factor : 1.0;
    }
    return ramp;
}

inline reference::Ramp judged(const Ramp &ramp) {
    return {ramp.stops, ramp.extinction, ramp.colour, ramp.linear, ramp.associated};
}

} // namespace sfumato::testing
