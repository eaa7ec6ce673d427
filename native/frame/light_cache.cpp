// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/light_cache.hpp"

#include "frame/layers.hpp"
#include "frame/light_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr int ACROSS = 48, UP = 27; // rays from the camera
constexpr float CELLS = 16.0F;      // over the distance to what it sees
constexpr int RAYS = 64;            // from a cell
constexpr std::size_t PLACES = 4;   // in a cell, of which these start
constexpr std::size_t MOST = 1 << 15;
constexpr int ROUNDS = 2; // in which what is met becomes a cell

// What a ray from a cell meets: another cell, and what that sends of a light of 1.
struct Link {
    std::int32_t cell = -1;
    glm::vec3 albedo{0.0F};
};

struct Cell {
    std::uint32_t key = NO_CELL;
    int level = 0;
    std::size_t count = 0;
    std::array<BouncePoint, PLACES> places;
    glm::vec3 direct{0.0F};  // of lights
    glm::vec3 emitted{0.0F}; // of what else glows, the mean of what rays find
};

template <typename Body>
void in_parallel(std::size_t count, std::size_t grain, const Body &body) {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, grain),
                              [&](const auto &range) { body(range.begin(), range.end()); });
}

std::vector<BounceRay> camera_rays(const FrameView &frame) {
    std::vector<BounceRay> rays;
    const auto &c = frame.camera;
    for (int y = 0; y < UP; ++y) {
        for (int x = 0; x < ACROSS; ++x) {
            const float u = (static_cast<float>(x) + 0.5F) / ACROSS, v = (static_cast<float>(y) + 0.5F) / UP;
            const glm::vec3 near = c[0] + c[1] * u + c[2] * v, far = c[3] + c[4] * u + c[5] * v;
            rays.push_back({near, glm::normalize(far - near)});
        }
    }
    return rays;
}

// Builds the cells, and what they see of each other.
class Growth {
public:
    Growth(const FrameView &frame, const BounceKernels &kernels, LightCacheView &view)
        : frame_(frame), kernels_(kernels), view_(view), slots_(4 * MOST, NO_CELL), cell_of_slot_(4 * MOST, -1) {}

    void run() {
        const std::vector<BounceRay> rays = camera_rays(frame_);
        std::vector<BouncePoint> seen = met(rays);
        kernels_.meet_more(frame_, rays, seen);
        const glm::vec3 &eye = rays[rays.size() / 2].origin;
        std::vector<float> distances;
        for (const BouncePoint &point : seen) {
            if (point.hit) {
                distances.push_back(glm::distance(eye, point.position));
            }
        }
        if (distances.empty()) {
            return;
        }
        const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
        std::nth_element(distances.begin(), middle, distances.end());
        view_.eye = eye;
        view_.near = std::max(*middle, 1e-6F);
        view_.size = view_.near / CELLS;
        for (const BouncePoint &point : seen) {
            static_cast<void>(cell_at(point, true));
        }
        std::size_t done = 0;
        for (int round = 0; done < cells.size(); ++round) {
            const std::size_t end = cells.size();
            look_around(done, end, round < ROUNDS);
            done = end;
        }
        light();
    }

    // A ray to the sky, and what it finds there.
    struct Missed {
        BounceRay ray;
        glm::vec3 radiance;
    };

    std::vector<Cell> cells;
    std::vector<Link> links; // RAYS of each cell
    std::vector<Missed> missed;

private:
    [[nodiscard]] std::vector<BouncePoint> met(const std::vector<BounceRay> &rays) const {
        constexpr std::size_t GRAIN = 1024;
        std::vector<BouncePoint> out(rays.size());
        in_parallel(rays.size(), GRAIN, [&](std::size_t first, std::size_t end) {
            kernels_.meet(frame_, std::span(rays).subspan(first, end - first),
                          std::span(out).subspan(first, end - first));
        });
        return out;
    }

    // The cell of a point, or -1: it may be made.
    std::int32_t cell_at(const BouncePoint &point, bool grows) {
        if (!point.hit) {
            return -1;
        }
        const glm::vec3 away = point.position - view_.eye;
        const int level = cell_level(view_, glm::length(away));
        const glm::vec3 q = away / std::ldexp(view_.size, level);
        const std::uint32_t key = cell_key(level, cell_face(point.normal), static_cast<int>(std::floor(q.x)),
                                           static_cast<int>(std::floor(q.y)), static_cast<int>(std::floor(q.z)));
        const auto mask = static_cast<std::uint32_t>(slots_.size() - 1);
        const std::uint32_t slot = cell_slot(slots_.data(), mask, key);
        if (slots_[slot] == NO_CELL) {
            if (!grows || cells.size() >= MOST) {
                return -1;
            }
            slots_[slot] = key;
            cell_of_slot_[slot] = static_cast<std::int32_t>(cells.size());
            cells.emplace_back().key = key;
            cells.back().level = level;
        }
        const std::int32_t found = cell_of_slot_[slot];
        Cell &cell = cells[static_cast<std::size_t>(found)];
        if (grows && cell.count < PLACES) {
            cell.places[cell.count++] = point;
        }
        return found;
    }

