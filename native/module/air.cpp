// SPDX-License-Identifier: GPL-3.0-or-later
// Air: what Python hands over, checked.
#include "module/rays.hpp"
#include "module/scene_parts.hpp"

#include <optional>
#include <string>
#include <utility>

#include <glm/vector_relational.hpp>

namespace sfumato {

using namespace arguments;

namespace {

Air checked_air(const Floats &rayleigh, const Floats &mie, const Floats &absorption, const Floats &emission,
                float anisotropy, const std::string &phase, const Floats &tint) {
    const auto amount = [](const Floats &array, const std::string &name) {
        require_range(array, 0.0F, 1e30F, name);
        return vector3(array, name);
    };
    Air air;
    air.rayleigh = amount(rayleigh, "rayleigh");
    air.mie = amount(mie, "mie");
    air.absorption = amount(absorption, "absorption");
    air.emission = amount(emission, "emission");
    air.shaft_tint = amount(tint, "tint");
    require_range(anisotropy, -0.9999F, 0.9999F, "anisotropy");
    air.anisotropy = anisotropy;
    air.cornette_shanks = one_of<2>(phase, {"henyey-greenstein", "cornette-shanks"}, "phase") == 1;
    return air;
}

} // namespace

void set_air(ConsoleScene &scene, const Floats &rayleigh, const Floats &mie, const Floats &absorption,
             const Floats &emission, float anisotropy, const std::string &phase, float scale_height, float ground,
             const Floats &tint) {
    Air air = checked_air(rayleigh, mie, absorption, emission, anisotropy, phase, tint);
    require_range(scale_height, 0.0F, 1e15F, "scale_height");
    require_range(ground, -1e15F, 1e15F, "ground");
    air.scale_height = scale_height;
    air.ground = ground;
    std::erase_if(scene.air, [](const Air &other) { return other.shape == nullptr; });
    if (air.rayleigh + air.mie + air.absorption + air.emission != glm::vec3(0.0F)) {
        scene.air.insert(scene.air.begin(), std::move(air));
    }
}

void add_fog(ConsoleScene &scene, const CheckedMesh &mesh, const Doubles &to_world, const Floats &rayleigh,
             const Floats &mie, const Floats &absorption, const Floats &emission, float anisotropy,
             const std::string &phase, const Floats &tint, const std::optional<Visibility> &visibility) {
    Air air = checked_air(rayleigh, mie, absorption, emission, anisotropy, phase, tint);
    air.shape = mesh.shape;
    air.to_world = places(to_world);
    air.visibility = visibility.value_or(Visibility{});
    if (air.visibility.seen != Seen::SHOWN && air.visibility.seen != Seen::UNSEEN) {
        throw py::value_error("visibility.seen must be 'shown' or 'unseen': fog is no holdout, and catches no shadow");
    }
    scene.air.push_back(std::move(air));
}

} // namespace sfumato
