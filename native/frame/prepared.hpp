// SPDX-License-Identifier: GPL-3.0-or-later
// What outlives a frame: parts of the last ones, and the threads that make them.
#pragma once

#include "maps/lighting.hpp"
#include "solids/surfaces.hpp"

#include <mutex>

#include <oneapi/tbb/task_arena.h>

namespace sfumato {

// Parts are immutable, and frames hold those that they use, so a frame stays as it is while the next one is made.
// Frames that share a Prepared are made one after the other.
class Prepared {
public:
    explicit Prepared(int threads = 0) // 0: as many as the machine has
        : arena(threads > 0 ? threads : oneapi::tbb::task_arena::automatic), solids(threads) {}

    void end_round() {
        solids.end_round();
        lights.end_round();
        ranges.end_round();
    }

    std::mutex making;
    oneapi::tbb::task_arena arena;
    Solids solids;
    LightParts lights;
    Kept<std::vector<glm::vec2>> ranges; // brick_ranges of grids under a transfer function
};

} // namespace sfumato
