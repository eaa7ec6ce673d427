// SPDX-License-Identifier: GPL-3.0-or-later
// What compositors are given beside a picture: images of the layers that are meant for them.
#pragma once

#include "frame/layers.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sfumato {

struct PassKind {
    const char *name;
    Layer layer;
    std::size_t channels; // of the image
    std::size_t sums;     // what a sample brings of it: of a share, both sides of the division
    bool filtered;        // as the picture is; or seen through the middle of each pixel alone
    void (*read)(const Layers &, std::size_t lane, float *values);
};

constexpr std::size_t MOST_SUMS = 32; // of all kinds together

std::span<const PassKind> pass_kinds();

// One of them, row 0 at the bottom.
struct PassImage {
    const PassKind *kind;
    std::vector<float> values; // kind->sums a pixel

    // Of a share, divides: then there are kind->channels a pixel. Where there is nothing to take from, all is left; a
    // colour of which there is none has what the others have.
    void finish();
};

std::vector<PassImage> pass_images(LayerSet wanted, std::size_t pixels);

} // namespace sfumato
