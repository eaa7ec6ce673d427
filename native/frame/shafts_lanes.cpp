// SPDX-License-Identifier: GPL-3.0-or-later
// Light shafts: rays through sections of light, slices of rays that share one line of a map, and pixels between them.
#include "frame/shaft_kernels.hpp"
#include "maps/sections_lanes.hpp"
#include "text/air_text.hpp"
#include "text/camera_text.hpp"
#include "text/epipolar_text.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace sfumato::SFUMATO_ISA {
namespace {

using AirText = text::AirText<Real, Isa>;
using CameraText = text::CameraText<Real, Isa>;
using EpipolarText = text::EpipolarText<Real, Isa>;
using Ray = CameraText::Ray;
constexpr float TREE_ROOT = 256.0F;  // columns that a slice's tree has at once
constexpr float LOOK_COLUMNS = 2.5F; // before a surface, in which its own texels are already met
constexpr float NOWHERE = std::numeric_limits<float>::max();
constexpr float DARKNESS = 16.0F; // optical depth from which on nothing is seen

inline Ray ray_at(const ShaftView &view, Real x, Real y) {
    const auto &[near, far] = view.camera;
    return CameraText().camera_ray(broadcast(near[0]), broadcast(near[1]), broadcast(near[2]), broadcast(far[0]),
                                   broadcast(far[1]), broadcast(far[2]), x * (1.0F / static_cast<float>(view.width)),
                                   y * (1.0F / static_cast<float>(view.height)));
}

inline Real end_of(const ShaftView &view, const Ray &ray, Real distance) {
    const float thinnest = std::min({view.extinction.x, view.extinction.y, view.extinction.z});
    return min(min(distance, ray.reach), DARKNESS / std::max(thinnest, 1e-20F));
}

// Metres of light that a stretch from the eye on sends there, less what the air keeps.
inline Real passing(float extinction, Real distance) {
    return distance * AirText().mean_decay(distance * extinction);
}

// The lit stretches of a ray, as `sum` of each colour.
struct Lit {
    explicit Lit(const ShaftView &view) : extinction(&view.extinction.x), colours(view.colours()) {}
    void add(Mask which, Real from, Real to, Real share) {
        for (int c = 0; c < colours; ++c) {
            const Real more = share * (passing(extinction[c], to) - passing(extinction[c], from));
            sum[c] = sum[c] + pick(which, more, 0.0F);
        }
    }
    const float *extinction;
    int colours;
    Real sum[3] = {Real(0.0F), Real(0.0F), Real(0.0F)};
};

// What a metre of light scatters to the eye, for each colour.
inline vec3 scattered(const ShaftView &view, const Ray &ray) {
    const Real cosine = -dot(ray.direction, broadcast(view.direction));
    const Real haze = AirText().henyey_greenstein(cosine, Real(view.anisotropy)), sky = AirText().rayleigh(cosine);
    vec3 out;
    for (int c = 0; c < 3; ++c) {
        out[c] = (haze * view.mie[c] + sky * view.rayleigh[c]) * view.irradiance[c];
    }
    return out;
}

// Adds three colours of some lanes' pixels.
inline void add_colours(const vec3 &scatters, const Real sum[3], int colours, std::size_t lanes,
                        const std::uint32_t *pixels, std::size_t first, float *out) {
    alignas(64) float rgb[3][LANES];
    for (int c = 0; c < 3; ++c) {
        (scatters[c] * sum[colours == 3 ? c : 0]).store_aligned(rgb[c]);
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        float *const pixel = out + 3 * (pixels != nullptr ? pixels[lane] : first + lane);
        for (int c = 0; c < 3; ++c) {
            pixel[c] += rgb[c][lane];
        }
    }
}

// Lanes of the pixels in a row, from x on; those beyond its end are not asked.
struct RowLanes {
    RowLanes(const ShaftView &view, int x, int y)
        : count(static_cast<std::size_t>(std::min(LANES, view.width - x))),
          first(static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x)) {
        alignas(64) float far[LANES] = {};
        std::copy_n(view.distance + first, count, far);
        distance = Real::load_aligned(far);
        asked = lane_numbers() < static_cast<float>(count);
    }
    std::size_t count, first;
    Real distance;
    Mask asked;
};

