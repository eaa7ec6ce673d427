// SPDX-License-Identifier: GPL-3.0-or-later
// CMake names the instruction sets that it compiled.
#include "text/dispatch.hpp"

#include <vector>

namespace sfumato {
namespace {

std::vector<InstructionSet> runnable() {
    std::vector<InstructionSet> all{{InstructionSet::Kind::BASELINE, "baseline", 4}};
#ifdef SFUMATO_X86
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        all.push_back({InstructionSet::Kind::AVX2, "avx2", 8});
    }
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd")) {
        all.push_back({InstructionSet::Kind::AVX512, "avx512", 16});
    }
#endif
    return all;
}

} // namespace

std::span<const InstructionSet> instruction_sets() {
    static const std::vector<InstructionSet> all = runnable();
    return all;
}

const InstructionSet &instruction_set() {
    return instruction_sets().back();
}

} // namespace sfumato
