// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes and cameras: what Python hands over, checked.
#include "scene/scene.hpp"

#include "lights/polygon_parts.hpp"
#include "media/medium.hpp"
#include "media/transfer.hpp"
#include "module/lights.hpp"
#include "module/parts.hpp"
#include "module/scene_parts.hpp"
#include "scene/camera.hpp"
#include "textures/pattern.hpp"

#include <algorithm>
#include <numbers>
#include <variant>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;
using arguments::text; // and not the shaders

// Numbers for a compositor, one for each of `count`.
std::vector<std::uint32_t> numbers(const std::optional<Doubles> &array, std::size_t count, const std::string &name) {
    if (!array) {
        return {};
    }
    require_shape(*array, {static_cast<py::ssize_t>(count)}, name);
    return indices(*array, 1 << 24, name); // what a pixel in single precision can tell apart
}

void add_instances(ConsoleScene &scene, const CheckedMesh &mesh, const Doubles &to_world, const Floats &albedo,
                   const std::optional<Floats> &gloss, const std::optional<Floats> &emission,
                   const std::optional<Floats> &diffuse, const std::optional<Doubles> &object_index,
                   const std::optional<Doubles> &material_index, const std::optional<Visibility> &visibility,
                   const std::optional<Floats> &transmittance, const py::list &patterns,
                   const std::optional<Floats> &values, const std::optional<Floats> &translucence,
                   const std::optional<Floats> &sheen, bool lamp, const py::sequence &moving) {
    Instances out;
    out.lamp = lamp;
    out.visibility = visibility.value_or(Visibility{});
    out.shape = mesh.shape;
    out.materials = checked_materials(albedo, gloss, emission, diffuse, transmittance);
    add_more(translucence, sheen, out.materials);
    if (out.materials.albedo.size() < mesh.materials) {
        throw py::value_error("albedo has " + text(out.materials.albedo.size()) + " rows, but the mesh names " +
                              text(mesh.materials) + " materials");
    }
    out.to_world = places(to_world);
    out.moving = moving_places(moving, out.to_world.size());
    out.index = numbers(object_index, out.to_world.size(), "object_index");
    out.materials.index = numbers(material_index, out.materials.albedo.size(), "material_index");
    if (values) {
        require_shape(*values, {static_cast<py::ssize_t>(out.to_world.size()), -1}, "values");
        require_finite(*values, "values");
        out.values.assign(values->data(), values->data() + values->size());
    }
    if (!patterns.empty() && patterns.size() != out.materials.albedo.size()) {
        throw py::value_error("patterns holds " + text(patterns.size()) + ", but there are " +
                              text(out.materials.albedo.size()) + " rows of albedo");
    }
    for (const py::handle &each : patterns) {
        if (!each.is_none() && !py::isinstance<Pattern>(each)) {
            throw py::value_error("patterns holds " + told(each) + ", but must hold a Pattern or None each");
        }
        const auto pattern = each.is_none() ? nullptr : each.cast<std::shared_ptr<Pattern>>();
        if (pattern) {
            require_inputs(*pattern, *mesh.shape, values ? static_cast<std::size_t>(values->shape(1)) : 0);
        }
        out.materials.patterns.push_back(pattern);
    }
    scene.meshes.push_back(std::move(out));
}

void add_mesh(ConsoleScene &scene, const Floats &vertices, const Doubles &triangles, const Floats &corner_normals,
              const Doubles &material, const Floats &albedo, const std::optional<Floats> &gloss,
              const std::optional<Floats> &corner_tangents, const std::optional<Floats> &emission,
              const std::optional<Floats> &diffuse, const std::optional<Floats> &transmittance) {
    require_shape(triangles, {-1, 3}, "triangles");
    require_shape(corner_normals, {triangles.shape(0), 3, 3}, "corner_normals");
    require_finite(corner_normals, "corner_normals");
    if (corner_tangents) {
        require_shape(*corner_tangents, {triangles.shape(0), 3, 3}, "corner_tangents");
        require_finite(*corner_tangents, "corner_tangents");
    }
    require_shape(albedo, {-1, 3}, "albedo");
    require_shape(material, {triangles.shape(0)}, "material");
    static_cast<void>(indices(material, albedo.shape(0), "material"));
    Instances out;
    out.shape = checked_mesh(vertices, triangles, corner_normals, material, corner_tangents).shape;
    out.materials = checked_materials(albedo, gloss, emission, diffuse, transmittance);
    out.to_world = {glm::mat4(1.0F)};
    scene.meshes.push_back(std::move(out));
}

