// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/stages.hpp"

#include "maps/project_fog.hpp"
#include "maps/splat.hpp"
#include "scene/scene.hpp"

#include <utility>

namespace sfumato {
namespace {

struct PartStage {
    const char *name;
    bool (*needed)(const Scene &, const Content &);
    void (*make)(const Making &, Content &);
};

// Stages that are local to a tile of packets run one after the other while it is in the cache.
struct RayStage {
    const char *name;
    bool (*needed)(const FrameView &, LayerSet);
    void (*run)(const InstructionSet &, const FrameView &, LayerSet, const Packet &, Layers &);
};

bool lights_meet_smoke(const Scene &scene, const Content &content) {
    return !scene.lights.empty() && !content.media.empty();
}

bool lights_meet_bodies(const Scene & /*scene*/, const Content &content) {
    return !content.lighting.views().empty() && !content.lighting.bodies().empty();
}

// Grids first, hair last.
std::vector<Body> bodies_of(const Making &making, Content &content) {
    std::vector<Body> bodies;
    for (const CroppedMedium &medium : content.media) {
        bodies.push_back(body_of(medium));
    }
    for (std::size_t i = 0; content.puffs && i < content.puffs->bodies.size(); ++i) {
        bodies.push_back(body_of(content.puffs, i));
    }
    content.first_fog = static_cast<int>(bodies.size());
    for (const std::shared_ptr<const Fog> &fog : content.fogs) {
        bodies.push_back(body_of(fog, std::max(making.settings.air_texels / 2, 1))); // the world is larger
    }
    std::vector<Body> hair;
    for (const Strands &strands : content.strands) {
        hair.push_back(body_of(strands));
    }
    if (content.world_air) {
        // What throws shadows in it.
        std::vector<Body> casters = bodies;
        casters.insert(casters.end(), hair.begin(), hair.end());
        if (const std::optional<Body> body = air_body(*content.surfaces, casters, making.settings.air_texels)) {
            content.air_body = static_cast<int>(bodies.size());
            bodies.push_back(*body);
        }
    }
    bodies.insert(bodies.end(), hair.begin(), hair.end());
    return bodies;
}

LightMapSettings map_settings(const FrameSettings &settings) {
    LightMapSettings map{settings.coefficients, settings.texels_per_cell};
    map.basis = settings.basis;
    map.curved = settings.curved;
    map.shared = settings.shared_ranges;
    return map;
}

// Of an image of the smoke alone, fragments are left out: those are hair and sheets.
void merge(const InstructionSet &with, const FrameView &view, LayerSet wanted, const Packet &packet, Layers &layers) {
    if (wanted.has(Layer::SMOKE_ALONE)) {
        auto fragments = std::exchange(layers.events->fragments, {});
        frame_kernels(with).merge(view, packet, layers);
        keep_smoke(layers);
        layers.events->fragments = std::move(fragments);
    }
    frame_kernels(with).merge(view, packet, layers);
}

constexpr std::array PARTS = {
    PartStage{"hair", [](const Scene &scene, const Content & /*content*/) { return !scene.strands.empty(); },
              [](const Making &making, Content &content) {
                  // Where no strand has two keys nothing is shown.
                  const auto any = [](const Strands &strands) {
                      const std::vector<std::uint32_t> &first = strands.shape->first;
                      return std::adjacent_find(first.begin(), first.end(), [](std::uint32_t a, std::uint32_t b) {
                                 return b - a > 1;
                             }) != first.end();
                  };
                  std::ranges::copy_if(making.scene.strands, std::back_inserter(content.strands), any);
              }},
    PartStage{"solids", [](const Scene & /*scene*/, const Content & /*content*/) { return true; },
              [](const Making &making, Content &content) {
                  content.surfaces.emplace(making.scene.meshes, making.scene.lights, making.prepared.solids);
                  content.grey = content.surfaces->dims_greyly();
              }},
    PartStage{"smoke", [](const Scene &scene, const Content & /*content*/) { return !scene.media.empty(); },
              [](const Making &making, Content &content) {
                  for (const Medium &medium : making.scene.media) {
                      CroppedMedium smoke = crop(medium);
                      if (!smoke.empty()) {
                          if (medium.transfer) {
                              const auto ranges = making.prepared.ranges.get(
                                  Key().part(smoke.grid), [&smoke] { return brick_ranges(*smoke.grid); });
                              classify(smoke, medium, *ranges);
                          }
                          content.grey = content.grey && smoke.grey();
                          content.media.push_back(std::move(smoke));
                      }
                  }
                  const auto seen = [](const CroppedMedium &medium) { return medium.visibility.seen == Seen::SHOWN; };
                  content.seen_media = static_cast<std::size_t>(
                      std::stable_partition(content.media.begin(), content.media.end(), seen) - content.media.begin());
              }},
    PartStage{"particles", [](const Scene &scene, const Content & /*content*/) { return !scene.particles.empty(); },
              [](const Making &making, Content &content) {
                  content.puffs = puffs_of(making.scene.particles);
                  content.grey = content.grey && (!content.puffs || content.puffs->grey());
              }},
    PartStage{"world", [](const Scene &scene, const Content & /*content*/) { return !scene.air.empty(); },
              [](const Making &making, Content &content) {
                  for (const Air &air : making.scene.air) {
                      if (air.shape == nullptr) {
                          content.air.push_back(view_of(air));
                          content.world_air = true;
                          content.grey = content.grey && is_grey(content.air.back());
                      }
                  }
              }},
    PartStage{"fog",
              [](const Scene &scene, const Content & /*content*/) {
                  return std::ranges::any_of(scene.air, [](const Air &air) { return air.shape != nullptr; });
              },
              [](const Making &making, Content &content) {
                  content.fogs = fogs_of(making.scene.air, making.prepared.solids);
                  const auto seen = [](const std::shared_ptr<const Fog> &fog) {
                      return fog->air.visibility.seen == Seen::SHOWN;
                  };
                  std::stable_partition(content.fogs.begin(), content.fogs.end(), seen);
                  for (const std::shared_ptr<const Fog> &fog : content.fogs) {
                      const AirView view = view_of(fog->air);
                      content.grey = content.grey && is_grey(view);
                      if (seen(fog)) {
                          content.air.push_back(view);
                          content.fog_views.push_back(fog->view());
                      }
                  }
              }},
    PartStage{"lights", [](const Scene &scene, const Content & /*content*/) { return !scene.lights.empty(); },
              [](const Making &making, Content &content) {
                  const FrameSettings &settings = making.settings;
                  const int samples = settings.shared_ranges ? 1 : settings.light_samples;
                  content.lighting =
                      Lighting(making.scene.lights, bodies_of(making, content), *content.surfaces, samples,
                               making.prepared.lights, content.world_air ? content.air.data() : nullptr);
              }},
    PartStage{"light maps", lights_meet_bodies,
              [](const Making &making, Content &content) {
                  content.lighting.build_maps(*content.surfaces, map_settings(making.settings), making.with,
                                              making.prepared.lights);
              }},
    PartStage{"light volumes", lights_meet_smoke,
              [](const Making &making, Content &content) {
                  content.lighting.fill_volumes(content.media, content.grey, making.with, making.prepared.lights);
              }},
};

constexpr std::array RAYS = {
    RayStage{"surfaces", [](const FrameView & /*view*/, LayerSet /*wanted*/) { return true; },
             [](const InstructionSet &with, const FrameView &view, LayerSet wanted, const Packet &packet,
                Layers &layers) { frame_kernels(with).surfaces(view, wanted, packet, layers); }},
    RayStage{"sheets",
             [](const FrameView &view, LayerSet wanted) {
                 return wanted.has(Layer::RADIANCE) && view.surfaces.sheets.scene != nullptr;
             },
             [](const InstructionSet &with, const FrameView &view, LayerSet wanted, const Packet &packet,
                Layers &layers) { frame_kernels(with).sheets(view, wanted, packet, layers); }},
    RayStage{"strands",
             [](const FrameView &view, LayerSet wanted) {
                 return wanted.has(Layer::RADIANCE) && wanted.has(Layer::SMOKE) && !view.strands.empty();
             },
             [](const InstructionSet &with, const FrameView &view, LayerSet /*wanted*/, const Packet &packet,
                Layers &layers) { frame_kernels(with).strands(view, packet, layers); }},
    RayStage{"slices",
             [](const FrameView &view, LayerSet wanted) {
                 return wanted.has(Layer::SMOKE) && view.particles.puffs != nullptr;
             },
             [](const InstructionSet &with, const FrameView &view, LayerSet /*wanted*/, const Packet &packet,
                Layers &layers) { frame_kernels(with).particles(view, packet, layers); }},
    RayStage{
        "march",
        [](const FrameView &view, LayerSet wanted) { return wanted.has(Layer::SMOKE) && !view.seen_media.empty(); },
        [](const InstructionSet &with, const FrameView &view, LayerSet /*wanted*/, const Packet &packet,
           Layers &layers) { frame_kernels(with).march(view, packet, layers); }},
    RayStage{"air",
             [](const FrameView &view, LayerSet wanted) { return wanted.has(Layer::SMOKE) && !view.air.empty(); },
             [](const InstructionSet &with, const FrameView &view, LayerSet /*wanted*/, const Packet &packet,
                Layers &layers) { frame_kernels(with).air(view, packet, layers); }},
    RayStage{"merge", [](const FrameView &view, LayerSet wanted) { return merges(view, wanted); }, merge},
    RayStage{"composite", [](const FrameView & /*view*/, LayerSet /*wanted*/) { return true; },
             [](const InstructionSet &with, const FrameView &view, LayerSet wanted, const Packet & /*packet*/,
                Layers &layers) { composite(view, wanted, with.lanes, layers); }},
};

} // namespace

std::vector<StageClock::Row> StageClock::rows() const {
    static_assert(PARTS.size() + RAYS.size() <= MOST);
    std::vector<Row> out;
    const auto add = [&](const char *name, std::size_t stage) {
        const std::chrono::steady_clock::duration time(times_[stage].load());
        if (time.count() > 0) {
            out.push_back({name, std::chrono::duration<double>(time).count()});
        }
    };
    for (std::size_t i = 0; i < PARTS.size(); ++i) {
        add(PARTS[i].name, i);
    }
    for (std::size_t i = 0; i < RAYS.size(); ++i) {
        add(RAYS[i].name, PARTS.size() + i);
    }
    return out;
}

Content content_of(const Making &making, StageClock &clock) {
    Content content;
    for (std::size_t i = 0; i < PARTS.size(); ++i) {
        if (PARTS[i].needed(making.scene, content)) {
            clock.time(i, [&] { PARTS[i].make(making, content); });
        }
    }
    return content;
}

void Tracer::run(std::span<const Packet> packets, std::span<Layers> layers) const {
    for (Layers &layer : layers.first(view.sorted ? packets.size() : 0)) {
        layer.events->clear();
    }
    for (std::size_t i = 0; i < RAYS.size(); ++i) {
        if (RAYS[i].needed(view, wanted)) {
            clock.time(PARTS.size() + i, [&] {
                for (std::size_t p = 0; p < packets.size(); ++p) {
                    RAYS[i].run(with, view, wanted, packets[p], layers[p]);
                }
            });
        }
    }
}

} // namespace sfumato
