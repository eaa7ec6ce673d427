// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of pre-integrated tables (preintegration.hpp), and the plain views that they read. Everything is in
// double precision: a table's entry is a product of as many transmittances as it has slabs, which in single precision
// would all be rounded the same way.
#pragma once

#include "text/dispatch.hpp"

#include <cstddef>

namespace sfumato {

// Numbers of which arrays of slabs have a multiple.
constexpr std::size_t SLAB_GROUP = MAX_LANES;

// Of each slab between two neighbouring values of a table, per unit of length.
struct SlabView {
    const double *front = nullptr, *back = nullptr; // extinction at either end
    const double *emission_front[3] = {}, *emission_back[3] = {}, *bow[3] = {};
};

// What a ray meets in a slab.
struct SlabSent {
    double forwards[4];  // radiance, RGB, seen from the lower value's side; and opacity
    double backwards[4]; // from the higher one's
    double behind = 1.0; // transmittance
};

// Slabs of one length, from `first`, a multiple of SLAB_GROUP, to before `last`.
struct SlabBatch {
    SlabView slabs;
    double length = 0.0;
    std::size_t first = 0, last = 0;
    SlabSent *out = nullptr; // of slab k at k
};

// What rays meet in `width` slabs each, those from slab i on, for i from `first` to `last`.
struct Windows {
    const SlabSent *slabs = nullptr;
    SlabSent *run = nullptr; // width + 1 of them to work in
    std::size_t width = 1, first = 0, last = 0;
    float *forwards = nullptr, *backwards = nullptr; // four numbers from 4 i
};

struct PreintegrationKernels {
    void (*send_slabs)(const SlabBatch &);
    void (*compose_windows)(const Windows &);
};

const PreintegrationKernels &preintegration_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
