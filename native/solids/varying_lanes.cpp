// SPDX-License-Identifier: GPL-3.0-or-later
// What varies over surfaces, asked for by itself.
#include "solids/all_hits_lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace sfumato::SFUMATO_ISA {
namespace {

void store_outputs(const Pattern &pattern, const PatternPacket &packet, std::span<float> out) {
    PatternRegisters registers;
    run_pattern(pattern, pattern.steps, packet, registers);
    const std::size_t outputs = pattern.outputs.size();
    for (std::size_t k = 0; k < outputs; ++k) {
        alignas(64) float values[LANES];
        sound(Real::load_aligned(registers.of[pattern.outputs[k].from])).store_aligned(values);
        for (std::size_t lane = 0; lane < out.size() / outputs; ++lane) {
            out[lane * outputs + k] = values[lane];
        }
    }
}

void outputs_on_surface(const Pattern &pattern, const PlaceView &place, std::span<const Hit> hits,
                        std::span<const glm::vec3> positions, std::span<float> out) {
    SurfaceView view;
    view.places = &place;
    const std::size_t outputs = pattern.outputs.size();
    for (std::size_t first = 0; first < hits.size(); first += LANES) {
        const auto some = hits.subspan(first, std::min(hits.size() - first, std::size_t{LANES}));
        Met met;
        alignas(64) float position[3][MAX_LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const std::size_t i = std::min(lane, some.size() - 1);
            met.hit[lane] = true;
            met.place[lane] = 0;
            met.triangle[lane] = some[i].triangle;
            met.u[lane] = some[i].u;
            met.v[lane] = some[i].v;
            for (int axis = 0; axis < 3; ++axis) {
                position[axis][lane] = positions[first + i][axis];
            }
        }
        PatternPacket packet;
        place_point(view, met, got(position), packet);
        turn_to_eye(view, met, {0.0F, 0.0F, 0.0F}, packet);
        put(got(packet.normal), packet.incoming);
        store_outputs(pattern, packet, out.subspan(first * outputs, some.size() * outputs));
    }
}

void outputs_of_rows(const Pattern &pattern, std::span<const float> rows, std::size_t count, std::span<float> out) {
    const std::size_t outputs = pattern.outputs.size(), width = rows.size() / count;
    PatternPacket packet{};
    for (std::size_t first = 0; first < count; first += LANES) {
        const std::size_t some = std::min(count - first, std::size_t{LANES});
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            packet.row[lane] = rows.data() + (first + std::min(lane, some - 1)) * width;
        }
        store_outputs(pattern, packet, out.subspan(first * outputs, some * outputs));
    }
}

} // namespace

extern const VaryingKernels varying_kernels;
const VaryingKernels varying_kernels{&varying_transmittances, &outputs_on_surface, &outputs_of_rows};

} // namespace sfumato::SFUMATO_ISA
