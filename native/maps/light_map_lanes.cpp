// SPDX-License-Identifier: GPL-3.0-or-later
// Building a light map from a density grid, and looking it up, many texels or cells at a time.
#include "maps/map_kernels.hpp"
#include "maps/sampling.hpp"
#include "rays/series_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"
#include "text/ramp_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {

void light_box(const LightBox &box); // light_box_lanes.cpp
// splat_lanes.cpp
void splat_puffs(const Splat<SplatPuff> &splat, int column, int row);
void meet_puffs(const Splat<SplatPuff> &splat, int column, int row, int packet, SplatAbsorbers &out);
// splat_strands_lanes.cpp
void splat_strands(const Splat<SplatStrand> &splat, int column, int row);
void meet_strands(const Splat<SplatStrand> &splat, int column, int row, int packet, SplatAbsorbers &out);

namespace {

using CameraText = text::CameraText<Real, Isa>;

// The light ray of a texel in grid space: the middle of the first slice, and from there one slice on.
struct Path {
    vec3 start, step;
};

Path path_of(const ProjectRow &row, const Real &column) {
    const LightMapView &map = row.map;
    const Real x = (column + 0.5F) * (1.0F / static_cast<float>(map.width));
    const Real y = (static_cast<float>(row.y) + 0.5F) * (1.0F / static_cast<float>(map.height));
    const Real slice = 1.0F / static_cast<float>(row.slices);
    if (!map.radial) {
        return {transform_point(row.light_to_grid, {x, y, 0.5F * slice}),
                transform_vector(row.light_to_grid, {Real(0.0F), Real(0.0F), slice})};
    }
    LightsText::Octahedral place;
    place.x = map.low[0] + x * (1.0F / map.scale[0]);
    place.y = map.low[1] + y * (1.0F / map.scale[1]);
    const vec3 direction = LightsText().octahedral_direction(place);
    const Real depth = slice * (1.0F / map.scale[2]);
    return {transform_point(row.light_to_grid, direction * (map.low[2] + 0.5F * depth)),
            transform_vector(row.light_to_grid, direction * depth)};
}

// The densities along the rays of one packet, at the slices that may hold smoke.
struct Samples {
    float *densities; // LANES each
    float *slices;    // their numbers
    int count = 0;

    [[nodiscard]] Real density(int i) const {
        return Real::load_unaligned(densities + static_cast<std::ptrdiff_t>(i) * LANES);
    }
};

struct AskedRamp {
    RampView ramp;

