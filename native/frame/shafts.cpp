// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/shafts.hpp"

#include "frame/shaft_kernels.hpp"
#include "text/epipolar_text.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using EpipolarText = text::EpipolarText<float>;

// Pixels between slices, and between samples of a slice. The worst distance of a pixel from its samples is half the
// diagonal.
struct Spacing {
    float along, deep;
};

Spacing spacing_of(ShaftMethod method) {
    constexpr float ROOT2 = 1.41421356F;
    return method == ShaftMethod::EPIPOLAR_FINE ? Spacing{ROOT2, ROOT2} : Spacing{2.0F, 6.0F};
}

// Where the sun lies on the screen (0 to 1), as x, y and w. Nowhere, all 0, where all rays go along its light.
glm::dvec3 epipole(const Camera &camera, const glm::dvec3 &light) {
    constexpr double STRAIGHT = 1e-4;
    std::array<glm::dvec3, 3> along;
    for (std::size_t k = 0; k < 3; ++k) {
        along[k] = glm::dvec3(camera.far[k]) - glm::dvec3(camera.near[k]);
    }
    if (glm::length(along[1]) + glm::length(along[2]) > 1e-5 * glm::length(along[0])) {
        const glm::dvec3 place = glm::inverse(glm::dmat3(along[0], along[1], along[2])) * light;
        return glm::dvec3(place.y, place.z, place.x) * (place.x < 0.0 ? -1.0 : 1.0);
    }
    const glm::dvec3 across(camera.near[1]), up(camera.near[2]);
    const glm::dvec3 place = glm::inverse(glm::dmat3(along[0], across, up)) * light;
    const bool straight = glm::length(place.y * across + place.z * up) < STRAIGHT;
    return straight ? glm::dvec3(0.0) : glm::dvec3(place.y, place.z, 0.0);
}

// All that the kernels read of an epipole's slices and samples.
class Slices {
public:
    Slices(const ShaftView &view, const glm::dvec3 &light, Spacing spacing)
        : width(static_cast<float>(view.width)), height(static_cast<float>(view.height)) {
        for (int c = 0; c < 3; ++c) {
            epipolar.light[c] = static_cast<float>(light[c]);
        }
        std::size_t samples = 0, strides = 0;
        std::array<std::vector<std::int32_t>, 4> tables;
        for (int b = 0; b < 4; ++b) {
            const auto i = static_cast<std::size_t>(b);
            plan(b, spacing, tables[i]);
            BorderView &border = epipolar.borders[b];
            border.first = samples;
            samples += static_cast<std::size_t>(border.slices) * static_cast<std::size_t>(border.samples);
            strides += tables[i].size();
        }
        as_one.reserve(strides);
        for (int b = 0; b < 4; ++b) {
            const auto &table = tables[static_cast<std::size_t>(b)];
            epipolar.borders[b].as_one = as_one.data() + as_one.size();
            as_one.insert(as_one.end(), table.begin(), table.end());
        }
        SampleView &of = epipolar.samples;
        std::size_t k = 0;
        for (float **array : {&of.share, &of.from, &of.to, &of.start[0], &of.start[1], &of.start[2]}) {
            if (k < 3 + static_cast<std::size_t>(view.colours())) {
                numbers[k] = std::make_unique_for_overwrite<float[]>(samples + MAX_LANES);
                *array = numbers[k++].get();
            }
        }
    }

    EpipolarView epipolar;

    [[nodiscard]] SliceView slice(const ShaftView &view, int b, int number) const {
        const BorderView &border = epipolar.borders[b];
        SliceView out;
        out.border = b;
        out.number = number;
        const float along = border.along * static_cast<float>(number);
        out.exit[0] = b < 2 ? (b == 1 ? width : 0.0F) : along;
        out.exit[1] = b < 2 ? along : (b == 3 ? height : 0.0F);
        const auto &[near, far] = view.camera;
        const double u = double{out.exit[0]} / double{width}, v = double{out.exit[1]} / double{height};
        const glm::dvec3 origin = glm::dvec3(near[0]) + u * glm::dvec3(near[1]) + v * glm::dvec3(near[2]);
        const glm::dvec3 end = glm::dvec3(far[0]) + u * glm::dvec3(far[1]) + v * glm::dvec3(far[2]);
        const auto onto = [&view](const glm::dvec3 &of, double one) {
            const auto &rows = view.map.world_to_light.rows;
            const auto row = [&](const float *r) {
                return double{r[0]} * of.x + double{r[1]} * of.y + double{r[2]} * of.z + double{r[3]} * one;
            };
            return glm::dvec2(row(rows[0]) * view.map.width, row(rows[1]) * view.map.height);
        };
        const glm::dvec2 p = onto(origin, 1.0), d = onto(end - origin, 0.0);
        out.along_y = std::abs(d.y) > std::abs(d.x);
        const double m = out.along_y ? p.y : p.x, speed = out.along_y ? d.y : d.x;
        out.reversed = speed < 0.0;
        double columns = MAX_LANES;
        while (columns < std::max(view.map.width, view.map.height)) {
            columns *= 2.0;
        }
        out.m0 = static_cast<float>(out.reversed ? columns - m : m);
        out.n0 = static_cast<float>(out.along_y ? p.x : p.y);
        out.slope = static_cast<float>((out.along_y ? d.x : d.y) / std::max(std::abs(speed), 1e-30));
        return out;
    }

private:
    // How a border's slices are spaced.
    void plan(int b, Spacing spacing, std::vector<std::int32_t> &table) {
        BorderView &border = epipolar.borders[b];
        const bool side = b < 2;
        const float length = side ? height : width, depth = side ? width : height;
        const float light = epipolar.light[side ? 0 : 1], across = epipolar.light[side ? 1 : 0], w = epipolar.light[2];
        const float away = b == 1 || b == 3 ? depth * w - light : light; // from the epipole to the border
        table.assign(2, 1);
        border.samples = 2;
        border.along = 1e9F;
        if (!(away > 1e-6F * std::abs(across) + 1e-20F)) {
            return; // no slice leaves here
        }
        border.slices = static_cast<int>(std::ceil(length / spacing.along));
        border.along = length / static_cast<float>(border.slices);
        border.slices += 1 + MOST_AS_ONE + 1;
        // How far slices go across while they come nearer to the border by one: the most of any, and the least.
        const float low = std::abs(across) / away, high = std::abs(length * w - across) / away;
        const float most = std::max(low, high);
        const float least = across * (length * w - across) >= 0.0F ? 0.0F : std::min(low, high);
        const float deepest = std::min(w > 0.0F ? std::min(depth, away / w) : depth, length / std::max(least, 1e-6F));
        const auto steps = static_cast<int>(std::ceil(deepest * std::sqrt(1.0F + most * most) / spacing.deep));
        border.deep = deepest / static_cast<float>(std::max(steps, 1));
        border.samples = std::max(steps, 1) + 1;
        table.clear();
        for (int j = 0; j < border.samples; ++j) {
            const float share = (away - static_cast<float>(j) * border.deep * w) / away;
            table.push_back(static_cast<std::int32_t>(EpipolarText().slices_as_one(share)));
        }
    }

