// SPDX-License-Identifier: GPL-3.0-or-later
// How the samples of a picture are told to packets.
#pragma once

#include "frame/film.hpp"
#include "frame/layers.hpp"
#include "frame/picture.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace sfumato {

constexpr int TILE = 4; // the sampling pattern repeats every TILE x TILE pixels; TILE^2 = FILM_TURNS

// Neighbouring pixels get distant turns (the order of Bayer's matrix).
inline int film_turn(int x, int y) {
    constexpr std::array<int, 16> BAYER = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    return BAYER[static_cast<std::size_t>((y % TILE) * TILE + x % TILE)];
}

// A pixel, or one of `count` samples of it, for what is textured: as wide as a box of the film filter's variance.
// Of 1.5 pixels, Blackman and Harris's is as wide as 1.44.
struct Standing {
    float beside_u, beside_v, pixels;

    Standing(std::size_t count, const Film &film, const Image &image)
        : beside_u(1.0F / static_cast<float>(image.width)), beside_v(1.0F / static_cast<float>(image.height)) {
        constexpr double WIDE = 1.44 / 3.0; // of the filter's diameter
        const double width = film.filter.shape == Filter::Shape::BOX ? 1.0 : WIDE * film.filter.diameter();
        pixels = static_cast<float>(width / std::sqrt(static_cast<double>(count)));
    }

    void put(Packet &packet) const {
        packet.stands_for = pixels;
        packet.beside_u = beside_u;
        packet.beside_v = beside_v;
    }
};

// One sample of a pixel: where in it, and where on every light.
inline void put_sample(const FilmSample &sample, int x, int y, const Image &image, Packet &packet, std::size_t lane) {
    packet.u[lane] = (static_cast<float>(x) + 0.5F + sample.x) / static_cast<float>(image.width);
    packet.v[lane] = (static_cast<float>(y) + 0.5F + sample.y) / static_cast<float>(image.height);
    packet.light_u[lane] = packet.look_u[lane] = sample.light_u;
    packet.light_v[lane] = packet.look_v[lane] = sample.light_v;
}

// Of a first look, through the pixel's middle.
inline void put_first_look(bool spread, int x, int y, const Image &image, Packet &packet, std::size_t lane) {
    const FilmSample look = spread ? first_look(x, y) : FilmSample{0.0F, 0.0F, 0.5F, 0.5F};
    put_sample(look, x, y, image, packet, lane);
    // Of a look for light of other surfaces, quarters of the square are divided once more.
    const auto finer = [](float middle, int tile) {
        return middle + (static_cast<float>(tile % 2) - 0.5F) / (2.0F * TILE);
    };
    packet.look_u[lane] = finer(look.light_u, x / TILE);
    packet.look_v[lane] = finer(look.light_v, y / TILE);
}

} // namespace sfumato
