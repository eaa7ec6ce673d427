// SPDX-License-Identifier: GPL-3.0-or-later
// Chunks of the Blosc container, version 1, as OpenVDB writes them: LZ4, bytes shuffled or not.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sfumato {

// Fills `out` from a chunk that must be as large when it is unpacked; `scratch` may hold anything before and after.
// Throws std::runtime_error where the chunk is damaged, or packed by another codec, which it names.
void unpack_blosc(std::span<const std::byte> chunk, std::span<std::byte> out, std::vector<std::byte> &scratch);

} // namespace sfumato
