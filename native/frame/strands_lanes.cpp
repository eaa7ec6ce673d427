// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the strands: hair on each ray of a packet, as fragments. A sample stands for a part of the picture
// around it, by the film's filter, and hair covers the share of that which it hides; so hair that is thinner than a
// pixel is as smooth as it should be with one sample a pixel.
#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/sampling.hpp"
#include "rays/bins_lanes.hpp"
#include "solids/all_hits_lanes.hpp"
#include "solids/hits_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/rays_text.hpp"
#include "text/strands_text.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using StrandsText = text::StrandsText<Real, Isa>;

// Lanes that are left less than this see nothing more.
constexpr float HIDDEN = 1e-4F;
// What covers less of a sample is none.
constexpr float LEAST_COVER = 1e-6F;
// The filter as if it were even, against its whole extent: of the same spread.
constexpr float EVEN_SHARE = 0.46F;

// Where a packet's samples lie in the picture.
struct Samples {
    Real x, y, left, per_diameter; // left: of what lies behind the fragments so far, of which `last` is the farthest
    float reach;
    Real last = 0.0F;
};

// The share of a sample's surroundings on one side of a line that is `beyond` pixels away.
Real filtered(const Samples &samples, Real beyond) {
    return CameraText().filter_share(clamp(0.5F + beyond * samples.per_diameter, 0.0F, 1.0F));
}

// A segment as samples see it.
struct Seen {
    Real cover, distance, low, high; // the part of its width
    Real along;                      // the share of the way to its end, in space
};

Seen seen(const StrandSegment &s, const Samples &samples) {
    const float way_x = s.to[0] - s.from[0], way_y = s.to[1] - s.from[1];
    const float length = std::sqrt(way_x * way_x + way_y * way_y), per_length = 1.0F / std::max(length, 1e-6F);
    const float dx = length > 0.0F ? way_x * per_length : 1.0F, dy = length > 0.0F ? way_y * per_length : 0.0F;
    const Real from_x = samples.x - s.from[0], from_y = samples.y - s.from[1];
    const Real to_x = samples.x - s.to[0], to_y = samples.y - s.to[1];
    const Real forth = from_x * dx + from_y * dy, left_of = from_y * dx - from_x * dy;
    Seen out;
    out.cover = 0.0F;
    const float wide = std::max(s.from_radius, s.to_radius) + samples.reach;
    const Mask near = (abs(left_of) < wide) & (forth > -samples.reach) & (forth < length + samples.reach);
    if (!xsimd::any(near)) {
        return out;
    }
    const Real share = clamp(forth * per_length, 0.0F, 1.0F);
    const Real radius = s.from_radius + (s.to_radius - s.from_radius) * share;
    const Real across = filtered(samples, left_of + radius) - filtered(samples, left_of - radius);
    // At a free end it fades, at a joint its neighbour goes on.
    const bool starts = s.from_joint[0] == 0.0F && s.from_joint[1] == 0.0F;
    const bool ends = s.to_joint[0] == 0.0F && s.to_joint[1] == 0.0F;
    const Real past_start = starts ? filtered(samples, forth)
                                   : pick(from_x * s.from_joint[0] + from_y * s.from_joint[1] >= 0.0F, 1.0F, 0.0F);
    const Real before_end =
        ends ? filtered(samples, length - forth) : pick(to_x * s.to_joint[0] + to_y * s.to_joint[1] < 0.0F, 1.0F, 0.0F);
    out.cover = clamp(across * max(past_start + before_end - 1.0F, 0.0F), 0.0F, 1.0F);
    // What is even in the picture is not so in space.
    out.along = share * s.from_depth / (s.to_depth + share * (s.from_depth - s.to_depth));
    out.distance = s.from_distance + (s.to_distance - s.from_distance) * out.along;
    const Real per_radius = 1.0F / max(radius, 1e-9F), around = samples.reach * EVEN_SHARE;
    // At its edges a sample sees a part that has some width, too.
    const Real least = radius - samples.reach * 0.25F;
    out.low = clamp(min(left_of - around, least) * per_radius, -1.0F, 0.99F);
    out.high = max(clamp(max(left_of + around, -least) * per_radius, -0.99F, 1.0F), out.low + 0.01F);
    return out;
}

