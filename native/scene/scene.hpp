// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame is made from: plain arrays, in world space where nothing else is said, metres, Z up, scene-linear RGB.
// A field enters here with its first reader. `reference` shares this file with the methods and nothing else.
#pragma once

#include "scene/light.hpp"
#include "scene/visibility.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct Grid;            // media/grid.hpp
struct Pattern;         // textures/pattern.hpp
class TransferFunction; // media/transfer.hpp

// What a layer of gloss leaves to all that lies below it: everything; of light, what it does not reflect; or nothing.
enum class Below : std::uint8_t { ALL, REST, NOTHING };

// A layer that reflects like a mirror broken into facets: GGX (Walter et al. 2007) with Smith's shadowing, or
// Beckmann's.
struct Gloss {
    glm::vec3 reflectance{0.0F}; // of light from straight on
    float edge = 0.0F;           // 1: at grazing angles all is reflected; 0: no more than straight on
    // Of refraction, from 1 on: from straight on to the edge, reflectance rises as a dielectric's. 0: Schlick's (1994).
    // A layer with an index that leaves the rest loses to what is below the reflectance of its strongest colour.
    float index = 0.0F;
    std::array<float, 2> alpha{0, 0}; // slopes along the tangent and across it; the square of an artist's roughness
    // A habit of older renderers: what masks and what shadows a facet know nothing of each other (the product of
    // Smith's two G1), where they go by its height (Heitz 2014, eq 99).
    bool apart = false;
    // Whether what facets send to each other leaves them in the end, as far as it is not absorbed.
    bool lossless = false;
    Below below = Below::ALL;
    // Less than Schlick's reflectance at the angle whose cosine is 1/7, 82 degrees, by so much: a metal's dip before
    // the edge (Kutz, Hasan and Edmondson, "Novel aspects of the Adobe Standard Material", 2021).
    glm::vec3 dip{0.0F};
    bool beckmann = false;
    float share = 1.0F; // of the surface that has this layer
    float turn = 0.0F;  // of the tangent, counterclockwise, as a share of a whole turn
};

// How a surface spreads what it does not mirror.
enum class Spreading : std::uint8_t {
    LAMBERT,
    BURLEY,         // 2012
    GROOVES,        // Oren and Nayar's (1994), of one reflection
    GROOVES_AGAIN,  // of all reflections (Portsmouth, Kutz and Hill 2025)
    GROOVES_DEEPER, // the same, a habit of some years' renderers: from the second reflection on coloured once too often
    // Of sheens alone.
    SHEEN,  // Burley's (2012), which knows no roughness
    VELVET, // Ashikhmin's (2000)
    FIBRES, // Zeltner, Burley and Chiang's (2022)
};

struct Diffuse {
    Spreading spreading = Spreading::LAMBERT;
    float roughness = 0.0F; // in [0, 1]; not Lambert's
};

// What fibres or dust on a surface add at its rim.
struct Sheen {
    glm::vec3 colour{0.0F};
    Diffuse spread{Spreading::SHEEN};
};

// Triangles in a space of their own, which any number of objects may share. Once shared it never changes: its address
// is its identity, and what a frame makes of it is kept under that.
struct Shape {
    std::vector<glm::vec3> vertices;
    std::vector<glm::uvec3> triangles; // indices into vertices
    // Unit length: one triple for each triangle; or one for each vertex; or none of both, where faces are flat and
    // their front is the side from which their corners run counterclockwise.
    std::vector<std::array<glm::vec3, 3>> corner_normals;
    std::vector<glm::vec3> vertex_normals;
    std::vector<std::uint32_t> material; // one for each triangle, a row of Materials; or none: the first
    std::vector<std::array<glm::vec3, 3>> corner_tangents; // as corner_normals; or none
    // What patterns ask for: so many numbers for each corner of each triangle, interpolated between.
    std::uint32_t channel_count = 0;
    std::vector<float> channels;
    // The vertices at even times from the shutter's opening to its closing, an odd number of them; or none: they rest.
    // Normals and all else are those of the middle.
    std::vector<std::vector<glm::vec3>> moving;
};

