// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/classification.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sfumato {
namespace {

using Text = TransferFunction::Text;

// What steps: `send` of each one's front, back and length.
template <typename Send>
void for_steps(double length, double step, const Send &send) {
    const double whole = std::floor(length / step + 1e-9);
    for (int k = 0; k < static_cast<int>(whole); ++k) {
        send(step * k, step * (k + 1), step);
    }
    if (const double rest = length - step * whole; rest > 1e-9 * step) {
        send(step * whole, length, rest);
    }
}

// A ray from cell to cell. Between two planes through the cells' centres the number is one cubic.
class Cells {
public:
    Cells(const CellRay &ray, double length) : far(length) {
        for (int axis = 0; axis < 3; ++axis) {
            const double along = ray.to[axis] - ray.from[axis], from = ray.from[axis] - 0.5;
            const double speed = std::abs(along) / length;
            between[axis] = speed > 0.0 ? 1.0 / speed : far;
            const double ahead = along > 0.0 ? std::floor(from) + 1.0 - from : from - std::ceil(from) + 1.0;
            next[axis] = speed > 0.0 ? ahead / speed : far;
        }
    }
    // The end of the cell that begins at `t`.
    double end() {
        const double t = std::min({next.x, next.y, next.z, far});
        for (int axis = 0; axis < 3; ++axis) {
            if (next[axis] <= t + 1e-9) { // through an edge, or a corner
                next[axis] += between[axis];
            }
        }
        return t;
    }

private:
    double far;
    glm::dvec3 next{0.0}, between{0.0};
};

// The line through what both of Gauss's points hold, over a piece of a cell.
Text::Stretch line_through(const Emitted &first, const Emitted &second, double length) {
    const Emitted middle = 0.5 * length * (first + second);
    const Emitted half = 0.5 * std::numbers::sqrt3 * length * (second - first);
    Text::Stretch out;
    out.front = middle.w - half.w;
    out.back = middle.w + half.w;
    out.emission_front = glm::dvec3(middle - half);
    out.emission_back = glm::dvec3(middle + half);
    out.bow = glm::dvec3(0.0);
    return out;
}

class CubicSplit {
public:
    explicit CubicSplit(const TransferFunction &ramp) : transfer(ramp) {}

    Sent operator()(const Text::Cubic &cubic, double length) {
        const Text::Turns turns = Text().turns_of(cubic);
        cuts.assign(1, 0.0);
        cut(cubic, 0.0, turns.first);
        cut(cubic, turns.first, turns.second);
        cut(cubic, turns.second, 1.0);
        cuts.push_back(1.0);
        Sent sum = CLEAR;
        for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
            const double low = cuts[i], share = cuts[i + 1] - low;
            if (share > 1e-12) {
                constexpr double GAUSS = 0.5 / std::numbers::sqrt3;
                const auto at = [&](double x) { return Text().cubic_at(cubic, low + share * x); };
                const std::size_t part = transfer.part_of(at(0.5));
                // Between stops closer than a crossing is exact, a line is steep enough to leave all bounds outside.
                const auto emitted = [&](double s) { return transfer.at(part, transfer.clamped(part, s)); };
                const Text::Stretch line =
                    line_through(emitted(at(0.5 - GAUSS)), emitted(at(0.5 + GAUSS)), share * length);
                sum = before(sum, sent_by(line));
            }
        }
        return sum;
    }

private:
    // Where the cubic, which does not turn between two places, meets stops; and its far end.
    void cut(const Text::Cubic &cubic, double low, double high) {
        const double first = Text().cubic_at(cubic, low), last = Text().cubic_at(cubic, high);
        const std::vector<double> &stops = transfer.ramp().stops;
        const std::size_t from = transfer.part_of(std::min(first, last)), to = transfer.part_of(std::max(first, last));
        for (std::size_t i = 0; i < to - from; ++i) {
            const double stop = stops[first < last ? from + i : to - 1 - i];
            cuts.push_back(std::max(Text().cubic_crossing(cubic, low, high, stop), cuts.back()));
        }
        cuts.push_back(high);
    }

    const TransferFunction &transfer;
    std::vector<double> cuts;
};

