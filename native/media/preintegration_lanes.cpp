// SPDX-License-Identifier: GPL-3.0-or-later
// Slabs of a pre-integrated table, many at a time, and the windows over them.
#include "media/preintegration_kernels.hpp"
#include "text/preintegration_text.hpp"

#include <algorithm>

#include <xsimd/xsimd.hpp>

namespace sfumato::SFUMATO_ISA {
namespace {

using Doubles = xsimd::batch<double>;

// As lanes.hpp has it for single precision: what this text asks for.
struct DoubleIsa {
    static Doubles pick(xsimd::batch_bool<double> condition, Doubles a, Doubles b) {
        return xsimd::select(condition, a, b);
    }
    static bool any_lane(xsimd::batch_bool<double> condition) { return xsimd::any(condition); }
};

using Text = text::PreintegrationText<Doubles, DoubleIsa>;
constexpr std::size_t LANES = Doubles::size;
static_assert(SLAB_GROUP % LANES == 0);

inline Text::vec3 load(const double *const rgb[3], std::size_t at, Doubles scale) {
    return {Doubles::load_unaligned(rgb[0] + at) * scale, Doubles::load_unaligned(rgb[1] + at) * scale,
            Doubles::load_unaligned(rgb[2] + at) * scale};
}

inline double highest(Doubles x) {
    alignas(64) double lanes[LANES];
    x.store_aligned(lanes);
    return *std::max_element(lanes, lanes + LANES);
}

struct Both {
    Text::vec3 forwards = Text::vec3(Doubles(0.0)), backwards = Text::vec3(Doubles(0.0));
    Doubles behind = Doubles(1.0);
};

inline Both sent_by(const Text::Stretch &stretch) {
    const Text::Attenuation over = Text().attenuation_over(Text().depth_of(stretch));
    return {Text().radiance_of(stretch, over), Text().radiance_of(Text().reversed_stretch(stretch), over), over.behind};
}

// As many pieces for all lanes as one of them asks for.
inline Both sent_in_pieces(const Text::Stretch &stretch) {
    const int pieces = static_cast<int>(highest(Text().pieces_of(stretch)));
    if (pieces <= 1) {
        return sent_by(stretch);
    }
    const double share = 1.0 / pieces;
    Both sum;
    for (int i = 0; i < pieces; ++i) {
        const Both piece = sent_by(Text().piece_of(stretch, Doubles(share * i), Doubles(share)));
        sum.forwards = sum.forwards + piece.forwards * sum.behind;
        sum.backwards = piece.backwards + sum.backwards * piece.behind;
        sum.behind = sum.behind * piece.behind;
    }
    return sum;
}

inline void store(const Both &both, SlabSent *out) {
    alignas(64) double lanes[7][LANES];
    for (int c = 0; c < 3; ++c) {
        both.forwards[c].store_aligned(lanes[c]);
        both.backwards[c].store_aligned(lanes[c + 3]);
    }
    both.behind.store_aligned(lanes[6]);
    for (std::size_t lane = 0; lane < LANES; ++lane) {
        SlabSent &slab = out[lane];
        for (int c = 0; c < 3; ++c) {
            slab.forwards[c] = lanes[c][lane];
            slab.backwards[c] = lanes[c + 3][lane];
        }
        slab.forwards[3] = slab.backwards[3] = 1.0 - lanes[6][lane]; // opacity composes as light does
        slab.behind = lanes[6][lane];
    }
}

} // namespace

void send_slabs(const SlabBatch &batch) {
    const Doubles length(batch.length);
    const SlabView &slabs = batch.slabs;
    for (std::size_t k = batch.first; k < batch.last; k += LANES) {
        Text::Stretch stretch;
        stretch.front = Doubles::load_unaligned(slabs.front + k) * length;
        stretch.back = Doubles::load_unaligned(slabs.back + k) * length;
        stretch.emission_front = load(slabs.emission_front, k, length);
        stretch.emission_back = load(slabs.emission_back, k, length);
        stretch.bow = load(slabs.bow, k, length);
        store(sent_in_pieces(stretch), batch.out + k);
    }
}

// Two stacks, whose fixed windows make them van Herk's blocks: every window of `width` slabs holds just one boundary
// between blocks of so many. From there the slabs behind are composed once for all windows, and those before it one by
// one as the window moves. Nothing is taken off again, so that nothing is divided by a transmittance of nearly nothing.
void compose_windows(const Windows &windows) {
    const std::size_t width = windows.width;
    const SlabSent *const slabs = windows.slabs;
    SlabSent *const run = windows.run;
    for (std::size_t middle = (windows.first + width - 1) / width * width; middle < windows.last + width;
         middle += width) {
        const std::size_t highest = std::min(middle, windows.last);
        const std::size_t lowest = std::max(middle + 1 > width ? middle + 1 - width : 0, windows.first);
        run[0] = SlabSent{};
        for (std::size_t p = 0; middle + p < highest + width; ++p) {
            const SlabSent &slab = slabs[middle + p], &sum = run[p];
            SlabSent &next = run[p + 1];
            for (int c = 0; c < 4; ++c) {
                next.forwards[c] = sum.forwards[c] + sum.behind * slab.forwards[c];
                next.backwards[c] = slab.backwards[c] + slab.behind * sum.backwards[c];
            }
            next.behind = sum.behind * slab.behind;
        }
        SlabSent front{};
        for (std::size_t i = middle;; --i) {
            if (i < middle) {
                const SlabSent &slab = slabs[i];
                for (int c = 0; c < 4; ++c) {
                    front.forwards[c] = slab.forwards[c] + slab.behind * front.forwards[c];
                    front.backwards[c] = front.backwards[c] + front.behind * slab.backwards[c];
                }
                front.behind *= slab.behind;
            }
            if (i <= highest) {
                const SlabSent &back = run[i + width - middle];
                for (std::size_t c = 0; c < 4; ++c) {
                    windows.forwards[4 * i + c] =
                        static_cast<float>(front.forwards[c] + front.behind * back.forwards[c]);
                    windows.backwards[4 * i + c] =
                        static_cast<float>(back.backwards[c] + back.behind * front.backwards[c]);
                }
            }
            if (i == lowest) {
                break;
            }
        }
    }
}

extern const PreintegrationKernels preintegration_kernels{send_slabs, compose_windows};

} // namespace sfumato::SFUMATO_ISA
