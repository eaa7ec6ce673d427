// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame.hpp"

#include "frame/film.hpp"
#include "frame/glance.hpp"
#include "scene/scene.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

constexpr int TILE = 4; // the sampling pattern repeats every TILE x TILE pixels; TILE^2 = FILM_TURNS

// Neighbouring pixels get distant turns (the order of Bayer's matrix).
int film_turn(int x, int y) {
    constexpr std::array<int, 16> BAYER = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    return BAYER[static_cast<std::size_t>((y % TILE) * TILE + x % TILE)];
}

struct Image {
    Output output;
    int width, height;
    std::vector<float> rgba;       // premultiplied
    std::vector<float> surfaces;   // mean radiance of the surfaces, were there no smoke; or the mean share in shadow
    std::vector<float> unshadowed; // the radiance, or irradiance, were there no shadows of solids either
    std::vector<float> seen;       // the share of it that the smoke leaves
    std::vector<float> distance;   // at the pixel's centre

    Image(Output what, int w, int h)
        : output(what), width(w), height(h), rgba(4 * at(0, h)), surfaces(at(0, h)), unshadowed(at(0, h)),
          seen(at(0, h)), distance(at(0, h)) {}

    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }

    void set_colour(std::size_t pixel, const Traced &light, int lane) {
        float *const to = rgba.data() + 4 * pixel;
        for (int c = 0; c < 3; ++c) {
            to[c] = light.radiance[c][lane];
        }
        to[3] = light.alpha[lane];
    }
};

// The first look: every pixel once, through its centre, and either through the middles of the lights or spread over
// them.
void trace_row(const InstructionSet &with, const FrameView &view, bool spread, Image &image, int y) {
    const int lanes = with.lanes;
    Packet packet;
    Traced light;
    for (int x0 = 0; x0 < image.width; x0 += lanes) {
        for (int lane = 0; lane < lanes; ++lane) {
            const int x = x0 + lane;
            const FilmSample look = spread ? first_look(x, y) : FilmSample{0.0F, 0.0F, 0.5F, 0.5F};
            packet.u[lane] = (static_cast<float>(x) + 0.5F) / static_cast<float>(image.width);
            packet.v[lane] = (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height);
            packet.light_u[lane] = look.light_u;
            packet.light_v[lane] = look.light_v;
            packet.active[lane] = x < image.width ? 1.0F : 0.0F;
        }
        frame_kernels(with).trace(view, image.output, packet, light);
        for (int lane = 0; lane < lanes && x0 + lane < image.width; ++lane) {
            const std::size_t pixel = image.at(x0 + lane, y);
            image.set_colour(pixel, light, lane);
            image.surfaces[pixel] = light.surface[lane];
            image.unshadowed[pixel] = light.unshadowed[lane];
            image.seen[pixel] = light.seen[lane];
            image.distance[pixel] = light.distance[lane];
        }
    }
}

// What of a pixel one sample cannot tell.
enum class Unsure : std::uint8_t { NOTHING, SHADOWS, ALL };