    // Follows rays from some cells: as many as their cosines, each cell's turned by another angle.
    void look_around(std::size_t first, std::size_t end, bool grows) {
        std::vector<BounceRay> rays((end - first) * RAYS);
        in_parallel(end - first, 64, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) {
                const Cell &cell = cells[first + i];
                const double turn = std::fmod(static_cast<double>(first + i) * 0.7548776662466927, 1.0);
                for (int k = 0; k < RAYS; ++k) {
                    const BouncePoint &place = cell.places[static_cast<std::size_t>(k) % cell.count];
                    const double radius = std::sqrt((k + 0.5) / RAYS);
                    const double angle = 2.0 * std::numbers::pi * (std::numbers::phi * k + turn);
                    const auto x = static_cast<float>(radius * std::cos(angle));
                    const auto y = static_cast<float>(radius * std::sin(angle));
                    const glm::vec3 &n = place.normal;
                    const glm::vec3 other =
                        std::abs(n.z) < 0.9F ? glm::vec3(0.0F, 0.0F, 1.0F) : glm::vec3(1.0F, 0.0F, 0.0F);
                    const glm::vec3 across = glm::normalize(glm::cross(other, n));
                    rays[i * RAYS + static_cast<std::size_t>(k)] = {
                        place.position,
                        across * x + glm::cross(n, across) * y + n * std::sqrt(std::max(1.0F - x * x - y * y, 1e-6F))};
                }
            }
        });
        const std::vector<BouncePoint> points = met(rays);
        links.resize(end * RAYS);
        for (std::size_t i = first; i < end; ++i) {
            glm::vec3 emitted(0.0F);
            for (std::size_t k = 0; k < RAYS; ++k) {
                const BouncePoint &point = points[(i - first) * RAYS + k];
                links[i * RAYS + k] = {cell_at(point, grows), point.albedo};
                emitted += point.emission;
                if (!point.hit && point.emission != glm::vec3(0.0F)) {
                    missed.push_back({rays[(i - first) * RAYS + k], point.emission});
                }
            }
            cells[i].emitted = emitted / static_cast<float>(RAYS);
        }
    }

    void light() {
        std::vector<BouncePoint> points;
        std::vector<std::size_t> firsts;
        for (const Cell &cell : cells) {
            firsts.push_back(points.size());
            points.insert(points.end(), cell.places.begin(),
                          cell.places.begin() + static_cast<std::ptrdiff_t>(cell.count));
        }
        std::vector<glm::vec3> light(points.size());
        in_parallel(points.size(), 256, [&](std::size_t first, std::size_t end) {
            kernels_.lit(frame_, std::span(points).subspan(first, end - first),
                         std::span(light).subspan(first, end - first));
        });
        for (std::size_t i = 0; i < cells.size(); ++i) {
            for (std::size_t k = 0; k < cells[i].count; ++k) {
                cells[i].direct += light[firsts[i] + k] / static_cast<float>(cells[i].count);
            }
        }
    }

    const FrameView &frame_;
    const BounceKernels &kernels_;
    LightCacheView &view_;
    std::vector<std::uint32_t> slots_;
    std::vector<std::int32_t> cell_of_slot_;
};

float mean(const glm::vec3 &rgb) {
    return (rgb.x + rgb.y + rgb.z) * (1.0F / 3.0F);
}

struct Bright {
    glm::vec3 middle;
    float size, flux;
    int place = -1;
};

// Where rays leave the box around all cells to the sky: of a room, its windows.
void add_windows(const Growth &growth, float size, std::vector<Bright> &all) {
    glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
    for (const Cell &cell : growth.cells) {
        for (std::size_t k = 0; k < cell.count; ++k) {
            low = glm::min(low, cell.places[k].position);
            high = glm::max(high, cell.places[k].position);
        }
    }
    struct Sum {
        glm::vec3 middle{0.0F};
        float radiance = 0.0F, count = 0.0F;
    };
    std::map<std::array<int, 3>, Sum> windows;
    for (const auto &[ray, radiance] : growth.missed) {
        float reach = std::numeric_limits<float>::max();
        for (int axis = 0; axis < 3; ++axis) {
            const float way = ray.direction[axis];
            if (std::abs(way) > 1e-6F) {
                reach = std::min(reach, ((way > 0.0F ? high : low)[axis] - ray.origin[axis]) / way);
            }
        }
        const glm::vec3 out = ray.origin + ray.direction * std::max(reach, 0.0F);
        std::array<int, 3> key{};
        for (int axis = 0; axis < 3; ++axis) {
            key[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor((out[axis] - low[axis]) / size));
        }
        Sum &sum = windows[key];
        sum.middle += out;
        sum.radiance += mean(radiance);
        sum.count += 1.0F;
    }
    for (const auto &[key, sum] : windows) {
        all.push_back({sum.middle / sum.count, size, sum.radiance / sum.count * size * size});
    }
}

