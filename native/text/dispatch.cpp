// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the kernels of this processor. CMake names the instruction sets that it compiled.
#include "lights/area_light.hpp"
#include "lights/microfacet.hpp"
#include "text/kernels.hpp"

#include <vector>

#define SFUMATO_DECLARE(ISA)                                                                                           \
    namespace sfumato::ISA {                                                                                           \
    void project_row(const ProjectRow &);                                                                              \
    void light_slice(const LightSlice &);                                                                              \
    void look_up(const LightMapView &, const float *, float *, int);                                                   \
    void trace(const FrameView &, Output, const Packet &, Traced &);                                                   \
    void integrate_lights(const LightBatch<float> &);                                                                  \
    void harmonic_sums(const HarmonicSums &);                                                                          \
    void weigh_rows(const WeightedRows &);                                                                             \
    void look_up_series(const SeriesLookUp &);                                                                         \
    void look_up_texels(const TexelLookUp &);                                                                          \
    void reflect_lights(const MicrofacetBatch<float> &);                                                               \
    }

SFUMATO_DECLARE(baseline)
#ifdef SFUMATO_X86
SFUMATO_DECLARE(avx2)
SFUMATO_DECLARE(avx512)
#endif

namespace sfumato {
namespace {

#define SFUMATO_TABLE(ISA, LANES)                                                                                      \
    Kernels {                                                                                                          \
#ISA, LANES, ISA::project_row, ISA::light_slice, ISA::look_up, ISA::trace, ISA::integrate_lights,              \
            ISA::harmonic_sums, ISA::weigh_rows, ISA::look_up_series, ISA::look_up_texels, ISA::reflect_lights         \
    }

std::vector<Kernels> runnable() {
    std::vector<Kernels> all{SFUMATO_TABLE(baseline, 4)};
#ifdef SFUMATO_X86
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        all.push_back(SFUMATO_TABLE(avx2, 8));
    }
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd")) {
        all.push_back(SFUMATO_TABLE(avx512, 16));
    }
#endif
    return all;
}

} // namespace

std::span<const Kernels> available_kernels() {
    static const std::vector<Kernels> all = runnable();
    return all;
}

const Kernels &kernels() {
    return available_kernels().back();
}

} // namespace sfumato
