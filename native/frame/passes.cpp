// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/passes.hpp"

#include <algorithm>
#include <array>

namespace sfumato {
namespace {

constexpr float NOTHING = 1e-12F; // W/(m^2 sr)

using Colours = float[3][MAX_LANES];

void read_three(const Colours &from, std::size_t lane, float *values) {
    for (std::size_t c = 0; c < 3; ++c) {
        values[c] = from[c][lane];
    }
}

constexpr std::array KINDS = {
    // The fourth: 1 where there is a surface.
    PassKind{"position", Layer::POSITION, 4, 4, false,
             [](const Layers &layers, std::size_t lane, float *values) {
                 read_three(layers.passes->position, lane, values);
                 values[3] = layers.hit[lane];
             }},
    PassKind{
        "normal", Layer::NORMAL, 3, 3, true,
        [](const Layers &layers, std::size_t lane, float *values) { read_three(layers.passes->normal, lane, values); }},
    PassKind{"mist", Layer::MIST, 1, 1, true,
             [](const Layers &layers, std::size_t lane, float *values) { values[0] = layers.passes->mist[lane]; }},
    PassKind{
        "object_index", Layer::OBJECT_INDEX, 1, 1, false,
        [](const Layers &layers, std::size_t lane, float *values) { values[0] = layers.passes->object_index[lane]; }},
    PassKind{
        "material_index", Layer::MATERIAL_INDEX, 1, 1, false,
        [](const Layers &layers, std::size_t lane, float *values) { values[0] = layers.passes->material_index[lane]; }},
    PassKind{"smoke", Layer::SMOKE_ALONE, 4, 4, true,
             [](const Layers &layers, std::size_t lane, float *values) {
                 float through = 0.0F;
                 for (std::size_t c = 0; c < 3; ++c) {
                     values[c] = layers.passes->smoke[c][lane];
                     through += layers.passes->left[c][lane];
                 }
                 values[3] = 1.0F - through * (1.0F / 3.0F);
             }},
    PassKind{"smoke_shadow", Layer::LEFT_BY_SMOKE, 3, 6, true,
             [](const Layers &layers, std::size_t lane, float *values) {
                 read_three(layers.passes->past_smoke, lane, values);
                 read_three(layers.passes->open, lane, values + 3);
             }},
    // Of each sample, as Cycles 3.4 has it: 0 where there is no light.
    PassKind{"shadow", Layer::LEFT_BY_ALL, 3, 3, true,
             [](const Layers &layers, std::size_t lane, float *values) {
                 for (std::size_t c = 0; c < 3; ++c) {
                     const float all = layers.passes->unshadowed[c][lane];
                     values[c] = all > NOTHING ? std::clamp(layers.passes->shadowed[c][lane] / all, 0.0F, 1.0F) : 0.0F;
                 }
             }},
};

constexpr std::size_t all_sums() {
    std::size_t sum = 0;
    for (const PassKind &kind : KINDS) {
        sum += kind.sums;
    }
    return sum;
}
static_assert(all_sums() <= MOST_SUMS);

} // namespace

std::span<const PassKind> pass_kinds() {
    return KINDS;
}

std::vector<PassImage> pass_images(LayerSet wanted, std::size_t pixels) {
    std::vector<PassImage> out;
    for (const PassKind &kind : KINDS) {
        if (wanted.has(kind.layer)) {
            out.push_back({&kind, std::vector<float>(kind.sums * pixels)});
        }
    }
    return out;
}

void PassImage::finish() {
    if (kind->sums == kind->channels) {
        return;
    }
    constexpr float LITTLE = 1e-4F; // of all colours
    std::size_t to = 0;
    for (std::size_t from = 0; from < values.size(); from += kind->sums) {
        const std::array<float, 3> left = {values[from], values[from + 1], values[from + 2]};
        const std::array<float, 3> all = {values[from + 3], values[from + 4], values[from + 5]};
        const float sum = all[0] + all[1] + all[2];
        const float mean = sum > NOTHING ? (left[0] + left[1] + left[2]) / sum : 1.0F;
        for (std::size_t c = 0; c < 3; ++c) {
            const float share = all[c] > NOTHING && all[c] > LITTLE * sum ? left[c] / all[c] : mean;
            values[to++] = std::clamp(share, 0.0F, 1.0F);
        }
    }
    values.resize(to);
}

} // namespace sfumato
