// SPDX-License-Identifier: GPL-3.0-or-later
// A frame on the CPU: light maps, surfaces, smoke, film. A stage that the scene does not need does not run.
#pragma once

#include "frame/prepared.hpp"
#include "frame/trace.hpp"
#include "maps/lighting.hpp"
#include "media/medium.hpp"
#include "solids/surfaces.hpp"
#include "text/dispatch.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sfumato {

struct Camera;
struct Scene;

struct FrameSettings {
    int coefficients = 15;        // of the light maps, over each ray's own range; the paper's maps have 7 over all
    double texels_per_cell = 1.0; // resolution of the light map against the medium's grid
    double steps_per_cell = 1.0;  // of the march along view rays
    int light_samples = 16;       // at most, of a light that is large enough to blur the smoke's shadow
};

// Called between parts of the work with the share that is done; false stops it.
using Progress = std::function<bool(double)>;

// Everything about a scene that does not depend on the camera.
class Frame {
public:
    // What `prepared` has of an earlier frame is not made again.
    Frame(const Scene &scene, const FrameSettings &settings, std::shared_ptr<Prepared> prepared,
          const InstructionSet &with = instruction_set());
    Frame(const Scene &scene, const FrameSettings &settings, const InstructionSet &with = instruction_set())
        : Frame(scene, settings, std::make_shared<Prepared>(), with) {}

    // Premultiplied RGBA, row 0 at the bottom, filtered as Cycles filters by default. Pixels in which surfaces or
    // their shadows change are sampled `edge_samples` times, the others once. Nothing if progress said stop.
    [[nodiscard]] std::optional<std::vector<float>> render(const Camera &camera, int width, int height,
                                                           int edge_samples, const Progress &progress) const;

    // What a GPU needs of the surfaces: RGB, and the distance to the first surface through the pixel's centre. RGB is
    // what `output` says, anything but PICTURE, sampled and filtered as a picture is.
    [[nodiscard]] std::optional<std::vector<float>> surfaces(const Camera &camera, int width, int height, Output output,
                                                             int edge_samples, const Progress &progress) const;

    // The picture for a camera that moves: frame/glance.hpp. With shadow_strength, an overlay's two images.
    [[nodiscard]] std::vector<float> glance(const Camera &camera, int width, int height, Output output, int spacing,
                                            std::optional<float> shadow_strength = std::nullopt) const;

    // RGB of the share of a light that the smoke lets through to each of `points` (x, y, z in turn).
    void transmittance(std::size_t light, std::span<const float> points, std::span<float> rgb) const;

    [[nodiscard]] std::span<const CroppedMedium> media() const { return media_; }
    [[nodiscard]] const Lighting &lighting() const { return lighting_; }
    [[nodiscard]] bool grey() const { return grey_; }
    [[nodiscard]] double step_length() const { return step_length_; } // cells

private:
    [[nodiscard]] FrameView view(const Camera &camera, std::span<const MediumView> media) const;

    const InstructionSet *instruction_set_;
    std::shared_ptr<Prepared> prepared_;
    double step_length_;
    glm::vec3 background_;
    std::optional<Surfaces> surfaces_;
    std::vector<CroppedMedium> media_; // those that are not empty
    bool grey_ = true;
    Lighting lighting_;
};

} // namespace sfumato
