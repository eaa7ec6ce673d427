// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0};
    double reach = 0.0;

    glm::dvec3 at(double distance) const { return origin + distance * direction; }
};

Ray camera_ray(const Camera &camera, double u, double v) {
    const auto point = [u, v](const std::array<glm::vec3, 3> &plane) {
        return glm::dvec3(plane[0]) + u * glm::dvec3(plane[1]) + v * glm::dvec3(plane[2]);
    };
    Ray ray;
    ray.origin = point(camera.near);
    const glm::dvec3 across = point(camera.far) - ray.origin;
    ray.reach = glm::length(across);
    ray.direction = across / ray.reach;
    return ray;
}

// Light that the smoke on the first `end` metres of a ray scatters into it once, as it arrives at the ray's origin:
//     L = int_0^end  T(origin, x) sigma_s rho(x) p(theta) E V(x, sun)  ds ,   x = origin + s direction.
glm::dvec3 in_scattered(const Scene &scene, const Medium &medium, const Sun &sun, const Ray &ray, double end,
                        double longest_step) {
    const glm::dvec3 extinction = glm::dvec3(medium.scattering) + glm::dvec3(medium.absorption);
    const glm::dvec3 towards_sun = -glm::normalize(glm::dvec3(sun.direction));
    glm::dvec3 sum(0.0);
    double column_before = 0.0; // from the ray's origin to the start of the step

    const auto integrand = [&](double start, double s) {
        const glm::dvec3 x = ray.at(s);
        const double column_to_eye = column_before + column(medium, ray.at(start), x);
        return density(medium, x) * glm::exp(-extinction * column_to_eye) * visibility(scene, x, towards_sun);
    };

    // Steps never straddle a plane through cell centres, where the density has a kink: within one, it is smooth.
    const std::vector<double> crossings = cell_crossings(medium, ray.origin, ray.at(end));
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        const double from = crossings[i] * end;
        const double to = crossings[i + 1] * end;
        // A density is never negative, so if it is zero inside a cell then it is zero all along the way through it.
        if (density(medium, ray.at(0.5 * (from + to))) == 0.0) {
            continue;
        }
        const double steps = std::ceil((to - from) / longest_step);
        for (int k = 0; k < static_cast<int>(steps); ++k) {
            const double start = from + (to - from) * (k / steps);
            const double half = 0.5 * (to - from) / steps;
            const double offset = half / std::numbers::sqrt3; // Gauss and Legendre, two points
            sum += half * (integrand(start, start + half - offset) + integrand(start, start + half + offset));
            column_before += column(medium, ray.at(start), ray.at(start + 2.0 * half));
        }
    }
    // The light turns from the way the sun shines to the way back along the ray.
    const double phase = henyey_greenstein(glm::dot(-towards_sun, -ray.direction), double{medium.anisotropy});
    return glm::dvec3(medium.scattering) * phase * glm::dvec3(sun.irradiance) * sum;
}

glm::dvec4 radiance(const Scene &scene, const Ray &ray, const Settings &settings) {
    const std::optional<Hit> hit = first_hit(scene, ray.origin, ray.direction, ray.reach);
    const double end = hit ? hit->distance : ray.reach;
    glm::dvec3 colour = hit ? reflected(scene, *hit, settings.sun_samples_per_axis) : glm::dvec3(scene.background);
    double alpha = hit ? 1.0 : 0.0;
    if (scene.medium) {
        const glm::dvec3 behind = transmittance(*scene.medium, ray.origin, ray.at(end));
        colour *= behind;
        alpha = hit ? 1.0 : 1.0 - (behind.x + behind.y + behind.z) / 3.0;
    }
    if (scene.medium && scene.sun) {
        colour += in_scattered(scene, *scene.medium, *scene.sun, ray, end, settings.step);
    }
    return glm::dvec4(colour, alpha);
}

} // namespace

std::vector<glm::dvec4> render(const Scene &scene, const Camera &camera, unsigned width, unsigned height,
                               const Settings &settings) {
    if (settings.sun_samples_per_axis == 0) {
        throw std::invalid_argument("sun_samples_per_axis must be at least 1, but is 0");
    }
    if (!(settings.step > 0.0)) {
        throw std::invalid_argument("step must be a positive number of metres, but is " +
                                    std::to_string(settings.step));
    }
    std::vector<glm::dvec4> image;
    image.reserve(std::size_t{width} * height);
    for (unsigned y = 0; y < height; ++y) {
        for (unsigned x = 0; x < width; ++x) {
            const Ray ray = camera_ray(camera, (x + 0.5) / width, (y + 0.5) / height);
            image.push_back(radiance(scene, ray, settings));
        }
    }
    return image;
}

} // namespace sfumato::reference
