// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame does, stage by stage, in order: the two tables of stages.cpp. A stage that the scene does not need does
// not run. Those of the first table make what does not depend on the camera, those of the second follow rays.
#pragma once

#include "frame/layers.hpp"
#include "frame/prepared.hpp"
#include "maps/lighting.hpp"
#include "media/fog.hpp"
#include "media/medium.hpp"
#include "media/particles.hpp"
#include "scene/scene.hpp"
#include "solids/surfaces.hpp"
#include "text/dispatch.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace sfumato {

struct FrameSettings {
    int coefficients = 15;        // of the light maps, over each ray's own range; the paper's maps have 7 over all
    double texels_per_cell = 1.0; // resolution of the light map against the medium's grid
    double steps_per_cell = 1.0;  // of the march along view rays
    int light_samples = 16;       // at most, of a light that is large enough to blur the smoke's shadow
    BasisName basis = COSINE;     // of the light maps
    bool curved = false;          // light maps of resolved curves, and of no basis
    bool shared_ranges = false;   // one range a map: a large light has one map, and a filter stands for its size
    int air_texels = 1024;        // along the longer side of what throws shadows in air, of the light maps for that
};

// Of a frame, what does not depend on the camera.
struct Content {
    std::optional<Surfaces> surfaces;
    std::vector<Strands> strands;
    std::vector<CroppedMedium> media;             // those that are not empty
    std::size_t seen_media = 0;                   // those that the camera sees come first
    std::shared_ptr<const Puffs> puffs;           // null where there are none
    std::vector<AirView> air;                     // the world's comes first
    bool world_air = false;                       // whether it is there
    int air_body = -1;                            // and which of the bodies it is; or none
    std::vector<std::shared_ptr<const Fog>> fogs; // those that the camera sees come first
    std::vector<FogView> fog_views;               // of these; so does `air` after the world's
    int first_fog = 0;                            // among the bodies
    bool grey = true;
    Lighting lighting;
};

struct Making {
    const Scene &scene;
    const FrameSettings &settings;
    const InstructionSet &with;
    Prepared &prepared;
};

// The time that each stage took; stages of rays are timed on all threads at once.
class StageClock {
public:
    struct Row {
        const char *name;
        double seconds;
    };

    // What runs the body of a stage, by its number: those of parts first.
    template <typename Body>
    void time(std::size_t stage, const Body &body) {
        const auto start = std::chrono::steady_clock::now();
        body();
        times_[stage] += (std::chrono::steady_clock::now() - start).count() + 1; // none that ran took no time
    }
    // Of the stages that ran, in order.
    [[nodiscard]] std::vector<Row> rows() const;

private:
    static constexpr std::size_t MOST = 24;
    std::array<std::atomic<std::chrono::steady_clock::rep>, MOST> times_{};
};

// Makes all parts that a scene needs.
Content content_of(const Making &making, StageClock &clock);

// Follows samples through a frame, a tile of packets at a time.
struct Tracer {
    const InstructionSet &with;
    const FrameView &view;
    LayerSet wanted;
    StageClock &clock;

    // fill(packet, lane, number) places each of `count` samples, take(layers, lane, number) has what became of it; or
    // take(layers, packet, lane, number).
    // Of each sample, the shadows of solids are looked at `shadow_samples` times where that is not 0: packet.shadows.
    template <typename Fill, typename Take>
    void trace(std::size_t count, const Fill &fill, const Take &take, std::size_t shadow_samples = 0) const {
        const auto lanes = static_cast<std::size_t>(with.lanes);
        std::array<Packet, TILE> packets;
        std::array<Layers, TILE> layers;
        std::vector<PassLayers> passes(wanted.passes() ? TILE : 0);
        for (std::size_t p = 0; p < passes.size(); ++p) {
            layers[p].passes = &passes[p];
        }
        std::vector<Events> events(view.sorted ? TILE : 0);
        for (std::size_t p = 0; p < events.size(); ++p) {
            layers[p].events = &events[p];
        }
        std::vector<ShadowSample> shadows(shadow_samples * TILE);
        for (std::size_t first = 0; first < count; first += lanes * TILE) {
            const std::size_t left = std::min(count - first, lanes * TILE), used = (left + lanes - 1) / lanes;
            for (std::size_t p = 0; p < used; ++p) {
                packets[p].shadows = std::span(shadows).subspan(p * shadow_samples, shadow_samples);
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const std::size_t number = p * lanes + lane; // lanes to spare follow the last sample
                    fill(packets[p], lane, first + std::min(number, left - 1));
                    packets[p].active[lane] = number < left ? 1.0F : 0.0F;
                }
            }
            run({packets.data(), used}, layers);
            for (std::size_t number = 0; number < left; ++number) {
                const Layers &own = layers[number / lanes];
                if constexpr (std::is_invocable_v<Take, const Layers &, const Packet &, std::size_t, std::size_t>) {
                    take(own, packets[number / lanes], number % lanes, first + number);
                } else {
                    take(own, number % lanes, first + number);
                }
            }
        }
    }

private:
    static constexpr std::size_t TILE = 16; // packets: their layers stay in a first cache

    void run(std::span<const Packet> packets, std::span<Layers> layers) const;
};

} // namespace sfumato
