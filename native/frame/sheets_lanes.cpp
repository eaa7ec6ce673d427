// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the sheets: what lets light through before the first opaque surface of each ray, as fragments.
#include "frame/bounced_lanes.hpp"
#include "frame/more_lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

// The hits of all lanes in order of depth: the first of each, then the second.
class Ranks {
public:
    explicit Ranks(const std::vector<Hit> &hits) : hits_(hits) {
        std::fill_n(next_, LANES, std::size_t{0});
        std::fill_n(end_, LANES, std::size_t{0});
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const auto lane = static_cast<std::size_t>(hits[i].lane);
            next_[lane] = end_[lane] == 0 ? i : next_[lane];
            end_[lane] = i + 1;
        }
    }

    // The next of each of the lanes that are still looking; false where none has any.
    bool next(Mask looking, Met &met) {
        alignas(64) float asked[LANES], distances[LANES];
        pick(looking, 1.0F, 0.0F).store_aligned(asked);
        bool any = false;
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            met.hit[lane] = asked[lane] > 0.0F && next_[lane] < end_[lane];
            distances[lane] = 0.0F;
            if (!met.hit[lane]) {
                continue;
            }
            any = true;
            const Hit &hit = hits_[next_[lane]++];
            distances[lane] = hit.distance;
            met.place[lane] = hit.place;
            met.triangle[lane] = hit.triangle;
            met.u[lane] = hit.u;
            met.v[lane] = hit.v;
        }
        met.distance = Real::load_aligned(distances);
        return any;
    }

private:
    const std::vector<Hit> &hits_;
    std::size_t next_[LANES], end_[LANES];
};

constexpr float FARTHEST = 1e6F; // metres

Real mean(const Real (&rgb)[3]) {
    return (rgb[0] + rgb[1] + rgb[2]) * (1.0F / 3.0F);
}

void keep(Mask where, const vec3 &value, float (&to)[3][MAX_LANES]) {
    store(pick(where, value, load(to)), to);
}

void keep(Mask where, Real value, float *to) {
    pick(where, value, Real::load_aligned(to)).store_aligned(to);
}

// Lays what sheets send over what is behind them, sheet by sheet.
class Over {
public:
    explicit Over(Layers &layers) : layers_(layers) {
        for (Real &share : left_) {
            share = 1.0F;
        }
    }

    // Of the lanes that meet a sheet, what it sends; `through` is what it leaves.
    void add(const FrameView &frame, LayerSet wanted, const Ray &ray, const Surface &sheet, const Reflected &light,
             const Real (&through)[3]) {
        const Real before = mean(left_), alpha = 1.0F - mean(through);
        open_ = open_ + pick(sheet.hit, before * mean(light.open), 0.0F);
        unshadowed_ = unshadowed_ + pick(sheet.hit, before * light.unshadowed, 0.0F);
        if (layers_.passes != nullptr) {
            add_passes(frame, wanted, ray, sheet, light, alpha);
        }
        for (int c = 0; c < 3; ++c) {
            left_[c] = pick(sheet.hit, left_[c] * through[c], left_[c]);
        }
    }

    // The lanes in which there is still something to see.
    [[nodiscard]] Mask looking() const { return max(max(left_[0], left_[1]), left_[2]) > OPAQUE_LEFT; }

    void finish(LayerSet wanted) {
        const Real left = mean(left_);
        over(open_, left, layers_.open);
        over(unshadowed_, left, layers_.unshadowed);
        if (layers_.passes == nullptr) {
            return;
        }
        PassLayers &passes = *layers_.passes;
        for (int c = 0; c < 3; ++c) {
            over(lights_[c].open, left_[c], passes.open[c]);
            over(lights_[c].past_smoke, left_[c], passes.past_smoke[c]);
            over(lights_[c].shadowed, left_[c], passes.shadowed[c]);
            over(lights_[c].unshadowed, left_[c], passes.unshadowed[c]);
        }
        if (wanted.has(Layer::MIST)) {
            over(mist_, left, passes.mist);
        }
    }

private:
    struct Light {
        Real open = 0.0F, past_smoke = 0.0F, shadowed = 0.0F, unshadowed = 0.0F;
    };