// Whether surfaces or their shadows change around a pixel by more than one sample can tell. Filtering leaves a linear
// ramp as it is, so what counts is how far a pixel is from the middle between two opposite neighbours: of that, what
// shows through the smoke. Where without the shadows of solids nothing would change, and the surface is the same, only
// they are looked at again.
Unsure unsure_of(const Image &image, int x, int y) {
    constexpr float CONTRAST = 0.03F, STEP = 0.02F;
    const auto at = [&image](int i, int j) {
        return image.at(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1));
    };
    const std::size_t centre = at(x, y);
    const float *rgba = image.rgba.data() + 4 * centre;
    const float mean = (rgba[0] + rgba[1] + rgba[2]) * (1.0F / 3.0F);
    const bool radiance = image.output == Output::PICTURE || image.output == Output::SURFACES;
    const float brightness = radiance ? mean : 1.0F - mean; // a share in shadow leaves the rest
    constexpr std::array<std::array<int, 2>, 4> WAYS = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
    Unsure found = Unsure::NOTHING;
    for (const auto &[dx, dy] : WAYS) {
        const std::size_t before = at(x - dx, y - dy), after = at(x + dx, y + dy);
        const auto bend = [&](const std::vector<float> &values) {
            return std::abs(values[before] + values[after] - 2.0F * values[centre]);
        };
        const float seen = std::max({image.seen[before], image.seen[centre], image.seen[after]});
        const float alpha = std::abs(image.rgba[4 * before + 3] - image.rgba[4 * after + 3]);
        const bool rim = (image.distance[before] > 2.0F * image.distance[after] ||
                          image.distance[after] > 2.0F * image.distance[before]) &&
                         alpha > CONTRAST;
        const float change = bend(image.surfaces) * seen, unshadowed = bend(image.unshadowed);
        const bool edge = change > CONTRAST * (brightness + change);
        const bool shadow = unshadowed <= CONTRAST * (image.unshadowed[centre] + unshadowed) &&
                            bend(image.distance) <= STEP * image.distance[centre];
        if (rim || (edge && !shadow)) {
            return Unsure::ALL;
        }
        found = edge ? Unsure::SHADOWS : found;
    }
    return found;
}

// Samples some pixels of a row: of each its own pattern, in as few packets as hold them all.
void refine_pixels(const InstructionSet &with, const FrameView &view, std::span<const std::vector<FilmSample>> patterns,
                   Image &image, std::span<const int> columns, int y) {
    const auto lanes = static_cast<std::size_t>(with.lanes), count = patterns.front().size();
    const std::size_t all = columns.size() * count;
    std::vector<std::array<double, 4>> sums(columns.size());
    Packet packet;
    Traced light;
    for (std::size_t first = 0; first < all; first += lanes) {
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t at = std::min(first + lane, all - 1);
            const int x = columns[at / count];
            const FilmSample &s = patterns[static_cast<std::size_t>(film_turn(x, y))][at % count];
            packet.u[lane] = (static_cast<float>(x) + 0.5F + s.x) / static_cast<float>(image.width);
            packet.v[lane] = (static_cast<float>(y) + 0.5F + s.y) / static_cast<float>(image.height);
            packet.light_u[lane] = s.light_u;
            packet.light_v[lane] = s.light_v;
            packet.active[lane] = first + lane < all ? 1.0F : 0.0F;
        }
        frame_kernels(with).trace(view, image.output, packet, light);
        for (std::size_t lane = 0; lane < lanes && first + lane < all; ++lane) {
            std::array<double, 4> &sum = sums[(first + lane) / count];
            for (std::size_t c = 0; c < 3; ++c) {
                sum[c] += static_cast<double>(light.radiance[c][lane]);
            }
            sum[3] += static_cast<double>(light.alpha[lane]);
        }
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
        float *const rgba = image.rgba.data() + 4 * image.at(columns[i], y);
        for (std::size_t c = 0; c < 4; ++c) {
            rgba[c] = static_cast<float>(sums[i][c] / static_cast<double>(count));
        }
    }
}

// The same for some pixels of a row, as many at a time as there are lanes, where it is only shadows that change.
void refine_shadows(const InstructionSet &with, const FrameView &view,
                    std::span<const std::vector<FilmSample>> patterns, Image &image, std::span<const int> columns,
                    int y) {
    const auto lanes = static_cast<std::size_t>(with.lanes);
    std::vector<ShadowSample> samples(patterns.front().size());
    Packet packet;
    packet.shadows = samples;
    Traced light;
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    for (std::size_t first = 0; first < columns.size(); first += lanes) {
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const int x = columns[std::min(first + lane, columns.size() - 1)];
            const float column = static_cast<float>(x) + 0.5F, row = static_cast<float>(y) + 0.5F;
            packet.u[lane] = column / width;
            packet.v[lane] = row / height;
            packet.active[lane] = first + lane < columns.size() ? 1.0F : 0.0F;
            const std::vector<FilmSample> &pattern = patterns[static_cast<std::size_t>(film_turn(x, y))];
            for (std::size_t k = 0; k < samples.size(); ++k) {
                samples[k].u[lane] = (column + pattern[k].x) / width;
                samples[k].v[lane] = (row + pattern[k].y) / height;
                samples[k].light_u[lane] = pattern[k].light_u;
                samples[k].light_v[lane] = pattern[k].light_v;
            }
        }
        frame_kernels(with).trace(view, image.output, packet, light);
        for (std::size_t lane = 0; lane < lanes && first + lane < columns.size(); ++lane) {
            image.set_colour(image.at(columns[first + lane], y), light, static_cast<int>(lane));
        }
    }
}