inline Real march(const ShaftView &view, const Ray &ray, Real distance, Mask asked, float most, Lit &lit) {
    const Real end = end_of(view, ray, distance);
    const LineOnMap line = line_on(view.map, ray.origin, ray.direction, Real(0.0F), end);
    return for_lit_sections(line, Real(0.0F), end, asked, MapHeights(view.tree, line), most,
                            [&](Mask which, Real from, Real to, Real share) { lit.add(which, from, to, share); });
}

std::size_t count_of(Real tested) {
    return static_cast<std::size_t>(sum(tested));
}

std::size_t march_row(const ShaftView &view, int y, float most, float *out) {
    std::size_t tested = 0;
    for (int x = 0; x < view.width; x += LANES) {
        const RowLanes lanes(view, x, y);
        const Ray ray = ray_at(view, lane_numbers() + (static_cast<float>(x) + 0.5F), static_cast<float>(y) + 0.5F);
        Lit lit(view);
        tested += count_of(march(view, ray, lanes.distance, lanes.asked, most, lit));
        add_colours(scattered(view, ray), lit.sum, lit.colours, lanes.count, nullptr, lanes.first, out);
    }
    return tested;
}

std::size_t march_pixels(const ShaftView &view, std::span<const std::uint32_t> pixels, float *out) {
    std::size_t tested = 0;
    for (std::size_t i = 0; i < pixels.size(); i += LANES) {
        const std::size_t count = std::min(pixels.size() - i, static_cast<std::size_t>(LANES));
        alignas(64) float x[LANES] = {}, y[LANES] = {}, far[LANES] = {};
        for (std::size_t lane = 0; lane < count; ++lane) {
            const auto width = static_cast<std::uint32_t>(view.width);
            x[lane] = static_cast<float>(pixels[i + lane] % width) + 0.5F;
            y[lane] = static_cast<float>(pixels[i + lane] / width) + 0.5F;
            far[lane] = view.distance[pixels[i + lane]];
        }
        const Ray ray = ray_at(view, Real::load_aligned(x), Real::load_aligned(y));
        Lit lit(view);
        tested += count_of(
            march(view, ray, Real::load_aligned(far), lane_numbers() < static_cast<float>(count), ALL_COLUMNS, lit));
        add_colours(scattered(view, ray), lit.sum, lit.colours, count, pixels.data() + i, 0, out);
    }
    return tested;
}

// ---- Slices ----

// The tree of a slice: the two texels beside its line in each column, then bounds of 2, 4, 8, ... columns.
class SliceHeights {
public:
    SliceHeights(const ShaftView &view, const SliceView &slice, float low_column, float high_column,
                 SliceScratch &scratch)
        : columns_(columns_of(view.map.width, view.map.height)), scratch_(scratch) {
        const auto columns = static_cast<std::size_t>(columns_);
        scratch.low.resize(2 * columns);
        scratch.high.resize(2 * columns);
        scratch.weight.resize(columns);
        const auto group = static_cast<std::size_t>(std::min(TREE_ROOT, columns_));
        std::size_t first = static_cast<std::size_t>(low_column) / group * group;
        std::size_t last = std::min(static_cast<std::size_t>(high_column) / group * group + group, columns);
        for (std::size_t i = first; i < last; i += LANES) {
            fetch(view, slice, i);
        }
        std::size_t fine = 0, coarse = columns;
        for (std::size_t count = 2; static_cast<float>(count) <= root(); count *= 2) {
            first /= 2;
            last /= 2;
            float *const low = scratch.low.data(), *const high = scratch.high.data();
            for (std::size_t i = first; i < last; ++i) { // of a single column the two are its texels
                const std::size_t a = fine + 2 * i, b = a + 1;
                low[coarse + i] = std::min(std::min(low[a], high[a]), std::min(low[b], high[b]));
                high[coarse + i] = std::max(std::max(low[a], high[a]), std::max(low[b], high[b]));
            }
            fine = coarse;
            coarse += columns / count;
        }
    }

