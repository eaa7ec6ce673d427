// SPDX-License-Identifier: GPL-3.0-or-later
// What rays through a frame bring home, layer by layer, a packet at a time: what the kernels read and what they answer.
// Views own nothing.
#pragma once

#include "frame/bounce.hpp"
#include "frame/drawn.hpp"
#include "frame/events.hpp"
#include "lights/light.hpp"
#include "media/air.hpp"
#include "media/fog_view.hpp"
#include "media/medium_view.hpp"
#include "media/particle_view.hpp"
#include "media/strand_view.hpp"
#include "solids/surface_view.hpp"
#include "text/dispatch.hpp"

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

// How a picture fades with the distance from the eye: from `start` on, over `depth`, both in metres, by a power of the
// share of the way. Of an orthographic camera what counts is the distance along its axis, of others, whose `axis` is 0,
// the way to the eye.
struct Mist {
    glm::vec3 eye{0.0F}, axis{0.0F};
    float start = 0.0F, depth = 1.0F, power = 1.0F;
};

struct FrameView {
    std::array<glm::vec3, 6> camera; // near0, near_u, near_v, far0, far_u, far_v
    SurfaceView surfaces;
    std::span<const LightView> lights;
    std::size_t smoke_lights = 0; // the first of them: what is marched asks for no more
    std::span<const MediumView> media;
    std::span<const MediumView> seen_media; // by the camera: the first of them
    ParticlesView particles;
    bool sorted = false;                    // whether anything else than grids may lie before a surface
    std::size_t first_hair = 0;             // among the bodies: hair is in other renderers' pictures, too
    std::span<const glm::vec3> extinctions; // of all bodies that have light maps
    bool grey = true;                       // all of these are: one march serves all colours
    StrandsView strands;
    std::span<const AirView> air;       // the world's comes first, then that of
    std::span<const FogView> fogs;      // these,
    int first_fog = 0;                  // whose bodies begin here
    const AirView *world_air = nullptr; // it, or null
    int air_body = -1;                  // of the world's air, among the bodies; or none
    glm::vec3 background{0.0F};
    SkyImageView backdrop; // which it multiplies, or none
    float background_alpha = 0.0F;
    float shadow_strength = 1.0F; // of an overlay: the share of a surface's light that shadows take at most
    Mist mist;                    // where that is asked for
    BounceView bounces;
    float least_alpha = 0.5F; // of a sheet of which passes tell
    // Of a march that asks the lights themselves, in one of so many steps, for all of them; 0: it asks light volumes.
    int asks_every = 0, asks_first = 0;
};

enum class Layer : std::uint16_t {
    RADIANCE = 1,     // of the first surface or the background, in all shadows, but as if no smoke stood before it
    SMOKE_SHADOW = 2, // the share of its light that smoke takes
    ALL_SHADOWS = 4,  // the share of its light that smoke and solids take
    SMOKE = 8,        // what the smoke before the surface sends to the eye, and what it leaves of all behind it
    // Of a picture, for compositors (PassLayers):
    POSITION = 16,
    NORMAL = 32,
    MIST = 64,
    OBJECT_INDEX = 128,
    MATERIAL_INDEX = 256,
    SMOKE_ALONE = 512,
    LEFT_BY_SMOKE = 1024, // the share of a surface's radiance that smoke leaves it
    LEFT_BY_ALL = 2048,   // the share of the light that it reflects that smoke and solids leave it
    // Of what is asked for of surfaces: as if there were no sheets before them.
    SHEETLESS = 4096
};

// What a picture asks for: one layer of the surface, and the smoke or not. With the smoke the two are composited:
// before the radiance, a finished picture; before a shadow, what an overlay adds to another picture of the surfaces,
// and what it leaves of that.
struct LayerSet {
    std::uint16_t bits = 0;

    constexpr LayerSet() = default;
    constexpr LayerSet(Layer layer) // NOLINT(google-explicit-constructor): one layer is a set
        : bits(static_cast<std::uint16_t>(layer)) {}
    [[nodiscard]] constexpr bool has(Layer layer) const { return (bits & static_cast<std::uint16_t>(layer)) != 0; }
    [[nodiscard]] constexpr bool passes() const {
        constexpr int FIRST = static_cast<int>(Layer::POSITION), END = static_cast<int>(Layer::SHEETLESS);
        return bits % END >= FIRST;
    }
    [[nodiscard]] constexpr bool shadow() const { return has(Layer::SMOKE_SHADOW) || has(Layer::ALL_SHADOWS); }
    [[nodiscard]] constexpr bool overlay() const { return shadow() && has(Layer::SMOKE); }
    [[nodiscard]] constexpr LayerSet with(Layer layer) const {
        LayerSet both = *this;
        both.bits = static_cast<std::uint16_t>(both.bits | static_cast<std::uint16_t>(layer));
        return both;
    }
};

// Whether what lies before a surface is merged: with the smoke, or without it what sheets there are.
inline bool merges(const FrameView &view, LayerSet wanted) {
    const bool sheets = wanted.has(Layer::RADIANCE) && view.surfaces.sheets.scene != nullptr;
    return view.sorted && (wanted.has(Layer::SMOKE) || sheets);
}

constexpr LayerSet PICTURE = LayerSet(Layer::RADIANCE).with(Layer::SMOKE);

// Where on the image, and on every light, the shadows of solids are looked at: as Packet's, for each lane.
struct ShadowSample {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES];
};