// Fragments that wait until there are as many as lanes.
struct Waiting {
    int count = 0;
    int lane[LANES] = {};
    const StrandSegment *segment[LANES] = {};
    alignas(64) float cover[LANES] = {}, distance[LANES] = {}, low[LANES] = {}, high[LANES] = {}, along[LANES] = {};
};

// Of the strands of as many fragments what shading asks.
struct Shaded {
    vec3 point, tangent, to_eye, aside; // aside: at right angles to both, on the right where the strand leads up
    StrandsText::Fibre fibre;
    vec3 albedo, highlight;
    Real highlight_variance;
    Mask dielectric, active;
    Real width; // of the strand, metres
    Real light_u, light_v;
    const StrandRow *row[LANES];
};

Mask reached(const Shaded &shaded, const LightView &light) {
    alignas(64) float lit[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        lit[lane] = (shaded.row[lane]->lit_by & light.reach.lights) != 0 ? 1.0F : 0.0F;
    }
    return shaded.active & (Real::load_aligned(lit) > 0.0F);
}

// What solids and sheets leave of a light, in each colour, asked for one of its points.
vec3 past_solids(const FrameView &frame, const LightView &light, const Shaded &shaded, Mask asked) {
    vec3 left{1.0F, 1.0F, 1.0F};
    if ((light.solids.scene == nullptr && light.sheets.scene == nullptr) || !xsimd::any(asked)) {
        return left;
    }
    const Towards towards = sample_towards(light, shaded.point, shaded.light_u, shaded.light_v);
    const vec3 &p = shaded.point;
    const Real offset = 4e-6F * max(max(abs(p.x), abs(p.y)), abs(p.z)) + 1e-6F;
    if (light.solids.scene != nullptr) {
        typename Rays<LANES>::Ray rays;
        set_rays(rays, light.solids, p, towards.direction, offset, towards.distance);
        alignas(64) int valid[LANES];
        valid_lanes(asked, valid);
        Rays<LANES>::occluded(valid, light.solids.scene, false, rays);
        const Real visible = pick(Real::load_aligned(rays.tfar) < 0.0F, 0.0F, 1.0F);
        left = {visible, visible, visible};
        asked = asked & (visible > 0.0F);
    }
    if (light.sheets.scene != nullptr) {
        left = left * past_sheets(frame.surfaces, light.sheets, p + towards.direction * offset, towards.direction,
                                  towards.distance, asked);
    }
    return left;
}

// What is sent of light from a direction, of irradiance 1.
vec3 sent(const Shaded &shaded, const StrandsText::StrandLook &look, const vec3 &towards) {
    const Real sine = clamp(dot(towards, shaded.tangent), -1.0F, 1.0F);
    // The eye's part across the strand has the length look.cosine.
    const vec3 eye = shaded.to_eye - shaded.tangent * look.sine;
    const Real around = atan(dot(towards, shaded.aside) * look.cosine, dot(towards, eye));
    vec3 out{0.0F, 0.0F, 0.0F};
    if (xsimd::any(shaded.dielectric & shaded.active)) {
        out = StrandsText().strand_sent(shaded.fibre, look, sine, around);
    }
    if (xsimd::any(shaded.active & !shaded.dielectric)) {
        const Real matt = StrandsText().matt_strand(look, sine, around);
        const Real shine = StrandsText().strand_highlight(look, sine, shaded.highlight_variance);
        out = pick(shaded.dielectric, out, shaded.albedo * matt + shaded.highlight * shine);
    }
    return out;
}

