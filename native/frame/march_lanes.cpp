// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the media: the smoke before the first surface of each ray of a packet. The march itself is text that the
// GPU has too; here is what it asks of grids and lights.
#include "frame/layers.hpp"
#include "maps/arriving_lanes.hpp"
#include "text/lanes.hpp"
#include "text/march_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {
namespace {

// Of what light volumes hold (light_box).
Real depth_of_root(Real root) {
    return root * (root + 1.0F);
}

template <int COLOURS>
struct Asked {
    using Colour = std::conditional_t<COLOURS == 1, Real, vec3>;
    using Place = Cell;
    struct Arriving {
        Colour depth;
        Real share;
    };
    static constexpr int MEDIA = MAX_MEDIA;

    const FrameView *frame = nullptr;
    Knots *knots = nullptr; // where something else lies before the surface
    // Of a march that asks lights themselves, where it is.
    mutable int noted_step = 0;
    mutable vec3 noted_place{};

    void leave_knot(Real t, const Real &step, const vec3 &radiance, const Colour &depth) const {
        if (knots == nullptr) {
            return;
        }
        constexpr std::size_t ROWS = Knots::rows(COLOURS);
        knots->values.resize(knots->values.size() + ROWS * MAX_LANES);
        float *to = knots->values.data() + (knots->values.size() - ROWS * MAX_LANES);
        const auto keep = [&to](Real value) {
            value.store_unaligned(to);
            to += MAX_LANES;
        };
        keep(t);
        for (int c = 0; c < 3; ++c) {
            keep(radiance[c]);
        }
        if constexpr (COLOURS == 1) {
            keep(depth);
        } else {
            keep(depth.x);
            keep(depth.y);
            keep(depth.z);
        }
        keep(step);
        ++knots->count;
    }

    [[nodiscard]] const MediumView &medium(int m) const { return frame->seen_media[static_cast<std::size_t>(m)]; }
    [[nodiscard]] const LightView &light(int i) const { return frame->lights[static_cast<std::size_t>(i)]; }

    [[nodiscard]] int media_count() const { return static_cast<int>(frame->seen_media.size()); }
    [[nodiscard]] vec3 to_grid(int m, const vec3 &p) const { return transform_point(medium(m).world_to_grid, p); }
    [[nodiscard]] vec3 along_grid(int m, const vec3 &v) const { return transform_vector(medium(m).world_to_grid, v); }
    [[nodiscard]] vec3 grid_size(int m) const {
        const GridView &grid = medium(m).density;
        return broadcast(glm::vec3(grid.nx, grid.ny, grid.nz));
    }
    [[nodiscard]] Real clearance_at(int m, const vec3 &cell) const {
        return SFUMATO_ISA::clearance_at(medium(m).clearance, cell);
    }
    [[nodiscard]] Cell place_at(int m, const vec3 &cell) const { return locate(medium(m).density, cell); }
    [[nodiscard]] Real density_at(int m, const Cell &place) const { return sample(medium(m).density, place, 0); }
    [[nodiscard]] Real longest_step(int m) const { return medium(m).step_length; }
    [[nodiscard]] Colour extinction_of(int m) const { return colour(medium(m).extinction); }
    [[nodiscard]] vec3 scattering_of(int m) const {
        const float *const rgb = medium(m).scattering;
        return {Real(rgb[0]), Real(rgb[1]), Real(rgb[2])};
    }
    [[nodiscard]] vec3 scattering_at(int m, const Cell &place) const {
        vec3 scattering = scattering_of(m);
        if (medium(m).tint != nullptr) {
            const Real share = 1.0F / max(density_at(m, place), 1e-30F);
            for (int c = 0; c < 3; ++c) {
                scattering[c] = scattering[c] * sample_of(m, medium(m).tint, 3, place, c) * share;
            }
        }
        return scattering;
    }
    [[nodiscard]] bool emits(int m) const { return medium(m).glow != nullptr; }
    [[nodiscard]] Real glow_at(int m, const Cell &place) const { return sample_of(m, medium(m).glow, 1, place, 0); }
    [[nodiscard]] Real last_row(int m) const { return static_cast<float>(medium(m).emission.size() / 3 - 1); }
    [[nodiscard]] vec3 emission_row(int m, const Real &row) const {
        const float *const rows = medium(m).emission.data();
        const Index at = truncate(row) * Index(3);
        return {gather(rows, at), gather(rows + 1, at), gather(rows + 2, at)};
    }
    [[nodiscard]] bool classified(int m) const { return medium(m).ramp.rows != nullptr; }
    [[nodiscard]] bool splits(int m) const { return medium(m).split; }
    [[nodiscard]] vec3 ramp_row(int m, const Real &row) const { return SFUMATO_ISA::ramp_row(medium(m).ramp, row); }
    [[nodiscard]] Real last_part(int m) const { return static_cast<float>(medium(m).ramp.parts - 1); }
    [[nodiscard]] Real anisotropy_of(int m) const { return medium(m).anisotropy; }
    void note_step(const Real &k, const vec3 &world) const {
        if (frame->asks_every > 0) {
            noted_step = static_cast<int>(lowest(k));
            noted_place = world;
        }
    }
    [[nodiscard]] Arriving light_at(int m, const Cell &place, int i) const {
        if (frame->asks_every > 0) {
            return exact_light(m, i);
        }
        const float *const volume = medium(m).light[static_cast<std::size_t>(i)];
        const auto channel = [&](int c) { return sample_of(m, volume, COLOURS + 1, place, c); };
        if constexpr (COLOURS == 1) {
            return {depth_of_root(channel(0)), channel(1)};
        } else {
            return {{depth_of_root(channel(0)), depth_of_root(channel(1)), depth_of_root(channel(2))}, channel(3)};
        }
    }

