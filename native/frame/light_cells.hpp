// SPDX-License-Identifier: GPL-3.0-or-later
// Where light is kept: the cells of a LightCacheView, by place and facing, in a table with open addresses. Those who
// fill it and the kernels each have their own copy, as the text has it (text/lanes.hpp).
#pragma once

#include "frame/bounce.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

namespace sfumato {
namespace {

[[maybe_unused]] int cell_level(const LightCacheView &cache, float distance) {
    constexpr int MOST = 15;
    int level = 0;
    for (float end = 2.0F * cache.near; distance > end && level < MOST; end *= 2.0F) {
        ++level;
    }
    return level;
}

// Of six, the one that a direction is closest to.
[[maybe_unused]] std::uint32_t cell_face(const glm::vec3 &normal) {
    const float x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    const int axis = x > y && x > z ? 0 : y > z ? 1 : 2;
    return static_cast<std::uint32_t>(2 * axis) + (normal[axis] < 0.0F ? 1U : 0U);
}

// Of a place, in cells from the eye.
[[maybe_unused]] std::uint32_t cell_key(int level, std::uint32_t face, int x, int y, int z) {
    const auto digit = [](int i) { return static_cast<std::uint32_t>(std::clamp(i + 128, 0, 255)); };
    return (((static_cast<std::uint32_t>(level) * 6 + face) * 256 + digit(x)) * 256 + digit(y)) * 256 + digit(z);
}

// The slot of a cell, or the free one where it would be.
[[maybe_unused]] std::uint32_t cell_slot(const std::uint32_t *keys, std::uint32_t mask, std::uint32_t key) {
    std::uint32_t slot = (key * 2654435769U >> 8U) & mask; // Knuth's multiplicative hashing
    while (keys[slot] != key && keys[slot] != NO_CELL) {
        slot = (slot + 1) & mask;
    }
    return slot;
}

} // namespace
} // namespace sfumato