// Rows from black on.
std::vector<glm::vec3> checked_emission(const Floats &emission) {
    require_shape(emission, {-1, 3}, "emission");
    require_range(emission, 0.0F, 1e30F, "emission");
    if (emission.shape(0) < 2 || emission.shape(0) > EMISSION_ROWS) {
        throw py::value_error("emission has " + text(emission.shape(0)) + " rows; there may be 2 to " +
                              text(EMISSION_ROWS));
    }
    std::vector<glm::vec3> rows;
    for (py::ssize_t row = 0; row < emission.shape(0); ++row) {
        rows.emplace_back(emission.at(row, 0), emission.at(row, 1), emission.at(row, 2));
    }
    if (rows.front() != glm::vec3(0.0F)) {
        throw py::value_error("emission begins with (" + text(rows.front().x) + ", " + text(rows.front().y) + ", " +
                              text(rows.front().z) + "); what does not glow must be black");
    }
    return rows;
}

// What is given of a medium by the number that its grid holds.
void check_transfer(const TransferFunction *transfer, const TransferFunction *radiated, bool tinted) {
    if (transfer == nullptr) {
        if (radiated != nullptr) {
            throw py::value_error(
                "there is a radiated, but no transfer that says how dense it is: one of extinction 0");
        }
        return;
    }
    if (tinted) {
        throw py::value_error("there are cells' colours and a transfer, which has colours of its own");
    }
    const auto check = [](const TransferFunction &function, const char *name) {
        const Emitted outside = function.at(0.0);
        if (outside != Emitted(0.0)) {
            throw py::value_error(std::string(name) + " has " + text(outside.w) + " of extinction and (" +
                                  text(outside.x) + ", " + text(outside.y) + ", " + text(outside.z) +
                                  ") of colour at 0, which is what lies outside the grid: it must be empty there");
        }
        if (function.ramp().stops.size() > MOST_STOPS) {
            throw py::value_error(std::string(name) + " has " + text(function.ramp().stops.size()) +
                                  " stops; a medium's may have " + text(MOST_STOPS));
        }
    };
    check(*transfer, "transfer");
    if (radiated != nullptr) {
        check(*radiated, "radiated");
        const std::vector<double> &extinction = radiated->ramp().extinction;
        if (std::any_of(extinction.begin(), extinction.end(), [](double value) { return value != 0.0; })) {
            throw py::value_error("radiated has an extinction, which is transfer's alone: it must be 0");
        }
    }
}

void add_medium(ConsoleScene &scene, const std::variant<CheckedGrid, Floats> &density, const Doubles &grid_to_world,
                const Floats &scattering, const Floats &absorption, float anisotropy,
                const std::optional<Floats> &colour, const std::optional<Visibility> &visibility,
                const std::optional<Floats> &glow, const std::optional<Floats> &emission,
                const TransferFunction *transfer, const TransferFunction *radiated) {
    const auto *array = std::get_if<Floats>(&density);
    if (array != nullptr) {
        require_shape(*array, {-1, -1, -1}, "density");
    }
    if (scene.media.size() == MAX_MEDIA) {
        throw py::value_error("scene holds " + std::to_string(MAX_MEDIA) + " media, and can hold no more");
    }
    require_range(grid_to_world, -1e30, 1e30, "grid_to_world");
    Medium medium;
    medium.grid_to_world = affine_matrix(grid_to_world, "grid_to_world");
    if (!(std::abs(glm::determinant(glm::dmat4(medium.grid_to_world))) > 0.0)) {
        throw py::value_error("grid_to_world flattens the grid: its determinant is 0");
    }
    medium.scattering = vector3(scattering, "scattering");
    medium.absorption = vector3(absorption, "absorption");
    require_range(scattering, 0.0F, 1e30F, "scattering");
    require_range(absorption, 0.0F, 1e30F, "absorption");
    require_range(anisotropy, -0.9999F, 0.9999F, "anisotropy");
    medium.anisotropy = anisotropy;
    medium.visibility = visibility.value_or(Visibility{});
    if (medium.visibility.seen != Seen::SHOWN && medium.visibility.seen != Seen::UNSEEN) {
        throw py::value_error(
            "visibility.seen must be 'shown' or 'unseen': smoke is no holdout, and catches no shadow");
    }
    CheckedGrid grid;
    if (array != nullptr) {
        const glm::uvec3 resolution(array->shape(2), array->shape(1), array->shape(0));
        const glm::vec3 extinction = medium.scattering + medium.absorption;
        const float least = transfer != nullptr ? 0.0F : emptiness(resolution, medium.grid_to_world, extinction);
        grid = checked_grid(*array, least, colour, glow);
    } else if (colour || glow) {
        throw py::value_error(std::string(colour ? "colour" : "glow") +
                              " is given beside a Grid, which has its own: give it to the Grid");
    } else {
        grid = std::get<CheckedGrid>(density);
    }
    if (emission) {
        medium.emission = checked_emission(*emission);
    }
    const bool glows = array != nullptr ? glow.has_value() : grid.grid && !grid.grid->glow.empty();
    if (glows != emission.has_value() && (array != nullptr || grid.grid)) {
        throw py::value_error(glows ? "there is a glow, but no emission that says what it emits"
                                    : "there is an emission, but no glow that says where");
    }
    check_transfer(transfer, radiated, grid.grid && !grid.grid->tint.empty());
    if (transfer != nullptr) {
        medium.transfer = std::make_shared<const TransferFunction>(*transfer);
        medium.radiated = radiated != nullptr ? std::make_shared<const TransferFunction>(*radiated) : nullptr;
    }
    medium.resolution = grid.resolution;
    medium.grid = grid.grid;
    scene.media.push_back(std::move(medium));
    scene.sources.push_back({array != nullptr ? std::optional(*array) : std::nullopt, colour, glow});
}

