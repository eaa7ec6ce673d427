// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfumato {

using Text = TransferFunction::Text;

TransferFunction::TransferFunction(Ramp described) : given(std::move(described)) {
    const std::size_t count = given.stops.size();
    const auto colour = [&](std::size_t i) { return given.colour[i]; };
    const auto value = [&](std::size_t i) {
        return Emitted(colour(i) * (given.associated ? 1.0 : given.extinction[i]), given.extinction[i]);
    };
    parts.resize(count + 1);
    parts[0].from = given.stops[0];
    parts[0].first = value(0);
    for (std::size_t i = 0; i < count; ++i) {
        Part &part = parts[i + 1];
        part.from = given.stops[i];
        part.first = value(i);
        if (i + 1 < count) {
            part.width = given.stops[i + 1] - given.stops[i];
            if (given.linear) {
                part.gain = value(i + 1) - value(i);
                if (!given.associated) { // the product of two lines
                    const double more = given.extinction[i + 1] - given.extinction[i];
                    part.bow = Emitted(-more * (colour(i + 1) - colour(i)), 0.0);
                }
            }
        }
        if (i > 0) {
            const Part &last = parts[i];
            part.before = last.before + last.width * (last.first + 0.5 * last.gain + last.bow / 6.0);
        }
    }
}

std::size_t TransferFunction::part_of(double s) const {
    return static_cast<std::size_t>(std::upper_bound(given.stops.begin(), given.stops.end(), s) - given.stops.begin());
}

double TransferFunction::clamped(std::size_t part, double s) const {
    const std::vector<double> &stops = given.stops;
    const double above = part > 0 ? std::max(s, stops[part - 1]) : s;
    return part < stops.size() ? std::min(above, stops[part]) : above;
}

Emitted TransferFunction::at(std::size_t number, double s) const {
    const Part &part = parts[number];
    const double u = (s - part.from) / part.width;
    return part.first + part.gain * u + part.bow * (u * (1.0 - u));
}

Emitted TransferFunction::integral(double s) const {
    const Part &part = parts[part_of(s)];
    const double u = (s - part.from) / part.width;
    return part.before + part.width * u * (part.first + 0.5 * u * part.gain + u * (0.5 - u / 3.0) * part.bow);
}

Emitted TransferFunction::mean(double a, double b) const {
    const auto within = [this](std::size_t number, double from, double to) {
        const double share = (to - from) / parts[number].width;
        return 0.5 * (at(number, from) + at(number, to)) + parts[number].bow * (share * share / 6.0);
    };
    const double low = std::min(a, b), high = std::max(a, b);
    const std::size_t first = part_of(low), last = part_of(high);
    if (first == last) {
        return within(first, low, high);
    }
    // The difference of two integrals would cancel where both ends are close to a stop.
    const double from = given.stops[first], to = given.stops[last - 1];
    const Emitted sum = (from - low) * within(first, low, from) + (parts[last].before - parts[first + 1].before) +
                        (high - to) * within(last, to, high);
    return sum / (high - low);
}

Text::Stretch TransferFunction::stretch(std::size_t number, double front, double back, double length) const {
    const Emitted enters = length * at(number, front), leaves = length * at(number, back);
    const double share = (back - front) / parts[number].width;
    Text::Stretch out;
    out.front = enters.w;
    out.back = leaves.w;
    out.emission_front = glm::dvec3(enters);
    out.emission_back = glm::dvec3(leaves);
    out.bow = glm::dvec3(parts[number].bow) * (length * share * share);
    return out;
}

Sent sent_by(const Text::Stretch &stretch) {
    const int pieces = static_cast<int>(Text().pieces_of(stretch));
    const double share = 1.0 / pieces;
    Sent sum = CLEAR;
    for (int i = 0; i < pieces; ++i) {
        const Text::Stretch piece = pieces > 1 ? Text().piece_of(stretch, share * i, share) : stretch;
        const Text::Attenuation over = Text().attenuation_over(Text().depth_of(piece));
        sum = before(sum, {Text().radiance_of(piece, over), over.behind});
    }
    return sum;
}

Sent sent_by(const TransferFunction &transfer, double front, double back, double length) {
    if (front == back) {
        return sent_by(transfer.stretch(transfer.part_of(front), front, back, length));
    }
    const std::vector<double> &stops = transfer.ramp().stops;
    const std::size_t first = transfer.part_of(std::min(front, back)), last = transfer.part_of(std::max(front, back));
    const bool rising = front < back;
    Sent sum = CLEAR;
    double from = front;
    for (std::size_t i = 0; i <= last - first; ++i) {
        const std::size_t part = rising ? first + i : last - i;
        const double to = i == last - first ? back : stops[rising ? part : part - 1];
        sum = before(sum, sent_by(transfer.stretch(part, from, to, length * (to - from) / (back - front))));
        from = to;
    }
    return sum;
}

std::pair<double, double> difference(const Ramp &a, const Ramp &b) {
    constexpr double ENDLESS = std::numeric_limits<double>::infinity();
    if (a == b) {
        return {ENDLESS, -ENDLESS};
    }
    if (a.linear != b.linear || a.associated != b.associated) {
        return {-ENDLESS, ENDLESS};
    }
    const std::size_t shorter = std::min(a.stops.size(), b.stops.size());
    const auto same = [&](std::size_t i, std::size_t j) {
        return a.stops[i] == b.stops[j] && a.extinction[i] == b.extinction[j] && a.colour[i] == b.colour[j];
    };
    std::size_t head = 0, tail = 0;
    while (head < shorter && same(head, head)) {
        ++head;
    }
    while (tail < shorter - head && same(a.stops.size() - 1 - tail, b.stops.size() - 1 - tail)) {
        ++tail;
    }
    // A ramp of constants keeps the value of the last common stop up to the first that differs.
    double low = head > 0 ? a.stops[head - 1] : -ENDLESS;
    if (!a.linear && head > 0 && head < shorter) {
        low = std::min(a.stops[head], b.stops[head]);
    }
    return {low, tail > 0 ? a.stops[a.stops.size() - tail] : ENDLESS};
}

} // namespace sfumato
