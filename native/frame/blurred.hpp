// SPDX-License-Identifier: GPL-3.0-or-later
// What a lens and an open shutter blur: pixels that are seen from many eyes.
#pragma once

#include "frame/picture.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace sfumato {

// The eyes that a picture has, as eyes_of() counts them, or so many of them that they take turns; none where the camera
// is sharp and still.
struct Blur {
    std::span<const FrameView> views;
    int rounds = 0;

    [[nodiscard]] bool empty() const { return views.empty(); }
    [[nodiscard]] const FrameView &view(std::size_t eye) const { return views[eye % views.size()]; }
};

// The pixels in which not all eyes see the same: those around which a second look, from another eye in each pixel, is
// not as the first one, which is `sharp`, and was `looked` at first; and all to which some eye moves what changes
// there, which the look may miss where it is small and bright.
std::vector<std::uint8_t> blurred_pixels(const Tracer &tracer, const Blur &blur, const Film &film, const Image &sharp,
                                         std::span<const float> looked, std::span<const std::uint8_t> changes);

// Samples those pixels of the rows from `first` to `last` that are blurred, in as many rounds as they need.
void refine_blurred(const Tracer &tracer, const Blur &blur, const Film &film, std::span<const std::uint8_t> blurred,
                    int first, int last, Image &image);

} // namespace sfumato