// One for each of `count`, or one for all of them.
std::vector<float> one_each(const Floats &array, py::ssize_t count, float high, const std::string &name) {
    if (array.ndim() > 0) {
        require_shape(array, {count}, name);
    }
    require_range(array, 0.0F, high, name);
    return array.ndim() > 0 ? std::vector<float>(array.data(), array.data() + count)
                            : std::vector<float>(static_cast<std::size_t>(count), *array.data());
}

void add_particles(ConsoleScene &scene, const Floats &points, const Floats &radius, const Floats &opacity,
                   const Floats &albedo, const Floats &extinction, float anisotropy,
                   const std::optional<Visibility> &visibility) {
    require_shape(points, {-1, 3}, "points");
    require_range(points, -1e15F, 1e15F, "points");
    const py::ssize_t count = points.shape(0);
    Particles out;
    out.radius = one_each(radius, count, 1e15F, "radius");
    out.opacity = one_each(opacity, count, 1.0F, "opacity");
    if (albedo.ndim() == 2) {
        require_shape(albedo, {count, 3}, "albedo");
    } else {
        require_shape(albedo, {3}, "albedo");
    }
    require_range(albedo, 0.0F, 1.0F, "albedo");
    require_range(extinction, 0.0F, 1.0F, "extinction");
    out.extinction = vector3(extinction, "extinction");
    if (std::max({out.extinction.x, out.extinction.y, out.extinction.z}) != 1.0F) {
        throw py::value_error("extinction is (" + text(out.extinction.x) + ", " + text(out.extinction.y) + ", " +
                              text(out.extinction.z) + "), but that of the strongest colour must be 1");
    }
    require_range(anisotropy, -0.9999F, 0.9999F, "anisotropy");
    out.anisotropy = anisotropy;
    out.visibility = visibility.value_or(Visibility{});
    if (out.visibility.seen != Seen::SHOWN && out.visibility.seen != Seen::UNSEEN) {
        throw py::value_error(
            "visibility.seen must be 'shown' or 'unseen': particles are no holdout, and catch no shadow");
    }
    const auto *const first = reinterpret_cast<const glm::vec3 *>(points.data());
    out.points.assign(first, first + count);
    const auto *const colours = reinterpret_cast<const glm::vec3 *>(albedo.data());
    out.albedo.assign(colours, colours + albedo.size() / 3);
    scene.particles.push_back(std::move(out));
}

glm::vec3 unit_vector(const Floats &array, const std::string &name) {
    const glm::dvec3 v(vector3(array, name));
    const double length = glm::length(v);
    if (!(length > 0.0)) {
        throw py::value_error(name + " is (0, 0, 0), but must point somewhere");
    }
    return glm::vec3(v / length);
}

glm::vec3 strength_of(const Floats &array, const std::string &name) {
    require_range(array, 0.0F, 1e30F, name);
    return vector3(array, name);
}

glm::vec3 place_of(const Floats &array, const std::string &name) {
    require_range(array, -1e15F, 1e15F, name);
    return vector3(array, name);
}

void add_sun(ConsoleScene &scene, const Floats &direction, const Floats &irradiance, float angle,
             const std::optional<Reach> &reach) {
    Light light;
    light.reach = reach.value_or(Reach{});
    light.kind = Light::Kind::SUN;
    light.direction = unit_vector(direction, "direction");
    light.strength = strength_of(irradiance, "irradiance");
    require_range(angle, 0.0F, 3.1415F, "angle");
    light.angle = angle;
    scene.lights.push_back(light);
}

// One that differs from side to side, or one radiance.
using SkyOrRadiance = std::variant<std::shared_ptr<SkyImage>, Floats>;

void add_sky(ConsoleScene &scene, const SkyOrRadiance &radiance, const std::optional<Reach> &reach, float gain) {
    require_range(gain, 0.0F, 1e30F, "gain");
    Light light;
    light.reach = reach.value_or(Reach{});
    light.kind = Light::Kind::SKY;
    if (const auto *image = std::get_if<std::shared_ptr<SkyImage>>(&radiance)) {
        light.image = *image;
        light.gain = gain;
    } else {
        light.strength =
            strength_of(std::get<Floats>(radiance), "radiance") * (gain * 4.0F * std::numbers::pi_v<float>);
    }
    scene.lights.push_back(light);
}

