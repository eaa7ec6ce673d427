// SPDX-License-Identifier: GPL-3.0-or-later
// The lights of a frame: how often each is sampled, its light maps, and the light volumes of the smoke.
#pragma once

#include "lights/light.hpp"
#include "maps/light_map.hpp"
#include "media/medium.hpp"
#include "scene/kept.hpp"
#include "solids/surfaces.hpp"

#include <memory>
#include <span>
#include <vector>

namespace sfumato {

// What was made of lights and smoke before.
struct LightParts {
    Kept<LightMap> maps;
    Kept<SolidDepths> solids;
    Kept<LightVolume> volumes;

    void end_round();
};

// Everything that the lights of a frame need, and the views of it.
class Lighting {
public:
    Lighting() = default;
    // Of each light its view and, at most most_samples of them, the points at which it is sampled.
    Lighting(std::span<const Light> lights, std::span<const CroppedMedium> media, const Surfaces &surfaces,
             int most_samples);
    // The maps of every medium from every sample of every light, then the light volumes of the media.
    void build_maps(std::span<const CroppedMedium> media, const Surfaces &surfaces, const LightMapSettings &settings,
                    const InstructionSet &with, LightParts &parts);
    void fill_volumes(std::vector<CroppedMedium> &media, bool grey, const InstructionSet &with,
                      LightParts &parts) const;

    [[nodiscard]] std::span<const LightView> views() const { return views_; }
    // The map of one medium in one light, null where that light cannot meet it, or is not hidden by it.
    [[nodiscard]] const LightMap *map(std::size_t light, std::size_t sample, std::size_t medium) const;

private:
    // A map of one medium from one sample of a light; both null where that light cannot meet it.
    struct Map {
        std::shared_ptr<const LightMap> columns;
        std::shared_ptr<const SolidDepths> solids;
    };

    [[nodiscard]] Map build_map(const LightView &light, const glm::dvec3 &sample, const CroppedMedium &medium,
                                const Surfaces &surfaces, const LightMapSettings &settings, const InstructionSet &with,
                                LightParts &parts) const;
    [[nodiscard]] Key volume_key(std::size_t light, std::size_t own, std::span<const CroppedMedium> media,
                                 bool grey) const;

    std::size_t media_ = 0;
    std::vector<std::vector<glm::vec3>> samples_; // of each light
    std::vector<std::vector<Map>> maps_;          // of each light: for each sample and medium, the medium first
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
