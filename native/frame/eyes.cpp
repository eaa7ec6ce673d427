// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/eyes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

namespace sfumato {
namespace {

// The directions of Sobol's sequence (1967) in its first three dimensions: by the polynomials 1, x + 1 and x^2 + x + 1.
using Directions = std::array<std::uint32_t, 32>;

std::array<Directions, 3> sobol_directions() {
    constexpr std::uint32_t TOP = 1U << 31U;
    std::array<Directions, 3> out{};
    for (std::size_t j = 0; j < 32; ++j) {
        out[0][j] = TOP >> j;
        out[1][j] = j == 0 ? TOP : out[1][j - 1] ^ (out[1][j - 1] >> 1U);
        out[2][j] = j == 0 ? TOP : j == 1 ? 3U << 30U : out[2][j - 1] ^ out[2][j - 2] ^ (out[2][j - 2] >> 2U);
    }
    return out;
}

float sobol(const Directions &directions, std::size_t index) {
    std::uint32_t sum = 0;
    for (std::size_t j = 0; index != 0; index >>= 1U, ++j) {
        sum ^= (index & 1U) != 0 ? directions[j] : 0U;
    }
    return (static_cast<float>(sum >> 8U) + 0.5F) * 0x1p-24F;
}

// Shirley and Chiu's map (1997) of a square to a disk keeps what is near together.
glm::vec2 on_disk(float u, float v) {
    const float x = 2.0F * u - 1.0F, y = 2.0F * v - 1.0F;
    const bool wide = std::abs(x) > std::abs(y);
    const float radius = wide ? x : y, quarter = 0.25F * std::numbers::pi_v<float>;
    if (radius == 0.0F) {
        return {0.0F, 0.0F};
    }
    const float angle = wide ? quarter * (y / x) : 2.0F * quarter - quarter * (x / y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// A regular polygon in the unit circle, as Cycles turns it: triangles from the middle to two corners.
glm::vec2 on_polygon(int corners, float rotation, float u, float v) {
    const float turn = u * static_cast<float>(corners), corner = std::floor(turn);
    const float out = std::sqrt(turn - corner), along = v * out;
    const float half = std::numbers::pi_v<float> / static_cast<float>(corners);
    const glm::vec2 p((1.0F - out + along) * std::cos(half), (1.0F - out - along) * std::sin(half));
    // (1 - out, along) are the weights of the corners; so p is the triangle's point about its own axis.
    const float angle = rotation + 2.0F * half * corner, c = std::cos(angle), s = std::sin(angle);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
}

} // namespace

std::size_t eye_of(int turn, int k, int count) {
    // In an order, found by exchanges, in which neither a place on the lens nor the time goes by where in the pixel the
    // samples are: of any of their binary digits each is as good as independent.
    constexpr int ORDERED = 16;
    constexpr std::array<int, ORDERED> ORDER = {15, 9, 11, 4, 2, 13, 0, 6, 8, 10, 14, 5, 3, 12, 1, 7};
    // Of four there is none; then what goes with it in one pixel goes against it in the next.
    const int own = count < ORDERED ? k ^ (turn % 2 != 0 ? count - 1 : 0)
                                    : k - k % ORDERED + ORDER[static_cast<std::size_t>(k % ORDERED)];
    return static_cast<std::size_t>(turn * count + own);
}

std::size_t first_eye_of(int turn) {
    return static_cast<std::size_t>(turn);
}

std::vector<Glimpse> eyes_of(const Exposure &exposure, int count, float width) {
    const std::array<Directions, 3> directions = sobol_directions();
    const Lens &lens = exposure.lens;
    std::vector<Glimpse> out(static_cast<std::size_t>(FILM_TURNS * count));
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float u = sobol(directions[0], i), v = sobol(directions[1], i);
        out[i].time = exposure.when(0.5F + width * (sobol(directions[2], i) - 0.5F));
        out[i].camera = exposure.at(out[i].time);
        if (lens.radius > 0.0F) {
            const glm::vec2 at = lens.blades < 3 ? on_disk(u, v) : on_polygon(lens.blades, lens.rotation, u, v);
            out[i].camera = through(out[i].camera, lens, width * at.x / lens.ratio, width * at.y);
        }
    }
    return out;
}

} // namespace sfumato
