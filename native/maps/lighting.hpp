// SPDX-License-Identifier: GPL-3.0-or-later
// The lights of a frame: how often each is sampled, its light maps, and the light volumes of the smoke.
#pragma once

#include "lights/light_view.hpp"
#include "maps/light_map.hpp"
#include "media/medium.hpp"

#include <span>
#include <vector>

namespace sfumato {

struct Light;

struct LightingSettings {
    LightMapSettings map;
    int most_samples = 16; // of a light whose extent blurs the smoke's shadow
};

// Everything that the lights of a frame need, and the views of it.
class Lighting {
public:
    Lighting() = default;
    // Fills the light volumes of `media` too.
    Lighting(std::span<const Light> lights, std::vector<CroppedMedium> &media, const SurfaceView &surfaces,
             const LightingSettings &settings, bool grey, const InstructionSet &with);

    [[nodiscard]] std::span<const LightView> views() const { return views_; }
    // The map of one medium in one light, null where that light cannot meet it.
    [[nodiscard]] const LightMap *map(std::size_t light, std::size_t sample, std::size_t medium) const;

private:
    std::size_t media_ = 0;
    std::vector<std::vector<glm::vec3>> samples_; // of each light
    std::vector<std::vector<LightMap>> maps_;     // of each light: for each sample and medium, the medium first
    std::vector<std::vector<LightMapView>> map_views_;
    std::vector<LightView> views_;
};

// What a kernel has to know of a light, without its samples and maps. `cell` is the size of the smallest cell of smoke.
LightView view_of(const Light &light, double cell);

// Points at which a light stands for all of itself, no more of them than its penumbra behind the smoke asks for; of a
// sun, directions towards it.
std::vector<glm::vec3> light_samples(const LightView &light, std::span<const CroppedMedium> media, int most);

// Views of media with the light volumes that they have by now.
std::vector<MediumView> views_of(std::span<const CroppedMedium> media, double step_length);

} // namespace sfumato
