// SPDX-License-Identifier: GPL-3.0-or-later
#include "solids/surfaces.hpp"

#include "scene/scene.hpp"

#include <algorithm>
#include <stdexcept>

namespace sfumato {

// One geometry for everything: a primitive number then says all that shading wants to know.
Surfaces::Surfaces(std::span<const Mesh> meshes) {
    std::size_t vertices = 0, triangles = 0;
    for (const Mesh &mesh : meshes) {
        vertices += mesh.vertices.size();
        triangles += mesh.triangles.size();
    }
    if (triangles == 0) {
        return;
    }
    device_.reset(rtcNewDevice(nullptr));
    if (!device_) {
        throw std::runtime_error("Embree could not start");
    }
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *positions = static_cast<glm::vec3 *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), vertices));
    auto *indices = static_cast<glm::uvec3 *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), triangles));
    if (positions == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw std::runtime_error("no memory for the triangles of the scene");
    }
    corner_normals_.reserve(9 * triangles);
    material_.reserve(triangles);
    const bool tangents =
        std::any_of(meshes.begin(), meshes.end(), [](const Mesh &mesh) { return !mesh.corner_tangents.empty(); });
    std::uint32_t first_vertex = 0;
    for (const Mesh &mesh : meshes) {
        positions = std::copy(mesh.vertices.begin(), mesh.vertices.end(), positions);
        indices = std::transform(mesh.triangles.begin(), mesh.triangles.end(), indices,
                                 [first_vertex](glm::uvec3 t) { return t + first_vertex; });
        first_vertex += static_cast<std::uint32_t>(mesh.vertices.size());
        for (const auto &corners : mesh.corner_normals) {
            for (const glm::vec3 &normal : corners) {
                corner_normals_.insert(corner_normals_.end(), {normal.x, normal.y, normal.z});
            }
        }
        for (std::size_t i = 0; tangents && i < mesh.triangles.size(); ++i) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const glm::vec3 tangent =
                    mesh.corner_tangents.empty() ? glm::vec3(0.0F) : mesh.corner_tangents[i][corner];
                corner_tangents_.insert(corner_tangents_.end(), {tangent.x, tangent.y, tangent.z});
            }
        }
        const auto first_material = static_cast<std::int32_t>(properties_.size() / MATERIAL_FLOATS);
        for (const std::uint32_t material : mesh.material) {
            material_.push_back(first_material + static_cast<std::int32_t>(material));
        }
        for (std::size_t i = 0; i < mesh.albedo.size(); ++i) {
            const glm::vec3 &albedo = mesh.albedo[i];
            const Gloss gloss = i < mesh.gloss.size() ? mesh.gloss[i] : Gloss{};
            const glm::vec3 &f0 = gloss.reflectance;
            const float rough = i < mesh.diffuse_roughness.size() ? mesh.diffuse_roughness[i] : -1.0F;
            const glm::vec3 emission = i < mesh.emission.size() ? mesh.emission[i] : glm::vec3(0.0F);
            properties_.insert(properties_.end(), {albedo.x, albedo.y, albedo.z, f0.x, f0.y, f0.z, gloss.edge,
                                                   gloss.alpha[0], gloss.alpha[1], gloss.apart ? 1.0F : 0.0F,
                                                   gloss.index, emission.x, emission.y, emission.z, rough});
        }
    }
    rtcCommitGeometry(geometry);
    scene_.reset(rtcNewScene(device_.get()));
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
}

SurfaceView Surfaces::view() const {
    return {scene_.get(), corner_normals_.data(), material_.data(), properties_.data(),
            corner_tangents_.empty() ? nullptr : corner_tangents_.data()};
}

} // namespace sfumato
