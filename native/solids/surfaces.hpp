// SPDX-License-Identifier: GPL-3.0-or-later
// All meshes of a scene as one Embree scene, with the attributes that shading reads.
#pragma once

#include "solids/surface_view.hpp"

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Mesh;

class Surfaces {
public:
    explicit Surfaces(std::span<const Mesh> meshes);

    [[nodiscard]] SurfaceView view() const;

private:
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_; // null where there are no triangles
    std::vector<float> corner_normals_;
    std::vector<std::int32_t> material_;
    std::vector<float> properties_; // of materials
    std::vector<float> corner_tangents_;
};

} // namespace sfumato
