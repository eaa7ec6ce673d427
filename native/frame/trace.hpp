// SPDX-License-Identifier: GPL-3.0-or-later
// One packet of rays through a frame: what the kernel reads and what it answers. Views own nothing.
#pragma once

#include "lights/light.hpp"
#include "media/medium_view.hpp"
#include "solids/surface_view.hpp"
#include "text/dispatch.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

struct FrameView {
    std::array<glm::vec3, 6> camera; // near0, near_u, near_v, far0, far_u, far_v
    SurfaceView surfaces;
    std::span<const LightView> lights;
    std::span<const MediumView> media;
    bool grey = true; // all extinctions are: one march serves all colours
    glm::vec3 background{0.0F};
    // In use, the outputs that are shadows are handed over as a picture for an overlay: the smoke's radiance, and what
    // it leaves of a surface that shadows take this share of the light from.
    std::optional<float> shadow_strength;
};

// What trace() computes for a surface, and whether it marches through the smoke before it.
enum class Output : std::uint8_t {
    PICTURE,      // its radiance, behind the smoke
    SURFACES,     // its radiance, as if there were no smoke between it and the eye
    SMOKE_SHADOW, // the share of its light that smoke takes
    ALL_SHADOWS   // the share of its light that smoke and solids take
};

// Where on the image, and on every light, the shadows of solids are looked at: as Packet's, for each lane.
struct ShadowSample {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES];
};

// Samples in, light out; as many as the kernel has lanes.
struct Packet {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];             // where on the image, in [0, 1]
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES]; // where on every light, in [0, 1]^2
    alignas(64) float active[MAX_LANES];                      // 1, or 0 for lanes to spare
    // Shadows of solids are averaged over these, as they fall on the plane of the surface that the ray itself meets.
    // Where there are none, from the ray itself, and light_u and light_v.
    std::span<const ShadowSample> shadows;
};

struct Traced {
    alignas(64) float radiance[3][MAX_LANES];
    alignas(64) float alpha[MAX_LANES];
    alignas(64) float surface[MAX_LANES]; // mean radiance of the surface, were there no smoke; or mean share in shadow
    alignas(64) float unshadowed[MAX_LANES]; // radiance, or irradiance, were there no shadows at all
    alignas(64) float seen[MAX_LANES];       // the share of it that the smoke leaves
    alignas(64) float behind[3][MAX_LANES];  // with shadow_strength: the share left of what lies behind the smoke
    alignas(64) float distance[MAX_LANES];   // to the first surface, or the ray's reach
};

struct FrameKernels {
    void (*trace)(const FrameView &, Output, const Packet &, Traced &);
};

const FrameKernels &frame_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