Classified split(const DenseCells &cells, const CellRay &ray, double length, const TransferFunction &transfer) {
    const auto at = [&](double t) { return cells.at(glm::mix(ray.from, ray.to, t / length)); };
    Cells walk(ray, length);
    CubicSplit send(transfer);
    Classified out;
    double t = 0.0, value = at(0.0);
    out.samples = 1;
    while (t < length) {
        const double end = walk.end(), third = (end - t) / 3.0;
        if (third > 1e-9) {
            const double last = at(end);
            const Text::Cubic cubic = Text().cubic_through(value, at(t + third), at(end - third), last);
            out.sent = before(out.sent, send(cubic, end - t));
            out.samples += 3;
            value = last;
        }
        t = end;
    }
    return out;
}

} // namespace

double DenseCells::at(const glm::dvec3 &place) const {
    const glm::dvec3 lower = glm::floor(place - 0.5), above = place - 0.5 - lower;
    const glm::ivec3 first(lower);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 side(corner & 1, (corner >> 1) & 1, corner >> 2), cell = first + side;
        if (cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size.x && cell.y < size.y && cell.z < size.z) {
            const glm::dvec3 share = glm::mix(1.0 - above, above, glm::dvec3(side));
            const auto row =
                static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(cell.y);
            sum += share.x * share.y * share.z *
                   values[row * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(cell.x)];
        }
    }
    return sum;
}

Classified classify(const DenseCells &cells, const CellRay &ray, const TransferFunction &transfer, Classification how,
                    double step, const PreintegratedTable *table) {
    const double length = glm::distance(ray.from, ray.to);
    if (!(length > 0.0)) {
        return {};
    }
    if (how == Classification::SPLIT) {
        return split(cells, ray, length, transfer);
    }
    const auto at = [&](double t) { return cells.at(glm::mix(ray.from, ray.to, t / length)); };
    Classified out;
    double front = 0.0;
    if (how != Classification::POST) {
        front = at(0.0);
        out.samples = 1;
    }
    for_steps(length, step, [&](double near, double far, double stretch) {
        out.samples += 1;
        Sent sent;
        if (how == Classification::POST) {
            sent = from_means(stretch * transfer.at(at(0.5 * (near + far))), SelfAttenuation::MEAN_SOURCE);
        } else {
            const double back = at(far);
            sent = how == Classification::FULL && stretch == step
                       ? table->look_up(front, back, 0)
                       : from_means(stretch * transfer.mean(front, back), SelfAttenuation::MEAN_SOURCE);
            front = back;
        }
        out.sent = before(out.sent, sent);
    });
    return out;
}

PreintegratedTable table_for(const DenseCells &cells, const Ramp &ramp, double step, std::size_t entries) {
    const auto count = static_cast<std::size_t>(cells.size.x) * static_cast<std::size_t>(cells.size.y) *
                       static_cast<std::size_t>(cells.size.z);
    const std::span<const float> values(cells.values, count);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double low = values.empty() ? 0.0 : std::min(0.0, double{*least});
    const double high = values.empty() ? 0.0 : std::max(0.0, double{*most});
    return {ramp, low, high > low ? high : low + 1.0, entries, {step}, SelfAttenuation::FULL};
}

ChosenClassification choose_classification(const DenseCells &cells, std::span<const CellRay> rays,
                                           const TransferFunction &transfer, double step, double error,
                                           std::size_t entries) {
    const PreintegratedTable table = table_for(cells, transfer.ramp(), step, entries);
    ChosenClassification chosen;
    double mean = 0.0;
    for (const CellRay &ray : rays) {
        const Sent exact = classify(cells, ray, transfer, Classification::SPLIT, step, nullptr).sent;
        mean += exact.x + exact.y + exact.z;
        for (std::size_t i = 0; i < STEPPED; ++i) {
            const Sent sent = classify(cells, ray, transfer, static_cast<Classification>(i), step, &table).sent;
            const glm::dvec3 apart(sent - exact);
            chosen.errors[i] += glm::dot(apart, apart);
        }
    }
    const double count = 3.0 * static_cast<double>(std::max<std::size_t>(rays.size(), 1));
    for (double &each : chosen.errors) {
        each = std::sqrt(each / count) / std::max(mean / count, 1e-30);
    }
    const double best = *std::min_element(chosen.errors.begin(), chosen.errors.end());
    for (std::size_t i = 0; i < STEPPED; ++i) {
        if (chosen.errors[i] <= std::min(error, 1.02 * best)) {
            chosen.how = static_cast<Classification>(i);
            break;
        }
    }
    return chosen;
}

} // namespace sfumato
