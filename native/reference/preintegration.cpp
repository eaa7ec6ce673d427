// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/preintegration.hpp"

#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

// Just inside of a stretch, so that its ends are not read on the other side of a step.
constexpr double INSIDE = 1e-9;

} // namespace

glm::dvec4 Ramp::operator()(double s) const {
    const auto value = [this](std::size_t i) {
        return glm::dvec4(colour[i] * (associated ? 1.0 : extinction[i]), extinction[i]);
    };
    std::size_t i = 0;
    while (i < stops.size() && stops[i] <= s) {
        ++i;
    }
    if (i == 0 || i == stops.size() || !linear) {
        return value(i == 0 ? 0 : i - 1);
    }
    const double u = (s - stops[i - 1]) / (stops[i] - stops[i - 1]);
    const double kappa = (1.0 - u) * extinction[i - 1] + u * extinction[i];
    const glm::dvec3 c = (1.0 - u) * colour[i - 1] + u * colour[i];
    return {associated ? c : kappa * c, kappa};
}

glm::dvec4 sent(const Ramp &ramp, double front, double back, double length, int intervals) {
    std::vector<double> cuts{0.0, 1.0};
    for (const double stop : ramp.stops) {
        if (stop > std::min(front, back) && stop < std::max(front, back)) {
            cuts.push_back((stop - front) / (back - front));
        }
    }
    std::sort(cuts.begin(), cuts.end());
    glm::dvec3 radiance(0.0);
    double depth = 0.0; // before the interval
    for (std::size_t cut = 0; cut + 1 < cuts.size(); ++cut) {
        const double t0 = cuts[cut], share = (cuts[cut + 1] - t0) / intervals;
        for (int i = 0; i < intervals; ++i) {
            const auto at = [&](double x) { return ramp(front + (back - front) * (t0 + share * (i + x))); };
            const glm::dvec4 a = at(INSIDE), m = at(0.5), b = at(1.0 - INSIDE);
            const double step = length * share;
            // Extinction is linear here, so both depths are exact.
            const double to_middle = step * (a.w + m.w) / 4.0, to_end = step * (a.w + 4.0 * m.w + b.w) / 6.0;
            radiance +=
                std::exp(-depth) * step / 6.0 *
                (glm::dvec3(a) + 4.0 * std::exp(-to_middle) * glm::dvec3(m) + std::exp(-to_end) * glm::dvec3(b));
            depth += to_end;
        }
    }
    return {radiance, std::exp(-depth)};
}

glm::dvec4 sent_along(const Ramp &ramp, const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to,
                      int points) {
    const std::vector<double> crossings = cell_crossings(medium, from, to);
    const double length = glm::distance(from, to);
    glm::dvec3 radiance(0.0);
    double passed = 1.0, front = density(medium, from);
    for (std::size_t cell = 0; cell + 1 < crossings.size(); ++cell) {
        const double share = (crossings[cell + 1] - crossings[cell]) / points;
        for (int i = 1; i <= points && share > 0.0; ++i) {
            const double back = density(medium, glm::mix(from, to, crossings[cell] + share * i));
            const glm::dvec4 there = sent(ramp, front, back, share * length, 1);
            radiance += passed * glm::dvec3(there);
            passed *= there.w;
            front = back;
        }
    }
    return {radiance, passed};
}

std::vector<glm::dvec4> table(const Ramp &ramp, double low, double high, int entries, double length) {
    const double slab = (high - low) / (entries - 1);
    std::vector<glm::dvec4> middles;
    for (int k = 0; k + 1 < entries; ++k) {
        middles.push_back(ramp(low + slab * (k + 0.5)));
    }
    std::vector<glm::dvec4> out;
    for (int i = 0; i < entries; ++i) {
        for (int j = 0; j < entries; ++j) {
            const int slabs = std::max(std::abs(j - i), 1);
            glm::dvec3 radiance(0.0);
            double passed = 1.0;
            for (int n = 0; n < slabs; ++n) {
                const glm::dvec4 emitted =
                    i == j ? ramp(low + slab * i) : middles[static_cast<std::size_t>(j > i ? i + n : i - 1 - n)];
                const double tau = emitted.w * length / slabs, behind = std::exp(-tau);
                radiance += passed * (tau > 1e-9 ? (1.0 - behind) / tau : 1.0) * (length / slabs) * glm::dvec3(emitted);
                passed *= behind;
            }
            out.emplace_back(radiance, passed);
        }
    }
    return out;
}

} // namespace sfumato::reference
