// SPDX-License-Identifier: GPL-3.0-or-later
#include "textures/pattern.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato {
namespace {

std::string step_named(std::size_t number) {
    return "step " + std::to_string(number);
}

// Of a step's input that is no number of the pattern.
std::string check_input(const PatternStep &step, std::size_t number, Pattern &pattern) {
    using namespace pattern_input;
    if (step.setting >= CHANNEL + MOST_CHANNELS) {
        return step_named(number) + " asks for input " + std::to_string(step.setting) + "; there are " +
               std::to_string(CHANNEL + MOST_CHANNELS);
    }
    if (step.from[0] > 2) {
        return step_named(number) + " asks for an input at place " + std::to_string(step.from[0]) +
               ", but there are 0, 1 and 2";
    }
    pattern.moves = pattern.moves || step.from[0] > 0;
    if (step.setting >= CHANNEL) {
        pattern.channels = std::max(pattern.channels, step.setting - CHANNEL + 1);
    } else if (step.setting >= PLACE) {
        pattern.place_values = std::max(pattern.place_values, step.setting - PLACE + 1);
    }
    return {};
}

std::string check_setting(const PatternStep &step, std::size_t number, std::size_t count, const char *what) {
    if (step.setting < count) {
        return {};
    }
    return step_named(number) + " asks for " + what + " " + std::to_string(step.setting) + ", but there are " +
           std::to_string(count);
}

// The steps that lead to the outputs in some slots.
std::vector<PatternStep> leading_to(const Pattern &pattern, int first_slot, int slots) {
    std::array<bool, PATTERN_REGISTERS> wanted{};
    for (const Pattern::Output &output : pattern.outputs) {
        if (output.slot >= first_slot && output.slot < first_slot + slots) {
            wanted[output.from] = true;
        }
    }
    std::vector<PatternStep> found;
    for (auto step = pattern.steps.rbegin(); step != pattern.steps.rend(); ++step) {
        const auto written = wanted.begin() + step->to;
        const int count = pattern_outputs(step->op);
        if (std::find(written, written + count, true) == written + count) {
            continue;
        }
        std::fill_n(written, count, false);
        for (int i = 0; i < pattern_inputs(step->op); ++i) {
            wanted[step->from[static_cast<std::size_t>(i)]] = true;
        }
        found.push_back(*step);
    }
    std::reverse(found.begin(), found.end());
    return found;
}

} // namespace

int pattern_inputs(PatternOp op) {
    switch (op) {
    case PatternOp::CONSTANT:
    case PatternOp::INPUT:
        return 0;
    case PatternOp::ADD:
    case PatternOp::SUBTRACT:
    case PatternOp::MULTIPLY:
    case PatternOp::DIVIDE:
    case PatternOp::MINIMUM:
    case PatternOp::MAXIMUM:
    case PatternOp::POWER:
    case PatternOp::ARC_TANGENT:
    case PatternOp::LESS:
    case PatternOp::EQUAL:
        return 2;
    case PatternOp::SELECT:
    case PatternOp::CHECKER:
        return 3;
    case PatternOp::NOISE:
    case PatternOp::VORONOI:
        return 10;
    case PatternOp::MUSGRAVE:
    case PatternOp::BRICKS:
        return 9;
    case PatternOp::WAVE:
        return 8;
    case PatternOp::IMAGE:
        return 6;
    case PatternOp::MAGIC:
    case PatternOp::WHITE_NOISE:
        return 4;
    default:
        return 1;
    }
}

int pattern_outputs(PatternOp op) {
    switch (op) {
    case PatternOp::VORONOI:
        return 8;
    case PatternOp::NOISE:
    case PatternOp::MAGIC:
    case PatternOp::WHITE_NOISE:
    case PatternOp::IMAGE:
        return 4;
    case PatternOp::BRICKS:
        return 2;
    default:
        return 1;
    }
}

