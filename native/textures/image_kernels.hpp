// SPDX-License-Identifier: GPL-3.0-or-later
// Looking up many places of one picture.
#pragma once

#include "text/dispatch.hpp"
#include "textures/image.hpp"

#include <cstddef>

namespace sfumato {

// Of each place its coordinates, how far they move along both axes of a pixel, and, to be written, its colour and
// alpha.
struct ImagePlaces {
    std::size_t count = 0;
    const float *u = nullptr, *v = nullptr;
    const float *across = nullptr, *up = nullptr; // (u, v) each, or null for no width
    float *rgba = nullptr;
};

struct ImageKernels {
    void (*look_up_all)(const ImageView &, Interpolation, Extension, const ImagePlaces &);
};

const ImageKernels &image_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