    [[nodiscard]] vec3 ramp_row(int /*m*/, const Real &row) const { return SFUMATO_ISA::ramp_row(ramp, row); }
    [[nodiscard]] Real last_part(int /*m*/) const { return static_cast<float>(ramp.parts - 1); }
};

// Under a transfer function, by the mean over all that lies between both ends of each slice: what is narrower than a
// slice is not missed.
Samples march_ramped(const ProjectRow &row, const Path &path, int first, int last) {
    text::RampText<Real, Isa, AskedRamp> ramp{{row.ramp}};
    Samples samples{row.scratch + row.slices, row.scratch};
    const float speed = highest(max(max(abs(path.step.x), abs(path.step.y)), abs(path.step.z)));
    const auto end_of = [&path](int slice) { return path.start + path.step * Real(static_cast<float>(slice) - 0.5F); };
    const auto value_at = [&row](const vec3 &p) { return sample(row.density, locate(row.density, p), 0); };
    int known = -1; // the slice before which `front` is
    Real front = 0.0F;
    for (int s = first; s < last;) {
        const vec3 near = end_of(s), far = end_of(s + 1);
        const Real clear = min(clearance_at(row.clearance, near), clearance_at(row.clearance, far));
        if (!xsimd::any(clear < 0.0F)) {
            s += 1 + static_cast<int>(std::max(lowest(clear) / speed - 1.0F, 0.0F));
            continue;
        }
        if (known != s) {
            front = value_at(near);
        }
        const Real back = value_at(far);
        ramp.mean_density(0, front, back)
            .store_unaligned(samples.densities + static_cast<std::ptrdiff_t>(samples.count) * LANES);
        samples.slices[samples.count++] = static_cast<float>(s);
        front = back;
        known = ++s;
    }
    return samples;
}

// Empty slices are leapt over.
Samples march_light(const ProjectRow &row, const Path &path) {
    Samples samples{row.scratch + row.slices, row.scratch};
    const float speed = highest(max(max(abs(path.step.x), abs(path.step.y)), abs(path.step.z)));
    const vec3 size{Real(static_cast<float>(row.density.nx)), Real(static_cast<float>(row.density.ny)),
                    Real(static_cast<float>(row.density.nz))};
    const auto slices = static_cast<float>(row.slices);
    const CameraText::Interval inside =
        CameraText().clip_to_box({Real(0.0F), Real(slices)}, path.start, path.step, size);
    const int first = static_cast<int>(std::min(slices, lowest(inside.near_t)));
    const int last = static_cast<int>(std::clamp(highest(inside.far_t) + 1.0F, 0.0F, slices));
    if (row.ramp.rows != nullptr) {
        return march_ramped(row, path, first, last);
    }
    for (int s = first; s < last;) {
        const vec3 p = path.start + path.step * Real(static_cast<float>(s));
        const Real clear = clearance_at(row.clearance, p);
        if (!xsimd::any(clear < 0.0F)) {
            s += 1 + static_cast<int>(lowest(clear) / speed);
            continue;
        }
        const Real density = sample(row.density, locate(row.density, p), 0);
        density.store_unaligned(samples.densities + static_cast<std::ptrdiff_t>(samples.count) * LANES);
        samples.slices[samples.count++] = static_cast<float>(s);
        ++s;
    }
    return samples;
}

// The range of depths that a ray's series spans: that of its smoke, less what cannot be seen at either end. `slice` is
// the depth of one slice, `total` the sum of the densities.
RaysText::DepthRange seen_range(const ProjectRow &row, const Samples &samples, Real total, float slice) {
    const float to_depth = row.slice_length * row.extinction; // optical depth of a unit of density
    const Real before = RaysText().trimmed_before(total * to_depth) * (1.0F / to_depth);
    const Real behind = RaysText().trimmed_behind(total);
    Real passed = 0.0F, front = 1.0F, back = 0.0F;
    for (int i = 0; i < samples.count; ++i) {
        const Real depth = slice * samples.slices[i];
        back = pick(total - passed > behind, depth + slice, back);
        passed = passed + samples.density(i);
        front = pick(passed > before, min(front, depth), front);
    }
    // Nothing lies beyond the map: smoke that begins at its very end, with the light inside, needs no room there. The
    // cosines' mirror image takes its step away.
    // A ray that only grazes smoke has no range that counts.
    const Mask smoky = total * to_depth > 1e-7F;
    RaysText::DepthRange range = RaysText().padded_range(pick(smoky, front, 0.0F), pick(smoky, max(front, back), 1.0F));
    range.low = max(range.low, 0.0F);
    range.high = max(min(range.high, 1.0F), range.low + 1e-4F);
    return range;
}

// The rays of a packet: their smoke, the sum of its densities, and the range of depths that a series has to span.
struct Packet {
    Samples samples;
    Real total;
    RaysText::DepthRange range;
};

Packet march_packet(const ProjectRow &row, int x) {
    Packet packet{march_light(row, path_of(row, lane_numbers() + static_cast<float>(x))), 0.0F, {}};
    for (int i = 0; i < packet.samples.count; ++i) {
        packet.total = packet.total + packet.samples.density(i);
    }
    if (row.map.shared) {
        packet.range.low = 0.0F;
        packet.range.high = 1.0F;
    } else {
        packet.range = seen_range(row, packet.samples, packet.total, 1.0F / static_cast<float>(row.slices));
    }
    return packet;
}

constexpr int MAX_COUNT = 64;

// sums[k] of the harmonics k = 1, ..., each a cosine or, of Fourier's, a cosine and a sine in turn.
template <typename Waves>
void sum_packet(const Packet &packet, float slice, int harmonics, Real *sums) {
    constexpr bool HALF = std::is_same_v<Waves, Swinging>;
    constexpr int BLOCKS = 4; // absorbers at a time
    const Samples &samples = packet.samples;
    for (int first = 0; first < samples.count; first += BLOCKS) {
        Real density[BLOCKS];
        Waves waves[BLOCKS];
        for (int b = 0; b < BLOCKS; ++b) {
            const int i = std::min(first + b, samples.count - 1);
            density[b] = first + b < samples.count ? samples.density(i) : Real(0.0F);
            const Real d = RaysText().relative_depth(packet.range, slice * (samples.slices[i] + 0.5F));
            waves[b] = Waves(unit_harmonic(HALF, d));
        }
        sum_harmonics(density, waves, BLOCKS, static_cast<std::size_t>(harmonics),
                      [sums](std::size_t k, Real cosine, Real sine) {
                          if constexpr (HALF) {
                              sums[k] = sums[k] + cosine;
                          } else {
                              sums[2 * k - 1] = sums[2 * k - 1] + cosine;
                              sums[2 * k] = sums[2 * k] + sine;
                          }
                      });
    }
}

template <BasisName BASIS>
void project_harmonics(const ProjectRow &row) {
    using Waves = std::conditional_t<BASIS == COSINE, Swinging, Turning>;
    constexpr float FREQUENCY = BASIS == COSINE ? 0.5F : 1.0F;
    const int count = row.map.count, width = row.map.width, stride = row.map.stride(), head = row.map.head();
    const float slice = 1.0F / static_cast<float>(row.slices);
    for (int x = 0; x < width; x += LANES) {
        const Packet packet = march_packet(row, x);
        const Real per_depth = 1.0F / (packet.range.high - packet.range.low);
        Real sums[MAX_COUNT];
        for (int k = 1; k < count; ++k) {
            sums[k] = 0.0F;
        }
        sum_packet<Waves>(packet, slice, BASIS == COSINE ? count - 1 : count / 2, sums);
        alignas(64) float lanes[LANES];
        const auto store = [&](Real value, int at) {
            value.store_aligned(lanes);
            for (int lane = 0; lane < LANES && x + lane < width; ++lane) {
                row.coefficients[static_cast<std::ptrdiff_t>(x + lane) * stride + at] = lanes[lane];
            }
        };
        store(packet.total * row.slice_length, 0);
        if (!row.map.shared) {
            store(packet.range.low, 1);
            store(per_depth, 2);
        }
        for (int k = 1; k < count; ++k) {
            const auto number = FREQUENCY * static_cast<float>(BASIS == COSINE ? k : (k + 1) / 2);
            const Real thickness = RaysText().slab_factor(number, slice * per_depth);
            store(sums[k] * thickness * (2.0F * row.slice_length / (6.28318530717958648F * number)), head + k - 1);
        }
    }
}

} // namespace

