// SPDX-License-Identifier: GPL-3.0-or-later
// What a lens and an open shutter blur. A pixel's samples are seen from many eyes. Each also tells what its neighbours
// see from eyes beside its own: where what it met is seen from there. So it is laid on all pixels there, and the more
// they are, the fewer samples a pixel takes (as Lehtinen et al., "Temporal light field reconstruction", 2011, but each
// sample for eyes so near that nothing else comes before it).
#pragma once

#include "frame/eyes.hpp"
#include "frame/picture.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace sfumato {

// The eyes of pixels that take so many samples; those of which what is sorted by its place in the picture has its own
// are less, and take turns.
struct Eyes {
    int count = 0;
    std::vector<FrameView> views;
    std::deque<std::vector<LightView>> lights; // of each, where anything moves

    [[nodiscard]] const FrameView &view(std::size_t eye) const { return views[eye % views.size()]; }
};

// What a frame's eyes see of what moves: rays meet it where it is, shading has it turned as at the nearest of even
// times while the shutter is open.
class MovedViews {
public:
    MovedViews() = default;
    MovedViews(const FrameView &middle, const Surfaces &surfaces);

    [[nodiscard]] bool empty() const { return views_.empty(); }
    // `lights` is for what those of that time are.
    [[nodiscard]] FrameView at(float time, std::vector<LightView> &lights) const;

private:
    std::vector<std::vector<PlaceView>> places_;
    std::vector<FrameView> views_;
};

struct Blur {
    Exposure exposure;
    MovedViews moved;
    Eyes few, many; // of what is blurred widely, and of all else
    // How far from the middle eye smoke begins and ends; not at all.
    float smoke_begins = 0.0F, smoke_ends = 0.0F;

    [[nodiscard]] bool empty() const { return many.views.empty(); }
};

// How much narrower lens and shutter are to be where each of `count` samples stands for as much of them around itself.
float narrowed(int count);

// Of each pixel how many samples it takes, 0 where all eyes see the same: it takes some around where a second look,
// from another eye in each pixel, is not as the first one, which is `sharp`, and was `looked` at first; and wherever
// some eye sees what changes there, which that look may miss where it is small and bright.
std::vector<std::uint16_t> blurred_pixels(const Tracer &tracer, const Blur &blur, const Film &film, const Image &sharp,
                                          std::span<const float> looked, std::span<const std::uint8_t> changes);

// Sums of what samples bring to pixels. Whole numbers, so that it does not matter which thread comes first.
class Blurring {
public:
    Blurring(const Tracer &tracer, const Blur &blur, const Film &film, std::span<const std::uint16_t> samples,
             const Image &image);
    // Samples the rows from `first` to `last`; of different rows on several threads.
    void sample(int first, int last);
    void finish(Image &image) const;

private:
    void sample(const Eyes &eyes, const FilmPatterns &patterns, int first, int last);
    void lay(int x, int y, const Image::Sample &values, const std::array<glm::vec2, 3> &moves, std::size_t seed);
    void add(int x, int y, const Image::Sample &values, std::int64_t weight);

    const Tracer &tracer_;
    const Blur &blur_;
    const Film &film_;
    std::span<const std::uint16_t> samples_;
    const Image &image_;
    std::size_t sums_; // of a pixel: what a sample brings, and the weights
    std::vector<std::int64_t> sum_;
    FilmPatterns few_, many_; // of these eyes
};

} // namespace sfumato
