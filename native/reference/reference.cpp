// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"

#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>

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

// Whether any smoke is at a point, or glows there; air may be everywhere.
bool smoky(const Scene &scene, const glm::dvec3 &x) {
    return !scene.air.empty() || std::any_of(scene.media.begin(), scene.media.end(), [&](const Medium &medium) {
        return density(medium, x) > 0.0 || emission(medium, x) != glm::dvec3(0.0);
    }) || std::any_of(scene.particles.begin(), scene.particles.end(), [&](const Particles &particles) {
        for (std::size_t i = 0; i < particles.points.size(); ++i) {
            if (extinction(particles, i, x) > 0.0) {
                return true;
            }
        }
        return false;
    });
}

// How far it is from a point to where the light changes fast: the nearest surface of a sphere, from both sides, or the
// nearest sample of another light.
double distance_to_lights(const Scene &scene, const glm::dvec3 &x, unsigned samples_per_axis) {
    double nearest = ENDLESS;
    for (const Light &light : scene.lights) {
        if (light.kind == Light::Kind::SPHERE) {
            const double from_centre = glm::distance(x, glm::dvec3(light.position));
            nearest = std::min(nearest, std::abs(from_centre - double{light.radius}));
            continue;
        }
        for (const LightSample &sample : light_samples(light, x, samples_per_axis)) {
            nearest = std::min(nearest, sample.distance);
        }
    }
    return nearest;
}

// Halves a step until it is short enough for the lights, and appends where its parts end. Close to a light the inverse
// square of the distance asks for more than the longest step does: an eighth of the distance leaves the rule below an
// error of (1/8)^4 / 36 = 7e-6. It ends at `shortest`, as the ray may go right through a light.
void append_steps(const Scene &scene, const Ray &ray, double from, double to, double shortest,
                  unsigned samples_per_axis, std::vector<double> &ends) {
    const double middle = 0.5 * (from + to);
    const double near = distance_to_lights(scene, ray.at(middle), samples_per_axis) / 8.0;
    if (to - from > std::max(near, shortest)) {
        append_steps(scene, ray, from, middle, shortest, samples_per_axis, ends);
        append_steps(scene, ray, middle, to, shortest, samples_per_axis, ends);
    } else {
        ends.push_back(to);
    }
}

// Where the steps along the first `end` metres of a ray start and end, in metres. They never straddle a plane through
// cell centres of any medium, or the rim of a particle, where its density has a kink: within one, everything is smooth.
std::vector<double> step_ends(const Scene &scene, const Ray &ray, double end, const Settings &settings) {
    std::vector<double> kinks;
    if (!scene.particles.empty() || !scene.air.empty()) {
        kinks = {0.0, 1.0};
    }
    const auto add = [&kinks](const std::vector<double> &own) { kinks.insert(kinks.end(), own.begin(), own.end()); };
    for (const Medium &medium : scene.media) {
        add(cell_crossings(medium, ray.origin, ray.at(end)));
    }
    for (const Particles &particles : scene.particles) {
        add(crossings(particles, ray.origin, ray.at(end)));
    }
    for (const Air &air : scene.air) {
        if (air.shape) {
            add(crossings(air, ray.origin, ray.at(end)));
        }
    }
    std::sort(kinks.begin(), kinks.end());
    std::vector<double> ends{0.0};
    for (std::size_t i = 0; i + 1 < kinks.size(); ++i) {
        const double from = kinks[i] * end;
        const double length = (kinks[i + 1] - kinks[i]) * end;
        // Neither is ever negative, so if it is zero inside a cell then it is zero all along the way through it.
        if (!smoky(scene, ray.at(from + 0.5 * length))) {
            ends.push_back(from + length);
            continue;
        }
        const double steps = std::ceil(length / settings.step);
        for (int k = 0; k < static_cast<int>(steps); ++k) {
            append_steps(scene, ray, from + length * (k / steps), from + length * ((k + 1) / steps),
                         1e-4 * settings.step, settings.light_samples_per_axis, ends);
        }
    }
    return ends;
}

