// SPDX-License-Identifier: GPL-3.0-or-later
// Lights in, integrals out, for any number of lanes of any precision: area_light_lanes.cpp has it for every instruction
// set, area_light.cpp in double precision.
#pragma once

#include "lights/area_light.hpp"
#include "text/integrals_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sfumato {

// The text, and what is summed with it. A lane of Real is a Number.
template <class Real, class Isa, class Number>
struct AreaLightLoops : text::IntegralsText<Real, Isa> {
    using Text = text::IntegralsText<Real, Isa>;
    using Text::abs;
    using Text::any_lane;
    using Text::arc_of;
    using Text::arvo_along;
    using Text::clamp;
    using Text::clip_edge;
    using Text::clipped_lambert_edge;
    using Text::diffuse_ellipse;
    using Text::diffuse_sphere;
    using Text::dot;
    using Text::edge_between;
    using Text::ellipse_lobe;
    using Text::ellipse_peak_along;
    using Text::gap_after;
    using Text::gap_angle;
    using Text::gap_edge;
    using Text::lorentzian_along;
    using Text::lorentzian_pearson_along;
    using Text::low_orders;
    using Text::low_orders_along;
    using Text::max;
    using Text::min;
    using Text::no_gap;
    using Text::outline_of;
    using Text::pick;
    using Text::poles_along;
    using Text::sphere_outline;
    using Text::two_poles;
    using Text::unit_arc_of;
    using Text::unit_or_zero;
    using typename Text::Edge;
    using typename Text::Gap;
    using typename Text::LowOrders;
    using typename Text::Outline;
    using typename Text::Poles;
    using typename Text::UnitArc;
    using typename Text::vec3;

    static constexpr std::size_t MAX_VERTICES = 64;

    // The same quantity of as many lights as there are lanes; lanes to spare repeat the last light.
    Real gathered(const Number *values, std::ptrdiff_t stride, std::size_t first, std::size_t count) {
        alignas(64) Number lanes[Isa::LANES];
        for (std::size_t lane = 0; lane < Isa::LANES; ++lane) {
            lanes[lane] = values[static_cast<std::ptrdiff_t>(std::min(first + lane, count - 1)) * stride];
        }
        return Isa::load(lanes);
    }

    vec3 gathered3(const Number *values, std::ptrdiff_t stride, std::size_t first, std::size_t count) {
        return {gathered(values, stride, first, count), gathered(values + 1, stride, first, count),
                gathered(values + 2, stride, first, count)};
    }