    // Under a transfer function, smoke may end within a cell: a final picture asks the light's maps, and not its
    // volume.
    [[nodiscard]] Arriving light_along(int m, const Cell &place, const vec3 &world, int i) const {
        Arriving out = light_at(m, place, i);
        if (splits(m) && xsimd::any(out.share > 0.0F)) {
            const auto found = arriving({&light(i), frame->extinctions, m, COLOURS == 1, frame->world_air}, world);
            if constexpr (COLOURS == 1) {
                out.depth = found.optical_depth[0];
            } else {
                out.depth = {found.optical_depth[0], found.optical_depth[1], found.optical_depth[2]};
            }
            out.share = pick(out.share > 0.0F, found.share, 0.0F); // what no light reaches has none in its volume
        }
        return out;
    }

    [[nodiscard]] int light_count() const { return static_cast<int>(frame->smoke_lights); }
    [[nodiscard]] bool is_parallel(int i) const { return light(i).parallel(); }
    [[nodiscard]] Real light_concentration(int i) const { return light(i).concentration; }
    [[nodiscard]] vec3 light_direction(int i) const { return broadcast(light(i).direction); }
    [[nodiscard]] vec3 light_position(int i) const { return broadcast(light(i).position); }
    [[nodiscard]] Real light_size2(int i) const { return light(i).size2; }
    [[nodiscard]] vec3 light_strength(int i) const { return broadcast(light(i).strength); }

private:
    // A part of the steps stands for all. Not inlined: few marches ask.
    [[gnu::noinline]] Arriving exact_light(int m, int i) const {
        if (noted_step % frame->asks_every != frame->asks_first) {
            return {Colour(0.0F), 0.0F};
        }
        ExactPacket packet;
        put(noted_place, packet);
        exact_arriving({&light(i), frame->extinctions, m, COLOURS == 1, frame->world_air}, packet);
        const Real share = Real::load_aligned(packet.out[3]) * static_cast<float>(frame->asks_every);
        if constexpr (COLOURS == 1) {
            return {Real::load_aligned(packet.out[0]), share};
        } else {
            return {{Real::load_aligned(packet.out[0]), Real::load_aligned(packet.out[1]),
                     Real::load_aligned(packet.out[2])},
                    share};
        }
    }
    // Of what is stored as the density is, `channels` numbers for each of its one.
    [[nodiscard]] Real sample_of(int m, const float *values, int channels, const Cell &place, int channel) const {
        GridView grid = medium(m).density;
        grid.channels = channels;
        grid.values = values;
        return sample(grid, {place.first * Index(channels), place.x, place.y, place.z}, channel);
    }
    static Colour colour(const float (&rgb)[3]) {
        if constexpr (COLOURS == 1) {
            return rgb[0];
        } else {
            return {Real(rgb[0]), Real(rgb[1]), Real(rgb[2])};
        }
    }
};

template <int COLOURS, bool RAMPED>
void march_along(const FrameView &frame, const BounceRays &rays, const float *reach, float (&sent)[3][MAX_LANES],
                 float (&left)[3][MAX_LANES]) {
    using Text = text::MarchText<Real, Isa, Asked<COLOURS>>;
    Text text{{.frame = &frame}};
    const auto loaded = [](const float(&v)[3][MAX_LANES]) {
        return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
    };
    const Real far = Real::load_aligned(reach);
    const typename Text::Ray ray{loaded(rays.origin), loaded(rays.direction), far};
    const auto smoke = RAMPED ? text.march_ramped(ray, far) : text.march(ray, far);
    for (int i = 0; i < 3; ++i) {
        smoke.radiance[i].store_aligned(sent[i]);
        if constexpr (COLOURS == 1) {
            RaysText().transmittance_of(smoke.depth).store_aligned(left[i]);
        } else {
            RaysText().transmittance_of(smoke.depth[i]).store_aligned(left[i]);
        }
    }
}

bool is_ramped(const FrameView &frame) {
    return std::ranges::any_of(frame.seen_media, [](const MediumView &medium) { return medium.ramp.rows != nullptr; });
}

template <int COLOURS, bool RAMPED>
void march_in(const FrameView &frame, const Packet &packet, Layers &out) {
    Events *const events = out.events;
    text::MarchText<Real, Isa, Asked<COLOURS>> text{
        {.frame = &frame,
         .knots = events != nullptr && (events->any() || !frame.air.empty()) ? &events->knots : nullptr}};
    const auto &c = frame.camera;
    const auto ray =
        text.camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                        broadcast(c[5]), Real::load_aligned(packet.u), Real::load_aligned(packet.v));
    // Nothing is met where the march has no way to go.
    const Real reach = Real::load_aligned(out.distance) * Real::load_aligned(packet.active);
    const auto smoke = RAMPED ? text.march_ramped(ray, reach) : text.march(ray, reach);
    for (int i = 0; i < 3; ++i) {
        smoke.radiance[i].store_aligned(out.smoke[i]);
        if constexpr (COLOURS == 1) {
            RaysText().transmittance_of(smoke.depth).store_aligned(out.through[i]);
        } else {
            RaysText().transmittance_of(smoke.depth[i]).store_aligned(out.through[i]);
        }
    }
}

} // namespace