// Light that the smoke at x emits, and that it scatters once into the direction `onwards`, for each metre:
//     sum over media  e(x)  +  sum over media, particles, air and lights  sigma_s rho(x) p(theta) E V(x, light) .
glm::dvec3 sent_at(const Scene &scene, const glm::dvec3 &x, const glm::dvec3 &onwards, unsigned samples_per_axis) {
    glm::dvec3 sum(0.0);
    for (const Medium &medium : scene.media) {
        sum += emission(medium, x);
    }
    for (const Air &air : scene.air) {
        sum += emission(air, x);
    }
    for (const Light &light : scene.lights) {
        for (const LightSample &sample : light_samples(light, x, samples_per_axis)) {
            if (sample.irradiance == glm::dvec3(0.0)) {
                continue;
            }
            const glm::dvec3 arriving = sample.irradiance * visibility(scene, x, sample.towards, sample.distance);
            for (const Medium &medium : scene.media) {
                // The light turns from the way it comes to the way on.
                const double phase = henyey_greenstein(glm::dot(-sample.towards, onwards), double{medium.anisotropy});
                sum += scattering(medium, x) * phase * arriving;
            }
            for (const Particles &particles : scene.particles) {
                const double phase =
                    henyey_greenstein(glm::dot(-sample.towards, onwards), double{particles.anisotropy});
                sum += scattering(particles, x) * phase * arriving;
            }
            for (const Air &air : scene.air) {
                sum += scattered(air, x, glm::dot(-sample.towards, onwards)) * arriving;
            }
        }
    }
    return sum;
}

// Light that the smoke on the first `end` metres of a ray sends into it, as it arrives at the ray's origin:
//     L = int_0^end  T(origin, x) sent_at(x)  ds ,   x = origin + s direction.
glm::dvec3 sent_by_smoke(const Scene &scene, const Ray &ray, double end, const Settings &settings) {
    glm::dvec3 sum(0.0);
    glm::dvec3 before(1.0); // the transmittance from the ray's origin to the start of the step
    const std::vector<double> ends = step_ends(scene, ray, end, settings);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const glm::dvec3 start = ray.at(ends[i]);
        const double half = 0.5 * (ends[i + 1] - ends[i]);
        if (!smoky(scene, ray.at(ends[i] + half))) {
            continue;
        }
        for (const double node : {-1.0 / std::numbers::sqrt3, 1.0 / std::numbers::sqrt3}) { // Gauss and Legendre
            const glm::dvec3 x = ray.at(ends[i] + (1.0 + node) * half);
            const glm::dvec3 to_eye = before * transmittance(scene, start, x);
            sum += half * to_eye * sent_at(scene, x, -ray.direction, settings.light_samples_per_axis);
        }
        before *= transmittance(scene, start, ray.at(ends[i + 1]));
    }
    return sum;
}

glm::dvec4 radiance(const Scene &scene, const Ray &ray, const Settings &settings) {
    const std::optional<Hit> hit = first_hit(scene, ray.origin, ray.direction, ray.reach);
    const double end = hit ? hit->distance : ray.reach;
    const glm::dvec3 colour = hit ? reflected(scene, *hit, settings.sun_samples_per_axis)
                              : scene.backdrop
                                  ? sky_radiance(*scene.backdrop, ray.direction) * glm::dvec3(scene.background)
                                  : glm::dvec3(scene.background);
    const glm::dvec3 through = transmittance(scene, ray.origin, ray.at(end));
    const double alpha = hit ? 1.0 : 1.0 - (through.x + through.y + through.z) / 3.0;
    return glm::dvec4(colour * through + sent_by_smoke(scene, ray, end, settings), alpha);
}

} // namespace

std::vector<glm::dvec4> render(const Scene &scene, const Camera &camera, unsigned width, unsigned height,
                               const Settings &settings) {
    if (settings.sun_samples_per_axis == 0) {
        throw std::invalid_argument("sun_samples_per_axis must be at least 1, but is 0");
    }
    if (settings.light_samples_per_axis == 0) {
        throw std::invalid_argument("light_samples_per_axis must be at least 1, but is 0");
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
