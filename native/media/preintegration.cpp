// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/preintegration.hpp"

#include "media/preintegration_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

namespace sfumato {
namespace {

// Between each of the values and the next. The few slabs in which the ramp has a stop are no stretch.
class Slabs {
public:
    Slabs(const TransferFunction &ramp, const std::vector<double> &values) : transfer(ramp) {
        for (auto &row : rows) {
            row.assign(values.size() - 1, 0.0);
        }
        for (std::size_t k = 0; k + 1 < values.size(); ++k) {
            const double front = values[k], back = values[k + 1];
            const std::size_t part = transfer.part_of(front);
            const std::vector<double> &stops = transfer.ramp().stops;
            if (part < stops.size() && stops[part] < back) {
                cut.push_back({k, front, back});
                continue;
            }
            const TransferFunction::Text::Stretch stretch = transfer.stretch(part, front, back, 1.0);
            rows[0][k] = stretch.front;
            rows[1][k] = stretch.back;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto channel = static_cast<int>(c);
                rows[2 + c][k] = stretch.emission_front[channel];
                rows[5 + c][k] = stretch.emission_back[channel];
                rows[8 + c][k] = stretch.bow[channel];
            }
        }
    }

    void send(double length, std::size_t first, std::size_t last, std::vector<SlabSent> &out) const {
        SlabBatch batch;
        batch.slabs.front = rows[0].data();
        batch.slabs.back = rows[1].data();
        for (std::size_t c = 0; c < 3; ++c) {
            batch.slabs.emission_front[c] = rows[2 + c].data();
            batch.slabs.emission_back[c] = rows[5 + c].data();
            batch.slabs.bow[c] = rows[8 + c].data();
        }
        batch.length = length;
        batch.first = first / SLAB_GROUP * SLAB_GROUP;
        batch.last = last;
        batch.out = out.data();
        preintegration_kernels().send_slabs(batch);
        for (const Cut &slab : cut) {
            if (slab.number >= first && slab.number < last) {
                const Sent there = sent_by(transfer, slab.front, slab.back, length);
                const Sent again = sent_by(transfer, slab.back, slab.front, length);
                SlabSent &sent = out[slab.number];
                for (int c = 0; c < 3; ++c) {
                    sent.forwards[c] = there[c];
                    sent.backwards[c] = again[c];
                }
                sent.behind = there.w;
                sent.forwards[3] = sent.backwards[3] = 1.0 - there.w;
            }
        }
    }

private:
    struct Cut {
        std::size_t number;
        double front, back;
    };
    const TransferFunction &transfer;
    std::array<std::vector<double>, 11> rows;
    std::vector<Cut> cut;
};

std::size_t rounded_up(std::size_t size) {
    return (size + SLAB_GROUP - 1) / SLAB_GROUP * SLAB_GROUP;
}

void put(float *entry, const Sent &sent) {
    for (int c = 0; c < 3; ++c) {
        entry[c] = static_cast<float>(sent[c]);
    }
    entry[3] = static_cast<float>(1.0 - sent.w);
}

} // namespace

Sent from_means(const Emitted &over, SelfAttenuation how) {
    const TransferFunction::Text::Attenuation passing = TransferFunction::Text().attenuation_over(over.w);
    return {glm::dvec3(over) * (how == SelfAttenuation::NONE ? 1.0 : passing.mean), passing.behind};
}

PreintegratedTable::PreintegratedTable(const Ramp &ramp, double lowest, double highest, std::size_t entries,
                                       std::vector<double> steps, SelfAttenuation attenuation)
    : transfer(ramp), low(lowest), high(highest), count(entries), lengths(std::move(steps)), how(attenuation),
      table(lengths.size() * entries * entries * 4) {
    build(0, count - 1);
}

double PreintegratedTable::value(std::size_t i) const {
    return low + (high - low) * (static_cast<double>(i) / static_cast<double>(count - 1));
}

std::size_t PreintegratedTable::rebuild(const Ramp &ramp) {
    const auto [from, to] = difference(transfer.ramp(), ramp);
    transfer = TransferFunction(ramp);
    if (how != SelfAttenuation::FULL) { // integrals from the first stop on are rounded otherwise everywhere behind it
        return from <= to ? build(0, count - 1) : 0;
    }
    std::size_t first = 0, last = count - 1;
    while (first < last && value(first + 1) < from) {
        ++first;
    }
    while (last > first && value(last - 1) > to) {
        --last;
    }
    // Slabs are cut into pieces by groups, so that a group's other slabs may be rounded otherwise.
    return from <= to ? build(first / SLAB_GROUP * SLAB_GROUP, std::min(rounded_up(last), count - 1)) : 0;
}