// How the triangles of an object reflect, diffusely and with gloss: a row for each of its materials.
struct Materials {
    std::vector<glm::vec3> albedo;
    std::vector<Diffuse> diffuse;     // one for each albedo; or none: Lambert's
    std::vector<Gloss> gloss;         // for each albedo equally many layers, from the top; or none
    std::vector<glm::vec3> emission;  // radiance on both sides, one for each albedo; or none. A POLYGON is its light
    std::vector<std::uint32_t> index; // an artist's number for a compositor, one for each albedo; or none: 0
    // The share of light, of each colour, that passes straight through, one for each albedo; or none: all are opaque.
    // What the rest of it does is all that stands above.
    std::vector<glm::vec3> transmittance;
    // Of light that falls on the other side the share that leaves diffusely on this one, one for each albedo; or none.
    std::vector<glm::vec3> translucence;
    std::vector<Sheen> sheen; // beside all that, one for each albedo; or none
    // What of these varies over a surface, one for each albedo, or null; or none. What a pattern gives stands in place
    // of what stands above, which is then no more than what is usual of it.
    std::vector<std::shared_ptr<const Pattern>> patterns;
};

// What stands alone in the world.
struct Mesh : Shape, Materials {};

// One shape in any number of places.
struct Instances {
    std::shared_ptr<const Shape> shape;
    Materials materials;
    std::vector<glm::mat4> to_world;
    std::vector<std::uint32_t> index; // an artist's number, one for each place; or none: 0
    // What patterns ask for of a place: of each equally many numbers; or none.
    std::vector<float> values;
    Visibility visibility;
    bool lamp = false; // whether lights stand for what it emits, too
    // Places at even times, as Shape has its vertices; or none.
    std::vector<std::vector<glm::mat4>> moving;

    Instances() = default;
    Instances(Mesh mesh) // NOLINT(google-explicit-constructor): a mesh is an object in one place
        : shape(std::make_shared<const Shape>(static_cast<Shape &&>(mesh))),
          materials(static_cast<Materials &&>(mesh)), to_world{glm::mat4(1.0F)} {}
};

// Smoke: a grid of densities, cell-centred, interpolated trilinearly and zero outside.
// Grid space is measured in cells: the cell (i, j, k) fills [i, i+1] x [j, j+1] x [k, k+1], its sample is at i + 1/2.
// Extinction is a colour times the one scalar density, so one scalar map serves coloured smoke too.
struct Medium {
    glm::uvec3 resolution{0};
    std::vector<float> density; // x runs fastest
    // The colour in which each cell scatters, by which `scattering` is multiplied; what it does not scatter of that, it
    // absorbs. What is interpolated is density times colour. Or none: white.
    std::vector<glm::vec3> colour;
    // What glows: a number in [0, 1] for each cell, and by rows at equal distances over [0, 1] what that emits, W/(m^3
    // sr), linear between two rows, whatever the density. The first row is black, as all is outside. Or none of both.
    std::vector<float> glow;
    std::vector<glm::vec3> emission;
    // What the frame makes of the density, where that is known already: then `density` may be empty.
    std::shared_ptr<const Grid> grid;
    // What the grid's number stands for, between cells too: the extinction is the density, and the colour that in which
    // it scatters, as `colour` has it. And what it emits, W/(m^3 sr), of a function whose extinction is 0. Both are
    // empty where the grid holds 0. Or none: the number is the density.
    std::shared_ptr<const TransferFunction> transfer, radiated;
    glm::mat4 grid_to_world{1.0F};
    glm::vec3 scattering{1.0F}; // sigma_s per metre and unit density
    glm::vec3 absorption{0.0F}; // sigma_a per metre and unit density
    float anisotropy = 0.0F;    // g of Henyey and Greenstein (1941), in (-1, 1)
    Visibility visibility;      // SHOWN or UNSEEN
};

// Smoke as soft puffs, whose densities fall as 1 - (r / radius)^2 from their middles.
struct Particles {
    std::vector<glm::vec3> points;
    std::vector<float> radius;     // one for each point
    std::vector<float> opacity;    // likewise, straight through the middle, of the strongest colour
    std::vector<glm::vec3> albedo; // of what a puff takes, the share that it scatters: one for each point, or for all
    glm::vec3 extinction{1.0F};    // in each colour, against that in the strongest
    float anisotropy = 0.0F;       // as a Medium's
    Visibility visibility;         // SHOWN or UNSEEN
};

