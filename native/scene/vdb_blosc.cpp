// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vdb_blosc.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <lz4.h>

namespace sfumato {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t HEADER = 16; // version, codec's version, flags, size of a number, three sizes of 32 bits
constexpr unsigned SHUFFLED = 0x1, COPIED = 0x2, BITS_SHUFFLED = 0x4, WHOLE_BLOCKS = 0x10;
constexpr unsigned LZ4 = 1; // in the upper three bits of the flags
constexpr std::array CODECS{"blosclz", "lz4", "snappy", "zlib", "zstd"};

// Before there was a flag for it, blocks were split by these.
constexpr std::size_t MOST_STREAMS = 16, LEAST_NUMBERS = 128;

[[noreturn]] void fail(const std::string &why) {
    throw std::runtime_error("a Blosc chunk of it " + why);
}

void require(bool right) {
    if (!right) {
        fail("is damaged");
    }
}

std::size_t number_at(Bytes bytes, std::size_t at) {
    require(at <= bytes.size() && bytes.size() - at >= sizeof(std::uint32_t));
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

// From all first bytes, all second bytes, ... back to numbers; what is left at the end is as it was.
template <std::size_t SIZE>
void unshuffle(Bytes in, std::span<std::byte> out, std::size_t size = SIZE) {
    const std::size_t step = SIZE == 0 ? size : SIZE, count = in.size() / step;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t byte = 0; byte < step; ++byte) {
            out[i * step + byte] = in[byte * count + i];
        }
    }
    std::copy(in.begin() + static_cast<std::ptrdiff_t>(count * step), in.end(),
              out.begin() + static_cast<std::ptrdiff_t>(count * step));
}

void unshuffle_numbers(Bytes in, std::span<std::byte> out, std::size_t size) {
    switch (size) {
    case 2:
        return unshuffle<2>(in, out);
    case 4:
        return unshuffle<4>(in, out);
    case 8:
        return unshuffle<8>(in, out);
    default:
        return unshuffle<0>(in, out, size);
    }
}

// A block is one stream, or one for each byte of a number; each has its size in front, and is copied where it is as
// large as what it stands for.
void unpack_block(Bytes chunk, std::size_t at, std::size_t streams, std::span<std::byte> out) {
    require(out.size() % streams == 0);
    const std::size_t each = out.size() / streams;
    for (std::size_t stream = 0; stream < streams; ++stream) {
        const std::size_t size = number_at(chunk, at);
        at += sizeof(std::uint32_t);
        require(size <= chunk.size() - at);
        const std::byte *from = chunk.data() + at;
        std::byte *to = out.data() + stream * each;
        if (size == each) {
            std::memcpy(to, from, each);
        } else {
            const int got = LZ4_decompress_safe(reinterpret_cast<const char *>(from), reinterpret_cast<char *>(to),
                                                static_cast<int>(size), static_cast<int>(each));
            require(got >= 0 && static_cast<std::size_t>(got) == each);
        }
        at += size;
    }
}

} // namespace

void unpack_blosc(Bytes chunk, std::span<std::byte> out, std::vector<std::byte> &scratch) {
    require(chunk.size() >= HEADER);
    const auto flags = std::to_integer<unsigned>(chunk[2]), codec = flags >> 5U;
    const auto number_size = std::to_integer<std::size_t>(chunk[3]);
    const std::size_t size = number_at(chunk, 4), block_size = number_at(chunk, 8), packed = number_at(chunk, 12);
    require(std::to_integer<unsigned>(chunk[0]) == 2 && size == out.size() && packed <= chunk.size());
    chunk = chunk.first(packed);
    if (out.empty()) {
        return;
    }
    if ((flags & COPIED) != 0) {
        require(chunk.size() >= HEADER + size);
        std::memcpy(out.data(), chunk.data() + HEADER, size);
        return;
    }
    if (codec != LZ4 || (flags & BITS_SHUFFLED) != 0) {
        fail("is packed by " + std::string(codec < CODECS.size() ? CODECS[codec] : "a codec that is not known") +
             ((flags & BITS_SHUFFLED) != 0 ? " with shuffled bits" : "") + ", only lz4 with shuffled bytes is read");
    }
    require(number_size > 0 && block_size > 0 && block_size <= size);
    const bool shuffled = (flags & SHUFFLED) != 0 && number_size > 1;
    const bool split =
        (flags & WHOLE_BLOCKS) == 0 && number_size <= MOST_STREAMS && block_size / number_size >= LEAST_NUMBERS;
    if (shuffled) {
        scratch.resize(std::max(scratch.size(), block_size));
    }
    for (std::size_t first = 0, block = 0; first < size; first += block_size, ++block) {
        const auto part = out.subspan(first, std::min(block_size, size - first));
        const auto target = shuffled ? std::span(scratch).first(part.size()) : part;
        const std::size_t streams = split && part.size() == block_size ? number_size : 1;
        unpack_block(chunk, number_at(chunk, HEADER + sizeof(std::uint32_t) * block), streams, target);
        if (shuffled) {
            unshuffle_numbers(target, part, number_size);
        }
    }
}

} // namespace sfumato
