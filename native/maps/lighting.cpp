// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/lighting.hpp"

#include "maps/map_kernels.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {

bool lights_smoke(const Light &light, const Body &body) {
    return body.takes_light && light.reach.smoke && (light.reach.lights & body.visibility.lit_by) != 0;
}

MediaViews views_of(std::span<const CroppedMedium> media, double step_length) {
    MediaViews out;
    out.light.reserve(media.size());
    for (const CroppedMedium &medium : media) {
        std::vector<const float *> &volumes = out.light.emplace_back();
        for (const auto &volume : medium.light) {
            volumes.push_back(volume->data());
        }
        MediumView &view = out.views.emplace_back();
        view.density = medium.grid->view();
        view.tint = medium.grid->tint.empty() ? nullptr : medium.grid->tint.data();
        if (!medium.emission.empty()) {
            view.glow = medium.grid->glow.data();
            view.emission = {&medium.emission.front().x, 3 * medium.emission.size()};
        }
        view.light = volumes;
        view.light_channels = medium.light_channels;
        view.clearance = medium.clearances();
        if (medium.ramp) {
            view.ramp = {medium.ramp->rows.data(), medium.ramp->parts()};
        }
        view.world_to_grid = affine(glm::inverse(medium.grid_to_world));
        view.anisotropy = medium.anisotropy;
        view.step_length = static_cast<float>(step_length);
        for (int c = 0; c < 3; ++c) {
            view.extinction[c] = medium.extinction[c];
            view.scattering[c] = medium.scattering[c];
        }
    }
    return out;
}

void LightParts::end_round() {
    maps.end_round();
    solids.end_round();
    sheets.end_round();
    trees.end_round();
    volumes.end_round();
    skies.end_round();
}

void Lighting::add_views(std::span<const Light> lights, const Surfaces &surfaces, LightParts &parts) {
    double cell = 0.0; // of the finest body that lights are asked about
    for (const Body &body : bodies_) {
        if (body.scatters) {
            cell = cell > 0.0 ? std::min(cell, body.cell_size) : body.cell_size;
        }
    }
    const auto add = [&](const Light &light, const Sky *sky) {
        views_.push_back(view_of(light, cell));
        views_.back().solids = view_of(surfaces.hiding(light));
        views_.back().sheets = view_of(surfaces.dimming(light));
        views_.back().sky = sky;
    };
    const bool directed =
        std::any_of(bodies_.begin(), bodies_.end(), [](const Body &b) { return std::abs(b.anisotropy) > 0.01F; });
    std::vector<std::pair<Light, const Sky *>> for_surfaces;
    for (const Light &light : lights) {
        const Sky *sky = nullptr;
        if (light.image) {
            skies_.push_back(parts.skies.get(Key().part(light.image), [&] { return Sky(*light.image); }));
            sky = skies_.back().get();
        }
        if (!surrounds(light) || (sky == nullptr && !directed)) {
            add(light, nullptr);
            continue;
        }
        for (const Light &part : parts_of_sky(light, sky)) {
            add(part, surrounds(part) ? sky : nullptr);
        }
        for_surfaces.emplace_back(light, sky);
        for_surfaces.back().first.reach.smoke = false;
    }
    for (const auto &[light, sky] : for_surfaces) {
        add(light, sky);
    }
    of_smoke_ = views_.size();
    while (of_smoke_ > 0 && !views_[of_smoke_ - 1].reach.smoke) {
        --of_smoke_;
    }
}

Lighting::Lighting(std::span<const Light> lights, std::vector<Body> bodies, const Surfaces &surfaces, int most_samples,
                   LightParts &parts, const AirView *air)
    : air_(air == nullptr ? std::nullopt : std::optional(*air)), bodies_(std::move(bodies)) {
    for (const Body &body : bodies_) {
        extinctions_.push_back(body.extinction);
    }
    add_views(lights, surfaces, parts);
    const auto many = std::count_if(views_.begin(), views_.end(), [](const LightView &v) { return v.of_many(); });
    // The faces of a mesh that glows, or the parts of a fire, are one light: what each throws is blurred by the others.
    const int share = std::max(most_samples / std::max(static_cast<int>(many), 1), std::min(most_samples, 4));
    for (const LightView &view : views_) {
        samples_.push_back(light_samples(view, bodies_, view.of_many() ? share : most_samples, air != nullptr));
    }
    shares_.resize(views_.size());
    std::vector<glm::dvec3> fluence; // of the last sky: its parts share it
    const Sky *of = nullptr;
    for (std::size_t i = 0; i < views_.size(); ++i) {
        views_[i].samples = samples_[i];
        if (views_[i].surrounds()) {
            if (of == nullptr || views_[i].sky != of) {
                fluence = sky_fluence(views_[i], most_samples);
                of = views_[i].sky;
            }
            weigh_sky(views_[i], fluence, shares_[i]);
        }
    }
}