void set_background(ConsoleScene &scene, const SkyOrRadiance &radiance, float alpha, float gain) {
    require_range(gain, 0.0F, 1e30F, "gain");
    require_range(alpha, 0.0F, 1.0F, "alpha");
    scene.backdrop = nullptr;
    if (const auto *image = std::get_if<std::shared_ptr<SkyImage>>(&radiance)) {
        scene.backdrop = *image;
        scene.background = glm::vec3(gain);
    } else {
        scene.background = strength_of(std::get<Floats>(radiance), "radiance") * gain;
    }
    scene.background_alpha = alpha;
}

void set_bounces(ConsoleScene &scene, bool gloss, int diffuse) {
    require_range(diffuse, 0, 64, "diffuse");
    scene.bounces = {gloss, diffuse};
}

void add_point(ConsoleScene &scene, const Floats &position, const Floats &intensity, float radius,
               const Floats &direction, float cone, float blend, bool facing_disk, bool spot_cosine,
               const py::object &across, const std::optional<Reach> &reach, bool part) {
    Light light;
    light.reach = reach.value_or(Reach{});
    light.kind = Light::Kind::SPHERE;
    light.position = place_of(position, "position");
    light.strength = strength_of(intensity, "intensity");
    light.direction = unit_vector(direction, "direction");
    require_range(radius, 0.0F, 1e15F, "radius");
    require_range(cone, 1e-3F, 6.2831855F, "cone");
    require_range(blend, 0.0F, 1.0F, "blend");
    light.radius = radius;
    light.cone = cone;
    light.blend = blend;
    light.facing_disk = facing_disk;
    light.part = part;
    light.spot_cosine = spot_cosine;
    if (!across.is_none()) {
        const Floats axes(any_array(across, "across"));
        require_shape(axes, {2, 3}, "across");
        require_range(axes, -1e6F, 1e6F, "across");
        light.across = {axes.at(0, 0), axes.at(0, 1), axes.at(0, 2)};
        light.up = {axes.at(1, 0), axes.at(1, 1), axes.at(1, 2)};
        light.oval = true;
    }
    scene.lights.push_back(light);
}

void add_area(ConsoleScene &scene, const Floats &position, const Floats &across, const Floats &up,
              const Floats &radiance, bool ellipse, float spread, const std::optional<Reach> &reach) {
    Light light;
    light.reach = reach.value_or(Reach{});
    light.kind = ellipse ? Light::Kind::ELLIPSE : Light::Kind::RECTANGLE;
    light.position = place_of(position, "position");
    light.across = place_of(across, "across");
    light.up = place_of(up, "up");
    light.strength = strength_of(radiance, "radiance");
    const glm::dvec3 x = light.across, y = light.up, normal = glm::cross(x, y);
    const double edges = glm::length(x) * glm::length(y);
    if (!(edges > 1e-20)) {
        throw py::value_error("across and up have lengths " + text(glm::length(x)) + " and " + text(glm::length(y)) +
                              ": the light has no area");
    }
    if (std::abs(glm::dot(x, y)) > 1e-3 * edges) {
        throw py::value_error("across and up must be at right angles, but the cosine of their angle is " +
                              text(glm::dot(x, y) / edges));
    }
    require_range(spread, 1e-3F, 3.1415928F, "spread");
    light.direction = glm::vec3(-glm::normalize(normal));
    light.spread = spread;
    scene.lights.push_back(light);
}

void add_polygon(ConsoleScene &scene, const Floats &corners, const Floats &radiance,
                 const std::optional<Reach> &reach) {
    require_shape(corners, {-1, 3}, "corners");
    require_range(corners, -1e15F, 1e15F, "corners");
    const auto count = static_cast<std::size_t>(corners.shape(0));
    if (count < 3 || count > 64) {
        throw py::value_error("corners has shape " + shape_of(corners) + ", but a polygon has 3 to 64 corners");
    }
    Light light;
    light.reach = reach.value_or(Reach{});
    light.kind = Light::Kind::POLYGON;
    light.strength = strength_of(radiance, "radiance");
    std::vector<glm::dvec3> polygon;
    for (std::size_t i = 0; i < count; ++i) {
        const float *const corner = corners.data() + 3 * i;
        polygon.emplace_back(corner[0], corner[1], corner[2]);
    }
    std::optional<std::vector<std::vector<glm::dvec3>>> parts{{polygon}};
    const PolygonFault fault = fault_of(polygon);
    if (fault == PolygonFault::NOT_CONVEX || (fault == PolygonFault::SOUND && count > 4)) {
        parts = convex_parts(polygon);
    }
    if (!parts || fault != PolygonFault::NOT_CONVEX) {
        require_sound(polygon, "corners", "");
    }
    for (const std::vector<glm::dvec3> &part : *parts) {
        for (std::size_t i = 0; i < 4; ++i) {
            light.corners[i] = glm::vec3(part[std::min(i, part.size() - 1)]);
        }
        scene.lights.push_back(light);
    }
}