// Samples, as many as the kernels have lanes.
struct Packet {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];             // where on the image, in [0, 1]
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES]; // where on every light, in [0, 1]^2
    alignas(64) float active[MAX_LANES];                      // 1, or 0 for lanes to spare
    float beside_u = 0.0F, beside_v = 0.0F;                   // how far on the image the next pixels are
    float stands_for = 1.0F;                                  // the width of what each sample is a mean of, pixels
    float reach = 1.5F; // of what a sample stands for around itself, pixels: of what is thinner than these
    // Shadows of solids are averaged over these, as they fall on the plane of the surface that the ray itself meets.
    // Where there are none, from the ray itself, and light_u and light_v.
    std::span<ShadowSample> shadows;
    // From each sample so many rays look for light of other surfaces, around a point of the square that is its own
    // among its neighbours; none where these told already.
    alignas(64) float look_u[MAX_LANES], look_v[MAX_LANES];
    int looks = 4;
    std::size_t sky_looks = 64; // at most, in which directions solids may hide a sky
    // In air every one of so many samples of a light is followed, from this one on: what makes up a pixel takes turns.
    std::size_t turn = 0, turns = 1;
};

// What a compositor is given of the first surface on each ray; 0 where there is none. Of these, what is asked for.
struct PassLayers {
    alignas(64) float position[3][MAX_LANES];
    alignas(64) float normal[3][MAX_LANES]; // shading normal, towards the eye
    alignas(64) float mist[MAX_LANES];      // 1 where there is no surface
    alignas(64) float object_index[MAX_LANES];
    alignas(64) float material_index[MAX_LANES];
    alignas(64) float open[3][MAX_LANES];       // the radiance, were there no smoke; the background's too
    alignas(64) float past_smoke[3][MAX_LANES]; // the same in the smoke's shadow
    alignas(64) float shadowed[3][MAX_LANES];   // the light that is reflected, in all shadows
    alignas(64) float unshadowed[3][MAX_LANES]; // were there no shadows at all
    alignas(64) float smoke[3][MAX_LANES];      // before the surface, without fragments; and what it leaves
    alignas(64) float left[3][MAX_LANES];
};

// What of a sky, and of other surfaces, surfaces send to the eye: neighbouring pixels look in different directions, and
// are put together.
struct SkyLayers {
    struct Part {
        alignas(64) float light[3][MAX_LANES]; // were it hidden by no solid; past smoke in the end
        alignas(64) float all[3][MAX_LANES];   // what a few directions bring, and
        alignas(64) float seen[3][MAX_LANES];  // what solids leave of that
        alignas(64) float open[MAX_LANES];     // the mean of the light's colours, without smoke
        // Where surfaces light each other: of what others send, the share that is sent on, and what rays find of it.
        alignas(64) float weight[3][MAX_LANES];
        alignas(64) float found[3][MAX_LANES];
    };
    Part dull, gloss;
    alignas(64) float normal[3][MAX_LANES]; // shading normal; anything where nothing is hit
};

// What becomes of a packet. Each stage writes its own.
struct Layers {
    // Surfaces: the first on each ray.
    alignas(64) float hit[MAX_LANES];        // 1, or 0 where there is none
    alignas(64) float cover[MAX_LANES];      // the alpha of what lies behind the smoke
    alignas(64) float caught[MAX_LANES];     // by a catcher: the mean share of its light that others take; else 0
    alignas(64) float distance[MAX_LANES];   // to it, or the ray's reach
    alignas(64) float surface[3][MAX_LANES]; // the layer that is asked for
    alignas(64) float open[MAX_LANES]; // the mean of the colours of the radiance, were there no smoke; or of the share
    alignas(64) float unshadowed[MAX_LANES]; // radiance, or irradiance, were there no shadows at all
    SkyLayers sky;
    // March, and merge: what lies before it.
    alignas(64) float smoke[3][MAX_LANES];
    alignas(64) float through[3][MAX_LANES];
    // Composite.
    alignas(64) float picture[4][MAX_LANES]; // premultiplied RGBA; of a shadow or an overlay the alpha is `hit`
    alignas(64) float behind[3][MAX_LANES];  // of an overlay: the share left of what lies behind the smoke
    alignas(64) float seen[MAX_LANES];       // the share of `open` that smoke leaves: before the surface and on it
    alignas(64) float fine[MAX_LANES];       // the share that is covered by what may be finer than pixels
    // Only where passes are asked for.
    PassLayers *passes = nullptr;
    // Only where a frame has what is sorted.
    Events *events = nullptr;
};

struct FrameKernels {
    void (*surfaces)(const FrameView &, LayerSet, const Packet &, Layers &);
    void (*sheets)(const FrameView &, LayerSet, const Packet &, Layers &);
    void (*strands)(const FrameView &, const Packet &, Layers &);
    void (*particles)(const FrameView &, const Packet &, Layers &);
    void (*march)(const FrameView &, const Packet &, Layers &);
    void (*air)(const FrameView &, const Packet &, Layers &);
    void (*merge)(const FrameView &, const Packet &, Layers &);
    DrawnKernels drawn;
    BounceKernels bounce;
};

const FrameKernels &frame_kernels(const InstructionSet &with = instruction_set());

// For the image of the smoke alone, what a march or a merge has written.
void keep_smoke(Layers &layers);

// Of `lanes` lanes; of a frame without smoke the march's layers are not read.
void composite(const FrameView &view, LayerSet wanted, int lanes, Layers &layers);

} // namespace sfumato
