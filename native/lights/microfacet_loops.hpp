// SPDX-License-Identifier: GPL-3.0-or-later
// Lights in, reflections out, for any number of lanes of any precision: microfacet_lanes.cpp has it for every
// instruction set, microfacet.cpp in double precision.
#pragma once

#include "lights/microfacet.hpp"
#include "text/microfacets_text.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato {

// The text, and what is done with it. A lane of Real is a Number.
template <class Real, class Isa, class Number>
struct MicrofacetLoops : text::MicrofacetsText<Real, Isa> {
    using Text = text::MicrofacetsText<Real, Isa>;
    using Text::horizon_arc;
    using Text::lit_arc;
    using Text::lit_edge;
    using Text::lobe_turns;
    using Text::mean_about;
    using Text::microfacet_ellipse;
    using Text::microfacet_quad;
    using Text::microfacet_sphere;
    using Text::microfacets;
    using Text::reflected;
    using Text::unit;
    using Text::with_arc;
    using typename Text::LitEdge;
    using typename Text::Mean;
    using typename Text::Microfacets;
    using typename Text::Reflection;
    using typename Text::RimArc;
    using typename Text::vec3;

    static constexpr std::size_t MAX_VERTICES = 64;

    // Number `offset` of as many lights as there are lanes; lanes to spare repeat the last light.
    Real lanes_of(const Number *values, std::ptrdiff_t stride, std::size_t offset, std::size_t first,
                  std::size_t count) {
        alignas(64) Number lanes[Isa::LANES];
        for (std::size_t lane = 0; lane < Isa::LANES; ++lane) {
            lanes[lane] = values[static_cast<std::ptrdiff_t>(std::min(first + lane, count - 1)) * stride +
                                 static_cast<std::ptrdiff_t>(offset)];
        }
        return Isa::load(lanes);
    }

    vec3 lanes3_of(const Number *values, std::ptrdiff_t stride, std::size_t offset, std::size_t first,
                   std::size_t count) {
        return {lanes_of(values, stride, offset, first, count), lanes_of(values, stride, offset + 1, first, count),
                lanes_of(values, stride, offset + 2, first, count)};
    }

    // Shorter polygons repeat their last vertex: an edge without length adds nothing.
    vec3 direction_of(const MicrofacetBatch<Number> &batch, std::size_t first, std::size_t vertex) {
        alignas(64) Number xyz[3][Isa::LANES];
        for (std::size_t lane = 0; lane < Isa::LANES; ++lane) {
            const std::size_t light = std::min(first + lane, batch.count - 1);
            const std::size_t size =
                batch.vertices != nullptr ? static_cast<std::size_t>(batch.vertices[light]) : batch.width / 3;
            const auto *at = batch.lights + light * batch.width + 3 * std::min(vertex, size - 1);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                xyz[axis][lane] = at[axis];
            }
        }
        return unit(vec3(Isa::load(xyz[0]), Isa::load(xyz[1]), Isa::load(xyz[2])));
    }

    // The commonest light with all of its text inlined: structs by value would pass through memory, at 1.6 times the
    // time.
    [[gnu::flatten]] Reflection flat_ggx_quad(const vec3 &view, Real alpha_x, Real alpha_y, Real index, const vec3 &a,
                                              const vec3 &b, const vec3 &c, const vec3 &d) {
        Microfacets m = microfacets(BRDF_GGX, view, alpha_x, alpha_y);
        m.index = index;
        return microfacet_quad(m, a, b, c, d);
    }

    // The text's quadrilateral for any number of corners.
    Reflection polygon_reflection(const MicrofacetBatch<Number> &batch, std::size_t first, const Microfacets &m) {
        const std::size_t count = batch.width / 3;
        RimArc arcs[MAX_VERTICES + 1];
        Real flux = 0.0F;
        vec3 middle(Real(0.0F), Real(0.0F), Real(0.0F)), leave = middle, enter = middle;
        const auto add = [&](std::size_t k) {
            flux = flux + arcs[k].flux;
            middle = middle + lobe_turns(m, arcs[k]);
        };
        for (std::size_t k = 0; k < count; ++k) {
            const LitEdge edge =
                lit_edge(direction_of(batch, first, k), direction_of(batch, first, k + 1 < count ? k + 1 : 0));
            arcs[k] = lit_arc(m, edge);
            leave = leave + edge.leave;
            enter = enter + edge.enter;
            add(k);
        }
        arcs[count] = horizon_arc(m, leave, enter);
        add(count);
        Mean mean = mean_about(m, middle, flux);
        for (std::size_t k = 0; k <= count; ++k) {
            mean = with_arc(mean, m, arcs[k]);
        }
        return reflected(m, 0.0F, mean, flux);
    }

    Reflection light_reflection(const MicrofacetBatch<Number> &batch, std::size_t first, const Microfacets &m) {
        const auto stride = static_cast<std::ptrdiff_t>(batch.width);
        const auto vector = [&](std::size_t k) { return lanes3_of(batch.lights, stride, 3 * k, first, batch.count); };
        switch (batch.shape) {
        case LightShape::SPHERE:
            return microfacet_sphere(m, vector(0), lanes_of(batch.lights, stride, 3, first, batch.count));
        case LightShape::ELLIPSE:
            return microfacet_ellipse(m, vector(0), vector(1), vector(2));
        default:
            return polygon_reflection(batch, first, m);
        }
    }

    bool is_quad(const MicrofacetBatch<Number> &batch) {
        return batch.shape == LightShape::POLYGON && batch.width == 12 && batch.vertices == nullptr;
    }

    Reflection ggx_quad_reflection(const MicrofacetBatch<Number> &batch, std::size_t first, const vec3 &view,
                                   Real alpha_x, Real alpha_y) {
        const auto corner = [&](std::size_t k) { return lanes3_of(batch.lights, 12, 3 * k, first, batch.count); };
        return flat_ggx_quad(view, alpha_x, alpha_y, batch.index, corner(0), corner(1), corner(2), corner(3));
    }

    void reflect_batch(const MicrofacetBatch<Number> &batch) {
        for (std::size_t first = 0; first < batch.count; first += Isa::LANES) {
            const auto alpha = [&](std::size_t k) {
                return lanes_of(batch.alpha.values, batch.alpha.stride, k, first, batch.count);
            };
            const vec3 view = lanes3_of(batch.view.values, batch.view.stride, 0, first, batch.count);
            Reflection light;
            if (batch.brdf == Brdf::GGX && is_quad(batch)) {
                light = ggx_quad_reflection(batch, first, view, alpha(0), alpha(1));
            } else {
                Microfacets m = microfacets(static_cast<int>(batch.brdf), view, alpha(0), alpha(1));
                m.index = batch.index;
                light = light_reflection(batch, first, m);
            }
            alignas(64) Number plain[Isa::LANES], fresnel[Isa::LANES];
            Isa::store(light.plain, plain);
            Isa::store(light.fresnel, fresnel);
            for (std::size_t lane = 0; lane < Isa::LANES && first + lane < batch.count; ++lane) {
                batch.out[2 * (first + lane)] = plain[lane];
                batch.out[2 * (first + lane) + 1] = fresnel[lane];
            }
        }
    }
};

} // namespace sfumato
