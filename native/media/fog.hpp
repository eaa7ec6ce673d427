// SPDX-License-Identifier: GPL-3.0-or-later
// Fog: what fills closed meshes evenly, ready to be met by rays.
//
// A ray is inside from a front on up to the next back; where shells of one mesh overlap, until it has left them all.
// What it is in where it starts follows from what it leaves later on. Of an open mesh a front without a back holds
// nothing, and a ray that starts outside of the mesh's box starts outside of it.
#pragma once

#include "media/fog_view.hpp"
#include "scene/scene.hpp"
#include "solids/all_hits.hpp"
#include "solids/surfaces.hpp"

#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// An Air that has a shape, in all its places.
struct Fog {
    Air air; // whose arrays the views read
    std::shared_ptr<const Places> places;
    std::vector<PlaceView> views;
    std::vector<FogBox> boxes; // around each place
    float outwards = 1.0F;     // FogView

    [[nodiscard]] FogView view() const { return {view_of(places), views.data(), boxes.data(), outwards}; }
    [[nodiscard]] FogBox box() const; // around all
    [[nodiscard]] glm::vec3 extinction() const { return air.rayleigh + air.mie + air.absorption; }
};

// Those that can be seen or dim light: what is not even there, has no volume anywhere, or does nothing is left out.
std::vector<std::shared_ptr<const Fog>> fogs_of(std::span<const Air> air, Solids &solids);

// Of a ray that has a lane among hits.
struct FogRay {
    glm::vec3 origin, direction;
};

// From all that rays meet of a fog, however far, to where they are in it, lane by lane, near first. Hits are put in
// order.
void stretches_of(const FogView &fog, std::span<const FogRay> rays, std::vector<Hit> &hits,
                  std::vector<FogStretch> &out);

// The same of up to four rays, which it follows; directions have any length, of which distances are shares. `hits` is
// memory to work in.
void follow(const FogView &fog, std::span<const FogRay> rays, std::vector<Hit> &hits, std::vector<FogStretch> &out);

} // namespace sfumato