void Lighting::build_maps(const Surfaces &surfaces, const LightMapSettings &settings, const InstructionSet &with,
                          LightParts &parts) {
    std::size_t maps = 0;
    const auto casters = std::count_if(bodies_.begin(), bodies_.end(), [](const Body &b) { return b.takes_light; });
    for (const std::vector<glm::vec3> &samples : samples_) {
        maps += samples.size() * static_cast<std::size_t>(casters);
    }
    constexpr double MOST_FLOATS = 1 << 28; // of all maps: a gibibyte
    for (std::size_t i = 0; i < views_.size(); ++i) {
        LightMapSettings map = settings;
        map.most_floats = std::min(map.most_floats, MOST_FLOATS / static_cast<double>(std::max<std::size_t>(maps, 1)));
        if (samples_[i].size() > 1) {
            // Each map is blurred by its neighbours: half the detail does, and less where they are all around.
            map.texels_per_cell *= views_[i].surrounds() ? 0.375 : 0.5;
        }
        std::vector<Map> &made = maps_.emplace_back();
        std::vector<LightMapView> &map_views = map_views_.emplace_back();
        for (const glm::vec3 &sample : samples_[i]) {
            for (const Body &body : bodies_) {
                // One number a texel, as coarse as itself.
                LightMapSettings solids = map;
                solids.coefficients = 1;
                solids.texels_per_cell = samples_[i].size() > 1 ? 0.5 : 1.0;
                solids.blur = 0.0;
                map.blur = map.shared ? shadow_blur(views_[i], body) : 0.0;
                made.push_back(
                    build_map(views_[i], glm::dvec3(sample), body, surfaces, body.clear ? solids : map, with, parts));
                map_views.push_back(made.back().view());
            }
        }
    }
    for (std::size_t i = 0; i < views_.size(); ++i) {
        views_[i].maps = map_views_[i].data();
    }
}

LightMapView Lighting::Map::view() const {
    LightMapView view = columns ? columns->view(solids.get(), sheets.get()) : LightMapView{};
    if (tree) {
        view.tree = tree->view();
    }
    return view;
}

Lighting::Map Lighting::build_map(const LightView &light, const glm::dvec3 &sample, const Body &body,
                                  const Surfaces &surfaces, const LightMapSettings &settings,
                                  const InstructionSet &with, LightParts &parts) {
    if (!body.takes_light || !meets(light, sample, ball_of(body))) {
        return {};
    }
    LightMap plan =
        light.parallel() ? plan_parallel_map(body, -sample, settings) : plan_radial_map(body, sample, settings);
    // The mesh does not shade the air just before its faces.
    const double nearest = light.of_mesh() ? 1e-3 * double{light.radius} : 0.0;
    Key rays;
    rays.number(plan.size.x, plan.size.y, plan.slices, static_cast<int>(plan.radial));
    rays.numbers(std::span<const double>(&plan.world_to_light[0].x, 16));
    rays.numbers(std::span<const double>(&plan.low.x, 3)).numbers(std::span<const double>(&plan.high.x, 3));
    Key columns = rays, solids = rays, sheets = rays;
    body.identify(columns);
    columns.number(plan.series.name, plan.series.count, plan.shared, plan.curved, plan.blur);
    if (plan.curved) {
        columns.number(body.extinction.x, body.extinction.y, body.extinction.z);
    }
    solids.part(surfaces.hiding(light)).number(nearest);
    const bool hides = (body.visibility.hides & light.reach.hidden_by) != 0;
    columns.number(hides);
    Map map;
    map.solids = parts.solids.get(solids, [&] { return find_solids(plan, light.solids, nearest); });
    if (light.sheets.scene != nullptr) {
        sheets.part(surfaces.dimming(light)).number(nearest);
        surfaces.add_dimming(sheets);
        map.sheets =
            parts.sheets.get(sheets, [&] { return find_sheets(plan, surfaces.view(), light.sheets, nearest); });
    }
    if (body.followed) {
        map.tree = parts.trees.get(Key().part(map.solids),
                                   [&] { return DepthTree(map.solids->data(), plan.size.x, plan.size.y); });
    }
    map.columns =
        parts.maps.get(columns, [&] { return hides ? body.project(std::move(plan), with) : std::move(plan); });
    return map;
}

