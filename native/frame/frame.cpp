// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame.hpp"

#include "frame/ball_footprints.hpp"
#include "frame/glance.hpp"
#include "scene/scene.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <mutex>
#include <span>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

void see_from(const Camera &camera, FrameView &view) {
    for (std::size_t i = 0; i < 3; ++i) {
        view.camera[i] = camera.near[i];
        view.camera[3 + i] = camera.far[i];
    }
}

} // namespace

Frame::Frame(const Scene &scene, const FrameSettings &settings, std::shared_ptr<Prepared> prepared,
             const InstructionSet &with)
    : instruction_set_(&with), prepared_(std::move(prepared)), clock_(std::make_unique<StageClock>()),
      step_length_(1.0 / settings.steps_per_cell), background_(scene.background), backdrop_(scene.backdrop),
      background_alpha_(scene.background_alpha), origin_(scene.origin), bounces_(scene.bounces) {
    const std::lock_guard making(prepared_->making);
    content_ = prepared_->arena.execute([&] { return content_of({scene, settings, with, *prepared_}, *clock_); });
    prepared_->end_round();
}

Frame::Views Frame::views(const Camera &camera, int width, int height, LayerSet wanted, double step_length,
                          double reach) const {
    Views out;
    out.media = views_of(content_.media, step_length);
    FrameView &view = out.frame;
    see_from(camera, view);
    view.surfaces = content_.surfaces->view();
    if (wanted.has(Layer::SHEETLESS)) {
        view.surfaces.sheets = {};
    }
    view.lights = content_.lighting.views();
    view.smoke_lights = content_.lighting.of_smoke();
    view.media = out.media.views;
    view.seen_media = view.media.first(content_.seen_media);
    view.extinctions = content_.lighting.extinctions();
    view.first_hair = view.extinctions.size() - std::min(view.extinctions.size(), content_.strands.size());
    view.grey = content_.grey;
    view.sorted = view.surfaces.sheets.scene != nullptr;
    view.background = background_;
    view.backdrop = backdrop_ ? view_of(*backdrop_) : SkyImageView{};
    view.background_alpha = background_alpha_;
    view.world_air = content_.world_air ? content_.air.data() : nullptr;
    if (wanted.has(Layer::SMOKE)) {
        view.air = content_.air;
        view.air_body = content_.air_body;
        view.fogs = content_.fog_views;
        view.first_fog = content_.first_fog;
        view.sorted = view.sorted || !view.air.empty();
    }
    if (wanted.has(Layer::SMOKE) && content_.puffs && content_.puffs->seen > 0) {
        see_particles(camera, width, height, out);
    }
    // In an overlay hair is the other picture's.
    if (wanted.has(Layer::SMOKE) && wanted.has(Layer::RADIANCE) && !content_.strands.empty()) {
        see_strands(camera, width, height, reach, out);
    }
    return out;
}

void Frame::see_strands(const Camera &camera, int width, int height, double reach, Views &views) const {
    prepared_->arena.execute([&] { views.strands = seen_strands(content_.strands, camera, width, height, reach); });
    views.frame.strands = views.strands.view();
    views.frame.sorted = views.frame.sorted || !views.frame.strands.empty();
}

void Frame::see_particles(const Camera &camera, int width, int height, Views &views) const {
    const Puffs &puffs = *content_.puffs;
    prepared_->arena.execute([&] {
        const BallFootprints footprint(camera, width, height);
        std::vector<Footprint> footprints(puffs.seen);
        views.puff_begins.resize(puffs.seen);
        oneapi::tbb::parallel_for(std::size_t{0}, puffs.seen, [&](std::size_t i) {
            footprints[i] = footprint(puffs.puffs[i].middle, puffs.puffs[i].radius);
            views.puff_begins[i] = footprint.begin(puffs.puffs[i].middle, puffs.puffs[i].radius);
        });
        views.puffs = Bins(footprints, views.puff_begins, width, height);
    });
    ParticlesView &view = views.frame.particles;
    show_particles(view);
    view.bins = views.puffs.view();
    view.begin = views.puff_begins.data();
    for (std::size_t i = 0; i < puffs.seen; ++i) {
        view.widest = std::max(view.widest, 2.0F * puffs.puffs[i].radius);
    }
    view.width = static_cast<float>(width);
    view.height = static_cast<float>(height);
    views.frame.sorted = true;
}

