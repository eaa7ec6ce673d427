// SPDX-License-Identifier: GPL-3.0-or-later
// What varies over a surface, as a program: numbers made of numbers, step by step, without branches.
#pragma once

#include "textures/image.hpp"
#include "textures/pattern_input.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sfumato {

constexpr int PATTERN_REGISTERS = 256;
constexpr int STEP_INPUTS = 10;
constexpr int STEP_INTEGERS = 6;

// What a step does. Of conditions, 1 is true and 0 is not; what has no value is 0, as in Cycles.
enum class PatternOp : std::uint8_t {
    CONSTANT, // `setting`, a place among the constants
    INPUT,    // `setting`, a pattern_input; from[0] is no register: 0 here, 1 and 2 a pixel further along its axes
    ADD,
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    MINIMUM,
    MAXIMUM,
    POWER,
    FLOOR,
    CEIL,
    TRUNCATE,
    SQUARE_ROOT,
    ABSOLUTE,
    SIGN,
    EXPONENT,
    LOGARITHM,
    SINE,
    COSINE,
    ARC_TANGENT, // of from[0] over from[1]
    LESS,
    EQUAL,
    SELECT,        // from[1] where from[0] is not 0, else from[2]
    TABLE,         // `setting`, a table over [0, 1], linear between its entries
    STEPPED_TABLE, // the same, the entry below
    // Textures, by the functions of shaders/textures of these names: first the point's coordinates and w, then what is
    // a number in the order of their arguments; `setting`, a row of integers, has what is not.
    NOISE,    // value and colour
    MUSGRAVE, // value
    VORONOI,  // value, colour, position and w
    CHECKER,  // value
    BRICKS, // of x and y: value, and how far what is no mortar is from the first colour to the second, times its share
    MAGIC,  // value and colour
    WAVE,   // value
    WHITE_NOISE, // value and colour
    IMAGE // of u, v, and how far these move along both axes of the footprint: colour and alpha; `setting`, a look-up
};

constexpr bool is_texture(PatternOp op) {
    return op >= PatternOp::NOISE && op <= PatternOp::WHITE_NOISE;
}

// By Python's names, in the order of the numbers.
constexpr std::array<std::string_view, 34> PATTERN_OPS = {
    "constant", "input",    "add",       "subtract",      "multiply",    "divide",      "minimum",
    "maximum",  "power",    "floor",     "ceil",          "truncate",    "square root", "absolute",
    "sign",     "exponent", "logarithm", "sine",          "cosine",      "arc tangent", "less",
    "equal",    "select",   "table",     "stepped table", "noise",       "musgrave",    "voronoi",
    "checker",  "brick",    "magic",     "wave",          "white noise", "image"};

// How many registers a step reads, and how many it writes, from `to` on.
int pattern_inputs(PatternOp op);
int pattern_outputs(PatternOp op);

struct PatternStep {
    PatternOp op;
    std::uint8_t to;
    std::uint16_t setting;
    std::array<std::uint8_t, STEP_INPUTS> from;
};

// What of a material a pattern gives, in place of what is the same all over it. Of layers of gloss, from the first of a
// layer on.
namespace pattern_slot {
enum { ALBEDO = 0, EMISSION = 3, TRANSMITTANCE = 6, ROUGHNESS = 9, NORMAL, FIRST_LOBE = NORMAL + 3 };
// Of a layer.
enum { REFLECTANCE = 0, DIP = 3, ALPHA_X = 6, ALPHA_Y, INDEX, SHARE, TURN, LOBE_SLOTS };
// After those of four layers.
enum { TRANSLUCENCE = FIRST_LOBE + 4 * LOBE_SLOTS, SHEEN = TRANSLUCENCE + 3, SHEEN_ROUGHNESS = SHEEN + 3, SLOTS };
static_assert(SLOTS <= 64); // the bits of Pattern::given
} // namespace pattern_slot

struct Pattern {
    struct Output {
        std::uint8_t slot, from;
    };
    struct LookUp {
        std::shared_ptr<const SurfaceImage> image;
        Interpolation interpolation;
        Extension extension;
    };

    std::vector<PatternStep> steps;
    std::vector<PatternStep> dimming; // those of them that its transmittance takes
    std::vector<float> constants;
    std::vector<std::vector<float>> tables;
    std::vector<std::array<std::int16_t, STEP_INTEGERS>> integers;
    std::vector<LookUp> look_ups;
    std::vector<Output> outputs;
    // What of it asks for more than the point itself.
    bool moves = false;        // inputs a pixel further
    int channels = 0;          // so many of the shape's
    int place_values = 0;      // so many of the place's
    bool dims = false;         // whether it gives a transmittance,
    bool dims_greyly = true;   // the same in all colours
    bool images_alone = false; // whether all that may be sharp in it are images, which look up means
    int points = 1;     // of a pixel that its mean takes: more where it may have edges, or whole features, within one
    bool bends = false; // or a normal
    std::uint64_t given = 0; // the slots of its outputs, as bits
};

// Sets what a pattern asks for; or says what is wrong with it, which no lane looks at again.
std::string settle(Pattern &pattern);

} // namespace sfumato
