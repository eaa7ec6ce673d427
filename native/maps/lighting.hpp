// SPDX-License-Identifier: GPL-3.0-or-later
// The lights of a frame: how often each is sampled, its light maps, and what of them arrives in smoke.
#pragma once

#include "lights/light.hpp"
#include "maps/light_map.hpp"
#include "maps/sheet_depths.hpp"
#include "media/air.hpp"
#include "media/medium.hpp"
#include "scene/kept.hpp"
#include "solids/surfaces.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sfumato {

// What was made of lights and smoke before.
struct LightParts {
    Kept<LightMap> maps;
    Kept<SolidDepths> solids;
    Kept<SheetDepths> sheets;
    Kept<DepthTree> trees;
    Kept<LightVolume> volumes;
    Kept<Sky> skies;

    void end_round();
};

// Whether a body is to be lit by a light.
bool lights_smoke(const Light &light, const Body &body);

// Everything that the lights of a frame need, and the views of it.
class Lighting {
public:
    Lighting() = default;
    // Of each light its view and, at most most_samples of them, the points at which it is sampled.
    // `air`: the world's, which dims lights on their way; null where there is none.
    Lighting(std::span<const Light> lights, std::vector<Body> bodies, const Surfaces &surfaces, int most_samples,
             LightParts &parts, const AirView *air = nullptr);
    // The maps of every body from every sample of every light.
    void build_maps(const Surfaces &surfaces, const LightMapSettings &settings, const InstructionSet &with,
                    LightParts &parts);
    // Then the light volumes of the media, which are the first of the bodies.
    void fill_volumes(std::vector<CroppedMedium> &media, bool grey, const InstructionSet &with,
                      LightParts &parts) const;
    [[nodiscard]] std::span<const LightView> views() const { return views_; }
    // The first of these: none of the others lights smoke.
    [[nodiscard]] std::size_t of_smoke() const { return of_smoke_; }
    [[nodiscard]] std::span<const Body> bodies() const { return bodies_; }
    // Of each body.
    [[nodiscard]] std::span<const glm::vec3> extinctions() const { return extinctions_; }
    // The map of one body in one light, null where that light cannot meet it, or is not hidden by it.
    [[nodiscard]] const LightMap *map(std::size_t light, std::size_t sample, std::size_t body) const;

private:
    // A map of one body from one sample of a light; all null where that light cannot meet it, and the last where no
    // sheet dims it.
    struct Map {
        std::shared_ptr<const LightMap> columns;
        std::shared_ptr<const SolidDepths> solids;
        std::shared_ptr<const SheetDepths> sheets;
        std::shared_ptr<const DepthTree> tree; // of solids, where rays are followed

        [[nodiscard]] LightMapView view() const;
    };

    [[nodiscard]] static Map build_map(const LightView &light, const glm::dvec3 &sample, const Body &body,
                                       const Surfaces &surfaces, const LightMapSettings &settings,
                                       const InstructionSet &with, LightParts &parts);
    // What of a light arrives in one of the bodies, as far as that is known without what is lit there.
    [[nodiscard]] Key arriving_key(std::size_t light, std::size_t own, bool grey) const;

    // A sky is one light, or where smoke can tell its parts apart many, and one for surfaces behind all others.
    void add_views(std::span<const Light> lights, const Surfaces &surfaces, LightParts &parts);

    std::optional<AirView> air_;
    std::vector<Body> bodies_;
    std::vector<glm::vec3> extinctions_;
    std::vector<std::vector<glm::vec3>> samples_; // of each light
    std::vector<std::vector<float>> shares_;      // of each sky
    std::vector<std::shared_ptr<const Sky>> skies_;
    std::size_t of_smoke_ = 0;
    std::vector<std::vector<Map>> maps_; // of each light: for each sample and body, the body first
    std::vector<std::vector<LightMapView>> map_views_;
    std::vector<LightView> views_;
};

// Views of media with the light volumes that they have by now. They point into `media`.
struct MediaViews {
    std::vector<std::vector<const float *>> light; // of each medium, the volume of each light
    std::vector<MediumView> views;
};
MediaViews views_of(std::span<const CroppedMedium> media, double step_length);

} // namespace sfumato
