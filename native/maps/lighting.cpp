// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/lighting.hpp"

#include "maps/map_kernels.hpp"
#include "scene/scene.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

// A sphere around a medium.
struct Ball {
    glm::dvec3 middle{0.0};
    double radius = 0.0;
};

Ball ball_of(const CroppedMedium &medium) {
    const glm::dvec3 n(medium.grid->resolution);
    const glm::dmat4 &m = medium.grid_to_world;
    Ball ball{glm::dvec3(m * glm::dvec4(0.5 * n, 1.0)), 0.0};
    for (int corner = 0; corner < 4; ++corner) { // the other four are their mirror images
        const glm::dvec3 at(n.x, (corner & 1) != 0 ? n.y : 0.0, (corner & 2) != 0 ? n.z : 0.0);
        ball.radius = std::max(ball.radius, glm::distance(ball.middle, glm::dvec3(m * glm::dvec4(at, 1.0))));
    }
    return ball;
}

// Whether light from `sample` can meet the medium at all: not behind an area light, not outside a spot's cone.
bool meets(const LightView &light, const glm::dvec3 &sample, const Ball &ball) {
    if (light.kind == Light::Kind::SUN) {
        return true;
    }
    const glm::dvec3 across = ball.middle - sample;
    const double distance = glm::length(across), along = glm::dot(across, glm::dvec3(light.direction));
    if (light.kind == Light::Kind::POLYGON) {
        return true;
    }
    if (light.kind != Light::Kind::SPHERE) {
        return along > -ball.radius;
    }
    if (light.cone_cosine <= -1.0F || distance <= ball.radius) {
        return true;
    }
    const double cone = std::acos(std::clamp(double{light.cone_cosine}, -1.0, 1.0));
    return std::acos(std::clamp(along / distance, -1.0, 1.0)) - std::asin(ball.radius / distance) < cone;
}

// A lattice of `count` points that share the square [-1, 1]^2 evenly (Fibonacci's), each with its mirror image, so that
// the middle of them is the middle of the light.
glm::dvec2 on_square(int i, int count) {
    const double from_middle = i - 0.5 * (count - 1);
    const double turn = std::numbers::phi * from_middle + 0.5;
    return 2.0 * glm::dvec2(from_middle / count, turn - std::floor(turn) - 0.5);
}

// The unit vector on the side of `axis`, another, whose part across it is given.
glm::dvec3 on_dome(const glm::dvec3 &axis, const glm::dvec3 &across) {
    return across + axis * std::sqrt(std::max(1.0 - glm::dot(across, across), 0.0));
}

} // namespace

LightView view_of(const Light &light, double cell) {
    LightView view;
    view.kind = light.kind;
    view.strength = light.strength;
    view.position = light.position;
    view.direction = light.direction;
    view.across = light.across;
    view.up = light.up;
    const double least = 0.25 * cell;
    double size = 0.0;
    switch (light.kind) {
    case Light::Kind::SUN: {
        const glm::dmat3 axes = axes_of(glm::dvec3(light.direction));
        // Of a cone's projection on the plane that faces the sun, equal areas bring equal parts of the irradiance.
        const double radius = std::sin(0.5 * double{light.angle});
        view.across = glm::vec3(axes[0] * radius);
        view.up = glm::vec3(axes[1] * radius);
        view.radius = static_cast<float>(radius);
        break;
    }
    case Light::Kind::SPHERE:
        view.radius = light.radius;
        view.blend = light.blend;
        view.spot_cosine = light.spot_cosine;
        view.facing2 = light.facing_disk ? light.radius * light.radius : 0.0F;
        view.cone_cosine =
            light.cone < 2.0F * std::numbers::pi_v<float> ? std::cos(0.5F * light.cone) : view.cone_cosine;
        size = double{light.radius};
        break;
    case Light::Kind::RECTANGLE:
    case Light::Kind::ELLIPSE: {
        const double edges = glm::length(glm::dvec3(light.across)) * glm::length(glm::dvec3(light.up));
        const double area = (light.kind == Light::Kind::ELLIPSE ? std::numbers::pi : 4.0) * edges;
        view.area = static_cast<float>(area);
        view.radius = static_cast<float>(std::sqrt(area / std::numbers::pi));
        view.spread_cotangent = light.spread < std::numbers::pi_v<float> ? 1.0F / std::tan(0.5F * light.spread) : 0.0F;
        size = double{view.radius};
        break;
    }
    case Light::Kind::POLYGON: {
        const glm::dvec3 a(light.corners[0]), b(light.corners[1]), c(light.corners[2]), d(light.corners[3]);
        const glm::dvec3 first = 0.5 * glm::cross(b - a, c - a), second = 0.5 * glm::cross(c - a, d - a);
        const double of_first = glm::length(first), area = of_first + glm::length(second);
        std::copy(light.corners.begin(), light.corners.end(), view.corners);
        view.position = glm::vec3((a + c + glm::mix(d, b, of_first / area)) / 3.0);
        view.direction = glm::vec3(glm::normalize(first + second));
        view.area = static_cast<float>(area);
        view.radius = static_cast<float>(std::sqrt(area / std::numbers::pi));
        size = double{view.radius};
        break;
    }
    }
    view.size2 = static_cast<float>(std::max(size * size, least * least));
    return view;
}

