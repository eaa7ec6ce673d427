// SPDX-License-Identifier: GPL-3.0-or-later
// A frame on the CPU: light map, surfaces, smoke, film. A stage that the scene does not need does not run.
#pragma once

#include "light_map.hpp"
#include "medium.hpp"
#include "scene.hpp"
#include "surfaces.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sfumato {

struct FrameSettings {
    int coefficients = 31;        // of the light map; the paper's own maps have 7
    double texels_per_cell = 1.0; // resolution of the light map against the medium's grid
    double steps_per_cell = 1.0;  // of the march along view rays
};

// Called between parts of the work with the share that is done; false stops it.
using Progress = std::function<bool(double)>;

// Everything about a scene that does not depend on the camera.
class Frame {
public:
    Frame(const Scene &scene, const FrameSettings &settings, const Kernels &with = kernels());

    // Premultiplied RGBA, row 0 at the bottom, filtered as Cycles filters by default. Pixels in which surfaces or
    // their shadows change are sampled `edge_samples` times, the others once. Nothing if progress said stop.
    [[nodiscard]] std::optional<std::vector<float>> render(const Camera &camera, int width, int height,
                                                           int edge_samples, const Progress &progress) const;

    // What a GPU needs of the surfaces, one ray a pixel and no smoke: RGB, and the distance to the first surface.
    // RGB is the radiance, or, unlit, the cosine of the sun's angle, in red times the visibility of the sun.
    [[nodiscard]] std::vector<float> surfaces(const Camera &camera, int width, int height, bool lit) const;

    // RGB of the share of sunlight that the smoke lets through to each of `points` (x, y, z in turn).
    void transmittance(std::span<const float> points, std::span<float> rgb) const;

    [[nodiscard]] const CroppedMedium &medium() const { return medium_; }
    [[nodiscard]] const std::optional<LightMap> &light_map() const { return light_map_; }
    [[nodiscard]] const std::optional<Sun> &sun() const { return sun_; }
    [[nodiscard]] double step_length() const { return step_length_; }

private:
    [[nodiscard]] FrameView view(const Camera &camera) const;

    const Kernels *kernels_;
    Surfaces surfaces_;
    CroppedMedium medium_;
    std::optional<Sun> sun_;
    std::optional<LightMap> light_map_; // where there are smoke and a sun
    double step_length_ = 1.0;
    glm::vec3 background_;
};

} // namespace sfumato