// Puts the brightest cells, of what they send of lights, together to few places.
void find_bright(const Growth &growth, LightCacheView &view) {
    constexpr float BRIGHTER = 4.0F, APART = 8.0F; // than the mean; cells
    const std::vector<Cell> &cells = growth.cells;
    std::vector<Bright> all;
    float flux = 0.0F, area = 0.0F;
    for (const Cell &cell : cells) {
        Bright each{glm::vec3(0.0F), std::ldexp(view.size, cell.level), 0.0F};
        glm::vec3 albedo(0.0F), emission(0.0F);
        for (std::size_t k = 0; k < cell.count; ++k) {
            emission += cell.places[k].emission / static_cast<float>(cell.count);
            each.middle += cell.places[k].position / static_cast<float>(cell.count);
            albedo += cell.places[k].albedo / static_cast<float>(cell.count);
        }
        each.flux = mean(emission + albedo * (cell.direct + cell.emitted)) * each.size * each.size;
        flux += each.flux;
        area += each.size * each.size;
        all.push_back(each);
    }
    add_windows(growth, 2.0F * view.size, all);
    std::erase_if(all, [&](const Bright &each) { return each.flux * area <= BRIGHTER * flux * each.size * each.size; });
    std::ranges::sort(all, std::ranges::greater(), &Bright::flux);
    for (Bright &each : all) {
        float closest = std::numeric_limits<float>::max();
        for (int k = 0; k < view.bright_count; ++k) {
            const float away = glm::distance(view.bright[static_cast<std::size_t>(k)].middle, each.middle);
            if (away < closest) {
                closest = away;
                each.place = k;
            }
        }
        if (closest > APART * each.size && view.bright_count < LightCacheView::MOST_BRIGHT) {
            each.place = view.bright_count++;
        }
        BrightPlace &place = view.bright[static_cast<std::size_t>(each.place)];
        place.middle = (place.middle * place.flux + each.middle * each.flux) / (place.flux + each.flux);
        place.flux += each.flux;
    }
    for (const Bright &each : all) {
        BrightPlace &place = view.bright[static_cast<std::size_t>(each.place)];
        place.radius = std::max(place.radius, glm::distance(place.middle, each.middle) + each.size);
    }
}

// What comes after one bounce more.
std::vector<glm::vec3> bounced(const Growth &growth, const std::vector<glm::vec3> &indirect) {
    std::vector<glm::vec3> out(indirect.size());
    in_parallel(out.size(), 256, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            glm::vec3 sum(0.0F);
            for (std::size_t k = 0; k < RAYS; ++k) {
                const Link &link = growth.links[i * RAYS + k];
                if (link.cell >= 0) {
                    const auto other = static_cast<std::size_t>(link.cell);
                    sum += link.albedo * (growth.cells[other].direct + growth.cells[other].emitted + indirect[other]);
                }
            }
            out[i] = sum / static_cast<float>(RAYS);
        }
    });
    return out;
}

} // namespace

LightCache::LightCache(const FrameView &frame, const BounceKernels &kernels, int bounces) {
    Growth growth(frame, kernels, view_);
    growth.run();
    count_ = growth.cells.size();
    find_bright(growth, view_);
    std::vector<glm::vec3> before(count_, glm::vec3(0.0F)), after = before;
    for (int i = 0; i < bounces; ++i) {
        before = std::move(after);
        after = bounced(growth, before);
    }
    std::size_t slots = 16;
    while (slots < 2 * count_) {
        slots *= 2;
    }
    view_.mask = static_cast<std::uint32_t>(slots - 1);
    keys_.assign(slots, NO_CELL);
    for (std::vector<glm::vec3> *values : {&direct_, &indirect_, &settled_}) {
        values->assign(slots, glm::vec3(0.0F));
    }
    for (std::size_t i = 0; i < count_; ++i) {
        const std::uint32_t slot = cell_slot(keys_.data(), view_.mask, growth.cells[i].key);
        keys_[slot] = growth.cells[i].key;
        const Cell &cell = growth.cells[i];
        direct_[slot] = cell.direct;
        indirect_[slot] = cell.emitted + before[i];
        settled_[slot] = cell.emitted + after[i];
    }
    view_.keys = keys_.data();
    view_.direct = direct_.data();
    view_.indirect = indirect_.data();
    view_.settled = settled_.data();
}

} // namespace sfumato