// Runs body(y) for each row of an image on all cores, asking `progress` between chunks of rows. False if it was
// stopped.
template <typename Body>
bool in_chunks(const Image &image, double done, double share, const Progress &progress, const Body &body) {
    // Few enough to keep all cores busy, and so many that a stop is not long in coming.
    constexpr std::size_t LEAST = 8, PIXELS = 1U << 16U;
    const auto chunks = progress ? static_cast<int>(std::max(LEAST, image.distance.size() / PIXELS)) : 1;
    const auto first = [&](int chunk) { return static_cast<int>(std::int64_t{image.height} * chunk / chunks); };
    for (int chunk = 0; chunk < chunks; ++chunk) {
        if (progress && !progress(done + share * chunk / chunks)) {
            return false;
        }
        oneapi::tbb::parallel_for(first(chunk), first(chunk + 1), body);
    }
    return true;
}

// Samples the pixels in which surfaces or their shadows change `edge_samples` times. False if progress said stop.
bool refine(const InstructionSet &with, const FrameView &view, int edge_samples, const Progress &progress,
            Image &image) {
    std::vector<std::vector<FilmSample>> patterns;
    patterns.reserve(FILM_TURNS);
    for (int turn = 0; turn < FILM_TURNS; ++turn) {
        patterns.push_back(film_samples(edge_samples, turn));
    }
    // Which pixels are edges is settled before any of them changes.
    std::vector<Unsure> unsure(image.distance.size());
    oneapi::tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            unsure[image.at(x, y)] = unsure_of(image, x, y);
        }
    });
    // A pixel and its eight neighbours may all miss a thin shadow or a corner of a light; their neighbours' do not.
    const auto beside_shadow = [&](int x, int y) {
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
                if (unsure[image.at(i, j)] == Unsure::SHADOWS) {
                    return true;
                }
            }
        }
        return false;
    };
    return in_chunks(image, 0.5, 0.5, progress, [&](int y) {
        std::vector<int> edges, shadows;
        for (int x = 0; x < image.width; ++x) {
            if (unsure[image.at(x, y)] == Unsure::ALL) {
                edges.push_back(x);
            } else if (beside_shadow(x, y)) {
                shadows.push_back(x);
            }
        }
        refine_pixels(with, view, patterns, image, edges, y);
        refine_shadows(with, view, patterns, image, shadows, y);
    });
}

// A first look at every pixel and, for more than one sample, a closer one at the edges. Nothing if progress said stop.
std::optional<Image> traced(const InstructionSet &with, const FrameView &view, Output output, int width, int height,
                            int edge_samples, const Progress &progress) {
    Image image(output, width, height);
    const bool closer = edge_samples > 1;
    if (!in_chunks(image, 0.0, closer ? 0.5 : 1.0, progress, [&](int y) { trace_row(with, view, closer, image, y); }) ||
        (closer && !refine(with, view, edge_samples, progress, image))) {
        return std::nullopt;
    }
    return image;
}

std::vector<CroppedMedium> cropped(std::span<const Medium> media) {
    std::vector<CroppedMedium> out;
    for (const Medium &medium : media) {
        CroppedMedium smoke = crop(medium);
        if (!smoke.empty()) {
            out.push_back(std::move(smoke));
        }
    }
    return out;
}

} // namespace

