// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes of a scene as Embree scenes, one for each shape and one of all its places, with what shading reads.
#pragma once

#include "lights/gloss_curves.hpp"
#include "scene/kept.hpp"
#include "solids/surface_view.hpp"

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Instances; // scene/scene.hpp
struct Shape;

// Embree's objects are counted by Embree.
struct ReleaseEmbree {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using EmbreeDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseEmbree>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseEmbree>;

// A shape, ready to be met by rays in its own space.
class Solid {
public:
    Solid(RTCDevice device, std::shared_ptr<const Shape> shape);
    [[nodiscard]] RTCScene scene() const { return scene_.get(); }
    [[nodiscard]] const Shape &shape() const { return *shape_; }

private:
    std::shared_ptr<const Shape> shape_; // whose arrays Embree reads
    std::vector<glm::vec3> padded_;      // its vertices, where Embree cannot read past the end of the shape's own
    EmbreeScene scene_;
};

// Where the solids of a scene stand, for rays in the world. What stands in many places, or has many triangles, is an
// instance of its solid. All else is copied there: rays meet that sooner, and it is soon copied again when it moves.
struct Places {
    std::vector<std::shared_ptr<const void>> kept; // what Embree refers to: solids, and the shapes of copies
    EmbreeScene scene;
    bool instanced = false;
};

// What was made of shapes and of gloss before.
class Solids {
public:
    explicit Solids(int threads = 0); // of Embree's own work; 0: as many as there are
    std::shared_ptr<const Places> places(std::span<const Instances> meshes); // null where there are no triangles
    std::shared_ptr<const GlossCurves> curves(const Gloss &gloss);
    void end_round();
    // Ever.
    [[nodiscard]] std::size_t made() const { return solids_.made(); }
    [[nodiscard]] std::size_t places_made() const { return places_.made(); }

private:
    std::shared_ptr<const Solid> solid(const std::shared_ptr<const Shape> &shape);
    void attach(const Instances &mesh, Places &places, unsigned &number);

    EmbreeDevice device_;
    int threads_;
    Kept<Solid> solids_;
    Kept<Places> places_;
    Kept<GlossCurves> curves_;
};

// All meshes of a scene.
class Surfaces {
public:
    Surfaces(std::span<const Instances> meshes, Solids &solids);
    explicit Surfaces(std::span<const Instances> meshes);

    [[nodiscard]] SurfaceView view() const;
    [[nodiscard]] const std::shared_ptr<const Places> &places() const { return places_; } // null without triangles

private:
    std::shared_ptr<const Places> places_;
    std::vector<PlaceView> views_;  // of each place
    std::vector<float> properties_; // of materials
    bool tangents_ = false;
};

} // namespace sfumato
