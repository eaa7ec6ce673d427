// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lights/gloss_curves.hpp"
#include "scene/visibility.hpp"
#include "solids/ray_scene.hpp"
#include "textures/pattern_place.hpp"

#include <cstdint>

namespace sfumato {

struct Pattern;    // textures/pattern.hpp
struct GlossTable; // lights/gloss_curves.hpp

constexpr int MAX_LOBES = 4; // of gloss

// Of a layer of gloss as lanes gather it: numbers, and of GlossCurves what it leaves, and its gain in each colour.
namespace lobe_row {
enum {
    REFLECTANCE = 0,
    DIP = 3,
    EDGE = 6,
    ALPHA_X,
    ALPHA_Y,
    APART,
    INDEX,
    BECKMANN,
    SHARE,
    TURN,
    TURN_COSINE,
    TURN_SINE,
    LEFT
};
constexpr int GAIN = LEFT + CURVE_POINTS;
constexpr int FLOATS = GAIN + 3 * CURVE_POINTS;
} // namespace lobe_row

// Of a material: what is diffuse, its number for a compositor, whether lights stand for what it emits, the number of
// what varies of it, from 1 on, or 0, and its layers of gloss from the top, of which only so many are there.
namespace material_row {
enum {
    ALBEDO = 0,
    EMISSION = 3,
    AGAIN = 6,
    TRANSMITTANCE = 9,
    TRANSLUCENCE = 12,
    SHEEN = 15,
    SPREADING = 18,
    ROUGHNESS,
    SHEEN_SPREADING,
    SHEEN_ROUGHNESS,
    NUMBER,
    LAMP,
    PATTERN,
    LOBES,
    FIRST_LOBE
};
constexpr int FLOATS = FIRST_LOBE + MAX_LOBES * lobe_row::FLOATS;
} // namespace material_row

// Views own nothing. One place of a shape: its arrays, as scene.hpp has them, null where it has none, and what takes
// its normals and tangents to the world, column by column.
struct PlaceView : PatternPlace {
    const float *corner_normals = nullptr;
    const float *vertex_normals = nullptr;
    const float *corner_tangents = nullptr;
    const std::uint32_t *material = nullptr;
    std::int32_t first_material = 0; // of its rows among all properties
    float object_index = 0.0F;
    float normals_to_world[9];
    Visibility visibility;
};

// What of a material varies; and of its layers of gloss, what their curves are made of where these do.
struct Varying {
    const Pattern *pattern = nullptr;
    const GlossTable *gloss[MAX_LOBES] = {};
};

struct SurfaceView {
    RayScene all;                      // places
    RayScene seen;                     // by the camera, of what is opaque
    RayScene sheets;                   // by the camera, of what lets light through
    RayScene catchers;                 // of shadows
    bool plain = true;                 // whether every place is shown, lit by all, and hides all
    const PlaceView *places = nullptr; // by Embree's number of the instance, or else of the geometry
    const float *properties = nullptr; // a material_row each
    bool tangents = false;             // whether any shape has tangents
    const Varying *varying = nullptr;  // by their numbers, from 1 on; null where nothing varies
    bool more = false;                 // whether any material is translucent or has a sheen
};

} // namespace sfumato
