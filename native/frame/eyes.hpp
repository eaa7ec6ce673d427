// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a lens and the instants from which a picture is taken together: each is a pinhole camera.
#pragma once

#include "frame/film.hpp"
#include "scene/exposure.hpp"

#include <cstddef>
#include <vector>

namespace sfumato {

struct Glimpse {
    Camera camera;
    float time; // of the shutter's, 0 as it opens, 1 as it closes
};

// The eyes of the samples of pixels, as many as `count` for each turn, 4 or a multiple of 16: those of one turn, and
// all of them, are spread over the lens and over time. These are as wide as `width` of what the exposure has.
std::vector<Glimpse> eyes_of(const Exposure &exposure, int count, float width);

// Of a pixel whose turn it is, the number of the eye of its sample k.
std::size_t eye_of(int turn, int k, int count);
// The eye of a first look: the first sixteen are as evenly spread as so many can be.
std::size_t first_eye_of(int turn);

} // namespace sfumato
