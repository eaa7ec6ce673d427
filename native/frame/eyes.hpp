// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a lens and the instants from which a picture is taken together: each is a pinhole camera.
#pragma once

#include "frame/film.hpp"
#include "scene/exposure.hpp"

#include <cstddef>
#include <vector>

namespace sfumato {

struct Eye {
    Camera camera;
    float time; // of the shutter's, 0 as it opens, 1 as it closes
};

// Samples of a pixel come in rounds: each, and all of them, is spread over the lens and over time.
constexpr int EYES_A_ROUND = 16;

// Of a pixel whose turn it is, the number of its eye of sample k in a round, among those of all turns and rounds.
std::size_t eye_of(int turn, int round, int k, int rounds);
// The eye of a first look: those of all turns lie far apart.
std::size_t first_eye_of(int turn, int rounds);

// One after the other, as eye_of() counts them.
std::vector<Eye> eyes_of(const Exposure &exposure, int rounds);

} // namespace sfumato