    Real largest_of(const vec3 &v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

    // Products of four lengths must stay within float's range; a factor of one elsewhere, so that nothing is rounded.
    Real safe_scale(Real size) {
        return pick(size < 1e-6F, 1.0F / max(size, 1e-36F), pick(size > 1e6F, 1.0F / size, 1.0F));
    }

    struct Polygon {
        vec3 vertices[MAX_VERTICES]; // shorter ones repeat their last vertex: an edge without length adds nothing
        std::size_t count = 0;
    };

    // The sum of along(edge, height_from, height_to) over the boundary, cut to the horizon of `normal` where there is
    // one and to the half space before `axis`. The closing edge in the plane of `axis` adds its angle: z = 0 there.
    // Positive for polygons that are clockwise seen from the origin.
    template <typename Along>
    Real along_boundary(const Polygon &polygon, const vec3 &axis, const vec3 *normal, const Along &along) {
        Gap behind = no_gap(), below = no_gap();
        Real sum = 0.0F, above = 0.0F, before = 0.0F;
        const auto add = [&](const Edge &edge) {
            const Real from = dot(edge.from, axis), to = dot(edge.to, axis);
            sum = sum + along(edge, from, to);
            behind = gap_after(behind, edge, from, to);
            before = max(before, max(from, to));
        };
        for (std::size_t i = 0; i < polygon.count; ++i) {
            const Edge edge = edge_between(polygon.vertices[i], polygon.vertices[i + 1 < polygon.count ? i + 1 : 0]);
            if (normal == nullptr) {
                add(edge);
                continue;
            }
            const Real from = dot(edge.from, *normal), to = dot(edge.to, *normal);
            add(clip_edge(edge, from, to));
            below = gap_after(below, edge, from, to);
            above = max(above, from);
        }
        if (normal != nullptr) {
            add(gap_edge(below, *normal));
            before = pick(above > 0.0F, before, 0.0F);
        }
        return pick(before > 0.0F, sum + gap_angle(behind, unit_or_zero(axis)), 0.0F);
    }

    // `axis` of any length.
    Real any_exponent(const Polygon &polygon, const vec3 &axis, const vec3 *normal, Real exponent) {
        Real sum = 0.0F;
        if (any_lane(exponent >= 9.0F)) {
            const Poles poles = two_poles(max(exponent, 9.0F));
            sum = along_boundary(polygon, axis, normal, [&](const Edge &edge, Real from, Real to) {
                return poles_along(arc_of(edge, axis, from, to), poles);
            });
        }
        if (any_lane(exponent < 9.0F)) {
            const LowOrders orders = low_orders(min(exponent, 9.0F));
            const vec3 unit = unit_or_zero(axis);
            const Real low = along_boundary(polygon, unit, normal, [&](const Edge &edge, Real from, Real to) {
                return low_orders_along(unit_arc_of(edge, unit, from, to), orders);
            });
            sum = pick(exponent < 9.0F, low, sum);
        }
        return sum;
    }

    // Lanes whose exponents differ are summed one exponent after another: its loop is the exponent.
    Real whole_exponent(const Polygon &polygon, const vec3 &axis, const vec3 *normal, Real exponent,
                        const Number *exponents, std::ptrdiff_t stride, std::size_t first, std::size_t count) {
        Real sum = 0.0F;
        Number done = -1;
        for (std::size_t lane = first; lane < std::min(first + Isa::LANES, count); ++lane) {
            const Number n = exponents[static_cast<std::ptrdiff_t>(lane) * stride];
            if (n == done) {
                continue;
            }
            done = n;
            const Real one = along_boundary(polygon, axis, normal, [&](const Edge &edge, Real from, Real to) {
                return arvo_along(unit_arc_of(edge, axis, from, to), static_cast<int>(n));
            });
            sum = pick(exponent == Real(n), one, sum);
        }
        return sum;
    }

    template <typename Peak>
    Real peaks(const Polygon &polygon, const vec3 &axis, const vec3 *normal, const Peak &peak) {
        return along_boundary(polygon, axis, normal, [&](const Edge &edge, Real from, Real to) {
            return peak(unit_arc_of(edge, axis, from, to));
        });
    }

    Real polygon_integral(const LightBatch<Number> &batch, std::size_t first, const vec3 *normal) {
        Polygon polygon;
        const auto size_of = [&](std::size_t light) {
            return batch.vertices != nullptr ? static_cast<std::size_t>(batch.vertices[light]) : batch.width / 3;
        };
        for (std::size_t lane = first; lane < std::min(first + Isa::LANES, batch.count); ++lane) {
            polygon.count = std::max(polygon.count, size_of(lane));
        }
        Real size = 0.0F;
        for (std::size_t v = 0; v < polygon.count; ++v) {
            alignas(64) Number xyz[3][Isa::LANES];
            for (std::size_t lane = 0; lane < Isa::LANES; ++lane) {
                const std::size_t light = std::min(first + lane, batch.count - 1);
                const auto *vertex = batch.lights + light * batch.width + 3 * std::min(v, size_of(light) - 1);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    xyz[axis][lane] = vertex[axis];
                }
            }
            polygon.vertices[v] = {Isa::load(xyz[0]), Isa::load(xyz[1]), Isa::load(xyz[2])};
            size = max(size, largest_of(polygon.vertices[v]));
        }
        const Real scale = safe_scale(size);
        for (std::size_t v = 0; v < polygon.count; ++v) {
            polygon.vertices[v] = polygon.vertices[v] * scale;
        }
        Real sum = 0.0F;
        if (batch.method == LobeMethod::DIFFUSE) {
            const vec3 &n = *normal;
            sum = along_boundary(polygon, n, nullptr, [&](const Edge &edge, Real from, Real to) {
                return clipped_lambert_edge(edge, n, from, to);
            });
        } else {
            const vec3 given = gathered3(batch.axis.values, batch.axis.stride, first, batch.count);
            const vec3 axis = unit_or_zero(given);
            const Real exponent = gathered(batch.exponent.values, batch.exponent.stride, first, batch.count);
            switch (batch.method) {
            case LobeMethod::ARVO:
                sum = whole_exponent(polygon, axis, normal, exponent, batch.exponent.values, batch.exponent.stride,
                                     first, batch.count);
                break;
            case LobeMethod::LORENTZIAN:
                sum = peaks(polygon, axis, normal, [&](const UnitArc &arc) { return lorentzian_along(arc, exponent); });
                break;
            case LobeMethod::LORENTZIAN_PEARSON:
                sum = peaks(polygon, axis, normal,
                            [&](const UnitArc &arc) { return lorentzian_pearson_along(arc, exponent); });
                break;
            case LobeMethod::ELLIPSE_PEAK:
                sum =
                    peaks(polygon, axis, normal, [&](const UnitArc &arc) { return ellipse_peak_along(arc, exponent); });
                break;
            default:
                sum = any_exponent(polygon, given, normal, exponent);
                break;
            }
        }
        const Real share = sum * Real(Number{0.5} * std::numbers::inv_pi_v<Number>);
        return clamp(batch.two_sided ? abs(share) : -share, 0.0F, 1.0F);
    }

