// SPDX-License-Identifier: GPL-3.0-or-later
// A frame's lights as one random point of each, or of a sky a few directions, from which what arrives is marched and
// not looked up. The mean over many such points is what maps and their samples stand for.
#pragma once

#include "maps/exact_rays.hpp"
#include "maps/lighting.hpp"
#include "media/medium.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sfumato {

// What does not depend on the points.
class ExactLights {
public:
    // `surfaces` must stay where it is. Bodies behind the media keep their maps, and with any of them each light the
    // points that it has.
    ExactLights(const Lighting &lighting, std::span<const CroppedMedium> media, const SurfaceView &surfaces);

    // Whether points are any of a light, and not of those that have maps.
    [[nodiscard]] bool anywhere() const { return anywhere_; }

    // The lights of one choice, by a place on the square [0, 1]^2 of each; and what their views point to.
    struct Choice {
        std::vector<std::vector<glm::vec3>> samples;
        std::vector<std::vector<float>> shares;
        std::vector<std::vector<ExactRays>> rays;
        std::vector<std::vector<LightMapView>> maps;
        std::vector<LightView> views;
    };
    [[nodiscard]] Choice choose(double u, double v) const;

private:
    // Of a sky, more directions than a frame has, or those that it has.
    struct Directions {
        std::vector<glm::vec3> samples;
        std::vector<float> shares;
    };

    const Lighting *lighting_;
    std::span<const CroppedMedium> media_;
    const SurfaceView *surfaces_;
    bool anywhere_;
    std::vector<Directions> skies_; // of each light
    std::vector<LightView> views_;
};

} // namespace sfumato
