// SPDX-License-Identifier: GPL-3.0-or-later
// A sky of many colours as the kernels take it: what of it is bright and narrow enough to throw a shadow of its own
// becomes suns; and the rest, which is smooth, is kept as pictures of what surfaces make of it.
#pragma once

#include "scene/sky_image.hpp"

#include <array>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// Owns nothing.
struct SkyImageView {
    const float *rgb = nullptr; // null for none
    int width = 0, height = 0;
};

SkyImageView view_of(const SkyImage &image);

// Each layer of gloss is twice as rough as the one before; the first is a mirror.
constexpr int GLOSS_LEVELS = 7;
constexpr float FIRST_ALPHA = 0.03125F; // of the second

class Sky {
public:
    struct Sun {
        glm::vec3 towards, irradiance;
        float angle; // diameter, radians
    };

    explicit Sky(const SkyImage &image);

    [[nodiscard]] std::span<const Sun> suns() const { return suns_; }
    // Of the rest, as is all that follows.
    [[nodiscard]] const glm::vec3 &mean() const { return mean_; }
    // What comes from the directions that are nearest to each of these, W/m^2.
    [[nodiscard]] std::vector<glm::dvec3> fluence(std::span<const glm::dvec3> towards) const;
    // Coarse, for looks in a few directions.
    [[nodiscard]] SkyImageView looks() const { return view_of(coarse_); }
    // What a white matt surface that faces a direction sends to the eye, in place of the direction's radiance.
    [[nodiscard]] SkyImageView dull() const { return view_of(dull_); }
    // What gloss does, whose half vectors have GGX's distribution about a direction, for all that it reflects.
    [[nodiscard]] SkyImageView gloss(int level) const { return view_of(gloss_[static_cast<std::size_t>(level)]); }

private:
    void take_suns(SkyImage &rest);

    std::vector<Sun> suns_;
    SkyImage coarse_, dull_;
    std::array<SkyImage, GLOSS_LEVELS> gloss_;
    glm::vec3 mean_{0.0F};
};

} // namespace sfumato