Key Lighting::arriving_key(std::size_t light, std::size_t own, bool grey) const {
    const LightView &view = views_[light];
    Key key;
    key.number(static_cast<int>(grey), static_cast<int>(view.kind), static_cast<int>(view.spot_cosine),
               static_cast<int>(view.oval));
    key.number(view.radius, view.cone_cosine, view.blend, view.facing2, view.spread_cotangent, view.area, view.size2);
    for (const glm::vec3 &v : {view.position, view.direction, view.across, view.up, view.corners[0], view.corners[1],
                               view.corners[2], view.corners[3]}) {
        key.number(v.x, v.y, v.z);
    }
    if (!samples_[light].empty()) {
        key.numbers(std::span<const float>(&samples_[light].front().x, 3 * samples_[light].size()));
    }
    key.numbers(std::span<const float>(shares_[light]));
    for (const Map &map : maps_[light]) {
        key.part(map.columns).part(map.solids).part(map.sheets);
    }
    key.number(lights_smoke(view, bodies_[own]), own);
    if (air_ && !(view.parallel() && air_->per_height == 0.0F)) {
        key.number(air_->extinction.x, air_->extinction.y, air_->extinction.z, air_->per_height, air_->ground);
    }
    key.numbers(std::span<const float>(&extinctions_.front().x, 3 * extinctions_.size()));
    return key;
}

void Lighting::fill_volumes(std::vector<CroppedMedium> &media, bool grey, const InstructionSet &with,
                            LightParts &parts) const {
    for (CroppedMedium &medium : media) {
        medium.light_channels = grey ? 2 : 4;
        medium.light.clear();
    }
    for (std::size_t m = 0; m < media.size(); ++m) {
        const CroppedMedium &medium = media[m];
        const std::size_t floats = medium.grid->density.size() * static_cast<std::size_t>(medium.light_channels);
        std::vector<std::shared_ptr<const LightVolume>> volumes;
        for (std::size_t i = 0; i < of_smoke_; ++i) {
            Key key = arriving_key(i, m, grey);
            key.part(medium.grid).numbers(std::span<const double>(&medium.grid_to_world[0].x, 16));
            volumes.push_back(parts.volumes.get(key, [&] {
                LightVolume volume(floats, 0.0F);
                if (!lights_smoke(views_[i], bodies_[m])) {
                    return volume;
                }
                LightBox box;
                box.at = {&views_[i], extinctions_, static_cast<int>(m), grey, air_ ? &*air_ : nullptr};
                // Not the ramp's: a stop that moves may leave the volume as it is.
                box.clearance = medium.grid->clearances();
                box.grid_to_world = affine(medium.grid_to_world);
                const Grid &grid = *medium.grid;
                oneapi::tbb::parallel_for(0, grid.boxes(), [&with, &grid, &volume, box](int number) {
                    const Grid::Box stored = grid.box(number);
                    LightBox own = box;
                    own.first = stored.first;
                    own.size = stored.size;
                    own.values = volume.data() + stored.begin * (own.at.grey ? 2 : 4);
                    map_kernels(with).light_box(own);
                });
                return volume;
            }));
        }
        media[m].light = std::move(volumes);
    }
}

const LightMap *Lighting::map(std::size_t light, std::size_t sample, std::size_t body) const {
    if (light >= maps_.size() || body >= bodies_.size() || sample >= samples_[light].size()) {
        return nullptr;
    }
    const LightMap *const map = maps_[light][sample * bodies_.size() + body].columns.get();
    return map == nullptr || map->bytes() == 0 ? nullptr : map;
}

} // namespace sfumato
