// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes of a scene as Embree scenes, one for each shape and one of all its places, with what shading reads.
#pragma once

#include "lights/gloss_curves.hpp"
#include "scene/kept.hpp"
#include "solids/embree.hpp"
#include "solids/sheets.hpp"
#include "solids/surface_view.hpp"

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct Gloss; // scene/scene.hpp
struct Light;

// Embree's objects are counted by Embree.
struct ReleaseEmbree {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using EmbreeDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseEmbree>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseEmbree>;

// A shape, ready to be met by rays in its own space; of a sheet, every hit may be asked for.
class Solid {
public:
    Solid(RTCDevice device, std::shared_ptr<const Shape> shape, bool sheet);
    [[nodiscard]] RTCScene scene() const { return scene_.get(); }
    [[nodiscard]] const Shape &shape() const { return *shape_; }

private:
    std::shared_ptr<const Shape> shape_;         // whose arrays Embree reads
    std::vector<std::vector<glm::vec3>> padded_; // vertices, where Embree cannot read past the end of the shape's own
    EmbreeScene scene_;
};

// Where the solids of a scene stand, for rays in the world. What stands in many places, or has many triangles, is an
// instance of its solid. All else is copied there: rays meet that sooner, and it is soon copied again when it moves.
struct Places {
    std::vector<std::shared_ptr<const void>> kept; // what Embree refers to: solids, and the shapes of copies
    EmbreeScene scene;
    bool instanced = false;
};

struct Box {
    glm::dvec3 low{0.0}, high{0.0};
};

// What was made of shapes and of gloss before.
class Solids {
public:
    explicit Solids(int threads = 0); // of Embree's own work; 0: as many as there are
    // Of the meshes whose turn it is, under their numbers among all; null where these have no triangles.
    std::shared_ptr<const Places> places(const Divided &all, const std::vector<bool> &which);
    std::shared_ptr<const GlossCurves> curves(const Gloss &gloss);
    std::shared_ptr<const GlossTable> table(const Gloss &gloss);
    // Of those of the scene's meshes that are opaque in part.
    Kept<Shape> &parts() { return parts_; }
    void end_round();
    // Ever.
    [[nodiscard]] std::size_t made() const { return solids_.made(); }
    [[nodiscard]] std::size_t places_made() const { return places_.made(); }

private:
    std::shared_ptr<const Solid> solid(const std::shared_ptr<const Shape> &shape, bool sheet);
    void attach(const Instances &mesh, bool sheet, Places &places, unsigned number);

    EmbreeDevice device_;
    int threads_;
    Kept<Shape> parts_;
    Kept<Solid> solids_;
    Kept<Places> places_;
    Kept<GlossCurves> curves_;
    Kept<GlossTable> tables_;
};

RayScene view_of(const std::shared_ptr<const Places> &places);
PlaceView view_of(const Shape &shape, const glm::mat4 &to_world, std::int32_t first_material);

// All meshes of a scene, and which of them rays meet: those of the camera, and those that ask what hides a light. Where
// nothing is left out these are one. What lets light through stands apart.
class Surfaces {
public:
    // A place of a shape that lets light through, which the camera sees: its number, and that of its first material.
    struct Sheet {
        std::shared_ptr<const Shape> shape;
        glm::mat4 to_world;
        std::uint32_t place, first_material;
    };

    Surfaces(std::span<const Instances> meshes, std::span<const Light> lights, Solids &solids);

    [[nodiscard]] SurfaceView view() const;
    // Whether any place or shape is elsewhere while the shutter is open, and the views of all places at such a time.
    [[nodiscard]] bool moves() const { return moves_; }
    [[nodiscard]] std::vector<PlaceView> places_at(float time) const;
    [[nodiscard]] std::size_t place_count() const { return views_.size(); }
    // Whether none that the camera sees is a holdout or a catcher; whether it sees any sheet.
    [[nodiscard]] bool opaque() const { return opaque_; }
    [[nodiscard]] bool sheets() const { return sheets_ != nullptr; }
    // Of all that stands there; none where nothing does.
    [[nodiscard]] std::optional<Box> bounds() const;
    [[nodiscard]] std::span<const Sheet> sheet_places() const { return sheet_places_; }
    // Adds to a key all that dims a light: of each material in turn the three colours, and what of them varies.
    void add_dimming(Key &key) const;
    // Whether all of these are grey.
    [[nodiscard]] bool dims_greyly() const;
    // What hides a light from others, and what dims it; null where nothing does.
    [[nodiscard]] std::shared_ptr<const Places> hiding(const Light &light) const;
    [[nodiscard]] std::shared_ptr<const Places> dimming(const Light &light) const;

private:
    void add_varying(const Materials &materials, std::size_t first_row, Solids &solids);

    std::shared_ptr<const Places> all_, seen_, sheets_, catchers_;
    std::map<LightSets, std::shared_ptr<const Places>> hiding_, dimming_; // by Reach::hidden_by
    bool plain_ = true, opaque_ = true;
    std::vector<PlaceView> views_; // of each place
    std::vector<Sheet> sheet_places_;
    std::vector<float> properties_; // of materials
    std::vector<float> transmittances_;
    std::vector<Varying> varying_;                                 // what of materials varies: of these
    std::vector<std::shared_ptr<const void>> patterns_;            // and the tables of their gloss
    std::vector<std::shared_ptr<const Pattern>> dimming_patterns_; // those of them that dim a light
    std::deque<std::vector<float>> values_;                        // of places
    bool tangents_ = false;
    bool more_ = false;
    bool moves_ = false;
    // Of places that move, by their numbers, their matrices at even times.
    std::map<std::size_t, std::vector<glm::mat4>> moving_;
};

} // namespace sfumato