py::array_t<float> corners(const Camera &camera) {
    std::vector<float> values;
    for (const auto &plane : {camera.near, camera.far}) {
        for (const glm::vec3 &v : plane) {
            values.insert(values.end(), {v.x, v.y, v.z});
        }
    }
    return to_numpy(std::move(values), {6, 3});
}

} // namespace

std::vector<glm::mat4> places(const Doubles &to_world) {
    const bool one = to_world.ndim() == 2;
    const py::ssize_t count = one ? 1 : to_world.ndim() == 3 ? to_world.shape(0) : 0;
    const bool fits = (one || to_world.ndim() == 3) && to_world.shape(to_world.ndim() - 1) == 4 &&
                      to_world.shape(to_world.ndim() - 2) == 4;
    if (!fits) {
        throw py::value_error("to_world has shape " + shape_of(to_world) + ", but must have (4, 4) or (any, 4, 4)");
    }
    require_range(to_world, -1e30, 1e30, "to_world");
    std::vector<glm::mat4> out;
    out.reserve(static_cast<std::size_t>(count));
    for (py::ssize_t i = 0; i < count; ++i) {
        const double *const m = to_world.data() + 16 * i;
        glm::mat4 &matrix = out.emplace_back();
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                matrix[column][row] = static_cast<float>(m[4 * row + column]);
            }
        }
        require_affine(matrix, 16 * i, "to_world");
    }
    return out;
}