void Frame::see_bounces(const Camera &camera, bool moving, Views &views) const {
    BounceView &view = views.frame.bounces;
    view.gloss = bounces_.gloss;
    view.diffuse = bounces_.diffuse > 0;
    view.settled = moving;
    view.surroundings = &surroundings_;
    if (!view.diffuse) {
        return;
    }
    const std::lock_guard making(bounced_->making);
    if (!bounced_->cache ||
        !(moving || (bounced_->camera->near == camera.near && bounced_->camera->far == camera.far))) {
        bounced_->camera = camera;
        bounced_->cache = prepared_->arena.execute([&] {
            return std::make_shared<const LightCache>(views.frame, frame_kernels(*instruction_set_).bounce,
                                                      bounces_.diffuse);
        });
    }
    views.cache = bounced_->cache;
    view.cache = &views.cache->view();
}

void Frame::show_particles(ParticlesView &view) const {
    view.puffs = content_.puffs->puffs.data();
    view.albedo = content_.puffs->albedo.data();
    view.bodies = content_.puffs->bodies;
    view.first_body = content_.media.size();
}

Blur Frame::blur_of(const Exposure &exposure, int width, int height, LayerSet wanted, const Film &film,
                    const FrameView &sharp, std::deque<Views> &sortings) const {
    constexpr int ROUND = 16, FEWER = 4;
    // Of what is sorted by where it is in the picture there are so many sortings, which pixels share.
    constexpr std::size_t SORTINGS = 32;
    Blur out;
    out.exposure = exposure;
    out.exposure.moves = exposure.moves && wanted.has(Layer::RADIANCE) && content_.surfaces->moves();
    if (out.exposure.sharp()) {
        return out;
    }
    if (out.exposure.moves) {
        out.moved = MovedViews(sharp, *content_.surfaces);
    }
    const bool sorting = sharp.particles.puffs != nullptr || !sharp.strands.empty();
    const auto see = [&](int count) {
        Eyes eyes{count, {}, {}};
        std::vector<Glimpse> all = eyes_of(exposure, count, narrowed(count));
        all.resize(sorting ? std::min(SORTINGS, all.size()) : all.size());
        for (const Glimpse &eye : all) {
            FrameView view = out.moved.empty() ? sharp : out.moved.at(eye.time, eyes.lights.emplace_back());
            see_from(eye.camera, view);
            if (sorting) {
                const Views &own = sortings.emplace_back(
                    views(eye.camera, width, height, wanted, step_length_, film.filter.diameter() / 2.0));
                view.particles = own.frame.particles;
                view.strands = own.frame.strands;
            }
            eyes.views.push_back(view);
        }
        return eyes;
    };
    out.many = see(ROUND * std::clamp(film.edge_samples / ROUND, 1, ROUND));
    out.few = sorting || out.many.count == ROUND ? out.many : see(std::max(out.many.count / FEWER, ROUND));
    std::tie(out.smoke_begins, out.smoke_ends) = smoke_from(sharp.camera[0]);
    return out;
}

std::pair<float, float> Frame::smoke_from(const glm::vec3 &eye) const {
    std::pair<float, float> out(std::numeric_limits<float>::max(), 0.0F);
    for (const CroppedMedium &medium : media().first(seen_media())) {
        const glm::dvec3 size(medium.grid->resolution);
        const glm::dvec3 middle(medium.grid_to_world * glm::dvec4(0.5 * size, 1.0));
        const glm::dvec3 corner(glm::abs(glm::dmat3(medium.grid_to_world)[0]) * size.x +
                                glm::abs(glm::dmat3(medium.grid_to_world)[1]) * size.y +
                                glm::abs(glm::dmat3(medium.grid_to_world)[2]) * size.z);
        const double away = glm::distance(middle, glm::dvec3(eye)), radius = 0.5 * glm::length(corner);
        out.first = std::min(out.first, static_cast<float>(std::max(away - radius, 0.0)));
        out.second = std::max(out.second, static_cast<float>(away + radius));
    }
    return out;
}

