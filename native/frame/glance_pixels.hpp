// SPDX-License-Identifier: GPL-3.0-or-later
// The pixels of a picture at a glance: those that are traced, and those that are interpolated between them.
#pragma once

#include "frame/layers.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfumato {

// Pixels x0 <= x <= x1, y0 <= y <= y1, of which the corners are traced.
struct Cell {
    int x0, y0, x1, y1;
    [[nodiscard]] bool done() const { return x1 - x0 <= 1 && y1 - y0 <= 1; }
};

struct GlancePixels {
    GlancePixels(LayerSet wanted, int w, int h)
        : width(w), height(h), planes(wanted.overlay() ? 2 : 1), channels(wanted.bits == PICTURE.bits ? 4 : 3),
          values(planes * 4 * at(0, h)), distance(at(0, h)), surface(at(0, h)), traced(at(0, h)) {}

    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] std::size_t clamped(int x, int y) const {
        return at(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
    }
    [[nodiscard]] float *value(std::size_t plane, std::size_t pixel) {
        return values.data() + 4 * (plane * distance.size() + pixel);
    }

    // What became of a traced pixel.
    void store(std::size_t pixel, const Layers &layers, std::size_t lane);
    // Interpolates between the corners of cells, which share no pixel but on their sides. Of a side that is traced on
    // the other cell's behalf, that stays; any other gets from both cells the same.
    void fill(const std::vector<Cell> &cells);

    int width, height;
    std::size_t planes;
    int channels;                // that count for edges
    std::vector<float> values;   // planes of RGBA
    std::vector<float> distance; // of what is traced
    std::vector<float> surface;  // of what is traced: Layers.open
    std::vector<std::uint8_t> traced;

private:
    void fill(const Cell &cell, std::size_t plane);
};

} // namespace sfumato