    static constexpr int MOST_AS_ONE = 16;
    float width, height;
    std::vector<std::int32_t> as_one;
    std::array<std::unique_ptr<float[]>, 6> numbers; // NOLINT(modernize-avoid-c-arrays): left as they are at first
};

template <typename Work>
std::size_t in_parallel(int count, const Work &work) {
    std::atomic<std::size_t> sum = 0;
    oneapi::tbb::parallel_for(
        oneapi::tbb::blocked_range<int>(0, count),
        [&](const oneapi::tbb::blocked_range<int> &part) { sum += work(part.begin(), part.end()); });
    return sum;
}

void march(const ShaftView &view, bool by_tree, Shafts &out) {
    out.rays += static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    out.texels += in_parallel(view.height, [&](int begin, int end) {
        std::size_t tested = 0;
        for (int y = begin; y < end; ++y) {
            tested += shaft_kernels().march_row(view, y, by_tree ? 1e6F : 1.0F, out.radiance.data());
        }
        return tested;
    });
}

void sample(const ShaftView &view, const Slices &slices, Shafts &out) {
    const EpipolarView &epipolar = slices.epipolar;
    for (int b = 0; b < 4; ++b) {
        const BorderView &border = epipolar.borders[b];
        for (int j = 0; j < border.samples && border.slices > 0; ++j) {
            out.rays += static_cast<std::size_t>(border.slices / border.as_one[j]);
        }
        out.texels += in_parallel(border.slices, [&](int begin, int end) {
            SliceScratch scratch;
            std::size_t tested = 0;
            for (int number = begin; number < end; ++number) {
                tested += shaft_kernels().march_slice(view, epipolar, slices.slice(view, b, number), scratch);
            }
            return tested;
        });
    }
}

void unwarp(const ShaftView &view, const Slices &slices, Shafts &out) {
    std::atomic<std::size_t> again = 0;
    out.texels += in_parallel(view.height, [&](int begin, int end) {
        std::vector<std::uint32_t> left;
        for (int y = begin; y < end; ++y) {
            shaft_kernels().unwarp_row(view, slices.epipolar, y, left, out.radiance.data());
        }
        again += left.size();
        return shaft_kernels().march_pixels(view, left, out.radiance.data());
    });
    out.rays += again;
}

} // namespace

SolidMap::SolidMap(std::vector<float> depth, int across, int down, const glm::dmat4 &world_to_map)
    : depths(std::move(depth)), width(across), height(down), onto(world_to_map), bounds(depths.data(), width, height) {}

Shafts shafts(const ShaftRays &rays, std::span<const ShaftLight> lights, const ShaftAir &air, ShaftMethod method) {
    Shafts out;
    out.radiance.assign(3 * rays.distance.size(), 0.0F);
    for (const ShaftLight &light : lights) {
        ShaftView view;
        view.camera = rays.camera;
        view.width = rays.width;
        view.height = rays.height;
        view.distance = rays.distance.data();
        view.rayleigh = air.rayleigh;
        view.mie = air.mie;
        view.extinction = air.rayleigh + air.mie + air.absorption;
        view.anisotropy = air.anisotropy;
        view.map.solid_depth = light.map->depth().data();
        view.map.width = light.map->columns();
        view.map.height = light.map->rows();
        view.map.world_to_light = affine(light.map->world_to_map());
        view.tree = light.map->tree();
        view.direction = light.direction;
        view.irradiance = light.irradiance;
        const glm::dvec3 place = epipole(rays.camera, light.direction);
        const glm::dvec3 on_screen(place.x * rays.width, place.y * rays.height, place.z);
        const bool sliced = method == ShaftMethod::EPIPOLAR || method == ShaftMethod::EPIPOLAR_FINE;
        if (!sliced || place == glm::dvec3(0.0)) {
            march(view, method != ShaftMethod::MARCH, out);
            continue;
        }
        const Slices slices(view, on_screen / std::max({std::abs(on_screen.x), std::abs(on_screen.y), on_screen.z}),
                            spacing_of(method));
        sample(view, slices, out);
        unwarp(view, slices, out);
    }
    return out;
}

} // namespace sfumato
