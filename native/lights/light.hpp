// SPDX-License-Identifier: GPL-3.0-or-later
// A light in a frame: what the kernels have to know of it, and the points that stand for all of it. What depends on the
// kind of a light is in this room: of the camera's side in light.cpp, of a point's in lights_lanes.hpp, of a surface's
// in shading_lanes.cpp. No other file asks for it.
#pragma once

#include "lights/sky.hpp"
#include "scene/light.hpp"
#include "solids/ray_scene.hpp"

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct Ball; // maps/body.hpp
struct Body;
struct LightMapView; // maps/map_view.hpp

// Owns nothing but its share of a sky's image.
struct LightView : Light {
    // Light's radius, and its half axes, are those of the disk that it shows: of a sun sin(angle / 2) long.
    float cone_cosine = -2.0F; // of a spot's edge; -2 for no spot
    float facing2 = 0.0F;      // radius^2 where a sphere looks like a disk, else 0
    float spread_cotangent = 0.0F;
    float area = 0.0F;                  // of rectangles, ellipses and polygons
    float size2 = 0.0F;                 // of falloff()
    float concentration = 1.0F;         // how far its light is of one direction: henyey_greenstein_of_cap
    std::span<const glm::vec3> samples; // points; of a sun or a sky, directions towards it
    float finer = 1.0F;                 // of how many times as many these are some
    std::span<const float> shares;      // of a sky: of all that it sends, what each sample stands for
    const Sky *sky = nullptr;           // of a sky that differs from side to side
    RayScene solids;                    // that may hide it
    RayScene sheets;                    // that may dim it
    const LightMapView *maps = nullptr; // for each sample and body; the body runs fastest

    // Whether its rays are parallel: then its direction is the same everywhere, and it does not fall off.
    [[nodiscard]] bool parallel() const { return kind == Kind::SUN || surrounds(); }
    // Whether it comes from everywhere: then its direction says nothing, and each of its samples has its own.
    [[nodiscard]] bool surrounds() const { return kind == Kind::SKY; }
    // Whether it is a face of a mesh that glows: what such a mesh throws, each of its faces blurs for the others.
    [[nodiscard]] bool of_mesh() const { return kind == Kind::POLYGON; }
    [[nodiscard]] bool of_many() const { return of_mesh() || part; }
};

// What a kernel has to know of a light, without its samples and maps. `cell` is the size of the smallest cell of any
// body.
LightView view_of(const Light &light, double cell);

// All around the same, of a radiance of one.
LightView white_surroundings();

inline bool surrounds(const Light &light) {
    return light.kind == LightKind::SKY;
}

// Directions to all of a sky where another light has `most` points.
int sky_samples(int most);

// Points at which a light stands for all of itself, no more of them than its penumbra behind the smoke asks for; of a
// sun, directions towards it. Where no body is, air still knows a light's size. Of a sky, which casts no edge that
// `most` directions would show, twice as many.
std::vector<glm::vec3> light_samples(const LightView &light, std::span<const Body> bodies, int most, bool in_air);

// One of them, by its place on a square [-1, 1]^2 that all of the light shares evenly; not of a sky.
glm::vec3 light_point(const LightView &light, std::span<const Body> bodies, const glm::dvec2 &square);

// A sky as lights whose colours and directions smoke can tell apart: eighths of it, and its suns.
std::vector<Light> parts_of_sky(const Light &light, const Sky *sky);

// What comes from around each of the directions to all of a sky, W/m^2, before its gain.
std::vector<glm::dvec3> sky_fluence(const LightView &light, int most);

// What each of a sky's samples stands for of that, and by it how strong the light is, and from where. Sets `shares`.
void weigh_sky(LightView &light, std::span<const glm::dvec3> fluence, std::vector<float> &shares);

// The standard deviation, in metres, of the bell that stands for the shadow of one point of the smoke in a light, over
// as much air as half the smoke is wide.
double shadow_blur(const LightView &light, const Body &body);

// Whether light from one of its samples can meet what is in the ball at all: not behind an area light, not outside a
// spot's cone.
bool meets(const LightView &light, const glm::dvec3 &sample, const Ball &ball);

// Two axes across a direction, and the direction.
glm::dmat3 axes_of(const glm::dvec3 &direction);

} // namespace sfumato
