// SPDX-License-Identifier: GPL-3.0-or-later
// What neighbouring pixels, which look in different directions for a sky and for light of other surfaces, tell
// together.
#pragma once

#include "frame/picture.hpp"

#include <cstddef>

namespace sfumato {

SkyPixel sky_pixel(const SkyLayers &layers, std::size_t lane);

// After the first look at all pixels.
void put_looks_together(Image &image);

// What a sample in a pixel has of a sky and of other surfaces, with what the pixels around it have found of that where
// they see the same surface.
void find_around(const Image &image, int x, int y, const Layers &layers, std::size_t lane, Image::Sample &values);

} // namespace sfumato