    static void over(Real sum, Real left, float *values) {
        (sum + left * Real::load_aligned(values)).store_aligned(values);
    }

    // What a compositor is told of one surface is of the first that is opaque enough.
    void add_passes(const FrameView &frame, LayerSet wanted, const Ray &ray, const Surface &sheet,
                    const Reflected &light, Real alpha) {
        const vec3 point = ray.origin + ray.direction * sheet.distance;
        const vec3 glow = sheet.emission;
        for (int c = 0; c < 3; ++c) {
            const auto sum = [&](Real &to, Real value) { to = to + pick(sheet.hit, left_[c] * value, 0.0F); };
            sum(lights_[c].open, light.open[c]);
            sum(lights_[c].past_smoke, light.shadowed[c]);
            sum(lights_[c].shadowed, light.shadowed[c] - component(glow, c));
            sum(lights_[c].unshadowed, light.lit[c]);
        }
        if (wanted.has(Layer::MIST)) {
            mist_ = mist_ + pick(sheet.hit, mean(left_) * alpha * mist_at(frame.mist, point, sheet.hit), 0.0F);
        }
        const Mask first = sheet.hit & (told_ < 0.5F) & (alpha >= frame.least_alpha);
        told_ = pick(first, 1.0F, told_);
        if (!xsimd::any(first)) {
            return;
        }
        PassLayers &passes = *layers_.passes;
        keep(first, Real(1.0F), layers_.hit);
        if (wanted.has(Layer::POSITION)) {
            keep(first, point, passes.position);
        }
        if (wanted.has(Layer::NORMAL)) {
            keep(first, sheet.normal, passes.normal);
        }
        if (wanted.has(Layer::OBJECT_INDEX)) {
            keep(first, sheet.object_index, passes.object_index);
        }
        if (wanted.has(Layer::MATERIAL_INDEX)) {
            keep(first, gather(frame.surfaces.properties + material_row::NUMBER, sheet.material),
                 passes.material_index);
        }
    }

    Layers &layers_;
    Real left_[3];
    Real open_ = 0.0F, unshadowed_ = 0.0F, mist_ = 0.0F, told_ = 0.0F;
    Light lights_[3];
};

} // namespace

void trace_sheets(const FrameView &frame, LayerSet wanted, const Packet &packet, Layers &layers) {
    const Mask active = Real::load_aligned(packet.active) > 0.0F;
    const Ray ray = ray_through(frame, Real::load_aligned(packet.u), Real::load_aligned(packet.v));
    for (int c = 0; c < 3 && !wanted.has(Layer::SMOKE); ++c) { // no march does
        Real(0.0F).store_aligned(layers.smoke[c]);
        Real(1.0F).store_aligned(layers.through[c]);
    }
    const std::optional<Beside> beside = beside_of(frame, packet);
    std::vector<Hit> hits;
    all_hits(frame.surfaces.places, frame.surfaces.sheets, ray.origin, ray.direction,
             Real::load_aligned(layers.distance), active, hits);
    if (hits.empty()) {
        return;
    }
    Ranks ranks(hits);
    Over over(layers);
    Met met;
    while (ranks.next(over.looking(), met)) {
        const Surface sheet = surface_at(frame.surfaces, met, ray, beside ? &*beside : nullptr);
        Reflected light = all_reflected(frame, wanted, packet, ray, sheet);
        if (wanted.has(Layer::RADIANCE) && (frame.bounces.gloss || frame.bounces.diffuse)) {
            add_from_others(from_others(frame, packet, ray, sheet, sheet.hit, true), light);
            add_from_behind(frame, packet, ray, sheet, sheet.hit, light);
        }
        Real through[3];
        alignas(64) float sent[3][LANES], left[3][LANES];
        for (int c = 0; c < 3; ++c) {
            through[c] = component(sheet.transmittance, c);
            light.shadowed[c].store_aligned(sent[c]);
            through[c].store_aligned(left[c]);
        }
        alignas(64) float distances[LANES];
        met.distance.store_aligned(distances);
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            if (met.hit[lane]) {
                layers.events->add(lane, {distances[lane],
                                          {sent[0][lane], sent[1][lane], sent[2][lane]},
                                          {left[0][lane], left[1][lane], left[2][lane]}});
            }
        }
        over.add(frame, wanted, ray, sheet, light, through);
    }
    over.finish(wanted);
}

