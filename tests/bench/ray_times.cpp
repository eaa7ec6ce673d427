// SPDX-License-Identifier: GPL-3.0-or-later
// How long single light rays take to build and to look up, for bench.py lightmaps: one line of JSON.
// Every time is the least of many runs, in nanoseconds a ray or a receiver, on one thread.
#include "rays/curve.hpp"
#include "rays/opacity.hpp"
#include "rays/ray_kernels.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>

namespace sfumato {
namespace {

constexpr std::size_t RAYS = 1000;

template <typename Work>
double nanoseconds(std::size_t each, const Work &work) {
    double least = 1e30;
    for (int run = 0; run < 40; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        least = std::min(least, time.count());
    }
    return least / static_cast<double>(each);
}

void print(const char *what, const std::string &method, std::size_t count, double time, bool last = false) {
    std::printf(R"({"what": "%s", "method": "%s", "count": %zu, "nanoseconds": %.2f}%s)", what, method.c_str(), count,
                time, last ? "]\n" : ", ");
}

struct Batch {
    explicit Batch(std::size_t absorbers, float slab_width) : each(absorbers), width(slab_width) {
        std::mt19937 generator(1);
        std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
        for (std::size_t i = 0; i < RAYS * each; ++i) {
            depth.push_back(0.1F + 0.8F * uniform(generator));
            tau.push_back(0.05F * uniform(generator));
        }
    }
    [[nodiscard]] Absorbers at(std::size_t ray) const {
        return {std::span(depth).subspan(ray * each, each), std::span(tau).subspan(ray * each, each), width};
    }
    [[nodiscard]] std::vector<float> project_all(const Series &series, std::span<const Range> ranges) const {
        std::vector<float> out(RAYS * series.count, 0.0F);
        for (std::size_t ray = 0; ray < RAYS; ++ray) {
            project(series, at(ray), ranges[ray], std::span(out).subspan(ray * series.count, series.count));
        }
        return out;
    }

    std::size_t each;
    float width;
    std::vector<float> depth, tau;
};

void builds(std::size_t absorbers, float width) {
    const Batch rays(absorbers, width);
    const std::vector<Range> whole(RAYS);
    const char *what = width > 0.0F ? "build slabs" : "build";
    for (const Series &series : {Series{FOURIER, 7, {}}, Series{PIECEWISE, 7, {}}, Series{COSINE, 15, {}}}) {
        const std::size_t count = series.count;
        std::vector<float> c(RAYS * count);
        print(what, series.basis().name, absorbers, nanoseconds(RAYS, [&] {
                  std::fill(c.begin(), c.end(), 0.0F);
                  for (std::size_t ray = 0; ray < RAYS; ++ray) {
                      project(series, rays.at(ray), whole[ray], std::span(c).subspan(ray * count, count));
                  }
              }));
    }
    std::array<std::uint8_t, CURVE_BYTES> texel{};
    print(what, "curve", absorbers, nanoseconds(50, [&] {
              for (std::size_t ray = 0; ray < 50; ++ray) {
                  fit_curve(exact_curve(rays.at(ray)), texel);
              }
          }));
}

void look_ups(std::size_t receivers, bool last) {
    const Batch rays(64, 0.0F);
    std::vector<float> ranges, depth, out(RAYS * receivers);
    std::vector<Range> own;
    for (std::size_t ray = 0; ray < RAYS; ++ray) {
        own.push_back(depth_range(rays.at(ray), RangeKind::MINMAX, 3.0F));
    }
    std::mt19937 generator(2);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    for (std::size_t i = 0; i < out.size(); ++i) {
        depth.push_back(uniform(generator));
    }
    for (std::size_t ray = 0; ray < RAYS; ++ray) {
        ranges.insert(ranges.end(), {0.0F, 1.0F});
    }
    const Series fourier{FOURIER, 7, {}}, cosine{COSINE, 15, {}};
    const std::vector<float> seven = rays.project_all(fourier, std::vector<Range>(RAYS));
    const std::vector<float> fifteen = rays.project_all(cosine, own);
    std::vector<std::int32_t> packed(RAYS * RAY_WORDS), curves(RAYS * RAY_WORDS);
    std::array<std::uint8_t, CURVE_BYTES> texel{};
    for (std::size_t ray = 0; ray < RAYS; ++ray) {
        pack(cosine, std::span(fifteen).subspan(ray * 15, 15), own[ray], texel);
        std::memcpy(packed.data() + ray * RAY_WORDS, texel.data(), texel.size());
        fit_curve(exact_curve(rays.at(ray)), texel);
        std::memcpy(curves.data() + ray * RAY_WORDS, texel.data(), texel.size());
    }
    const auto each = static_cast<int>(receivers), all = static_cast<int>(out.size());
    print(
        "look-up", "fourier", receivers, nanoseconds(out.size(), [&] {
            ray_kernels().look_up_series({seven.data(), ranges.data(), 7, false, depth.data(), out.data(), each, all});
        }));
    print("look-up", "cosine-range", receivers, nanoseconds(out.size(), [&] {
              ray_kernels().look_up_texels({packed.data(), false, depth.data(), out.data(), each, all});
          }));
    print("look-up", "curve", receivers, nanoseconds(out.size(), [&] {
              ray_kernels().look_up_texels({curves.data(), true, depth.data(), out.data(), each, all});
          }));
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t *>(packed.data()), RAYS * 20);
    const RayEvaluator monotone(cosine, Evaluator::MONOTONE);
    print("look-up", "cosine-range monotone", receivers,
          nanoseconds(out.size(),
                      [&] {
                          std::array<float, 15> c{};
                          for (std::size_t ray = 0; ray < RAYS; ++ray) {
                              const Range range = unpack(cosine, bytes.subspan(ray * 20, 20), c);
                              monotone(c, range, std::span(depth).subspan(ray * receivers, receivers),
                                       std::span(out).subspan(ray * receivers, receivers));
                          }
                      }),
          last);
}

} // namespace
} // namespace sfumato

int main() {
    std::putchar('[');
    sfumato::builds(64, 0.0F);
    sfumato::builds(128, 1.0F / 128.0F);
    sfumato::look_ups(1, false);
    sfumato::look_ups(65, true);
}
