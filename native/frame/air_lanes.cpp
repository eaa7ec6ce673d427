// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the air: what it scatters of all lights, emits and takes between the eye and the first opaque surface of
// each ray. A ray goes in steps, from knot to knot, at which what is met there finds what the air sends before it; and
// from wall to wall of fogs.
#include "frame/lamp_shine_lanes.hpp"
#include "frame/sun_shine_lanes.hpp"
#include "media/fog_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;

// Where rays go through fogs: from wall to wall.
class Walls {
public:
    Walls(const FrameView &frame, const Ray &ray, Real end, Mask asked) : amounts_(frame.fogs.size() * LANES, 0.0F) {
        std::vector<Hit> hits;
        std::vector<FogStretch> found;
        for (std::size_t fog = 0; fog < frame.fogs.size(); ++fog) {
            fog_stretches(frame.fogs[fog], ray.origin, ray.direction, end, asked, hits, found);
            for (const FogStretch &stretch : found) {
                std::vector<Wall> &walls = walls_[static_cast<std::size_t>(stretch.lane)];
                walls.push_back({stretch.near, fog, 1.0F});
                walls.push_back({stretch.far, fog, -1.0F});
            }
        }
        for (std::vector<Wall> &walls : walls_) {
            std::sort(walls.begin(), walls.end(), [](const Wall &a, const Wall &b) { return a.distance < b.distance; });
        }
    }

    // Where each ray meets the next one; endless where there is none.
    [[nodiscard]] Real next() const {
        alignas(64) float distance[LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            distance[lane] = next_[lane] < walls_[lane].size() ? walls_[lane][next_[lane]].distance : 1e30F;
        }
        return Real::load_aligned(distance);
    }
    // Through that, where it is no further than `upto`.
    void pass(Real upto) {
        alignas(64) float reached[LANES];
        upto.store_aligned(reached);
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            for (; next_[lane] < walls_[lane].size() && walls_[lane][next_[lane]].distance <= reached[lane];
                 ++next_[lane]) {
                const Wall &wall = walls_[lane][next_[lane]];
                amounts_[wall.fog * LANES + lane] += wall.change;
            }
        }
    }
    // In how many places of a fog each ray is.
    [[nodiscard]] Real amount(std::size_t fog) const { return Real::load_unaligned(amounts_.data() + fog * LANES); }

private:
    struct Wall {
        float distance;
        std::size_t fog;
        float change;
    };
    std::array<std::vector<Wall>, LANES> walls_;
    std::array<std::size_t, LANES> next_{};
    std::vector<float> amounts_;
};

// What all air on rays sends, and takes.
class AllAir {
public:
    AllAir(const FrameView &frame, const Packet &packet, const Ray &ray, Real end, Mask asked)
        : frame_(frame), packet_(packet), ray_(ray), walls_(frame, ray, end, asked) {}

    // On to another place, which is a knot.
    void go(Real to) {
        for (bool met = true; met;) {
            const Real wall = walls_.next(), upto = min(wall, to);
            met = xsimd::any(wall <= to);
            const Real from = steps_.empty() ? Real(0.0F) : steps_.back().to;
            steps_.push_back({from, upto, taken_});
            for (std::size_t fog = 0; fog < frame_.fogs.size(); ++fog) {
                amounts_.push_back(walls_.amount(fog));
            }
            walls_.pass(upto);
            move(upto);
        }
        knots_.push_back(steps_.size());
    }

    // What is sent and taken before each of them.
    void leave(AirKnots &knots) const;

private:
    void move(Real to) {
        const std::size_t first = frame_.air.size() - frame_.fogs.size();
        for (int c = 0; c < 3; ++c) {
            taken_.before[c] = taken_.before[c] + taken_.by_metre[c] * (to - taken_.start);
            taken_.by_metre[c] = 0.0F;
            for (std::size_t fog = 0; fog < frame_.fogs.size(); ++fog) {
                taken_.by_metre[c] = taken_.by_metre[c] + walls_.amount(fog) * frame_.air[first + fog].extinction[c];
            }
        }
        taken_.start = to;
    }
    [[nodiscard]] std::vector<Colours> sent() const;
    [[nodiscard]] Way way(std::size_t air, int body, std::span<const Step> steps, std::vector<Colours> &sum) const {
        return {frame_, packet_, frame_.air[air], body, ray_, frame_.grey ? 1 : 3, steps, sum};
    }

    const FrameView &frame_;
    const Packet &packet_;
    const Ray &ray_;
    Walls walls_;
    Taken taken_;
    std::vector<Step> steps_;
    std::vector<Real> amounts_;      // of each step, in how many places of each fog rays are
    std::vector<std::size_t> knots_; // of each, the steps before it
};

// What the air sends to the eye in each step.
void send(const Way &way) {
    for (std::size_t i = 0; i < way.steps.size(); ++i) {
        const Step &step = way.steps[i];
        const Real column = way.column(step.to) - way.column(step.from);
        const Way::Depth front = way.to_eye(step.fogs, step.from), back = way.to_eye(step.fogs, step.to);
        for (int c = 0; c < 3; ++c) {
            const int of = c < way.colours ? c : 0;
            Real &sum = way.scatter[i].of[c];
            sum = sum + AirText().lit_by_sun(column, front.of[of], back.of[of]) * way.air.emission[c];
        }
    }
    if (way.air.rayleigh == glm::vec3(0.0F) && way.air.mie == glm::vec3(0.0F)) {
        return;
    }
    for (const LightView &light : way.frame.lights) {
        if (!light.reach.smoke || (light.reach.lights & way.air.lit_by) == 0 || light.samples.empty()) {
            continue;
        }
        if (light.parallel()) {
            SunShine(way, light).add();
        } else {
            LampShine(way, light).add();
        }
    }
}