    [[nodiscard]] float root() const { return std::min(TREE_ROOT, columns_); }

    [[nodiscard]] ColumnNode node(Real column, Real /*count*/, Real per_count, Real /*level*/) const {
        const Index at = truncate(2.0F * columns_ * (1.0F - per_count) + column * per_count);
        ColumnNode node;
        node.depth[0] = gather(scratch_.low.data(), at);
        node.depth[1] = gather(scratch_.high.data(), at);
        node.low = min(node.depth[0], node.depth[1]);
        node.high = max(node.depth[0], node.depth[1]);
        node.weight = gather(scratch_.weight.data(), truncate(column));
        return node;
    }

private:
    void fetch(const ShaftView &view, const SliceView &slice, std::size_t i) {
        const int width = view.map.width, height = view.map.height;
        const Real column = lane_numbers() + static_cast<float>(i);
        const Real m = slice.reversed ? columns_ - 1.0F - column : column;
        const float along = static_cast<float>(slice.along_y ? height : width) - 1.0F;
        const Mask beside = (m < 0.0F) | (m > along);
        const Index j = truncate(clamp(m, 0.0F, along));
        const float across = static_cast<float>(slice.along_y ? width : height) - 1.0F;
        const Real n = clamp(slice.n0 + slice.slope * (column + 0.5F - slice.m0) - 0.5F, 0.0F, across);
        const Real below = floor(n);
        const Index n0 = truncate(below), n1 = truncate(min(below + 1.0F, across));
        const auto at = [&](Index k) { return slice.along_y ? j * Index(width) + k : k * Index(width) + j; };
        pick(beside, NOWHERE, gather(view.map.solid_depth, at(n0))).store_unaligned(scratch_.low.data() + i);
        pick(beside, NOWHERE, gather(view.map.solid_depth, at(n1))).store_unaligned(scratch_.high.data() + i);
        (n - below).store_unaligned(scratch_.weight.data() + i);
    }

    float columns_;
    SliceScratch &scratch_;
};

// Rays of a slice.
struct SliceRays {
    Real x, y; // on the screen
    Mask asked;
    Ray ray;
    Real distance, look;
    LineOnMap line;
};

inline SliceRays slice_rays(const ShaftView &view, const EpipolarView &epipolar, const SliceView &slice, int j,
                            int samples) {
    const BorderView &border = epipolar.borders[slice.border];
    const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
    const float away_x = slice.exit[0] * epipolar.light[2] - epipolar.light[0];
    const float away_y = slice.exit[1] * epipolar.light[2] - epipolar.light[1];
    const float gain = std::abs(slice.border < 2 ? away_x : away_y);
    const Real number = lane_numbers() + static_cast<float>(j);
    const EpipolarText::ScreenPlace place =
        EpipolarText().place_on_slice(slice.exit[0], slice.exit[1], away_x, away_y, gain, number * border.deep);
    SliceRays rays;
    rays.x = place.x;
    rays.y = place.y;
    const float beside = 2.0F * (border.along + border.deep) + 2.0F;
    rays.asked = (number < static_cast<float>(samples)) & (place.x > -beside) & (place.x < width + beside) &
                 (place.y > -beside) & (place.y < height + beside);
    rays.ray = ray_at(view, place.x, place.y);
    const Index px = truncate(clamp(floor(place.x), 0.0F, width - 1.0F));
    const Index py = truncate(clamp(floor(place.y), 0.0F, height - 1.0F));
    rays.distance = end_of(view, rays.ray, gather(view.distance, py * Index(view.width) + px));
    const vec3 p = transform_point(view.map.world_to_light, rays.ray.origin);
    const vec3 d = transform_vector(view.map.world_to_light, rays.ray.direction);
    const Mask all(true);
    const auto line_until = [&](Real end) {
        return line_on(view.map, p, d, slice.along_y ? all : !all, slice.reversed ? all : !all, Real(0.0F), end);
    };
    const Real column = line_until(rays.distance).per_column;
    rays.look = max(rays.distance * EPIPOLAR_LOOK, rays.distance - column * LOOK_COLUMNS);
    rays.line = line_until(rays.look);
    rays.line.slope = slice.slope;
    rays.line.n0 = slice.n0 + slice.slope * (rays.line.m0 - slice.m0);
    return rays;
}