// What of a map's optical depth at a strand is the strand's own, of those that belong to a body: half of it lies before
// its middle. The mean of what a look-up finds between two texels of which a strand covers a share c, wherever it lies,
// is 2 int (1 - x) sqrt(1 - c(x)) dx, here within 1 %.
Real own_depth(const LightMapView &map, const Shaded &shaded, std::int32_t body) {
    alignas(64) float own[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        own[lane] = shaded.row[lane]->body == body ? 1.0F : 0.0F;
    }
    const float texel = std::max(1.0F / (map.scale[0] * static_cast<float>(map.width)),
                                 1.0F / (map.scale[1] * static_cast<float>(map.height)));
    Real width = 1.0F;
    if (map.radial) {
        const vec3 p = transform_point(map.world_to_light, shaded.point);
        const Real distance = sqrt(max(dot(p, p), 1e-20F)), sum = (abs(p.x) + abs(p.y) + abs(p.z)) / distance;
        width = texel * sum * sqrt(sum) * distance;
    } else {
        const float(&row)[4] = map.world_to_light.rows[0];
        const float per_metre = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
        width = 1.0F / (per_metre * static_cast<float>(map.width));
    }
    const Real covered = min(shaded.width / width, 1.0F);
    return pick(Real::load_aligned(own) > 0.0F, -log(1.0F - covered * (0.4F + 0.067F * covered)), 0.0F);
}

vec3 lit(const FrameView &frame, const Shaded &shaded, const StrandsText::StrandLook &look) {
    const int colours = frame.grey ? 1 : 3;
    const std::size_t bodies = frame.extinctions.size();
    vec3 sum{0.0F, 0.0F, 0.0F};
    for (const LightView &light : frame.lights) {
        const Mask asked = reached(shaded, light);
        if (!(light.reach.diffuse || light.reach.gloss) || !xsimd::any(asked)) {
            continue;
        }
        vec3 of_light{0.0F, 0.0F, 0.0F};
        for (std::size_t j = 0; j < light.samples.size(); ++j) {
            const vec3 sample = broadcast(light.samples[j]);
            const vec3 towards = normalised(light.parallel() ? sample : sample - shaded.point);
            const Real irradiance =
                falloff_of(light, shaded.point - broadcast(light.position)) * sample_share(light, j, shaded.point);
            Real depth[3] = {0.0F, 0.0F, 0.0F};
            for (std::size_t m = 0; m < bodies; ++m) {
                const LightMapView &map = light.maps[j * bodies + m];
                if (map.empty() || map.clear()) {
                    continue;
                }
                const vec3 place = place_on(map, shaded.point);
                add_optical_depth(map, locate(map, place.x, place.y), place, &frame.extinctions[m].x, colours, depth);
                const auto own = static_cast<std::int32_t>(m) - static_cast<std::int32_t>(frame.first_hair);
                if (own >= 0) {
                    const Real less = own_depth(map, shaded, own);
                    for (int c = 0; c < colours; ++c) {
                        depth[c] = max(depth[c] - less, 0.0F);
                    }
                }
            }
            const vec3 each = sent(shaded, look, towards) * irradiance;
            for (int c = 0; c < 3; ++c) {
                of_light[c] = of_light[c] + each[c] * RaysText().transmittance_of(depth[c < colours ? c : 0]);
            }
        }
        const vec3 visible = past_solids(frame, light, shaded, asked);
        for (int c = 0; c < 3; ++c) {
            sum[c] = sum[c] + pick(asked, of_light[c] * (visible[c] * light.strength[c]), 0.0F);
        }
    }
    return sum;
}