std::vector<glm::vec3> light_samples(const LightView &light, std::span<const CroppedMedium> media, int most) {
    // How far the shadow of one point of the smoke spreads over as much air as the smoke is wide, in cells.
    double blur = 0.0;
    for (const CroppedMedium &medium : media) {
        const Ball ball = ball_of(medium);
        double angle = double{light.radius};
        if (light.kind != Light::Kind::SUN) {
            angle /= std::max(glm::distance(ball.middle, glm::dvec3(light.position)) - ball.radius, medium.cell_size);
        }
        blur = std::max(blur, 4.0 * angle * ball.radius / medium.cell_size);
    }
    // Shadows three cells apart melt into one.
    const int count = std::clamp(static_cast<int>(std::ceil(std::pow(std::min(blur / 3.0, 1e3), 2.0))), 1, most);
    std::vector<glm::vec3> samples;
    const glm::dvec3 position(light.position), towards(-glm::dvec3(light.direction));
    for (int i = 0; i < count; ++i) {
        const glm::dvec2 square = on_square(i, count);
        const LightsText::DiskPoint on_disk =
            LightsText().point_on_disk(static_cast<float>(square.x), static_cast<float>(square.y));
        const glm::dvec2 disk(on_disk.x, on_disk.y);
        const glm::dvec3 across(light.across), up(light.up);
        switch (light.kind) {
        case Light::Kind::SUN:
            samples.emplace_back(on_dome(towards, across * disk.x + up * disk.y));
            break;
        case Light::Kind::SPHERE: {
            // The disk that the sphere shows to the smoke.
            const glm::dvec3 middle = media.empty() ? position + towards : ball_of(media.front()).middle;
            const glm::dvec3 look = middle - position;
            const glm::dmat3 axes = axes_of(glm::length(look) > 0.0 ? look : towards);
            samples.emplace_back(position + double{light.radius} * (axes[0] * disk.x + axes[1] * disk.y));
            break;
        }
        case Light::Kind::RECTANGLE:
            samples.emplace_back(position + across * square.x + up * square.y);
            break;
        case Light::Kind::ELLIPSE:
            samples.emplace_back(position + across * disk.x + up * disk.y);
            break;
        case Light::Kind::POLYGON: {
            const glm::vec2 unit(0.5 * square + 0.5);
            const glm::vec3 *const c = light.corners;
            samples.push_back(LightsText().point_on_quad(c[0], c[1], c[2], c[3], unit.x, unit.y));
            break;
        }
        }
    }
    return samples;
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
        view.light = volumes;
        view.light_channels = medium.light_channels;
        view.clearance = medium.grid->clearances();
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
    volumes.end_round();
}

Lighting::Lighting(std::span<const Light> lights, std::vector<CroppedMedium> &media, const Surfaces &surfaces,
                   const LightingSettings &settings, bool grey, const InstructionSet &with, LightParts &parts)
    : media_(media.size()) {
    place_samples(lights, media, settings.most_samples);
    build_maps(media, surfaces, settings.map, with, parts);
    for (std::size_t i = 0; i < views_.size(); ++i) {
        views_[i].samples = samples_[i];
        views_[i].maps = map_views_[i].data();
    }
    fill_volumes(media, grey, with, parts);
}

void Lighting::place_samples(std::span<const Light> lights, std::span<const CroppedMedium> media, int most_samples) {
    double cell = media.empty() ? 0.0 : media.front().cell_size;
    for (const CroppedMedium &medium : media) {
        cell = std::min(cell, medium.cell_size);
    }
    const auto polygons = std::max(1, static_cast<int>(std::count_if(lights.begin(), lights.end(), [](const Light &l) {
                                       return l.kind == Light::Kind::POLYGON;
                                   })));
    for (const Light &light : lights) {
        const LightView &view = views_.emplace_back(view_of(light, cell));
        // The faces of a mesh that glows are parts of one light: what each of them throws is blurred by the others.
        const int share = std::max(most_samples / polygons, std::min(most_samples, 4));
        const int most = light.kind == Light::Kind::POLYGON ? share : most_samples;
        samples_.push_back(light_samples(view, media, most));
    }
}

void Lighting::build_maps(std::span<const CroppedMedium> media, const Surfaces &surfaces,
                          const LightMapSettings &settings, const InstructionSet &with, LightParts &parts) {
    std::size_t maps = 0;
    for (const std::vector<glm::vec3> &samples : samples_) {
        maps += samples.size() * media_;
    }
    constexpr double MOST_FLOATS = 1 << 28; // of all maps: a gibibyte
    for (std::size_t i = 0; i < views_.size(); ++i) {
        LightMapSettings map = settings;
        map.most_floats = std::min(map.most_floats, MOST_FLOATS / static_cast<double>(std::max<std::size_t>(maps, 1)));
        if (samples_[i].size() > 1) {
            // Each map is blurred by its neighbours: half the detail does.
            map.texels_per_cell *= 0.5;
        }
        std::vector<Map> &made = maps_.emplace_back();
        std::vector<LightMapView> &map_views = map_views_.emplace_back();
        for (const glm::vec3 &sample : samples_[i]) {
            for (const CroppedMedium &medium : media) {
                made.push_back(build_map(views_[i], glm::dvec3(sample), medium, surfaces, map, with, parts));
                map_views.push_back(made.back().columns ? made.back().columns->view(made.back().solids.get())
                                                        : LightMapView{});
            }
        }
    }
}

