// SPDX-License-Identifier: GPL-3.0-or-later
#include "textures/image_lanes.hpp"

#include "textures/image_kernels.hpp"

namespace sfumato::SFUMATO_ISA {

void look_up_all(const ImageView &image, Interpolation interpolation, Extension extension, const ImagePlaces &places) {
    constexpr auto WIDTH = static_cast<std::size_t>(LANES);
    for (std::size_t first = 0; first < places.count; first += WIDTH) {
        const std::size_t count = std::min(WIDTH, places.count - first);
        alignas(64) float lanes[6][LANES] = {};
        for (std::size_t lane = 0; lane < count; ++lane) {
            lanes[0][lane] = places.u[first + lane];
            lanes[1][lane] = places.v[first + lane];
            for (std::size_t axis = 0; axis < 2; ++axis) {
                lanes[2 + axis][lane] = places.across == nullptr ? 0.0F : places.across[2 * (first + lane) + axis];
                lanes[4 + axis][lane] = places.up == nullptr ? 0.0F : places.up[2 * (first + lane) + axis];
            }
        }
        const auto load = [&lanes](int row) { return Real::load_aligned(lanes[row]); };
        const Rgba found =
            look_up(image, interpolation, extension, load(0), load(1), {{load(2), load(3)}, {load(4), load(5)}},
                    lane_numbers() < static_cast<float>(count));
        found.r.store_aligned(lanes[0]);
        found.g.store_aligned(lanes[1]);
        found.b.store_aligned(lanes[2]);
        found.a.store_aligned(lanes[3]);
        for (std::size_t lane = 0; lane < count; ++lane) {
            for (std::size_t channel = 0; channel < 4; ++channel) {
                places.rgba[4 * (first + lane) + channel] = lanes[channel][lane];
            }
        }
    }
}

extern const ImageKernels image_kernels{look_up_all};

} // namespace sfumato::SFUMATO_ISA