class Strands {
public:
    Strands(const FrameView &frame, const Packet &packet, Layers &layers)
        : frame_(frame), packet_(packet), layers_(layers) {
        const auto &c = frame.camera;
        const auto ray =
            CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                                    broadcast(c[5]), Real::load_aligned(packet.u), Real::load_aligned(packet.v));
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis].store_aligned(origin_[axis]);
            ray.direction[axis].store_aligned(direction_[axis]);
        }
    }

    void run() {
        Samples samples{Real::load_aligned(packet_.u) * frame_.strands.width,
                        Real::load_aligned(packet_.v) * frame_.strands.height, 1.0F, 0.5F / packet_.reach,
                        packet_.reach};
        const Mask active = Real::load_aligned(packet_.active) > 0.0F;
        const Real end = Real::load_aligned(layers_.distance);
        for_primitives(frame_.strands.bins, samples.x, samples.y, active, [&](std::int32_t number) {
            const StrandSegment &segment = frame_.strands.segments[number];
            const Seen here = seen(segment, samples);
            const Mask met = active & (here.cover > LEAST_COVER) & (here.distance < end) &
                             ((samples.left > HIDDEN) | (here.distance < samples.last));
            if (xsimd::any(met)) {
                wait(segment, here, met);
                samples.left = samples.left * (1.0F - pick(met, here.cover, 0.0F));
                samples.last = pick(met, max(samples.last, here.distance), samples.last);
            }
            // Segments come by their nearer ends: what hides at its far end may have others before it.
            const float begins = std::min(segment.from_distance, segment.to_distance);
            return xsimd::any(active & ((samples.left > HIDDEN) | (samples.last > begins)));
        });
        shade();
        (1.0F - samples.left).store_aligned(layers_.fine);
    }

    // Of as many segments as there are lanes, or fewer, the middles, which the packet's rays go through: whole.
    void run(std::span<const StrandSegment> segments) {
        waiting_.count = static_cast<int>(segments.size());
        for (int i = 0; i < waiting_.count; ++i) {
            const StrandSegment &s = segments[static_cast<std::size_t>(i)];
            waiting_.lane[i] = i;
            waiting_.segment[i] = &s;
            waiting_.cover[i] = 1.0F;
            waiting_.distance[i] = 0.5F * (s.from_distance + s.to_distance);
            waiting_.low[i] = -1.0F;
            waiting_.high[i] = 1.0F;
            waiting_.along[i] = 0.5F;
        }
        shade();
    }