// Light leaving a strand of hair, of one of two models.
struct StrandMaterial {
    // A dielectric cylinder: Chiang, Bitterli, Tappan and Burley, "A practical and controllable hair and fur model for
    // production path tracing", 2016.
    bool dielectric = true;
    glm::vec3 absorption{0.0F};                                  // optical depth of a radius
    float longitudinal = 0.3F, primary = 0.3F, azimuthal = 0.3F; // roughness, of the second what is reflected at once
    float tilt = 0.0F;                                           // of the cuticle's scales, radians
    float index = 1.55F;
    // Or a matt one with a highlight: Kajiya and Kay, "Rendering fur with three dimensional textures", 1989.
    glm::vec3 albedo{0.0F}, highlight{0.0F};
    float roughness = 0.3F; // of the highlight
};

// Hairs, as rows of keys. Once shared it never changes, as a Shape.
struct StrandShape {
    std::vector<glm::vec3> points;    // of all strands, in the world
    std::vector<float> radius;        // one for each point
    std::vector<std::uint32_t> first; // of each strand, where its points begin; then the number of all
    bool smooth = true;               // Catmull and Rom's curve through the points, or straight between them
};

// Strands of one object.
struct Strands {
    std::shared_ptr<const StrandShape> shape;
    std::vector<StrandMaterial> materials;
    std::vector<std::uint32_t> material; // of each strand; or none: the first
    Visibility visibility;               // SHOWN or UNSEEN
};

// What fills the whole world, or a closed mesh, evenly or less with height, and scatters light on its way. The world's
// does not dim a sun, whose strength is that which arrives, unless it ends with height.
struct Air {
    // Scattering per metre (at `ground`): by Rayleigh's phase function, and by that of dust and droplets.
    glm::vec3 rayleigh{0.0F}, mie{0.0F};
    glm::vec3 absorption{0.0F};
    glm::vec3 emission{0.0F};     // W/(m^3 sr), likewise
    float anisotropy = 0.0F;      // of the second, in (-1, 1)
    bool cornette_shanks = false; // else Henyey and Greenstein's
    // Density is exp(-(z - ground) / scale_height), metres; a height of 0: the same everywhere.
    float scale_height = 0.0F, ground = 0.0F;
    glm::vec3 shaft_tint{1.0F};         // an artist's: times what is scattered; 1 is physical
    std::shared_ptr<const Shape> shape; // closed, what is inside it; none: everywhere
    std::vector<glm::mat4> to_world;    // of the shape, the places; of the world none
    Visibility visibility;              // SHOWN or UNSEEN
};

// What surfaces send to each other: whether gloss shows the others, and how many times light goes between them before
// it comes to what is matt.
struct Bounces {
    bool gloss = false;
    int diffuse = 0;
};

struct Scene {
    std::vector<Instances> meshes;
    std::vector<Medium> media;        // where they overlap, their densities add
    std::vector<Particles> particles; // with each other's and with those of the media, too
    std::vector<Strands> strands;
    std::vector<Air> air; // their densities add, too
    std::vector<Light> lights;
    glm::vec3 background{0.0F};               // radiance where no surface is; it lights nothing
    std::shared_ptr<const SkyImage> backdrop; // times it, or none
    float background_alpha = 0.0F;            // 1 where the picture is to have none of another behind it
    Bounces bounces;
    glm::dvec3 origin{0.0}; // the place in the world to which all of it is relative
};

// Rays of a camera, perspective or orthographic. (u, v) runs over [0, 1]^2 from the lower left corner of the image:
// the ray starts on the near plane at near[0] + u near[1] + v near[2], and its unnormalised direction, which is affine
// in (u, v) too, ends on the far plane: far[0] + u far[1] + v far[2].
struct Camera {
    std::array<glm::vec3, 3> near;
    std::array<glm::vec3, 3> far;
};

} // namespace sfumato
