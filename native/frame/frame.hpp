// SPDX-License-Identifier: GPL-3.0-or-later
// A frame on the CPU: light maps, surfaces, smoke, film. A stage that the scene does not need does not run.
#pragma once

#include "frame/blurred.hpp"
#include "frame/drawn.hpp"
#include "frame/light_cache.hpp"
#include "frame/measure.hpp"
#include "frame/picture.hpp"
#include "frame/prepared.hpp"
#include "frame/stages.hpp"
#include "media/strands.hpp"
#include "scene/exposure.hpp"
#include "scene/scene.hpp"
#include "text/dispatch.hpp"

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace sfumato {

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
    [[nodiscard]] std::optional<std::vector<float>> render(const Exposure &exposure, int width, int height,
                                                           int edge_samples, const Progress &progress) const;

    // The same, and the passes that are asked for beside the PICTURE.
    [[nodiscard]] std::optional<Image> passes(const Exposure &exposure, int width, int height, LayerSet wanted,
                                              const Mist &mist, float least_alpha, const Film &film,
                                              const Progress &progress) const;

    // The error of a picture that render() or passes() made, by about so many of its pixels: frame/measure.cpp.
    [[nodiscard]] Measured measure(const Camera &camera, int width, int height, std::span<const float> picture,
                                   const Filter &filter, int pixels, std::uint64_t seed) const;

    // What a GPU needs of the surfaces: RGB, and the distance to the first surface through the pixel's centre. RGB is
    // one layer of theirs, sampled and filtered as a picture is.
    [[nodiscard]] std::optional<std::vector<float>> surfaces(const Camera &camera, int width, int height,
                                                             LayerSet wanted, int edge_samples,
                                                             const Progress &progress) const;

    // The picture for a camera that moves, of a layer or the PICTURE: frame/glance.hpp. Of a shadow with the smoke, an
    // overlay's two images.
    [[nodiscard]] std::vector<float> glance(const Camera &camera, int width, int height, LayerSet wanted, int spacing,
                                            float shadow_strength = 1.0F) const;

    // RGB of the share of a light that the smoke lets through to each of `points` (x, y, z in turn).
    void transmittance(std::size_t light, std::span<const float> points, std::span<float> rgb) const;

    // Whether all that lies before opaque surfaces can be drawn by a GPU, in one batch: none of it takes one colour
    // more than another, and there are no grids and no air that it would have to be sorted with.
    [[nodiscard]] bool drawable() const;
    // What is drawn then, as a camera sees it. Of particles those that it sees, in the shadow of smoke or without that.
    [[nodiscard]] Sprites sprites(const Camera &camera, bool past_smoke) const;
    // Strands as strips, and sheets, those cut so that their light varies little over a triangle.
    [[nodiscard]] Triangles triangles(const Camera &camera, int width, int height) const;

    [[nodiscard]] std::span<const CroppedMedium> media() const { return content_.media; }
    [[nodiscard]] std::size_t seen_media() const { return content_.seen_media; } // which come first
    [[nodiscard]] const Lighting &lighting() const { return content_.lighting; }
    // Whether the first surface on each ray has an alpha of 1.
    [[nodiscard]] bool opaque() const { return !content_.surfaces->sheets() && covers(); }
    // Whether the camera sees any.
    [[nodiscard]] bool particles() const { return content_.puffs && content_.puffs->seen > 0; }
    [[nodiscard]] bool air() const { return !content_.air.empty(); }
    // Whether anything else than grids may lie before an opaque surface, which takes sorting along each ray.
    [[nodiscard]] bool sorted() const {
        return content_.surfaces->sheets() || particles() || !content_.strands.empty() || air();
    }
    [[nodiscard]] bool grey() const { return content_.grey; }
    [[nodiscard]] const glm::dvec3 &origin() const { return origin_; }
    [[nodiscard]] double step_length() const { return step_length_; } // cells
    // What ran so far, and how long that took.
    [[nodiscard]] std::vector<StageClock::Row> stages() const { return clock_->rows(); }

private:
    // Whether what lets nothing through has an alpha of 1.
    [[nodiscard]] bool covers() const { return content_.surfaces->opaque() || background_alpha_ == 1.0F; }

    // What the kernels read of a picture, and what that is made of.
    struct Views {
        MediaViews media;
        Bins puffs;
        std::vector<float> puff_begins;
        SeenStrands strands;
        std::shared_ptr<const LightCache> cache;
        FrameView frame;
    };
    // `reach`: as far as a sample sees around itself, pixels.
    [[nodiscard]] Views views(const Camera &camera, int width, int height, LayerSet wanted, double step_length,
                              double reach = Filter().diameter() / 2.0) const;
    // What does not depend on a picture.
    void show_particles(ParticlesView &view) const;
    void see_particles(const Camera &camera, int width, int height, Views &views) const;
    void see_strands(const Camera &camera, int width, int height, double reach, Views &views) const;
    // Light that surfaces have of each other: of a view that moves, what is kept of another camera's will do.
    void see_bounces(const Camera &camera, bool moving, Views &views) const;
    // What an exposure's eyes see, beside `sharp`, which is what its middle does; `sortings` has what is their own.
    [[nodiscard]] Blur blur_of(const Exposure &exposure, int width, int height, LayerSet wanted, const Film &film,
                               const FrameView &sharp, std::deque<Views> &sortings) const;
    // How far from an eye the smoke that is seen begins and ends.
    [[nodiscard]] std::pair<float, float> smoke_from(const glm::vec3 &eye) const;
    [[nodiscard]] std::optional<Image> image(const Exposure &exposure, int width, int height, LayerSet wanted,
                                             const Film &film, const Mist &mist, float least_alpha,
                                             const Progress &progress) const;

    const InstructionSet *instruction_set_;
    std::shared_ptr<Prepared> prepared_;
    std::unique_ptr<StageClock> clock_;
    double step_length_;
    glm::vec3 background_;
    std::shared_ptr<const SkyImage> backdrop_;
    float background_alpha_;
    glm::dvec3 origin_;
    Content content_;
    Bounces bounces_;
    LightView surroundings_ = white_surroundings();
    // Of the camera that asked last.
    struct Bounced {
        std::mutex making;
        std::optional<Camera> camera;
        std::shared_ptr<const LightCache> cache;
    };
    std::unique_ptr<Bounced> bounced_ = std::make_unique<Bounced>();
};

} // namespace sfumato
