// SPDX-License-Identifier: GPL-3.0-or-later
// What an object is to the camera and to lights, where that is less than everything.
#pragma once

#include <cstdint>

namespace sfumato {

// Sets of lights, a bit each.
using LightSets = std::uint64_t;

enum class Seen : std::uint8_t {
    SHOWN,
    HOLDOUT, // cuts a hole into the picture
    CATCHER, // shows nothing but the shadows that all but other catchers throw on it
    UNSEEN   // the camera sees what lies behind
};

struct Visibility {
    Seen seen = Seen::SHOWN;
    LightSets lit_by = ~LightSets{0}; // a light reaches it that has one of these: Reach::lights
    LightSets hides = ~LightSets{0};  // and it hides one that has one of these: Reach::hidden_by

    friend bool operator==(const Visibility &, const Visibility &) = default;
};

// What a light reaches, and what hides it. Nothing hides one without a set.
struct Reach {
    LightSets lights = 1, hidden_by = 1;
    bool diffuse = true, gloss = true, smoke = true; // whether it shows in what surfaces reflect, and in smoke
    bool plate = true; // whether it also lights the plate: what catchers are before anything stands on them

    friend bool operator==(const Reach &, const Reach &) = default;
};

} // namespace sfumato
