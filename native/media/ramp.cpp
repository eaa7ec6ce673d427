// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/ramp.hpp"

#include "media/grid.hpp"
#include "media/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sfumato {
namespace {

// Beyond all stops.
constexpr float FAR = 1e30F;

// A function between two of the stops of both, of which its own are some, as first + gain t + bow t (1 - t).
struct Course {
    Emitted first{0.0}, gain{0.0}, bow{0.0};
};

Course course_of(const TransferFunction *function, double from, double to) {
    Course out;
    if (function == nullptr) {
        return out;
    }
    const std::size_t part = function->part_of(from);
    out.first = function->at(part, from);
    const Emitted last = function->at(part, to);
    out.gain = last - out.first;
    out.bow = 4.0 * function->at(part, 0.5 * (from + to)) - 2.0 * (out.first + last);
    return out;
}

void append(std::vector<float> &rows, const glm::dvec3 &row) {
    for (int c = 0; c < 3; ++c) {
        rows.push_back(static_cast<float>(row[c]));
    }
}

// The mean change from cell to cell, of bricks that hold anything, over the narrowest width: from 1 to 3.
double fineness_of(std::span<const glm::vec2> ranges, double narrowest) {
    double change = 0.0, bricks = 0.0;
    for (const glm::vec2 &range : ranges) {
        if (range.y > 0.0F) {
            change += double{range.y - range.x} / (BRICK + 1);
            bricks += 1.0;
        }
    }
    return std::clamp(std::ceil(change / std::max(bricks * narrowest, 1e-30)), 1.0, 3.0);
}

bool any(const glm::dvec3 &row) {
    return row != glm::dvec3(0.0);
}

} // namespace

int MediumRamp::parts() const {
    return static_cast<int>(rows.size()) / PART_FLOATS;
}

std::vector<float> MediumRamp::densities() const {
    std::vector<float> out;
    for (std::size_t at = 0; at < rows.size(); at += PART_FLOATS) {
        const auto part = rows.begin() + static_cast<std::ptrdiff_t>(at);
        out.insert(out.end(), part, part + 5);
    }
    return out;
}

MediumRamp ramp_of(const TransferFunction &transfer, const TransferFunction *radiated,
                   std::span<const glm::vec2> ranges, const glm::ivec3 &bricks) {
    std::vector<double> stops = transfer.ramp().stops;
    if (radiated != nullptr) {
        const std::vector<double> &others = radiated->ramp().stops;
        stops.insert(stops.end(), others.begin(), others.end());
        std::sort(stops.begin(), stops.end());
    }
    MediumRamp out;
    std::vector<glm::vec2> held;    // where there is anything
    double narrowest = double{FAR}; // of what takes light
    for (std::size_t i = 0; i <= stops.size(); ++i) {
        const bool first = i == 0, last = i == stops.size();
        const double from = first ? stops[0] - 1.0 : stops[i - 1], to = last ? stops.back() + 1.0 : stops[i];
        // In single precision two stops may be one.
        if (!first && !last && !(static_cast<float>(from) < static_cast<float>(to))) {
            continue;
        }
        Course density = course_of(&transfer, from, to), emission = course_of(radiated, from, to);
        if (first || last) { // constant
            density = {transfer.at(from), Emitted(0.0), Emitted(0.0)};
            emission = {};
            if (radiated != nullptr) {
                emission.first = radiated->at(from);
            }
        }
        const bool dense = density.first.w > 0.0 || density.gain.w != 0.0;
        const bool filled = dense || any(glm::dvec3(emission.first)) || any(glm::dvec3(emission.gain));
        const float low = first ? -FAR : static_cast<float>(from), high = last ? FAR : static_cast<float>(to);
        append(out.rows, {low, high, first || last ? 0.0 : 1.0 / (double{high} - double{low})});
        append(out.rows, {density.first.w, density.gain.w, filled ? 1.0 : 0.0});
        append(out.rows, density.first);
        append(out.rows, density.gain);
        append(out.rows, density.bow);
        append(out.rows, emission.first);
        append(out.rows, emission.gain);
        out.takes_light = out.takes_light || dense;
        narrowest = dense ? std::min(narrowest, double{high} - double{low}) : narrowest;
        if (filled) {
            held.emplace_back(low, high);
        }
    }
    std::vector<std::uint8_t> occupied(ranges.size());
    std::transform(ranges.begin(), ranges.end(), occupied.begin(), [&held](const glm::vec2 &range) {
        return std::any_of(held.begin(), held.end(), [&range](const glm::vec2 &part) {
            return range.x <= part.y && range.y >= part.x && range.y > 0.0F;
        });
    });
    out.clearance = clearances_of(occupied, bricks);
    out.fineness = fineness_of(ranges, narrowest);
    return out;
}

} // namespace sfumato
