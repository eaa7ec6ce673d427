// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the surfaces: the first on each ray of a packet, and the light on it past solids and smoke.
#include "frame/bounced_lanes.hpp"
#include "frame/more_lanes.hpp"
#include "lights/sky_lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

namespace sfumato::SFUMATO_ISA {
namespace {

// `light` is that of the surfaces themselves, also where holdouts and catchers show something else; `shadowed` and
// `open` are those of the packet, the background's too.
void store_passes(const FrameView &frame, LayerSet wanted, const Ray &ray, const Surface &surface,
                  const Reflected &light, const Real (&shadowed)[3], const Real (&open)[3], PassLayers &out) {
    const vec3 point = ray.origin + ray.direction * surface.distance, nothing = broadcast(glm::vec3(0.0F));
    if (wanted.has(Layer::POSITION)) {
        store(pick(surface.hit, point, nothing), out.position);
    }
    if (wanted.has(Layer::NORMAL)) {
        store(pick(surface.hit, surface.normal, nothing), out.normal);
    }
    if (wanted.has(Layer::MIST)) {
        mist_at(frame.mist, point, surface.hit).store_aligned(out.mist);
    }
    if (wanted.has(Layer::OBJECT_INDEX)) {
        pick(surface.hit, surface.object_index, 0.0F).store_aligned(out.object_index);
    }
    if (wanted.has(Layer::MATERIAL_INDEX)) {
        const bool any = xsimd::any(surface.hit);
        const Real index =
            any ? gather(frame.surfaces.properties + material_row::NUMBER, surface.material) : Real(0.0F);
        pick(surface.hit, index, 0.0F).store_aligned(out.material_index);
    }
    const Real glow[3] = {surface.emission.x, surface.emission.y, surface.emission.z};
    for (int c = 0; c < 3; ++c) {
        pick(surface.hit, light.open[c], open[c]).store_aligned(out.open[c]);
        pick(surface.hit, light.shadowed[c], shadowed[c]).store_aligned(out.past_smoke[c]);
        pick(surface.hit, light.shadowed[c] - glow[c] - light.bounced[c], 0.0F).store_aligned(out.shadowed[c]);
        pick(surface.hit, light.lit[c], 0.0F).store_aligned(out.unshadowed[c]);
    }
}

} // namespace

void trace_surfaces(const FrameView &frame, LayerSet wanted, const Packet &packet, Layers &out) {
    const Mask active = Real::load_aligned(packet.active) > 0.0F;
    const Ray ray = ray_through(frame, Real::load_aligned(packet.u), Real::load_aligned(packet.v));
    const bool radiance = wanted.has(Layer::RADIANCE);
    // A shadow is laid over a picture that shows all solids.
    const std::optional<Beside> beside = beside_of(frame, packet);
    const Surface surface = first_surface(frame.surfaces, radiance ? frame.surfaces.seen : frame.surfaces.all, ray,
                                          active, beside ? &*beside : nullptr);
    surface.distance.store_aligned(out.distance);
    pick(surface.hit, 1.0F, 0.0F).store_aligned(out.hit);
    const vec3 behind = frame.backdrop.rgb == nullptr
                            ? broadcast(frame.background)
                            : multiplied(radiance_in(frame.backdrop, ray.direction), broadcast(frame.background));
    Real shadowed[3], open[3]; // with the shadow of the smoke and without
    for (int i = 0; i < 3; ++i) {
        shadowed[i] = open[i] = radiance ? component(behind, i) : Real(0.0F);
    }
    Real unshadowed = (open[0] + open[1] + open[2]) * (1.0F / 3.0F);
    Real cover = pick(surface.hit, 1.0F, frame.background_alpha), caught = 0.0F, caught_open = 0.0F;
    Reflected light = no_light();
    Reflected own = light;
    FromOthers others = from_no_others();
    if (xsimd::any(surface.hit)) {
        own = light = all_reflected(frame, wanted, packet, ray, surface);
        if (radiance && (frame.bounces.gloss || frame.bounces.diffuse)) {
            Mask shown = surface.hit;
            if (!frame.surfaces.plain) {
                shown = shown & !catchers(surface) &
                        !where(surface, [](const Visibility &v) { return v.seen == Seen::HOLDOUT; });
            }
            others = from_others(frame, packet, ray, surface, shown, frame.bounces.settled);
            add_from_others(others, light);
            add_from_others(others, own);
            add_from_behind(frame, packet, ray, surface, shown, light, &own);
        }
        if (radiance && !frame.surfaces.plain) {
            const Mask held = where(surface, [](const Visibility &v) { return v.seen == Seen::HOLDOUT; });
            const Mask catching = catchers(surface);
            cover = pick(held, 0.0F, cover);
            light.unshadowed = pick(held, 0.0F, light.unshadowed);
            for (int i = 0; i < 3; ++i) {
                // Where a catcher has no light of its own, none is missing.
                const Real whole = max(light.alone[i], 1e-20F);
                const auto share = [&](Real left) {
                    return pick(light.alone[i] > 0.0F, min(left / whole, 1.0F), 1.0F);
                };
                const Real left = share(light.shadowed[i]), left_open = share(light.open[i]);
                caught = caught + pick(catching, (1.0F - left) * (1.0F / 3.0F), 0.0F);
                caught_open = caught_open + pick(catching, (1.0F - left_open) * (1.0F / 3.0F), 0.0F);
                light.shadowed[i] = pick(held, 0.0F, pick(catching, left * component(behind, i), light.shadowed[i]));
                light.open[i] = pick(held, 0.0F, pick(catching, left_open * component(behind, i), light.open[i]));
            }
            cover = pick(catching, frame.background_alpha + (1.0F - frame.background_alpha) * caught, cover);
        }
        for (int i = 0; i < 3; ++i) {
            shadowed[i] = pick(surface.hit, light.shadowed[i], shadowed[i]);
            open[i] = pick(surface.hit, light.open[i], open[i]);
        }
        unshadowed = pick(surface.hit, light.unshadowed, unshadowed);
    }
    const Real *const seen = radiance ? open : shadowed;
    Real told = (seen[0] + seen[1] + seen[2]) * (1.0F / 3.0F) + caught_open;
    if (radiance && xsimd::any(surface.hit & surface.varied)) {
        const Mask plain = surface.hit & surface.varied & (cover >= 1.0F) & (caught <= 0.0F);
        told = pick(plain, own.even, told);
        unshadowed = pick(plain, own.even_unshadowed, unshadowed);
    }
    told.store_aligned(out.open);
    cover.store_aligned(out.cover);
    caught.store_aligned(out.caught);
    unshadowed.store_aligned(out.unshadowed);
    const Mask of_sky = surface.hit & (cover >= 1.0F) & (caught <= 0.0F);
    for (const auto &[from, to] : {std::pair(&light.dull, &out.sky.dull), std::pair(&light.gloss, &out.sky.gloss)}) {
        store(from->all, to->all);
        store(from->seen, to->seen);
        pick(of_sky, from->open, 0.0F).store_aligned(to->open);
        for (int i = 0; i < 3; ++i) {
            pick(of_sky, from->light[i], 0.0F).store_aligned(to->light[i]);
        }
    }
    for (const auto &[from, to] : {std::pair(&others.dull, &out.sky.dull), std::pair(&others.gloss, &out.sky.gloss)}) {
        store(from->weight, to->weight);
        store(from->found, to->found);
    }
    store(surface.normal, out.sky.normal);
    for (int i = 0; i < 3; ++i) {
        shadowed[i].store_aligned(out.surface[i]);
    }
    if (out.passes != nullptr) {
        store_passes(frame, wanted, ray, surface, own, shadowed, open, *out.passes);
    }
}

} // namespace sfumato::SFUMATO_ISA