void project_row(const ProjectRow &row) {
    row.map.basis == COSINE ? project_harmonics<COSINE>(row) : project_harmonics<FOURIER>(row);
}

void march_row(const ProjectRow &row, int x, RowAbsorbers &out) {
    const Packet packet = march_packet(row, x);
    out.count = packet.samples.count;
    packet.range.low.store_aligned(out.low);
    packet.range.high.store_aligned(out.high);
    (packet.total * row.slice_length).store_aligned(out.total);
}

void look_up(const LightMapView &map, const float *points, float *columns, int count, int colour) {
    for (int i = 0; i < count; i += LANES) {
        alignas(64) float xyz[3][LANES] = {};
        for (int lane = 0; lane < LANES && i + lane < count; ++lane) {
            for (int axis = 0; axis < 3; ++axis) {
                xyz[axis][lane] = points[3 * (i + lane) + axis];
            }
        }
        const vec3 p{Real::load_aligned(xyz[0]), Real::load_aligned(xyz[1]), Real::load_aligned(xyz[2])};
        const vec3 m = place_on(map, p);
        alignas(64) float lanes[LANES];
        column_density(map, locate(map, m.x, m.y), m, colour).store_aligned(lanes);
        for (int lane = 0; lane < LANES && i + lane < count; ++lane) {
            columns[i + lane] = lanes[lane];
        }
    }
}

extern const MapKernels map_kernels{project_row, march_row,  look_up,       light_box,
                                    splat_puffs, meet_puffs, splat_strands, meet_strands};

} // namespace sfumato::SFUMATO_ISA