private:
    void wait(const StrandSegment &segment, const Seen &here, Mask met) {
        alignas(64) float chosen[LANES], cover[LANES], distance[LANES], low[LANES], high[LANES], along[LANES];
        pick(met, 1.0F, 0.0F).store_aligned(chosen);
        here.cover.store_aligned(cover);
        here.distance.store_aligned(distance);
        here.low.store_aligned(low);
        here.high.store_aligned(high);
        here.along.store_aligned(along);
        for (int lane = 0; lane < LANES; ++lane) {
            if (chosen[lane] == 0.0F) {
                continue;
            }
            if (waiting_.count == LANES) {
                shade();
            }
            const int i = waiting_.count++;
            waiting_.lane[i] = lane;
            waiting_.segment[i] = &segment;
            waiting_.cover[i] = cover[lane];
            waiting_.distance[i] = distance[lane];
            waiting_.low[i] = low[lane];
            waiting_.high[i] = high[lane];
            waiting_.along[i] = along[lane];
        }
    }

    // All that wait.
    void shade() {
        if (waiting_.count == 0) {
            return;
        }
        const Shaded shaded = gathered();
        const Real sine = clamp(dot(shaded.to_eye, shaded.tangent), -1.0F, 1.0F);
        const StrandsText::StrandLook look = StrandsText().strand_look(
            shaded.fibre, sine, Real::load_aligned(waiting_.low), Real::load_aligned(waiting_.high));
        const vec3 radiance = lit(frame_, shaded, look) * Real::load_aligned(waiting_.cover);
        alignas(64) float rgb[3][LANES];
        for (int c = 0; c < 3; ++c) {
            radiance[c].store_aligned(rgb[c]);
        }
        for (int i = 0; i < waiting_.count; ++i) {
            layers_.events->add(
                static_cast<std::size_t>(waiting_.lane[i]),
                {waiting_.distance[i], {rgb[0][i], rgb[1][i], rgb[2][i]}, glm::vec3(1.0F - waiting_.cover[i])});
        }
        waiting_.count = 0;
    }

    // Lanes to spare repeat the last one.
    [[nodiscard]] Shaded gathered() {
        alignas(64) float v[24][LANES];
        Shaded out;
        for (int i = 0; i < LANES; ++i) {
            const int from = std::min(i, waiting_.count - 1), lane = waiting_.lane[from];
            const StrandSegment &segment = *waiting_.segment[from];
            const StrandRow &row = frame_.strands.rows[segment.material];
            out.row[i] = &row;
            const float along = waiting_.along[from];
            for (int axis = 0; axis < 3; ++axis) {
                v[axis][i] = origin_[axis][lane] + direction_[axis][lane] * waiting_.distance[from];
                v[3 + axis][i] = -direction_[axis][lane];
                v[6 + axis][i] =
                    segment.from_tangent[axis] + (segment.to_tangent[axis] - segment.from_tangent[axis]) * along;
                v[9 + axis][i] = row.absorption[axis];
                v[12 + axis][i] = row.albedo[axis];
                v[15 + axis][i] = row.highlight[axis];
            }
            v[18][i] = row.dielectric ? row.variance : row.highlight_variance;
            v[19][i] = row.primary;
            v[20][i] = row.scale;
            v[21][i] = row.tilt;
            v[22][i] = row.dielectric ? row.index : 0.0F;
            v[23][i] = segment.width[0] + (segment.width[1] - segment.width[0]) * along;
        }
        const auto colour = [&v](int at) {
            return vec3(Real::load_aligned(v[at]), Real::load_aligned(v[at + 1]), Real::load_aligned(v[at + 2]));
        };
        out.point = colour(0);
        out.to_eye = colour(3);
        const vec3 tangent = colour(6);
        out.tangent = tangent * (1.0F / sqrt(max(dot(tangent, tangent), 1e-20F)));
        const vec3 aside = cross(out.tangent, out.to_eye);
        out.aside = aside * (1.0F / sqrt(max(dot(aside, aside), 1e-20F)));
        out.fibre.absorption = colour(9);
        out.albedo = colour(12);
        out.highlight = colour(15);
        out.highlight_variance = out.fibre.variance = Real::load_aligned(v[18]);
        out.fibre.primary = Real::load_aligned(v[19]);
        out.fibre.scale = Real::load_aligned(v[20]);
        out.fibre.tilt = Real::load_aligned(v[21]);
        const Real index = Real::load_aligned(v[22]);
        out.dielectric = index > 0.0F;
        out.fibre.index = max(index, 1.0F);
        out.width = Real::load_aligned(v[23]);
        out.active = lane_numbers() < static_cast<float>(waiting_.count);
        place_on_lights(out);
        return out;
    }

    // Where on the lights solids are asked for; where a packet has only samples of shadows, in the middle.
    void place_on_lights(Shaded &out) const {
        alignas(64) float u[LANES], v[LANES];
        for (int i = 0; i < LANES; ++i) {
            const int lane = waiting_.lane[std::min(i, waiting_.count - 1)];
            u[i] = packet_.shadows.empty() ? packet_.light_u[lane] : 0.5F;
            v[i] = packet_.shadows.empty() ? packet_.light_v[lane] : 0.5F;
        }
        out.light_u = Real::load_aligned(u);
        out.light_v = Real::load_aligned(v);
    }

    const FrameView &frame_;
    const Packet &packet_;
    Layers &layers_;
    alignas(64) float origin_[3][MAX_LANES], direction_[3][MAX_LANES];
    Waiting waiting_;
};

} // namespace

void trace_strands(const FrameView &frame, const Packet &packet, Layers &layers) {
    Strands(frame, packet, layers).run();
}

void light_strands(const FrameView &frame, std::span<const StrandSegment> segments, std::span<glm::vec3> out) {
    Events events;
    Layers layers;
    layers.events = &events;
    Packet packet;
    for (std::size_t first = 0; first < segments.size(); first += LANES) {
        const auto some = segments.subspan(first, std::min(segments.size() - first, std::size_t{LANES}));
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const StrandSegment &s = some[std::min(lane, some.size() - 1)];
            // The middle in space is nearer to the far end in the picture.
            const float share = s.to_depth / (s.from_depth + s.to_depth);
            packet.u[lane] = (s.from[0] + (s.to[0] - s.from[0]) * share) / frame.strands.width;
            packet.v[lane] = (s.from[1] + (s.to[1] - s.from[1]) * share) / frame.strands.height;
            packet.light_u[lane] = packet.light_v[lane] = 0.5F;
            packet.active[lane] = lane < some.size() ? 1.0F : 0.0F;
        }
        events.clear();
        Strands(frame, packet, layers).run(some);
        for (std::size_t lane = 0; lane < some.size(); ++lane) {
            out[first + lane] = events.fragments[lane].front().radiance;
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