void meet_more(const FrameView &frame, std::span<const BounceRay> rays, std::vector<BouncePoint> &out) {
    const auto keep_places = [&out](const Surface &surface, const Ray &ray) {
        const vec3 point = ray.origin + ray.direction * surface.distance;
        const vec3 start = point + surface.geometric_normal * offset_of(point, surface.distance);
        alignas(64) float hits[MAX_LANES], position[3][MAX_LANES], normal[3][MAX_LANES];
        pick(surface.hit, 1.0F, 0.0F).store_aligned(hits);
        store(start, position);
        store(surface.normal, normal);
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            if (hits[lane] > 0.0F) {
                BouncePoint &place = out.emplace_back();
                place.hit = true;
                place.position = {position[0][lane], position[1][lane], position[2][lane]};
                place.normal = {normal[0][lane], normal[1][lane], normal[2][lane]};
            }
        }
    };
    std::vector<Hit> hits;
    for (std::size_t first = 0; first < rays.size(); first += LANES) {
        alignas(64) float origin[3][MAX_LANES], direction[3][MAX_LANES], asked[MAX_LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const BounceRay &ray = rays[std::min(first + lane, rays.size() - 1)];
            for (int axis = 0; axis < 3; ++axis) {
                origin[axis][lane] = ray.origin[axis];
                direction[axis][lane] = ray.direction[axis];
            }
            asked[lane] = first + lane < rays.size() ? 1.0F : 0.0F;
        }
        const Mask active = Real::load_aligned(asked) > 0.0F;
        const Ray ray{load(origin), load(direction), FARTHEST};
        const Surface solid = first_surface(frame.surfaces, frame.surfaces.seen, ray, active, nullptr);
        if (frame.surfaces.more && xsimd::any(solid.hit)) {
            keep_places(behind(solid), ray);
        }
        all_hits(frame.surfaces.places, frame.surfaces.sheets, ray.origin, ray.direction,
                 pick(solid.hit, solid.distance, FARTHEST), active, hits);
        Ranks ranks(hits);
        Met met;
        while (ranks.next(active, met)) {
            const Surface sheet = surface_at(frame.surfaces, met, ray);
            keep_places(sheet, ray);
            if (frame.surfaces.more) {
                keep_places(behind(sheet), ray);
            }
        }
    }
}

void light_sheets(const FrameView &frame, std::span<const SheetPoint> points, std::span<glm::vec3> out) {
    Packet packet;
    std::fill_n(packet.light_u, LANES, 0.5F);
    std::fill_n(packet.light_v, LANES, 0.5F);
    for (std::size_t first = 0; first < points.size(); first += LANES) {
        const auto some = points.subspan(first, std::min(points.size() - first, std::size_t{LANES}));
        alignas(64) float origin[3][LANES], direction[3][LANES], distance[LANES], sent[3][LANES];
        Met met;
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const SheetPoint &point = some[std::min(lane, some.size() - 1)];
            for (int axis = 0; axis < 3; ++axis) {
                direction[axis][lane] = point.direction[axis];
                origin[axis][lane] = point.point[axis] - point.direction[axis] * point.distance;
            }
            distance[lane] = point.distance;
            met.hit[lane] = true;
            met.place[lane] = point.place;
            met.triangle[lane] = point.triangle;
            met.u[lane] = point.u;
            met.v[lane] = point.v;
        }
        const auto loaded = [](const float(&v)[3][LANES]) {
            return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
        };
        met.distance = Real::load_aligned(distance);
        const Ray ray{loaded(origin), loaded(direction), met.distance};
        const Surface sheet = surface_at(frame.surfaces, met, ray);
        const Reflected light = all_reflected(frame, Layer::RADIANCE, packet, ray, sheet);
        for (int c = 0; c < 3; ++c) {
            light.shadowed[c].store_aligned(sent[c]);
        }
        for (std::size_t lane = 0; lane < some.size(); ++lane) {
            out[first + lane] = {sent[0][lane], sent[1][lane], sent[2][lane]};
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
