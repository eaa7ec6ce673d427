// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of which every pixel is traced: a first look at all of them, and a closer one where one sample is not
// enough.
#pragma once

#include "frame/stages.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace sfumato {

// Called between parts of the work with the share that is done; false stops it.
using Progress = std::function<bool(double)>;

struct Image {
    LayerSet wanted;
    int width, height;
    std::vector<float> rgba;       // premultiplied
    std::vector<float> surfaces;   // Layers.open
    std::vector<float> unshadowed; // and the others of Layers
    std::vector<float> seen;
    std::vector<float> distance; // at the pixel's centre

    Image(LayerSet what, int w, int h)
        : wanted(what), width(w), height(h), rgba(4 * at(0, h)), surfaces(at(0, h)), unshadowed(at(0, h)),
          seen(at(0, h)), distance(at(0, h)) {}

    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }

    void set_colour(std::size_t pixel, const Layers &layers, std::size_t lane) {
        for (std::size_t c = 0; c < 4; ++c) {
            rgba[4 * pixel + c] = layers.picture[c][lane];
        }
    }
};

// Pixels in which surfaces or their shadows change are sampled `edge_samples` times, the others once. Nothing if
// progress said stop.
std::optional<Image> traced(const Tracer &tracer, int width, int height, int edge_samples, const Progress &progress);

} // namespace sfumato
