// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the kernels of this processor. CMake names the instruction sets that it compiled.
#include "kernels.hpp"

#define SFUMATO_DECLARE(ISA)                                                                                           \
    namespace sfumato::ISA {                                                                                           \
    void project_row(const ProjectRow &);                                                                              \
    void light_slice(const LightSlice &);                                                                              \
    void look_up(const LightMapView &, const float *, float *, int);                                                   \
    void trace(const FrameView &, const Packet &, Light &);                                                            \
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
#ISA, LANES, ISA::project_row, ISA::light_slice, ISA::look_up, ISA::trace                                      \
    }

Kernels choose() {
#ifdef SFUMATO_X86
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd")) {
        return SFUMATO_TABLE(avx512, 16);
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return SFUMATO_TABLE(avx2, 8);
    }
#endif
    return SFUMATO_TABLE(baseline, 4);
}

} // namespace

const Kernels &kernels() {
    static const Kernels chosen = choose();
    return chosen;
}

} // namespace sfumato