// Of one slice of a border every sample that is its own.
int own_samples(const BorderView &border, int number) {
    int samples = 0;
    while (samples < border.samples && number % border.as_one[samples] == 0) {
        ++samples;
    }
    return samples;
}

std::size_t march_slice(const ShaftView &view, const EpipolarView &epipolar, const SliceView &slice,
                        SliceScratch &scratch) {
    const BorderView &border = epipolar.borders[slice.border];
    const int samples = own_samples(border, slice.number);
    float low = NOWHERE, high = 0.0F;
    for (int j = 0; j < samples; j += LANES) {
        const SliceRays rays = slice_rays(view, epipolar, slice, j, samples);
        const Mask on = rays.asked & (rays.line.from < rays.line.to);
        low = std::min(low, lowest(pick(on, rays.line.first, NOWHERE)));
        high = std::max(high, highest(pick(on, rays.line.last, 0.0F)));
    }
    const SliceHeights heights(view, slice, std::min(low, high), high, scratch);
    auto tested = static_cast<std::size_t>(2.0F * std::max(high - low, 0.0F));
    const SampleView &out = epipolar.samples;
    for (int j = 0; j < samples; j += LANES) {
        const SliceRays rays = slice_rays(view, epipolar, slice, j, samples);
        Lit lit(view);
        Real share = 0.0F, from = 0.0F;
        if (xsimd::any(rays.asked)) {
            tested += count_of(for_lit_sections(rays.line, Real(0.0F), rays.look, rays.asked, heights, ALL_COLUMNS,
                                                [&](Mask which, Real begin, Real end, Real part) {
                                                    lit.add(which, begin, end, part);
                                                    const Mask stays = which & (end >= rays.look);
                                                    share = share + pick(stays, part, 0.0F);
                                                    from = max(from, pick(which, pick(stays, begin, end), 0.0F));
                                                }));
        }
        const std::size_t at = border.first +
                               static_cast<std::size_t>(slice.number) * static_cast<std::size_t>(border.samples) +
                               static_cast<std::size_t>(j);
        const int count = std::min(LANES, samples - j);
        alignas(64) float lanes[LANES];
        const auto store = [&](Real value, float *where) {
            value.store_aligned(lanes);
            std::copy_n(lanes, count, where + at);
        };
        for (int c = 0; c < lit.colours; ++c) {
            store(lit.sum[c] - share * passing(lit.extinction[c], rays.look), out.start[c]);
        }
        store(share, out.share);
        store(pick(rays.asked, from, NOWHERE), out.from);
        store(rays.distance, out.to);
    }
    return tested;
}

// ---- Pixels between them ----

// Of each of the four borders one number.
template <typename Number>
struct OfBorders {
    template <typename Get>
    OfBorders(const EpipolarView &epipolar, const Get &get) {
        for (int b = 0; b < 4; ++b) {
            of[b] = get(epipolar.borders[b]);
        }
    }
    [[nodiscard]] Real at(Real border) const {
        return pick(border < 1.5F, pick(border < 0.5F, Real(of[0]), Real(of[1])),
                    pick(border < 2.5F, Real(of[2]), Real(of[3])));
    }
    Number of[4];
};

struct Blended {
    Real sum[3] = {Real(0.0F), Real(0.0F), Real(0.0F)};
    Real weight = 0.0F;
};

