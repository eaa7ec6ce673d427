// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded light rays for the tests of bases and curves, with the reference's answer.
#pragma once

#include "rays/basis.hpp"
#include "reference/reference.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sfumato {

struct Profile {
    std::vector<float> depth, tau;
    float width = 0.0F;

    [[nodiscard]] Absorbers absorbers() const { return {depth, tau, width}; }
    [[nodiscard]] double total() const {
        double sum = 0.0;
        for (const float t : tau) {
            sum += double{t};
        }
        return sum;
    }
    [[nodiscard]] double exact(double d) const {
        std::vector<reference::Fragment> fragments;
        for (std::size_t i = 0; i < depth.size(); ++i) {
            fragments.push_back({double{depth[i]}, -std::expm1(-double{tau[i]})});
        }
        return reference::transmittance(fragments, d);
    }
};

// A cloud of 64 flat particles.
inline Profile cloud(unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    std::normal_distribution<float> normal;
    const float centre = 0.3F + 0.4F * uniform(generator), spread = 0.06F + 0.08F * uniform(generator);
    Profile ray;
    for (int i = 0; i < 64; ++i) {
        ray.depth.push_back(std::clamp(centre + spread * normal(generator), 0.001F, 0.999F));
        ray.tau.push_back(0.03F + 0.04F * uniform(generator));
    }
    return ray;
}

// The root mean square of what `transmittance(ray, depths)` returns against the reference, over many clouds.
template <typename Method>
double error_in_clouds(const Method &method, unsigned rays = 60) {
    std::vector<float> depths;
    for (int k = 0; k < 65; ++k) {
        depths.push_back((float(k) + 0.37F) / 65.0F);
    }
    double sum = 0.0;
    for (unsigned seed = 0; seed < rays; ++seed) {
        const Profile ray = cloud(seed);
        const std::vector<float> found = method(ray, depths);
        for (std::size_t k = 0; k < depths.size(); ++k) {
            sum += std::pow(double{found[k]} - ray.exact(double{depths[k]}), 2);
        }
    }
    return std::sqrt(sum / (65.0 * rays));
}

} // namespace sfumato
