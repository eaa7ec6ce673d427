// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of which every pixel is traced: a first look at all of them, and a closer one where one sample is not
// enough.
#pragma once

#include "frame/film.hpp"
#include "frame/passes.hpp"
#include "frame/stages.hpp"

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace sfumato {

// Called between parts of the work with the share that is done; false stops it.
using Progress = std::function<bool(double)>;

// What a pixel's surface has of a sky, and of other surfaces. One look asks in a few directions, which is as coarse as
// it is cheap.
struct SkyPixel {
    struct Part {
        std::array<float, 3> light{};           // were it hidden by no solid, past smoke
        std::array<float, 3> all{}, seen{};     // what the directions bring, and what solids leave of that
        float open = 0.0F;                      // the mean of the light's colours, without smoke
        std::array<float, 3> weight{}, found{}; // of light from other surfaces: what is sent on, and what rays find
        [[nodiscard]] float sent_on() const { return weight[0] + weight[1] + weight[2]; }
    };
    Part dull, gloss;
    std::array<float, 3> normal{};

    [[nodiscard]] bool lit() const { return dull.open + gloss.open + dull.sent_on() + gloss.sent_on() > 0.0F; }
};

struct Image {
    LayerSet wanted;
    int width, height;
    std::vector<float> rgba;       // premultiplied
    std::vector<float> surfaces;   // Layers.open
    std::vector<float> unshadowed; // and the others of Layers
    std::vector<float> seen;
    std::vector<float> distance;   // at the pixel's centre
    std::vector<float> fine;       // none where nothing may be finer than pixels
    std::vector<SkyPixel> sky;     // none where no sky gives light
    bool shafts = false;           // whether air is lit and shaded before surfaces
    std::vector<PassImage> passes; // those of `wanted`

    Image(LayerSet what, int w, int h)
        : wanted(what), width(w), height(h), rgba(4 * at(0, h)), surfaces(at(0, h)), unshadowed(at(0, h)),
          seen(at(0, h)), distance(at(0, h)), passes(pass_images(what, at(0, h))) {}

    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }

    // What a sample brings: RGBA, and of each pass its sums.
    [[nodiscard]] std::size_t sums() const {
        std::size_t sum = 4;
        for (const PassImage &pass : passes) {
            sum += pass.kind->sums;
        }
        return sum;
    }
    using Sample = std::array<float, 4 + MOST_SUMS>;
    void read(const Layers &layers, std::size_t lane, Sample &values) const {
        for (std::size_t c = 0; c < 4; ++c) {
            values[c] = layers.picture[c][lane];
        }
        std::size_t at = 4;
        for (const PassImage &pass : passes) {
            pass.kind->read(layers, lane, values.data() + at);
            at += pass.kind->sums;
        }
    }
    // `middle`: whether the values are those of a ray through the pixel's centre.
    void set(std::size_t pixel, const Sample &values, bool middle) {
        for (std::size_t c = 0; c < 4; ++c) {
            rgba[4 * pixel + c] = values[c];
        }
        std::size_t at = 4;
        for (PassImage &pass : passes) {
            const std::size_t count = pass.kind->sums;
            for (std::size_t c = 0; c < count && (middle || pass.kind->filtered); ++c) {
                pass.values[count * pixel + c] = values[at + c];
            }
            at += count;
        }
    }
};

struct Blur; // frame/blurred.hpp

// Pixels in which surfaces or their shadows change are sampled as the film has it, those that are blurred from many
// eyes, the others once. Nothing if progress said stop.
std::optional<Image> traced(const Tracer &tracer, const Blur &blur, int width, int height, const Film &film,
                            const Progress &progress);

} // namespace sfumato