std::size_t PreintegratedTable::build(std::size_t first, std::size_t last) {
    std::size_t built = 0;
    for (std::size_t step = 0; step < lengths.size(); ++step) {
        float *const entries = table.data() + step * count * count * 4;
        for (std::size_t i = first; i <= last; ++i) {
            put(entries + (i * count + i) * 4, from_means(lengths[step] * transfer.at(value(i)), how));
        }
        built += last - first + 1;
        built += how == SelfAttenuation::FULL ? compose(entries, lengths[step], first, last)
                                              : from_integrals(entries, lengths[step]);
    }
    return built;
}

std::size_t PreintegratedTable::from_integrals(float *entries, double length) const {
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Sent both = from_means(length * transfer.mean(value(j), value(i)), how);
            put(entries + (i * count + j) * 4, both);
            put(entries + (j * count + i) * 4, both);
        }
    }
    return count * (count - 1);
}

// Diagonal by diagonal, in each of which all slabs are of one length. Several of them before any is written, so that a
// row of the table is written in stretches and not entry by entry.
std::size_t PreintegratedTable::compose(float *entries, double length, std::size_t first, std::size_t last) const {
    constexpr std::size_t STRIPS = 8;
    std::vector<double> edges;
    for (std::size_t i = 0; i <= rounded_up(count - 1); ++i) {
        edges.push_back(value(i));
    }
    const Slabs slabs(transfer, edges);
    std::vector<SlabSent> sent(edges.size() - 1), run(count);
    const std::size_t strip = 4 * count;
    std::vector<float> forwards(STRIPS * strip), backwards(STRIPS * strip);
    std::size_t built = 0;
    for (std::size_t narrowest = 1; narrowest < count; narrowest += STRIPS) {
        const std::size_t widths = std::min(STRIPS, count - narrowest);
        // Windows that hold a slab that changed; of a width they begin at these or before.
        const auto lowest = [first](std::size_t width) { return first + 1 > width ? first + 1 - width : 0; };
        const auto highest = [last, this](std::size_t width) { return std::min(last - 1, count - 1 - width); };
        for (std::size_t n = 0; n < widths; ++n) {
            const std::size_t width = narrowest + n;
            if (lowest(width) <= highest(width)) {
                slabs.send(length / static_cast<double>(width), lowest(width), highest(width) + width, sent);
                preintegration_kernels().compose_windows({sent.data(), run.data(), width, lowest(width), highest(width),
                                                          forwards.data() + n * strip, backwards.data() + n * strip});
                built += 2 * (highest(width) - lowest(width) + 1);
            }
        }
        for (std::size_t i = lowest(narrowest + widths - 1); i <= highest(narrowest); ++i) {
            for (std::size_t n = 0; n < widths; ++n) {
                const std::size_t width = narrowest + n;
                if (i >= lowest(width) && i <= highest(width)) {
                    std::copy_n(forwards.data() + n * strip + 4 * i, 4, entries + (i * count + i + width) * 4);
                }
            }
        }
        for (std::size_t j = lowest(narrowest + widths - 1) + narrowest;
             j <= highest(narrowest) + narrowest + widths - 1; ++j) {
            for (std::size_t n = 0; n < widths; ++n) {
                const std::size_t width = narrowest + n;
                if (j >= lowest(width) + width && j <= highest(width) + width) {
                    std::copy_n(backwards.data() + n * strip + 4 * (j - width), 4,
                                entries + (j * count + j - width) * 4);
                }
            }
        }
    }
    return built;
}

Sent PreintegratedTable::look_up(double front, double back, std::size_t step) const {
    const auto place = [this](double s) {
        const auto most = static_cast<double>(count - 1);
        return std::clamp((s - low) / (high - low) * most, 0.0, most);
    };
    const double x = place(front), y = place(back);
    const auto i = std::min(static_cast<std::size_t>(x), count - 2),
               j = std::min(static_cast<std::size_t>(y), count - 2);
    const double right = x - static_cast<double>(i), up = y - static_cast<double>(j);
    const float *const corner = table.data() + ((step * count + i) * count + j) * 4;
    const auto at = [&](std::size_t offset) {
        const float *const entry = corner + 4 * offset;
        return Sent(entry[0], entry[1], entry[2], entry[3]);
    };
    const Sent sum = glm::mix(glm::mix(at(0), at(1), up), glm::mix(at(count), at(count + 1), up), right);
    return {sum.x, sum.y, sum.z, 1.0 - sum.w};
}

} // namespace sfumato