    // Below n = 9, where the poles end, lobes are so wide that a polygon of the same area will do.
    Real wide_lobe_over(Outline outline, const vec3 &axis, const vec3 *normal, Real exponent) {
        outline = outline_of(outline.centre, outline.u, outline.v);
        constexpr std::size_t CORNERS = 64;
        constexpr double STEP = 2.0 * std::numbers::pi / CORNERS;
        const auto reach = static_cast<Number>(std::sqrt(STEP / std::sin(STEP)));
        Polygon polygon;
        polygon.count = CORNERS;
        for (std::size_t i = 0; i < CORNERS; ++i) {
            const double psi = STEP * static_cast<double>(i);
            polygon.vertices[i] = outline.centre + outline.u * Real(static_cast<Number>(std::cos(psi)) * reach) +
                                  outline.v * Real(static_cast<Number>(std::sin(psi)) * reach);
        }
        return any_exponent(polygon, axis, normal, exponent) * Real(Number{0.5} * std::numbers::inv_pi_v<Number>);
    }

    Real round_integral(const LightBatch<Number> &batch, std::size_t first, const vec3 *normal) {
        const auto number = [&](std::size_t i) {
            return gathered(batch.lights + i, static_cast<std::ptrdiff_t>(batch.width), first, batch.count);
        };
        const auto vector = [&](std::size_t i) { return vec3(number(i), number(i + 1), number(i + 2)); };
        Outline outline{vector(0), vec3(Real(0.0F)), vec3(Real(0.0F))};
        Real radius = 0.0F, size = largest_of(outline.centre);
        if (batch.shape == LightShape::SPHERE) {
            radius = number(3);
            size = max(size, radius);
        } else {
            outline.u = vector(3);
            outline.v = vector(6);
            size = max(size, max(largest_of(outline.u), largest_of(outline.v)));
        }
        const Real scale = 1.0F / max(size, 1e-36F);
        outline = {outline.centre * scale, outline.u * scale, outline.v * scale};
        radius = radius * scale;
        if (batch.method == LobeMethod::DIFFUSE) {
            return batch.shape == LightShape::SPHERE ? diffuse_sphere(*normal, outline.centre, radius)
                                                     : diffuse_ellipse(*normal, outline.centre, outline.u, outline.v);
        }
        if (batch.shape == LightShape::SPHERE) {
            outline = sphere_outline(outline.centre, radius);
        }
        const vec3 axis = unit_or_zero(gathered3(batch.axis.values, batch.axis.stride, first, batch.count));
        const Real exponent = gathered(batch.exponent.values, batch.exponent.stride, first, batch.count);
        const vec3 &horizon = normal != nullptr ? *normal : axis;
        Real value = 0.0F;
        if (any_lane(exponent >= 9.0F)) {
            value = ellipse_lobe(axis, max(exponent, 9.0F), horizon, outline.centre, outline.u, outline.v);
        }
        if (any_lane(exponent < 9.0F)) {
            const Real wide = abs(wide_lobe_over(outline, axis, normal, min(exponent, 8.99F)));
            value = pick(exponent < 9.0F, min(wide, 1.0F), value);
        }
        return value;
    }

    void integrate_batch(const LightBatch<Number> &batch) {
        for (std::size_t first = 0; first < batch.count; first += Isa::LANES) {
            vec3 normal(Real(0.0F));
            const bool horizon = batch.normal.values != nullptr;
            if (horizon) {
                normal = unit_or_zero(gathered3(batch.normal.values, batch.normal.stride, first, batch.count));
            }
            const vec3 *seen_from = horizon ? &normal : nullptr;
            const Real value = batch.shape == LightShape::POLYGON ? polygon_integral(batch, first, seen_from)
                                                                  : round_integral(batch, first, seen_from);
            alignas(64) Number lanes[Isa::LANES];
            Isa::store(value, lanes);
            for (std::size_t lane = 0; lane < Isa::LANES && first + lane < batch.count; ++lane) {
                batch.out[first + lane] = lanes[lane];
            }
        }
    }
};

} // namespace sfumato
