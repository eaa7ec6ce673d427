// SPDX-License-Identifier: GPL-3.0-or-later
// What of the materials of a packet's hits varies over their surfaces.
#pragma once

#include "lights/gloss_curves.hpp"
#include "solids/hits_lanes.hpp"
#include "solids/surface_view.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/microfacets_text.hpp"
#include "textures/pattern_packet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sfumato::SFUMATO_ISA {
namespace {

inline Real axis_of(const vec3 &v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// What is not finite is 0.
inline Real sound(Real x) {
    return pick(abs(x) < 3e38F, x, 0.0F);
}

// The rays through two neighbouring pixels.
struct Beside {
    text::CameraText<Real, Isa>::Ray along, across;
    float stands_for; // by a sample, pixels around it
};

// Where rays meet triangles: of each lane at most one.
struct Met {
    Real distance;
    alignas(64) bool hit[LANES];
    std::uint32_t place[LANES], triangle[LANES];
    float u[LANES], v[LANES];
};

// The property of each slot.
struct PropertyOf {
    int of[pattern_slot::SLOTS] = {};
    constexpr PropertyOf() {
        using namespace pattern_slot;
        constexpr int LIKE[][3] = {{ALBEDO, material_row::ALBEDO, 3},
                                   {EMISSION, material_row::EMISSION, 3},
                                   {TRANSMITTANCE, material_row::TRANSMITTANCE, 3},
                                   {ROUGHNESS, material_row::ROUGHNESS, 1},
                                   {TRANSLUCENCE, material_row::TRANSLUCENCE, 3},
                                   {SHEEN, material_row::SHEEN, 3},
                                   {SHEEN_ROUGHNESS, material_row::SHEEN_ROUGHNESS, 1}};
        for (const auto &[first, property, count] : LIKE) {
            for (int i = 0; i < count; ++i) {
                of[first + i] = property + i;
            }
        }
        constexpr int OF_LOBE[][3] = {{REFLECTANCE, lobe_row::REFLECTANCE, 3},
                                      {DIP, lobe_row::DIP, 3},
                                      {ALPHA_X, lobe_row::ALPHA_X, 2},
                                      {INDEX, lobe_row::INDEX, 1},
                                      {SHARE, lobe_row::SHARE, 1},
                                      {TURN, lobe_row::TURN, 1}};
        for (int k = 0; k < MAX_LOBES; ++k) {
            for (const auto &[first, property, count] : OF_LOBE) {
                for (int i = 0; i < count; ++i) {
                    of[pattern_slot::FIRST_LOBE + k * LOBE_SLOTS + first + i] =
                        material_row::FIRST_LOBE + k * lobe_row::FLOATS + property + i;
                }
            }
        }
    }
};
constexpr PropertyOf PROPERTY_OF{};

// The slots of packets' materials: as their rows have them, or as patterns give them.
class Slots {
public:
    // Where the row of each lane's material begins.
    Slots(const float *properties, Index material) : properties_(properties), material_(material) {}

    [[nodiscard]] Real property(int number) const { return gather(properties_ + number, material_); }
    [[nodiscard]] Real slot(int number) const {
        return has(number) ? value_[number] : property(PROPERTY_OF.of[static_cast<std::size_t>(number)]);
    }
    [[nodiscard]] vec3 colour(int first) const { return {slot(first), slot(first + 1), slot(first + 2)}; }
    void set(Mask where, int number, Real value) {
        value_[number] = pick(where, sound(value), slot(number));
        given_ |= std::uint64_t{1} << number;
    }
    [[nodiscard]] bool has(int number) const { return (given_ >> number & 1U) != 0; }

private:
    const float *properties_;
    Index material_;
    std::uint64_t given_ = 0;
    Real value_[pattern_slot::SLOTS];
};

// What layers of gloss leave and gain, where these vary: of the lanes in `where`.
struct VaryingCurves {
    Mask where = Mask(false);
    Real left = 1.0F;
    vec3 gain{1.0F, 1.0F, 1.0F};
};

// As gloss_curves() has it, of a layer's slots.
inline void add_curves(const GlossTable &table, const Slots &slots, int first, Real to_eye, Mask where,
                       VaryingCurves &curves) {
    using Text = text::MicrofacetsText<Real, Isa>;
    constexpr int LAST = GlossTable::ROUGHNESSES - 1, STEPS = CURVE_POINTS - 1;
    constexpr float PER_ROUGHNESS = LAST / (GlossTable::LAST_ROUGHNESS - GlossTable::FIRST_ROUGHNESS);
    using namespace pattern_slot;
    const Real share = slots.slot(first + SHARE);
    const Real rough = sqrt(sqrt(slots.slot(first + ALPHA_X) * slots.slot(first + ALPHA_Y)));
    const Real row = clamp((rough - GlossTable::FIRST_ROUGHNESS) * PER_ROUGHNESS, 0.0F, static_cast<float>(LAST));
    const Real place = clamp(to_eye, 0.0F, 1.0F) * static_cast<float>(STEPS);
    const Real low = min(floor(row), static_cast<float>(LAST - 1)),
               step = min(floor(place), static_cast<float>(STEPS - 1));
    const Real up = row - low, on = place - step;
    const Index at_mean = truncate(low), at = truncate(low * static_cast<float>(CURVE_POINTS) + step);
    const auto in = [&](const auto &values) {
        const float *const v = values.data();
        const Real below = gather(v, at), further = gather(v + 1, at);
        const Real above = gather(v + CURVE_POINTS, at), both = gather(v + CURVE_POINTS + 1, at);
        const Real here = below + on * (further - below), there = above + on * (both - above);
        return here + up * (there - here);
    };
    const Real once = in(table.plain), fresnel = in(table.fresnel);
    const Real low_mean = gather(table.mean.data(), at_mean);
    const Real mean = low_mean + up * (gather(table.mean.data() + 1, at_mean) - low_mean);
    const vec3 f0 = slots.colour(first + REFLECTANCE), dip = slots.colour(first + DIP);
    vec3 gain{share, share, share};
    Real left = table.leaves_rest || table.leaves_all ? Real(1.0F) : 1.0F - share;
    if (table.leaves_rest || table.lossless) {
        for (int c = 0; c < 3; ++c) {
            const Real straight = axis_of(f0, c);
            const Real all = straight + (1.0F - straight) * table.rise - axis_of(dip, c) * table.dip;
            const Real again = table.lossless ? Text().sent_again(all, mean) : Real(0.0F);
            const Real gained = Text().gain_of_again(again, once);
            (c == 0 ? gain.x : c == 1 ? gain.y : gain.z) = share * gained;
            if (table.leaves_rest) {
                const Real leaves = table.lossless ? once * gained : Real(1.0F);
                left = min(left, 1.0F - share * Text().reflected_by_layer(straight, table.edge, once, fresnel, leaves));
            }
        }
    }
    curves.left = pick(where, left, curves.left);
    curves.gain = pick(where, gain, curves.gain);
    curves.where = curves.where | where;
}

inline vec3 unit(const vec3 &v) {
    return v * (1.0F / sqrt(max(dot(v, v), 1e-37F)));
}

inline void put(const vec3 &v, float (&to)[3][MAX_LANES]) {
    v.x.store_aligned(to[0]);
    v.y.store_aligned(to[1]);
    v.z.store_aligned(to[2]);
}

inline vec3 got(const float (&from)[3][MAX_LANES]) {
    return {Real::load_aligned(from[0]), Real::load_aligned(from[1]), Real::load_aligned(from[2])};
}

inline void place_point(const SurfaceView &view, const Met &met, const vec3 &position, PatternPacket &packet) {
    for (int lane = 0; lane < LANES; ++lane) {
        packet.place[lane] = met.hit[lane] ? view.places + met.place[lane] : nullptr;
        packet.triangle[lane] = met.hit[lane] ? met.triangle[lane] : 0;
        for (int where = 0; where < 3; ++where) {
            packet.u[where][lane] = met.hit[lane] ? met.u[lane] : 0.0F;
            packet.v[where][lane] = met.hit[lane] ? met.v[lane] : 0.0F;
        }
    }
    for (auto &where : packet.position) {
        put(position, where);
    }
}

// Only these lanes are asked: the shapes of others may have nothing of what a pattern wants.
inline void ask(const SurfaceView &view, const Met &met, Mask where, PatternPacket &packet) {
    alignas(64) float asked[LANES];
    pick(where, 1.0F, 0.0F).store_aligned(asked);
    for (int lane = 0; lane < LANES; ++lane) {
        packet.place[lane] = asked[lane] > 0.0F ? view.places + met.place[lane] : nullptr;
    }
}

// Of a point that is looked at along `direction`, towards the eye.
inline void turn_to_eye(const SurfaceView &view, const Met &met, const vec3 &direction, PatternPacket &packet) {
    for (int lane = 0; lane < LANES; ++lane) {
        const Corners corners =
            met.hit[lane] ? corners_of(view.places[met.place[lane]], met.triangle[lane], met.u[lane], met.v[lane])
                          : Corners{};
        for (int axis = 0; axis < 3; ++axis) {
            packet.normal[axis][lane] = corners.normal[axis];
            packet.face[axis][lane] = corners.face[axis];
        }
    }
    const vec3 normal = unit(got(packet.normal)), face = unit(got(packet.face));
    const vec3 front = face * pick(dot(face, normal) < 0.0F, -1.0F, 1.0F);
    const Mask behind = dot(front, direction) > 0.0F;
    const Real side = pick(behind, -1.0F, 1.0F);
    put(normal * side, packet.normal);
    put(front * side, packet.face);
    put(-direction, packet.incoming);
    pick(behind, 1.0F, 0.0F).store_aligned(packet.back);
}

// From a point on a plane to where a ray meets it; no further than a tenth of the way to it, seen edge-on.
inline vec3 step_on_plane(const vec3 &point, const vec3 &normal, Real distance,
                          const text::CameraText<Real, Isa>::Ray &ray) {
    const Real facing = dot(ray.direction, normal);
    const Real safe = pick(abs(facing) > 1e-6F, facing, pick(facing < 0.0F, -1e-6F, 1e-6F));
    const vec3 step = ray.origin + ray.direction * (dot(point - ray.origin, normal) / safe) - point;
    const Real length = sqrt(dot(step, step)), most = 0.1F * distance;
    return step * pick(length > most, most / max(length, 1e-30F), 1.0F);
}

// The same two points on their triangles.
inline void move_on_triangles(PatternPacket &packet) {
    alignas(64) float edges[2][3][MAX_LANES] = {};
    for (int lane = 0; lane < LANES; ++lane) {
        if (packet.place[lane] == nullptr) {
            continue;
        }
        const PatternPlace &place = *packet.place[lane];
        const std::uint32_t *const vertex = place.triangles + std::size_t{3} * packet.triangle[lane];
        const auto corner = [&](int i) { return place.vertices + std::size_t{3} * vertex[i]; };
        for (int e = 0; e < 2; ++e) {
            float own[3], world[3];
            for (int axis = 0; axis < 3; ++axis) {
                own[axis] = corner(e + 1)[axis] - corner(0)[axis];
            }
            turn(place.to_world, own, world);
            for (int axis = 0; axis < 3; ++axis) {
                edges[e][axis][lane] = world[axis];
            }
        }
    }
    const vec3 p = got(edges[0]), q = got(edges[1]), here = got(packet.position[0]);
    const Real pp = dot(p, p), qq = dot(q, q), pq = dot(p, q);
    const Real inverse = 1.0F / max(pp * qq - pq * pq, 1e-37F);
    const Real u = Real::load_aligned(packet.u[0]), v = Real::load_aligned(packet.v[0]);
    for (int where = 1; where < 3; ++where) {
        const vec3 step = got(packet.position[where]) - here;
        const Real along_p = dot(step, p), along_q = dot(step, q);
        (u + (along_p * qq - along_q * pq) * inverse).store_aligned(packet.u[where]);
        (v + (along_q * pp - along_p * pq) * inverse).store_aligned(packet.v[where]);
    }
}

// A packet whose points are moved by shares of its steps.
inline void move_by(Real along, Real across, const PatternPacket &from, PatternPacket &to) {
    const auto moved = [&](const float(&rows)[3][MAX_LANES], float(&out)[3][MAX_LANES]) {
        const Real here = Real::load_aligned(rows[0]);
        const Real step = along * (Real::load_aligned(rows[1]) - here) + across * (Real::load_aligned(rows[2]) - here);
        for (int where = 0; where < 3; ++where) {
            (Real::load_aligned(rows[where]) + step).store_aligned(out[where]);
        }
    };
    const vec3 here = got(from.position[0]);
    const vec3 step = (got(from.position[1]) - here) * along + (got(from.position[2]) - here) * across;
    for (int where = 0; where < 3; ++where) {
        put(got(from.position[where]) + step, to.position[where]);
    }
    moved(from.u, to.u);
    moved(from.v, to.v);
}

// Whether light from a surface is proportional to a slot, so that a mean of it gives the mean light.
constexpr bool is_linear(int slot) {
    using namespace pattern_slot;
    if (slot < FIRST_LOBE) {
        return slot < ROUGHNESS;
    }
    if (slot >= TRANSLUCENCE) {
        return slot < SHEEN_ROUGHNESS;
    }
    const int own = (slot - FIRST_LOBE) % LOBE_SLOTS;
    return own < ALPHA_X || own == SHARE;
}

// Runs a pattern for a packet. Where it may be sharp, what light is proportional to is the mean over points in what
// each sample stands for, which lie evenly (Roberts' sequence, 2018) and in pairs around its middle: that is cheap
// beside the light that falls there. `values` has an output each. Returns the lanes in which so few points may not tell
// the mean.
inline Mask run_filtered(const Pattern &pattern, const PatternPacket &packet, bool filtered, Real *values) {
    constexpr int LEAST = 4; // points of a sample of many
    const std::size_t outputs = pattern.outputs.size();
    PatternRegisters registers;
    run_pattern(pattern, pattern.steps, packet, registers);
    const auto value = [&](std::size_t i) { return sound(Real::load_aligned(registers.of[pattern.outputs[i].from])); };
    for (std::size_t i = 0; i < outputs; ++i) {
        values[i] = value(i);
    }
    const bool any_linear = std::any_of(pattern.outputs.begin(), pattern.outputs.end(),
                                        [](const Pattern::Output &output) { return is_linear(output.slot); });
    Mask unsure(false);
    if (!filtered || pattern.points == 1 || !any_linear) {
        return unsure;
    }
    const float area = packet.stands_for * packet.stands_for;
    const int count = std::clamp(static_cast<int>(area * static_cast<float>(pattern.points)), LEAST, pattern.points);
    PatternPacket moved = packet;
    moved.stands_for = packet.stands_for / std::sqrt(static_cast<float>(count));
    Real sum[pattern_slot::SLOTS], half[pattern_slot::SLOTS];
    for (int k = 0; k < count; ++k) {
        const auto share = [k](float golden) {
            const float at = 0.5F + golden * static_cast<float>(k / 2 + 1);
            return (k % 2 == 0 ? 1.0F : -1.0F) * (at - std::floor(at) - 0.5F);
        };
        move_by(share(0.754877666F) * packet.stands_for, share(0.569840291F) * packet.stands_for, packet, moved);
        run_pattern(pattern, pattern.steps, moved, registers);
        for (std::size_t i = 0; i < outputs; ++i) {
            const Real here = value(i);
            sum[i] = k == 0 ? here : sum[i] + here;
            half[i] = k < count / 2 ? sum[i] : half[i];
        }
    }
    for (std::size_t i = 0; i < outputs; ++i) {
        if (is_linear(pattern.outputs[i].slot)) {
            constexpr float APART = 0.05F; // the means of both halves of the points
            values[i] = sum[i] * (1.0F / static_cast<float>(count));
            const Real apart = abs(2.0F * half[i] - sum[i]) * (1.0F / static_cast<float>(count));
            unsure = unsure | (apart > 0.5F * APART * max(values[i], 0.02F));
        }
    }
    return pattern.images_alone ? Mask(false) : unsure;
}

// Runs `body(varying, where)` for each that lanes have.
template <typename Body>
void for_each_varying(const SurfaceView &view, const Slots &slots, Mask asked, const Body &body) {
    const Real numbers = pick(asked, slots.property(material_row::PATTERN), 0.0F);
    alignas(64) float each[LANES];
    numbers.store_aligned(each);
    for (int lane = 0; lane < LANES; ++lane) {
        const float number = each[lane];
        if (number > 0.0F) {
            body(view.varying[static_cast<std::size_t>(number) - 1], asked & (numbers == number));
            for (int other = lane; other < LANES; ++other) {
                each[other] = each[other] == number ? 0.0F : each[other];
            }
        }
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