std::vector<Colours> AllAir::sent() const {
    std::vector<Colours> all(steps_.size());
    const std::size_t fogs = frame_.fogs.size(), first = frame_.air.size() - fogs;
    for (std::size_t i = 0; i < first; ++i) {
        send(way(i, frame_.air_body, steps_, all));
    }
    std::vector<Step> own;
    for (std::size_t fog = 0; fog < fogs; ++fog) {
        std::vector<Colours> of_one(steps_.size());
        own = steps_;
        bool any = false;
        for (std::size_t k = 0; k < own.size(); ++k) {
            own[k].to = pick(amounts_[k * fogs + fog] > 0.0F, own[k].to, own[k].from);
            any = any || xsimd::any(own[k].from < own[k].to);
        }
        if (!any) {
            continue;
        }
        send(way(first + fog, frame_.first_fog + static_cast<int>(fog), own, of_one));
        for (std::size_t k = 0; k < own.size(); ++k) {
            for (int c = 0; c < 3; ++c) {
                all[k].of[c] = all[k].of[c] + of_one[k].of[c] * amounts_[k * fogs + fog];
            }
        }
    }
    return all;
}

void AllAir::leave(AirKnots &knots) const {
    const auto keep = [&knots](Real value) {
        knots.values.resize(knots.values.size() + MAX_LANES);
        value.store_unaligned(knots.values.data() + (knots.values.size() - MAX_LANES));
    };
    std::vector<Colours> none;
    const Way any = way(0, -1, steps_, none);
    const auto leave_one = [&](Real at, const Colours &radiance, const Taken &fogs) {
        keep(at);
        for (const Real &value : radiance.of) {
            keep(value);
        }
        const Way::Depth depth = any.to_eye(fogs, at);
        for (int c = 0; c < any.colours; ++c) {
            keep(depth.of[c]);
        }
        ++knots.count;
    };
    const std::vector<Colours> sent = this->sent();
    Colours sum;
    leave_one(0.0F, sum, Taken{});
    std::size_t step = 0;
    for (const std::size_t knot : knots_) {
        for (; step < knot; ++step) {
            for (int c = 0; c < 3; ++c) {
                sum.of[c] = sum.of[c] + sent[step].of[c];
            }
        }
        leave_one(steps_[knot - 1].to, sum, steps_[knot - 1].fogs);
    }
}

// From the first to the last of what else is met on any ray, in each lane within its own way; the whole way where
// nothing is met.
struct Stretch {
    Real from, to;
};

Stretch met(const Events &events, Real end, int colours) {
    constexpr float FAR = 1e30F;
    alignas(64) float from[MAX_LANES], to[MAX_LANES];
    for (std::size_t lane = 0; lane < LANES; ++lane) {
        from[lane] = FAR;
        to[lane] = 0.0F;
        const auto take = [&](float near, float far) {
            from[lane] = std::min(from[lane], near);
            to[lane] = std::max(to[lane], far);
        };
        for (const Fragment &fragment : events.fragments[lane]) {
            take(fragment.distance, fragment.distance);
        }
        if (events.slices.count > 0 && events.slices.width[lane] > 0.0F) {
            const float first = events.slices.first[lane];
            take(first, first + events.slices.width[lane] * static_cast<float>(events.slices.count));
        }
        if (events.knots.count > 0) {
            const auto row = static_cast<std::size_t>(Knots::rows(colours)) * MAX_LANES;
            const float *const first = events.knots.values.data() + lane;
            const float *const last = first + (static_cast<std::size_t>(events.knots.count) - 1) * row;
            take(first[0] - first[static_cast<std::size_t>(4 + colours) * MAX_LANES], last[0]);
        }
    }
    const Real first = Real::load_aligned(from), last = Real::load_aligned(to);
    const Mask none = first > last;
    return {clamp(pick(none, 0.0F, first), 0.0F, end), clamp(pick(none, end, last), 0.0F, end)};
}

} // namespace

void trace_air(const FrameView &frame, const Packet &packet, Layers &out) {
    constexpr int STEPS = 48;
    const auto &c = frame.camera;
    const Real u = Real::load_aligned(packet.u), v = Real::load_aligned(packet.v);
    const Ray ray = CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]),
                                            broadcast(c[4]), broadcast(c[5]), u, v);
    const Real end = Real::load_aligned(out.distance) * Real::load_aligned(packet.active);
    Events &events = *out.events;
    AllAir air(frame, packet, ray, end, Real::load_aligned(packet.active) > 0.0F);
    if (events.any() || events.knots.count > 0) {
        const Stretch stretch = met(events, end, frame.grey ? 1 : 3);
        for (int i = 0; i <= STEPS; ++i) {
            air.go(stretch.from + (stretch.to - stretch.from) * (static_cast<float>(i) * (1.0F / STEPS)));
        }
    }
    air.go(end);
    air.leave(events.air);
}

} // namespace sfumato::SFUMATO_ISA
