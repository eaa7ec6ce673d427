// SPDX-License-Identifier: GPL-3.0-or-later
// The instruction sets for which the *_lanes.cpp are compiled, and the choice among them at run time. A room gathers
// its kernels in a table of function pointers: *_lanes.cpp define one for each set, in the namespace of the set, and a
// source file of the room chooses among them with SFUMATO_DISPATCH. The names of the tables end in _kernels: CMake
// hides all else of what is compiled for a set.
#pragma once

#include <cstdint>
#include <span>

namespace sfumato {

constexpr int MAX_LANES = 16; // of any instruction set

struct InstructionSet {
    enum class Kind : std::uint8_t { BASELINE, AVX2, AVX512 };
    Kind kind = Kind::BASELINE;
    const char *name = nullptr;
    int lanes = 0;
};

// Every set that this processor runs, the widest last.
std::span<const InstructionSet> instruction_sets();

// The widest.
const InstructionSet &instruction_set();

} // namespace sfumato

// Inside namespace sfumato: defines `const TABLE &NAME(const InstructionSet &)` from the tables ISA::NAME.
#ifdef SFUMATO_X86
#define SFUMATO_DISPATCH(TABLE, NAME)                                                                                  \
    namespace baseline {                                                                                               \
    extern const TABLE NAME;                                                                                           \
    }                                                                                                                  \
    namespace avx2 {                                                                                                   \
    extern const TABLE NAME;                                                                                           \
    }                                                                                                                  \
    namespace avx512 {                                                                                                 \
    extern const TABLE NAME;                                                                                           \
    }                                                                                                                  \
    const TABLE &NAME(const InstructionSet &with) {                                                                    \
        return with.kind == InstructionSet::Kind::AVX512 ? avx512::NAME                                                \
               : with.kind == InstructionSet::Kind::AVX2 ? avx2::NAME                                                  \
                                                         : baseline::NAME;                                             \
    }
#else
#define SFUMATO_DISPATCH(TABLE, NAME)                                                                                  \
    namespace baseline {                                                                                               \
    extern const TABLE NAME;                                                                                           \
    }                                                                                                                  \
    const TABLE &NAME(const InstructionSet &) {                                                                        \
        return baseline::NAME;                                                                                         \
    }
#endif
