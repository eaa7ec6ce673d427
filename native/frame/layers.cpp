// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/layers.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace sfumato {
namespace {

struct Behind {
    float smoke, through; // of one colour: what the smoke sends, and leaves
};

} // namespace

void keep_smoke(Layers &layers) {
    for (std::size_t c = 0; c < 3; ++c) {
        std::copy(std::begin(layers.smoke[c]), std::end(layers.smoke[c]), std::begin(layers.passes->smoke[c]));
        std::copy(std::begin(layers.through[c]), std::end(layers.through[c]), std::begin(layers.passes->left[c]));
    }
}

void composite(const FrameView &view, LayerSet wanted, int lanes, Layers &layers) {
    const bool smoky = (wanted.has(Layer::SMOKE) && !view.seen_media.empty()) || merges(view, wanted);
    const bool overlay = wanted.overlay();
    if (!smoky && wanted.has(Layer::SMOKE_ALONE)) {
        for (std::size_t c = 0; c < 3; ++c) {
            std::fill(std::begin(layers.smoke[c]), std::end(layers.smoke[c]), 0.0F);
            std::fill(std::begin(layers.through[c]), std::end(layers.through[c]), 1.0F);
        }
    }
    if (wanted.has(Layer::SMOKE_ALONE) && !merges(view, wanted)) {
        keep_smoke(layers);
    }
    for (int lane = 0; lane < lanes; ++lane) {
        float left = 0.0F, through = 0.0F, sent = 0.0F;
        for (int c = 0; c < 3; ++c) {
            const Behind smoke = smoky ? Behind{layers.smoke[c][lane], layers.through[c][lane]} : Behind{0.0F, 1.0F};
            const float surface = layers.surface[c][lane];
            layers.picture[c][lane] = overlay ? smoke.smoke : surface * smoke.through + smoke.smoke;
            if (overlay) {
                layers.behind[c][lane] = smoke.through * (1.0F - view.shadow_strength * surface);
            }
            layers.sky.dull.light[c][lane] *= smoke.through;
            layers.sky.gloss.light[c][lane] *= smoke.through;
            layers.sky.dull.weight[c][lane] *= smoke.through;
            layers.sky.gloss.weight[c][lane] *= smoke.through;
            left += surface * smoke.through;
            sent += smoke.smoke;
            through += smoke.through;
        }
        const float cover = wanted.has(Layer::RADIANCE) ? layers.cover[lane] : layers.hit[lane];
        left += layers.caught[lane] * through;
        left = merges(view, wanted) ? std::min(left + sent, 3.0F * layers.open[lane]) : left; // sheets are among it
        const bool opaque = cover == 1.0F || overlay || !smoky;
        layers.picture[3][lane] = opaque ? cover : 1.0F - through * (1.0F / 3.0F) * (1.0F - cover);
        layers.seen[lane] = smoky ? left * (1.0F / 3.0F) / std::max(layers.open[lane], 1e-20F) : 1.0F;
    }
}

SFUMATO_DISPATCH(FrameKernels, frame_kernels)

} // namespace sfumato