std::optional<Image> Frame::image(const Exposure &exposure, int width, int height, LayerSet wanted, const Film &film,
                                  const Mist &mist, float least_alpha, const Progress &progress) const {
    const Camera camera = exposure.middle();
    Views seen = views(camera, width, height, wanted, step_length_, film.filter.diameter() / 2.0);
    seen.frame.mist = mist;
    seen.frame.least_alpha = least_alpha;
    if (wanted.has(Layer::RADIANCE)) {
        see_bounces(camera, false, seen);
    }
    std::deque<Views> sortings;
    const Blur blur = blur_of(exposure, width, height, wanted, film, seen.frame, sortings);
    const Tracer tracer{*instruction_set_, seen.frame, wanted, *clock_};
    return prepared_->arena.execute([&] { return traced(tracer, blur, width, height, film, progress); });
}

std::optional<std::vector<float>> Frame::render(const Exposure &exposure, int width, int height, int edge_samples,
                                                const Progress &progress) const {
    std::optional<Image> picture =
        image(exposure, width, height, PICTURE, {edge_samples, {}}, {}, FrameView{}.least_alpha, progress);
    return picture ? std::optional(std::move(picture->rgba)) : std::nullopt;
}

std::optional<Image> Frame::passes(const Exposure &exposure, int width, int height, LayerSet wanted, const Mist &mist,
                                   float least_alpha, const Film &film, const Progress &progress) const {
    std::optional<Image> picture = image(exposure, width, height, wanted, film, mist, least_alpha, progress);
    if (picture) {
        for (PassImage &pass : picture->passes) {
            pass.finish();
        }
    }
    return picture;
}

std::optional<std::vector<float>> Frame::surfaces(const Camera &camera, int width, int height, LayerSet wanted,
                                                  int edge_samples, const Progress &progress) const {
    std::optional<Image> picture =
        image(camera, width, height, wanted, {edge_samples, {}}, {}, FrameView{}.least_alpha, progress);
    if (!picture) {
        return std::nullopt;
    }
    for (std::size_t pixel = 0; pixel < picture->distance.size(); ++pixel) {
        picture->rgba[4 * pixel + 3] = picture->distance[pixel];
    }
    return std::move(picture->rgba);
}

std::vector<float> Frame::glance(const Camera &camera, int width, int height, LayerSet wanted, int spacing,
                                 float shadow_strength) const {
    // Steps a little longer than a preview's miss less than what is interpolated does.
    constexpr double CELLS = 1.25;
    Views seen = views(camera, width, height, wanted, std::max(step_length_, CELLS));
    for (MediumView &medium : seen.media.views) {
        medium.split = false; // as the viewport's shader has it
    }
    seen.frame.shadow_strength = shadow_strength;
    if (wanted.has(Layer::RADIANCE)) {
        see_bounces(camera, true, seen);
    }
    const Tracer tracer{*instruction_set_, seen.frame, wanted, *clock_};
    return prepared_->arena.execute([&] { return sfumato::glance(tracer, width, height, spacing); });
}

void Frame::transmittance(std::size_t light, std::span<const float> points, std::span<float> rgb) const {
    std::vector<float> columns(points.size() / 3), depth(points.size()), sum(points.size(), 0.0F);
    const std::size_t samples = content_.lighting.views()[light].samples.size();
    for (std::size_t j = 0; j < samples; ++j) {
        std::fill(depth.begin(), depth.end(), 0.0F);
        for (std::size_t m = 0; m < content_.lighting.bodies().size(); ++m) {
            const LightMap *const map = content_.lighting.map(light, j, m);
            if (map == nullptr) {
                continue;
            }
            for (int c = 0; c < 3; ++c) {
                if (c == 0 || map->colours > 1) {
                    prepared_->arena.execute([&] { map->look_up(points, columns, c); });
                }
                for (std::size_t i = 0; i < columns.size(); ++i) {
                    depth[3 * i + static_cast<std::size_t>(c)] += columns[i] * content_.lighting.extinctions()[m][c];
                }
            }
        }
        for (std::size_t i = 0; i < depth.size(); ++i) {
            sum[i] += RaysText().transmittance_of(depth[i]);
        }
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
        rgb[i] = sum[i] / static_cast<float>(samples);
    }
}

} // namespace sfumato