// The two samples of a column on either side of a pixel.
inline void add_column(const EpipolarView &epipolar, int colours, const Real *passed, Real distance, Real along,
                       Index base, Real samples, Real j, Index as_one, Real weight, Blended &out) {
    const SampleView &of = epipolar.samples;
    const Real together = xsimd::to_float(as_one), place = along / together;
    const Real below = floor(place), share = place - below;
    for (int side = 0; side < 2; ++side) {
        const Real number = (side == 0 ? below : below + 1.0F) * together;
        const Index at = base + truncate(number) * truncate(samples) + truncate(j);
        const Real counts = (side == 0 ? 1.0F - share : share) * weight, to = gather(of.to, at);
        const Real knows = EpipolarText().sample_knows(distance, gather(of.from, at), to) * counts;
        const Real lit = gather(of.share, at);
        for (int c = 0; c < colours; ++c) {
            out.sum[c] = out.sum[c] + knows * (gather(of.start[c], at) + lit * passed[c]);
        }
        out.weight = out.weight + knows;
    }
}

void unwarp_row(const ShaftView &view, const EpipolarView &epipolar, int y, std::vector<std::uint32_t> &left,
                float *out) {
    const OfBorders<float> per_along(epipolar, [](const BorderView &b) { return 1.0F / b.along; });
    const OfBorders<float> per_deep(epipolar, [](const BorderView &b) { return 1.0F / b.deep; });
    const OfBorders<float> samples(epipolar, [](const BorderView &b) { return static_cast<float>(b.samples); });
    const OfBorders<float> first(epipolar, [](const BorderView &b) { return static_cast<float>(b.first); });
    const std::int32_t *const as_one = epipolar.borders[0].as_one; // of all borders
    const OfBorders<float> tables(epipolar,
                                  [as_one](const BorderView &b) { return static_cast<float>(b.as_one - as_one); });
    const int colours = view.colours();
    constexpr float ENOUGH = 0.25F; // of the weights of the four samples around a pixel
    for (int x = 0; x < view.width; x += LANES) {
        const RowLanes lanes(view, x, y);
        const Real px = lane_numbers() + (static_cast<float>(x) + 0.5F), py(static_cast<float>(y) + 0.5F);
        const Ray ray = ray_at(view, px, py);
        const Real distance = end_of(view, ray, lanes.distance);
        const EpipolarText::EpipolarPlace place =
            EpipolarText().epipolar_place(px, py, epipolar.light[0], epipolar.light[1], epipolar.light[2],
                                          static_cast<float>(view.width), static_cast<float>(view.height));
        const Real along = place.along * per_along.at(place.border), deep = place.deep * per_deep.at(place.border);
        const Real columns = samples.at(place.border);
        const Real j = clamp(floor(deep), 0.0F, columns - 2.0F), share = clamp(deep - j, 0.0F, 1.0F);
        const Index base = truncate(first.at(place.border));
        const Index table = truncate(tables.at(place.border) + j);
        Real passed[3];
        for (int c = 0; c < colours; ++c) {
            passed[c] = passing((&view.extinction.x)[c], distance);
        }
        Blended blended;
        add_column(epipolar, colours, passed, distance, along, base, columns, j, gather(as_one, table), 1.0F - share,
                   blended);
        add_column(epipolar, colours, passed, distance, along, base, columns, j + 1.0F,
                   gather(as_one, table + Index(1)), share, blended);
        const Mask known = blended.weight >= ENOUGH;
        for (Real &sum : blended.sum) {
            sum = pick(known, sum / max(blended.weight, ENOUGH), 0.0F);
        }
        add_colours(scattered(view, ray), blended.sum, colours, lanes.count, nullptr, lanes.first, out);
        if (xsimd::any(lanes.asked & !known)) {
            alignas(64) float unknown[LANES];
            pick(known, 0.0F, 1.0F).store_aligned(unknown);
            for (std::size_t lane = 0; lane < lanes.count; ++lane) {
                if (unknown[lane] > 0.0F) {
                    left.push_back(static_cast<std::uint32_t>(lanes.first + lane));
                }
            }
        }
    }
}

} // namespace

extern const ShaftKernels shaft_kernels;
const ShaftKernels shaft_kernels{march_row, march_pixels, march_slice, unwarp_row};

} // namespace sfumato::SFUMATO_ISA
