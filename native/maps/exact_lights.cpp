// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/exact_lights.hpp"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

namespace sfumato {
namespace {

// Of a sky: as many points as another light has at most, times two (sky_samples); and how many are asked at once.
constexpr int MOST = 256;
constexpr std::size_t AT_ONCE = 8;
// A part of a lamp is taken for as small as one of so many.
constexpr float FINER = 256.0F;

LightMapView exact_map(const ExactRays &rays) {
    LightMapView map;
    map.width = map.height = 1;
    map.world_to_light = affine(glm::dmat4(1.0));
    map.exact = &rays;
    return map;
}

// Of an even sky, what all its parts send together: they follow each other.
glm::vec3 whole_strength(std::span<const LightView> lights, std::size_t part) {
    const int octant = lights[part].octant;
    if (octant < 0) {
        return lights[part].strength;
    }
    glm::vec3 sum(0.0F);
    const std::size_t first = part - static_cast<std::size_t>(octant);
    for (std::size_t i = first; i < lights.size() && lights[i].octant == static_cast<int>(i - first); ++i) {
        sum += lights[i].strength;
    }
    return sum;
}

// Numbers of `count` of some directions, evenly by their shares.
std::vector<std::size_t> by_shares(std::span<const float> shares, std::size_t count, double u) {
    std::vector<std::size_t> out;
    double sum = 0.0;
    for (std::size_t i = 0; i < shares.size() && out.size() < count; ++i) {
        sum += double{shares[i]};
        while (out.size() < count && sum * static_cast<double>(count) > static_cast<double>(out.size()) + u) {
            out.push_back(i);
        }
    }
    while (!shares.empty() && out.size() < count) { // what rounding leaves
        out.push_back(shares.size() - 1);
    }
    return out;
}

} // namespace

ExactLights::ExactLights(const Lighting &lighting, std::span<const CroppedMedium> media, const SurfaceView &surfaces)
    : lighting_(&lighting), media_(media), surfaces_(&surfaces), anywhere_(lighting.bodies().size() == media.size()),
      views_(lighting.views().begin(), lighting.views().end()) {
    for (LightView &view : views_) {
        Directions &sky = skies_.emplace_back();
        if (!view.surrounds()) {
            continue;
        }
        if (anywhere_) {
            sky.samples = light_samples(view, lighting.bodies(), MOST, false);
            view.strength = whole_strength(lighting.views(), skies_.size() - 1);
            weigh_sky(view, sky_fluence(view, MOST), sky.shares);
        } else {
            sky.samples.assign(view.samples.begin(), view.samples.end());
            sky.shares.assign(view.shares.begin(), view.shares.end());
        }
    }
}

ExactLights::Choice ExactLights::choose(double u, double v) const {
    Choice out;
    out.views = views_;
    const std::size_t bodies = lighting_->bodies().size();
    for (std::size_t i = 0; i < views_.size(); ++i) {
        const LightView &light = views_[i];
        std::vector<glm::vec3> &samples = out.samples.emplace_back();
        std::vector<float> &shares = out.shares.emplace_back();
        std::vector<std::size_t> numbers; // of those that have maps
        float finer = FINER;
        if (light.surrounds()) {
            const Directions &sky = skies_[i];
            numbers = by_shares(sky.shares, std::min(AT_ONCE, sky.samples.size()), u);
            for (const std::size_t number : numbers) {
                samples.push_back(sky.samples[number]);
                shares.push_back(1.0F / static_cast<float>(numbers.size()));
            }
        } else if (anywhere_) {
            samples.push_back(light_point(light, lighting_->bodies(), {2.0 * u - 1.0, 2.0 * v - 1.0}));
        } else if (!light.samples.empty()) {
            const auto count = static_cast<double>(light.samples.size());
            numbers.push_back(std::min(static_cast<std::size_t>(u * count), light.samples.size() - 1));
            samples.push_back(light.samples[numbers.back()]);
            finer = static_cast<float>(count);
        }
        std::vector<ExactRays> &rays = out.rays.emplace_back();
        std::vector<LightMapView> &maps = out.maps.emplace_back();
        rays.reserve(samples.size() * bodies); // views point to them
        for (std::size_t j = 0; j < samples.size(); ++j) {
            for (std::size_t m = 0; m < bodies; ++m) {
                const Body &body = lighting_->bodies()[m];
                if (m >= media_.size()) {
                    maps.push_back(light.maps[numbers[j] * bodies + m]);
                    continue;
                }
                if (!body.takes_light) {
                    maps.emplace_back();
                    continue;
                }
                ExactRays &ray = rays.emplace_back();
                ray.density = media_[m].grid->view();
                ray.clearance = media_[m].grid->clearances();
                ray.world_to_grid = affine(glm::inverse(media_[m].grid_to_world));
                ray.hides = (body.visibility.hides & light.reach.hidden_by) != 0;
                ray.lit = lights_smoke(light, body);
                ray.light = samples[j];
                ray.parallel = light.parallel();
                ray.nearest = light.of_mesh() ? 1e-3F * light.radius : 0.0F;
                ray.solids = light.solids;
                ray.sheets = light.sheets;
                ray.surfaces = surfaces_;
                maps.push_back(exact_map(ray));
            }
        }
        LightView &view = out.views[i];
        view.samples = samples;
        view.shares = shares;
        view.maps = maps.data();
        view.finer = finer;
    }
    return out;
}

} // namespace sfumato
