// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture is taken with: a lens, and a shutter that stays open for a while.
#pragma once

#include "scene/scene.hpp"

#include <vector>

namespace sfumato {

// A thin lens, focused on a plane. Metres, along the camera's axis and from its eye; of an orthographic camera from the
// plane that it stands in.
struct Lens {
    float radius = 0.0F;   // of the aperture; 0: a pinhole, all is sharp
    float focus = 1.0F;    // where all is sharp
    float near = 0.0F;     // where the camera's near plane is
    int blades = 0;        // corners of the aperture; with less than three it is round
    float rotation = 0.0F; // of the corners, radians
    float ratio = 1.0F;    // of its height to its width
};

struct Exposure {
    std::vector<Camera> cameras; // at even times from the shutter's opening to its closing; one that does not move
    Lens lens;
    bool moves = false; // whether things that move do while it is open; else they stand as halfway through
    // When, as shares of that time, the light has come in to a share of 0 .. 1, at even shares; none: evenly.
    std::vector<float> shutter;

    Exposure() = default;
    Exposure(const Camera &camera) : cameras{camera} {} // NOLINT(google-explicit-constructor): sharp and still

    // Halfway through, without a lens.
    [[nodiscard]] Camera middle() const { return at(0.5F); }
    [[nodiscard]] Camera at(float time) const;
    // When that share of the light has come in.
    [[nodiscard]] float when(float share) const;
    // Whether all is seen from one place at one time.
    [[nodiscard]] bool sharp() const { return cameras.size() == 1 && lens.radius == 0.0F && !moves; }
};

// The pinhole camera at (x, y) of a lens, in radii to the right and up.
Camera through(const Camera &camera, const Lens &lens, float x, float y);

} // namespace sfumato