Frame::Frame(const Scene &scene, const FrameSettings &settings, std::shared_ptr<Prepared> prepared,
             const InstructionSet &with)
    : instruction_set_(&with), prepared_(std::move(prepared)), step_length_(1.0 / settings.steps_per_cell),
      background_(scene.background) {
    const std::lock_guard making(prepared_->making);
    prepared_->arena.execute([&] {
        surfaces_.emplace(scene.meshes, prepared_->solids);
        media_ = cropped(scene.media);
        grey_ = std::all_of(media_.begin(), media_.end(), [](const CroppedMedium &medium) { return medium.grey(); });
        lighting_ = Lighting(scene.lights, media_, *surfaces_,
                             {{settings.coefficients, settings.texels_per_cell}, settings.light_samples}, grey_, with,
                             prepared_->lights);
    });
    prepared_->end_round();
}

FrameView Frame::view(const Camera &camera, std::span<const MediumView> media) const {
    FrameView view;
    for (std::size_t i = 0; i < 3; ++i) {
        view.camera[i] = camera.near[i];
        view.camera[3 + i] = camera.far[i];
    }
    view.surfaces = surfaces_->view();
    view.lights = lighting_.views();
    view.media = media;
    view.grey = grey_;
    view.background = background_;
    return view;
}

std::optional<std::vector<float>> Frame::render(const Camera &camera, int width, int height, int edge_samples,
                                                const Progress &progress) const {
    const MediaViews media = views_of(media_, step_length_);
    std::optional<Image> image = prepared_->arena.execute([&] {
        return traced(*instruction_set_, view(camera, media.views), Output::PICTURE, width, height, edge_samples,
                      progress);
    });
    return image ? std::optional(std::move(image->rgba)) : std::nullopt;
}

std::optional<std::vector<float>> Frame::surfaces(const Camera &camera, int width, int height, Output output,
                                                  int edge_samples, const Progress &progress) const {
    const MediaViews media = views_of(media_, step_length_);
    std::optional<Image> image = prepared_->arena.execute([&] {
        return traced(*instruction_set_, view(camera, media.views), output, width, height, edge_samples, progress);
    });
    if (!image) {
        return std::nullopt;
    }
    for (std::size_t pixel = 0; pixel < image->distance.size(); ++pixel) {
        image->rgba[4 * pixel + 3] = image->distance[pixel];
    }
    return std::move(image->rgba);
}

std::vector<float> Frame::glance(const Camera &camera, int width, int height, Output output, int spacing,
                                 std::optional<float> shadow_strength) const {
    // Steps a little longer than a preview's miss less than what is interpolated does.
    constexpr double CELLS = 1.25;
    const MediaViews media = views_of(media_, std::max(step_length_, CELLS));
    FrameView seen = view(camera, media.views);
    seen.shadow_strength = shadow_strength;
    return prepared_->arena.execute(
        [&] { return sfumato::glance(*instruction_set_, seen, output, width, height, spacing); });
}

void Frame::transmittance(std::size_t light, std::span<const float> points, std::span<float> rgb) const {
    std::vector<float> columns(points.size() / 3), depth(points.size()), sum(points.size(), 0.0F);
    const std::size_t samples = lighting_.views()[light].samples.size();
    for (std::size_t j = 0; j < samples; ++j) {
        std::fill(depth.begin(), depth.end(), 0.0F);
        for (std::size_t m = 0; m < media_.size(); ++m) {
            const LightMap *const map = lighting_.map(light, j, m);
            if (map == nullptr) {
                continue;
            }
            prepared_->arena.execute([&] { map->look_up(points, columns); });
            for (std::size_t i = 0; i < depth.size(); ++i) {
                depth[i] += columns[i / 3] * media_[m].extinction[static_cast<int>(i % 3)];
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