// Images look up means by themselves, of what is finer than a pixel.
int points_of(PatternOp op) {
    constexpr std::array SHARP{PatternOp::FLOOR, PatternOp::CEIL,  PatternOp::TRUNCATE, PatternOp::SIGN,
                               PatternOp::LESS,  PatternOp::EQUAL, PatternOp::TABLE,    PatternOp::STEPPED_TABLE};
    const bool sharp = is_texture(op) || std::find(SHARP.begin(), SHARP.end(), op) != SHARP.end();
    return sharp ? 16 : op == PatternOp::IMAGE ? 4 : 1;
}

std::string settle(Pattern &pattern) {
    std::array<bool, PATTERN_REGISTERS> written{};
    for (std::size_t number = 0; number < pattern.steps.size(); ++number) {
        const PatternStep &step = pattern.steps[number];
        std::string wrong;
        pattern.points = std::max(pattern.points, points_of(step.op));
        if (step.op == PatternOp::INPUT) {
            wrong = check_input(step, number, pattern);
        } else if (step.op == PatternOp::CONSTANT) {
            wrong = check_setting(step, number, pattern.constants.size(), "constant");
        } else if (step.op == PatternOp::TABLE || step.op == PatternOp::STEPPED_TABLE) {
            wrong = check_setting(step, number, pattern.tables.size(), "table");
        } else if (is_texture(step.op)) {
            wrong = check_setting(step, number, pattern.integers.size(), "the integers");
        } else if (step.op == PatternOp::IMAGE) {
            wrong = check_setting(step, number, pattern.look_ups.size(), "look-up");
        }
        for (int i = 0; i < pattern_inputs(step.op) && wrong.empty(); ++i) {
            const int from = step.from[static_cast<std::size_t>(i)];
            if (!written[static_cast<std::size_t>(from)]) {
                wrong = step_named(number) + " reads register " + std::to_string(from) + ", which nothing has written";
            }
        }
        if (wrong.empty() && step.to + pattern_outputs(step.op) > PATTERN_REGISTERS) {
            wrong = step_named(number) + " writes beyond the last register";
        }
        if (!wrong.empty()) {
            return wrong;
        }
        std::fill_n(written.begin() + step.to, pattern_outputs(step.op), true);
    }
    pattern.images_alone = pattern.points == points_of(PatternOp::IMAGE);
    if (pattern.outputs.size() > pattern_slot::SLOTS) {
        return "there are " + std::to_string(pattern.outputs.size()) + " outputs, but only " +
               std::to_string(pattern_slot::SLOTS) + " slots";
    }
    for (const Pattern::Output &output : pattern.outputs) {
        if (output.slot >= pattern_slot::SLOTS) {
            return "an output goes to slot " + std::to_string(output.slot) + ", but there are " +
                   std::to_string(pattern_slot::SLOTS);
        }
        if (!written[output.from]) {
            return "an output comes from register " + std::to_string(output.from) + ", which nothing has written";
        }
        pattern.given |= std::uint64_t{1} << output.slot;
    }
    const auto gives = [&pattern](int first, int count) {
        return (pattern.given >> first & ((std::uint64_t{1} << count) - 1)) != 0;
    };
    pattern.dims = gives(pattern_slot::TRANSMITTANCE, 3);
    std::array<int, 3> through{-1, -1, -1};
    for (const Pattern::Output &output : pattern.outputs) {
        if (output.slot >= pattern_slot::TRANSMITTANCE && output.slot < pattern_slot::TRANSMITTANCE + 3) {
            through[output.slot - std::size_t{pattern_slot::TRANSMITTANCE}] = output.from;
        }
    }
    pattern.dims_greyly = through[0] == through[1] && through[0] == through[2];
    pattern.bends = gives(pattern_slot::NORMAL, 3);
    pattern.dimming = leading_to(pattern, pattern_slot::TRANSMITTANCE, 3);
    for (std::size_t i = 0; i < pattern.tables.size(); ++i) {
        if (pattern.tables[i].size() < 2) {
            return "table " + std::to_string(i) + " has " + std::to_string(pattern.tables[i].size()) +
                   " entries, but must have two at least";
        }
    }
    return {};
}

} // namespace sfumato