void bind_scene(py::module_ &m) {
    py::class_<ConsoleScene>(m, "Scene", R"(Meshes, smoke and lights.

>>> scene = Scene()
>>> scene.add_sun((0, 0, -1), irradiance=(1, 1, 1), angle=0.0)
>>> scene.set_background((0.5, 0.5, 0.5))
)")
        .def(py::init<>())
        .def("add_mesh", &add_mesh, py::arg("vertices"), py::arg("triangles"), py::arg("corner_normals"),
             py::arg("material"), py::arg("albedo"), py::arg("gloss") = py::none(),
             py::arg("corner_tangents") = py::none(), py::arg("emission") = py::none(), py::arg("diffuse") = py::none(),
             py::arg("transmittance") = py::none(),
             R"(Add triangles that reflect diffusely, and with gloss.

vertices (n, 3), metres in world space; triangles (m, 3), indices into vertices; corner_normals (m, 3, 3), unit
length; material (m,), indices into albedo; albedo (k, 3) in [0, 1]. gloss (k, 8) or, of layers from the top, of which
there may be four, (k, n, 8): in [0, 1] the reflectance of light from straight on (3), 1 where all light is reflected at
grazing angles and 0 where it is no more than straight on, GGX's alpha along the tangent and across it, both 0 for no
gloss, and 1 where masking and shadowing are independent (Smith's two G1) and 0 where they go by height (Heitz 2014,
eq 99); last, the index of refraction of microfacet_polygon, by which reflectance rises between straight on and grazing.
Or 16 numbers: then, also in [0, 1], 1 where light that facets send to each other is not lost (Kulla and Conty 2017);
what is left to all below, 0 for everything, .5 for what the layer does not reflect, 1 for nothing; how much less than
Schlick's the reflectance is at the angle whose cosine is 1/7 (3); 1 for Beckmann's facets, 0 for GGX; the share of the
surface that has this layer; and the turn of the tangent, counterclockwise, over a whole one.
corner_tangents (m, 3, 3). emission (k, 3), the radiance in W/(m^2 sr) that the surface sends to the eye by
itself; what it lights, add_polygon does. diffuse (k, 2): 0 for Lambert's surfaces, which all are without it, 1 for
Burley's (2012), 2 for Oren and Nayar's (1994), 3 with what they send on after further reflections (Portsmouth, Kutz and
Hill 2025), 4 with that in the colour of one reflection more; and a roughness in [0, 1]. transmittance (k, 3) in [0, 1],
the share of light of each colour that passes straight through, to the eye and in shadows; what the rest of the surface
reflects and emits is what all else says.
Raises ValueError for wrong shapes, indices out of range and values that are not finite or not in range.

>>> Scene().add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[[0, 0, 1]] * 3], [0], [[0.8, 0.8, 0.8]])
)")
        .def("add_instances", &add_instances, py::arg("mesh"), py::arg("to_world"), py::arg("albedo"),
             py::arg("gloss") = py::none(), py::arg("emission") = py::none(), py::arg("diffuse") = py::none(),
             py::arg("object_index") = py::none(), py::arg("material_index") = py::none(),
             py::arg("visibility") = py::none(), py::arg("transmittance") = py::none(),
             py::arg("patterns") = py::list(), py::arg("values") = py::none(), py::arg("translucence") = py::none(),
             py::arg("sheen") = py::none(), py::arg("lamp") = false, py::arg("moving") = py::tuple(),
             R"(Add a Mesh in one place, to_world (4, 4), or in many, (n, 4, 4): from its own space to metres in the
world. albedo (k, 3), gloss, emission (k, 3), diffuse (k, 2) and transmittance (k, 3) are those of add_mesh, a row for
each material that the mesh names. object_index (n,), a number for each place, and material_index (k,) are what Frame.passes
gives by these names; visibility, what it is to the camera and to lights, or all of that. patterns, a Pattern or None for
each material, give what varies of these, which then are no more than usual of it: of a layer of gloss the index decides
what it leaves. values (n, j) are what they ask for of each place. translucence (k, 3) in [0, 1], the share of light on
the other side that leaves diffusely on this one. sheen (k, 5), what fibres add: a colour; 5 for Burley's (2012), 6 for
Ashikhmin's velvet (2000), 7 for Zeltner, Burley and Chiang's (2022), of which all that comes leaves in the end where the
colour is white; and a roughness in [0, 1]. lamp: what it emits is
among the lights, too, so light that goes between surfaces (set_bounces) leaves it to these. moving: places as to_world
has them, at even times while the shutter of an Exposure is open, an odd number of them. Raises ValueError as add_mesh
does, and for too few rows.

>>> import numpy as np
>>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> Scene().add_instances(triangle, np.stack([np.eye(4), np.diag([2, 2, 2, 1])]), [[0.8, 0.8, 0.8]])
>>> leaf = {"translucence": [[0.2, 0.4, 0.1]], "sheen": [[0.1, 0.1, 0.1, 7, 0.5]]}
>>> Scene().add_instances(triangle, np.eye(4), [[0.2, 0.4, 0.1]], **leaf)
)")
        .def("add_medium", &add_medium, py::arg("density"), py::arg("grid_to_world"), py::arg("scattering"),
             py::arg("absorption"), py::arg("anisotropy") = 0.0F, py::arg("colour") = py::none(),
             py::arg("visibility") = py::none(), py::arg("glow") = py::none(), py::arg("emission") = py::none(),
             py::arg("transfer") = py::none(), py::arg("radiated") = py::none(),
             R"(Add a body of smoke, of which there may be 64; or a Grid that was made before. Where they overlap, their
densities add.

density (nz, ny, nx), not negative, sampled at cell centres, zero outside the grid; the scene refers to the array
instead of copying it, so it should not be changed while the scene is in use; grid_to_world (4, 4) takes
cells to metres: cell (i, j, k) fills [i, i + 1] and so on; scattering and absorption (3,), per metre and unit
density; anisotropy g of Henyey and Greenstein (1941) in (-1, 1); colour (nz, ny, nx, 3), not negative, by which each
cell's scattering is multiplied: what it does not scatter of that, it absorbs, so what it lets through stays the same;
visibility, 'shown' or 'unseen', and its lights. glow (nz, ny, nx) in [0, 1] is what shines by itself, whatever the
density: emission (n, 3), of 2 to 128 rows, gives in W/(m^3 sr) what it emits from 0, black as all outside the grid, to
1, linear between two rows. It lights nothing. transfer, a TransferFunction: then density holds any number, not negative,
and what it stands for, between cells too, is transfer's extinction; its colour, not associated, is what colour is of a
cell. radiated, one whose extinction is 0, is what is emitted by the same number, W/(m^3 sr). Both are empty at 0, and have
at most 1024 stops.
Raises ValueError for an empty, negative or non-finite density and for a matrix that flattens the grid.

>>> import numpy as np
>>> Scene().add_medium(np.ones((4, 4, 4)), np.eye(4), scattering=(1, 1, 1), absorption=(0, 0, 0))
)")
        .def(
            "add_particles", &add_particles, py::arg("points"), py::arg("radius"), py::arg("opacity"),
            py::arg("albedo") = std::array<float, 3>{0.8F, 0.8F, 0.8F},
            py::arg("extinction") = std::array<float, 3>{1.0F, 1.0F, 1.0F}, py::arg("anisotropy") = 0.0F,
            py::arg("visibility") = py::none(),
            R"(Add smoke as soft puffs, which show and shade as such. Where they overlap, their densities add, with those
of grids, too; so their order does not matter, and none begins at a sheet.

points (n, 3), metres, of which there may be none; radius, one for all or (n,), at which a puff's density, which falls
from the middle on as 1 - (r / radius)^2, is 0; opacity, one or (n,), in [0, 1], straight through the middle and in the
strongest colour, where 1 is taken for 1 - 2^-20; albedo (3,) or (n, 3) in [0, 1], of what is taken the share that is
scattered; extinction (3,), in each colour against the strongest, whose is 1; anisotropy g of Henyey and Greenstein (1941)
in (-1, 1); visibility, 'shown' or 'unseen', and its lights.
Raises ValueError for wrong shapes and for values that are not finite or not in range.

>>> Scene().add_particles([[0, 0, 0], [0, 0, 1]], radius=0.5, opacity=[0.1, 0.3])
)")
        .def("add_strands", &add_strands, py::arg("points"), py::arg("radius"), py::arg("first"),
             py::arg("fibre") = py::none(), py::arg("matt") = py::none(), py::arg("material") = py::none(),
             py::arg("smooth") = true, py::arg("visibility") = py::none(),
             R"(Add strands of hair: rows of keys, points (n, 3) in metres with a radius (n,) each. The keys of strand i
are those from first[i] up to first[i + 1]; first (m + 1,) ends with n. Through them leads Catmull and Rom's curve, or
where it is not smooth a straight line from one to the next. Returns how many strands have no two keys: they are
left out.

Light leaves them by one of two models. fibre (k, 8), Chiang's (2016): the optical depth of a radius in each colour (3),
the roughness in [0.001, 1] along a strand, around it, and along it of what is reflected at once, the tilt of the
cuticle's scales in radians, and the index of refraction. Or matt (k, 7), Kajiya and Kay's (1989): the albedo (3), the
share of light that is in the highlight (3), and its roughness. Without both it is brown hair. material (m,) is the row of each strand, the first
without it. visibility, 'shown' or 'unseen', and its lights.
Raises ValueError for wrong shapes, and for values that are not finite or not in range.

>>> keys = [[0, 0, 0], [0, 0, 1], [0, 1, 2], [1, 0, 0]]
>>> Scene().add_strands(keys, [0.001] * 4, [0, 3, 4], fibre=[[0.5, 0.8, 1.5, 0.3, 0.3, 0.3, 0.03, 1.55]])
1
)")
        .def("add_sun", &add_sun, py::arg("direction"), py::arg("irradiance"), py::arg("angle") = 0.0F,
             py::arg("reach") = py::none(),
             R"(Add a sun: direction (3,) in which its light travels; irradiance (3,) in W/m^2 on a surface that
faces it; angle, its angular diameter in radians; reach, what it reaches and what hides it, or all of that.

>>> Scene().add_sun((0, 0, -1), (4, 4, 4), angle=0.009)
)")
        .def(
            "add_sky", &add_sky, py::arg("radiance").none(false), py::arg("reach") = py::none(), py::arg("gain") = 1.0F,
            R"(Add light from all around: its radiance (3,), the same in every direction, or a Sky; reach, what it reaches
and what hides it, or all of that; gain, by what the radiance is multiplied. What the eye sees of it is set_background()'s.

>>> Scene().add_sky((0.05, 0.05, 0.05))
)")
        .def("add_point", &add_point, py::arg("position"), py::arg("intensity"), py::arg("radius") = 0.0F,
             py::arg("direction") = std::array<float, 3>{0.0F, 0.0F, -1.0F}, py::arg("cone") = 6.2831853F,
             py::arg("blend") = 0.0F, py::arg("facing_disk") = false, py::arg("spot_cosine") = false,
             py::arg("across") = py::none(), py::arg("reach") = py::none(), py::arg("part") = false,
             R"(Add a point light: position (3,); intensity (3,) in W/sr; radius, metres, that of a sphere; and where
cone, a whole angle in radians, is less than 2 pi, a spot that shines along direction (3,) and fades in over the share
blend, in [0, 1], of 1 - cos(cone / 2). Some renderers differ: with facing_disk the sphere looks as large as a disk of
its radius that faces the eye, and with spot_cosine a spot dims by the cosine to its axis, too.
across (2, 3) are two axes that with the direction measure the cone, which is round where they are unit vectors across
it, and narrower along longer ones. part says that it is one of several that stand for a fire: what they throw they blur
for each other, so fewer points stand for it.

>>> Scene().add_point((0, 0, 3), (10, 10, 10), radius=0.1, cone=0.8, blend=0.15)
)")
        .def("add_area", &add_area, py::arg("position"), py::arg("across"), py::arg("up"), py::arg("radiance"),
             py::arg("ellipse") = false, py::arg("spread") = 3.1415927F, py::arg("reach") = py::none(),
             R"(Add a rectangle, or the ellipse in it: position (3,) of its middle; across (3,) and up (3,), half its
axes, at right angles; radiance (3,) in W/(m^2 sr), straight ahead. It shines along cross(up, across), into the whole
angle spread, radians, in which it fades as 1 - tan(angle) / tan(spread / 2).
Raises ValueError for a light without area, and for axes that are not at right angles.

>>> Scene().add_area((0, 0, 3), (0.5, 0, 0), (0, 0.5, 0), (4, 4, 4))
)")
        .def("add_polygon", &add_polygon, py::arg("corners"), py::arg("radiance"), py::arg("reach") = py::none(),
             R"(Add a polygon that shines from both its sides, as a mesh that glows does: corners (3 to 64, 3), in turn;
radiance (3,) in W/(m^2 sr). One with more than four corners, or that is not convex, becomes several lights. It is not
seen itself: that is add_mesh's emission. Raises ValueError for corners that are not flat, that hold no area, or whose
edges cross.

>>> Scene().add_polygon([[0, 0, 3], [1, 0, 3], [0, 1, 3]], (4, 4, 4))
)")
        .def("add_fog", &add_fog, py::arg("mesh"), py::arg("to_world"),
             py::arg("rayleigh") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
             py::arg("mie") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
             py::arg("absorption") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
             py::arg("emission") = std::array<float, 3>{0.0F, 0.0F, 0.0F}, py::arg("anisotropy") = 0.0F,
             py::arg("phase") = "henyey-greenstein", py::arg("tint") = std::array<float, 3>{1.0F, 1.0F, 1.0F},
             py::arg("visibility") = py::none(),
             R"(Fill a closed Mesh, convex or not, with fog: even air that is as set_air has it, and dims all light that
comes through it.

mesh, whose surface is no part of it; to_world (4, 4) or (n, 4, 4), metres, its places: where two overlap, as where other
fog, smoke or air is, densities add. Where shells of one mesh overlap it is filled once. visibility, 'shown' or 'unseen',
and its lights. Of an open mesh only what lies between its front and its back on a ray is filled; what is flat holds none.
Raises ValueError for wrong shapes and values that are not finite or not in range.

>>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
>>> import numpy as np
>>> Scene().add_fog(Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), np.eye(4), mie=(1, 1, 1))
)")
        .def(
            "set_air", &set_air, py::arg("rayleigh") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
            py::arg("mie") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
            py::arg("absorption") = std::array<float, 3>{0.0F, 0.0F, 0.0F},
            py::arg("emission") = std::array<float, 3>{0.0F, 0.0F, 0.0F}, py::arg("anisotropy") = 0.0F,
            py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0F, py::arg("ground") = 0.0F,
            py::arg("tint") = std::array<float, 3>{1.0F, 1.0F, 1.0F},
            R"(Fill the world with air, which scatters the light of all lights on its way, once, and dims what lies in it.

rayleigh (3,), what it scatters per metre by 3 (1 + cos^2) / (16 pi); mie (3,), by Henyey and Greenstein's function
(1941) or, where phase is 'cornette-shanks', by theirs (1992), both of the anisotropy in (-1, 1); absorption (3,), per
metre; emission (3,), W/(m^3 sr). It is the same everywhere; or, where scale_height is positive, less with the height z
over ground, both in metres: as exp(-(z - ground) / scale_height). tint (3,), an artist's, is by what all that is
scattered is multiplied; 1 is physical.
The irradiance of suns is that which arrives: even air does not dim it. Where air ends with height, its column above a
place does. Raises ValueError for wrong shapes and values that are not finite or not in range.

>>> scene = Scene()
>>> scene.set_air(rayleigh=(5.8e-6, 13.6e-6, 33.1e-6), mie=(4e-6, 4e-6, 4e-6), anisotropy=0.76, scale_height=8000)
>>> scene.set_air()  # none
)")
        .def("set_background", &set_background, py::arg("radiance").none(false), py::arg("alpha") = 0.0F,
             py::arg("gain") = 1.0F,
             "Set the radiance (3,) where no surface is, or a Sky, times the gain, and the alpha there.\n"
             "It lights nothing.\n\n"
             ">>> Scene().set_background((0, 0, 0), alpha=1)\n")
        .def("set_bounces", &set_bounces, py::arg("gloss") = false, py::arg("diffuse") = 0,
             R"(Set what surfaces send to each other; without it, they reflect lights alone.

gloss: whether layers of gloss show the surfaces around them, and smoke before these, where they are as sharp as a mirror
nearly is. diffuse, 0 to 64: how many times light goes from matt surface to matt surface, that of lights and, unless it is 0, of all
that glows and is no lamp. Gloss that light comes to on the way counts as matt. Smoke is lit by lights alone.
Raises ValueError for a number out of range.

>>> scene = Scene()
>>> scene.set_bounces(gloss=True, diffuse=4)
)")
        .def(
            "set_origin",
            [](ConsoleScene &scene, const Doubles &origin) {
                require_shape(origin, {3}, "origin");
                require_range(origin, -1e15, 1e15, "origin");
                scene.origin = {origin.at(0), origin.at(1), origin.at(2)};
            },
            py::arg("origin"),
            R"(Say to which place (3,) in the world, metres, all that is added is relative: single precision knows a place
to 1e-7 of its distance from there. Cameras are, too.

>>> scene = Scene()
>>> scene.set_origin((10000.0, 0.0, 0.0))
>>> Frame(scene).origin.tolist()
[10000.0, 0.0, 0.0]
)");

    py::class_<Camera>(m, "Camera", R"(The rays of a projection.

view_projection (4, 4) takes world space to OpenGL's clip space, perspective or orthographic.
Raises ValueError if it cannot be inverted.

>>> import numpy as np
>>> Camera(np.eye(4)).corners.shape
(6, 3)
)")
        .def(py::init([](const Doubles &matrix) { return camera_from(matrix4(matrix, "view_projection")); }),
             py::arg("view_projection"))
        .def_property_readonly("corners", &corners,
                               "(6, 3): near0, near_u, near_v, far0, far_u, far_v of shaders/camera.glsl.");
}

} // namespace sfumato
