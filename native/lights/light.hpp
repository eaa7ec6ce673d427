// SPDX-License-Identifier: GPL-3.0-or-later
// A light in a frame: what the kernels have to know of it, and the points that stand for all of it. What depends on the
// kind of a light is in this room: of the camera's side in light.cpp, of a point's in lights_lanes.hpp, of a surface's
// in shading_lanes.cpp. No other file asks for it.
#pragma once

#include "scene/light.hpp"
#include "solids/ray_scene.hpp"

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct Ball; // maps/body.hpp
struct Body;
struct LightMapView; // maps/map_view.hpp

// Owns nothing.
struct LightView : Light {
    // Light's radius, and its half axes, are those of the disk that it shows: of a sun sin(angle / 2) long.
    float cone_cosine = -2.0F; // of a spot's edge; -2 for no spot
    float facing2 = 0.0F;      // radius^2 where a sphere looks like a disk, else 0
    float spread_cotangent = 0.0F;
    float area = 0.0F;                  // of rectangles, ellipses and polygons
    float size2 = 0.0F;                 // of falloff()
    std::span<const glm::vec3> samples; // points; of a sun, directions towards it
    RayScene solids;                    // that may hide it
    RayScene sheets;                    // that may dim it
    const LightMapView *maps = nullptr; // for each sample and body; the body runs fastest

    // Whether its rays are parallel: then its direction is the same everywhere, and it does not fall off.
    [[nodiscard]] bool parallel() const { return kind == Kind::SUN; }
    // Whether it is a face of a mesh that glows: what such a mesh throws, each of its faces blurs for the others.
    [[nodiscard]] bool of_mesh() const { return kind == Kind::POLYGON; }
    [[nodiscard]] bool of_many() const { return of_mesh() || part; }
};

// What a kernel has to know of a light, without its samples and maps. `cell` is the size of the smallest cell of any
// body.
LightView view_of(const Light &light, double cell);

// Points at which a light stands for all of itself, no more of them than its penumbra behind the smoke asks for; of a
// sun, directions towards it.
// Where no body is, air still knows a light's size.
std::vector<glm::vec3> light_samples(const LightView &light, std::span<const Body> bodies, int most, bool in_air);

// The standard deviation, in metres, of the bell that stands for the shadow of one point of the smoke in a light, over
// as much air as half the smoke is wide.
double shadow_blur(const LightView &light, const Body &body);

// Whether light from one of its samples can meet what is in the ball at all: not behind an area light, not outside a
// spot's cone.
bool meets(const LightView &light, const glm::dvec3 &sample, const Ball &ball);

// Two axes across a direction, and the direction.
glm::dmat3 axes_of(const glm::dvec3 &direction);

} // namespace sfumato
