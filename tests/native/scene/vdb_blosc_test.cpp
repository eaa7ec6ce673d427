// SPDX-License-Identifier: GPL-3.0-or-later
// Chunks as Blosc itself packs them.
#include "scene/vdb_blosc.hpp"

#include <random>
#include <stdexcept>
#include <string>

#include <blosc.h>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using Chunk = std::vector<std::byte>;

// Numbers that repeat enough to be packed, or do not.
Chunk content(std::size_t size, bool noise) {
    std::mt19937 generator(3);
    Chunk bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = static_cast<std::byte>(noise ? generator() : i / 97 + i % 5);
    }
    return bytes;
}

Chunk packed(const Chunk &bytes, const char *codec, int level, int shuffle, std::size_t number, std::size_t block) {
    Chunk chunk(bytes.size() + BLOSC_MAX_OVERHEAD);
    const int size = blosc_compress_ctx(level, shuffle, number, bytes.size(), bytes.data(), chunk.data(), chunk.size(),
                                        codec, block, 1);
    EXPECT_GE(size, BLOSC_MIN_HEADER_LENGTH);
    chunk.resize(static_cast<std::size_t>(size));
    return chunk;
}

std::string refusal(const Chunk &chunk, std::size_t size) {
    Chunk out(size), scratch;
    try {
        unpack_blosc(chunk, out, scratch);
    } catch (const std::runtime_error &error) {
        return error.what();
    }
    return "nothing was refused";
}

TEST(Blosc, IsUnpackedWhateverItsBlocksAre) {
    Chunk scratch;
    int split = 0, whole = 0, copied = 0;
    for (const std::size_t size : {0U, 1U, 15U, 128U, 1000U, 2048U, 4096U, 131072U, 131079U}) {
        for (const bool noise : {false, true}) {
            for (const std::size_t number : {1U, 2U, 3U, 4U, 8U, 12U, 17U}) {
                for (const std::size_t block : {0U, 128U, 1024U, 1U << 20U}) {
                    for (const int shuffle : {BLOSC_NOSHUFFLE, BLOSC_SHUFFLE}) {
                        for (const char *codec : {BLOSC_LZ4_COMPNAME, BLOSC_LZ4HC_COMPNAME}) {
                            const Chunk bytes = content(size, noise);
                            const Chunk chunk = packed(bytes, codec, 5, shuffle, number, block);
                            Chunk out(size, std::byte{7});
                            unpack_blosc(chunk, out, scratch);
                            ASSERT_EQ(out, bytes) << size << " " << number << " " << block;
                            const auto flags = std::to_integer<unsigned>(chunk[2]);
                            ++((flags & BLOSC_MEMCPYED) != 0 ? copied : (flags & 0x10U) != 0 ? whole : split);
                        }
                    }
                }
            }
        }
    }
    EXPECT_GT(split, 100);
    EXPECT_GT(whole, 100);
    EXPECT_GT(copied, 100);
}

TEST(Blosc, OfOtherCodecsIsRefusedByName) {
    const Chunk bytes = content(4096, false);
    EXPECT_EQ(refusal(packed(bytes, BLOSC_BLOSCLZ_COMPNAME, 5, BLOSC_SHUFFLE, 4, 0), bytes.size()),
              "a Blosc chunk of it is packed by blosclz, only lz4 with shuffled bytes is read");
    EXPECT_EQ(refusal(packed(bytes, BLOSC_ZLIB_COMPNAME, 5, BLOSC_SHUFFLE, 4, 0), bytes.size()),
              "a Blosc chunk of it is packed by zlib, only lz4 with shuffled bytes is read");
    EXPECT_EQ(refusal(packed(bytes, BLOSC_LZ4_COMPNAME, 5, BLOSC_BITSHUFFLE, 4, 0), bytes.size()),
              "a Blosc chunk of it is packed by lz4 with shuffled bits, only lz4 with shuffled bytes is read");
}

TEST(Blosc, OfAnotherSizeIsRefused) {
    const Chunk bytes = content(4096, false), chunk = packed(bytes, BLOSC_LZ4_COMPNAME, 5, BLOSC_SHUFFLE, 4, 0);
    for (const std::size_t size : {0U, 4095U, 4097U, 1U << 20U}) {
        EXPECT_EQ(refusal(chunk, size), "a Blosc chunk of it is damaged");
    }
    for (std::size_t size = 0; size < chunk.size(); ++size) {
        EXPECT_EQ(refusal(Chunk(chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(size)), bytes.size()),
                  "a Blosc chunk of it is damaged")
            << size;
    }
}

} // namespace
} // namespace sfumato