void trace_surfaces(const FrameView &frame, LayerSet wanted, const Packet &packet, Layers &out); // surfaces_lanes.cpp
void trace_sheets(const FrameView &frame, LayerSet wanted, const Packet &packet, Layers &out);   // sheets_lanes.cpp
void trace_particles(const FrameView &frame, const Packet &packet, Layers &out);                 // particles_lanes.cpp
void trace_strands(const FrameView &frame, const Packet &packet, Layers &out);                   // strands_lanes.cpp
void trace_air(const FrameView &frame, const Packet &packet, Layers &out);                       // air_lanes.cpp
void merge(const FrameView &frame, const Packet &packet, Layers &out);                           // merge_lanes.cpp
void shine(const FrameView &frame, BounceRays &rays);                                            // bounce_lanes.cpp
void meet(const FrameView &frame, std::span<const BounceRay> rays, std::span<BouncePoint> out);
void meet_more(const FrameView &frame, std::span<const BounceRay> rays,
               std::vector<BouncePoint> &out); // sheets_lanes.cpp
void lit(const FrameView &frame, std::span<const BouncePoint> points, std::span<glm::vec3> out);
void light_puffs(const FrameView &frame, std::span<const Puff> puffs, std::span<const glm::vec3> directions,
                 bool past_smoke, std::span<glm::vec3> out);
void light_strands(const FrameView &frame, std::span<const StrandSegment> segments, std::span<glm::vec3> out);
void light_sheets(const FrameView &frame, std::span<const SheetPoint> points, std::span<glm::vec3> out);

void march(const FrameView &frame, const Packet &packet, Layers &out) {
    if (is_ramped(frame)) {
        frame.grey ? march_in<1, true>(frame, packet, out) : march_in<3, true>(frame, packet, out);
    } else {
        frame.grey ? march_in<1, false>(frame, packet, out) : march_in<3, false>(frame, packet, out);
    }
}

void march_rays(const FrameView &frame, const BounceRays &rays, const float *reach, float (&sent)[3][MAX_LANES],
                float (&left)[3][MAX_LANES]) {
    if (is_ramped(frame)) {
        frame.grey ? march_along<1, true>(frame, rays, reach, sent, left)
                   : march_along<3, true>(frame, rays, reach, sent, left);
    } else {
        frame.grey ? march_along<1, false>(frame, rays, reach, sent, left)
                   : march_along<3, false>(frame, rays, reach, sent, left);
    }
}

extern const FrameKernels frame_kernels{trace_surfaces,
                                        trace_sheets,
                                        trace_strands,
                                        trace_particles,
                                        march,
                                        trace_air,
                                        merge,
                                        {light_puffs, light_strands, light_sheets},
                                        {shine, meet, meet_more, lit}};

} // namespace sfumato::SFUMATO_ISA