Lighting::Map Lighting::build_map(const LightView &light, const glm::dvec3 &sample, const CroppedMedium &medium,
                                  const Surfaces &surfaces, const LightMapSettings &settings,
                                  const InstructionSet &with, LightParts &parts) const {
    if (!meets(light, sample, ball_of(medium))) {
        return {};
    }
    LightMap plan = light.kind == Light::Kind::SUN ? plan_parallel_map(medium, -sample, settings)
                                                   : plan_radial_map(medium, sample, settings);
    // The mesh that a polygon is a part of does not shade the air just before it.
    const double nearest = light.kind == Light::Kind::POLYGON ? 1e-3 * double{light.radius} : 0.0;
    Key rays;
    rays.number(plan.count, plan.size.x, plan.size.y, plan.slices, static_cast<int>(plan.radial));
    rays.numbers(std::span<const double>(&plan.world_to_light[0].x, 16));
    rays.numbers(std::span<const double>(&plan.low.x, 3)).numbers(std::span<const double>(&plan.high.x, 3));
    Key columns = rays, solids = rays;
    columns.part(medium.grid).number(medium.strongest());
    columns.numbers(std::span<const double>(&medium.grid_to_world[0].x, 16));
    solids.part(surfaces.places()).number(nearest);
    Map map;
    map.solids = parts.solids.get(solids, [&] { return find_solids(plan, surfaces.view(), nearest); });
    map.columns = parts.maps.get(columns, [&] { return projected(std::move(plan), medium, with); });
    return map;
}

Key Lighting::volume_key(std::size_t light, std::size_t own, std::span<const CroppedMedium> media, bool grey) const {
    const LightView &view = views_[light];
    Key key;
    key.number(static_cast<int>(grey), static_cast<int>(view.kind), static_cast<int>(view.spot_cosine));
    key.number(view.radius, view.cone_cosine, view.blend, view.facing2, view.spread_cotangent, view.area, view.size2);
    for (const glm::vec3 &v : {view.position, view.direction, view.across, view.up, view.corners[0], view.corners[1],
                               view.corners[2], view.corners[3]}) {
        key.number(v.x, v.y, v.z);
    }
    if (!samples_[light].empty()) {
        key.numbers(std::span<const float>(&samples_[light].front().x, 3 * samples_[light].size()));
    }
    for (const Map &map : maps_[light]) {
        key.part(map.columns).part(map.solids);
    }
    for (const CroppedMedium &medium : media) {
        key.number(medium.extinction.x, medium.extinction.y, medium.extinction.z);
    }
    key.part(media[own].grid).number(own);
    key.numbers(std::span<const double>(&media[own].grid_to_world[0].x, 16));
    return key;
}

void Lighting::fill_volumes(std::vector<CroppedMedium> &media, bool grey, const InstructionSet &with,
                            LightParts &parts) const {
    for (CroppedMedium &medium : media) {
        medium.light_channels = grey ? 2 : 4;
        medium.light.clear();
    }
    const MediaViews unlit = views_of(media, 1.0);
    for (std::size_t m = 0; m < media_; ++m) {
        const CroppedMedium &medium = media[m];
        const std::size_t floats = medium.grid->density.size() * static_cast<std::size_t>(medium.light_channels);
        std::vector<std::shared_ptr<const LightVolume>> volumes;
        for (std::size_t i = 0; i < views_.size(); ++i) {
            volumes.push_back(parts.volumes.get(volume_key(i, m, media, grey), [&] {
                LightVolume volume(floats, 0.0F);
                LightBox box;
                box.light = &views_[i];
                box.media = unlit.views;
                box.own = static_cast<int>(m);
                box.grey = grey;
                box.grid_to_world = affine(medium.grid_to_world);
                const Grid &grid = *medium.grid;
                oneapi::tbb::parallel_for(0, grid.boxes(), [&with, &grid, &volume, box](int number) {
                    const Grid::Box stored = grid.box(number);
                    LightBox own = box;
                    own.first = stored.first;
                    own.size = stored.size;
                    own.values = volume.data() + stored.begin * (own.grey ? 2 : 4);
                    map_kernels(with).light_box(own);
                });
                return volume;
            }));
        }
        media[m].light = std::move(volumes);
    }
}

const LightMap *Lighting::map(std::size_t light, std::size_t sample, std::size_t medium) const {
    if (light >= maps_.size() || medium >= media_ || sample >= samples_[light].size()) {
        return nullptr;
    }
    return maps_[light][sample * media_ + medium].columns.get();
}

} // namespace sfumato
