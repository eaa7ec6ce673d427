// SPDX-License-Identifier: GPL-3.0-or-later
// Chunks as Blosc itself packs them.
#include "scene/vdb_blosc.hpp"

#include <algorithm>
#include <cstring>
#include <random>
#include <span>
#include <stdexcept>
#include <string>

#include <blosc.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

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

// Bytes behind which nothing can be read: sanitizers do not look into LZ4, but the processor does.
class Guarded {
public:
    explicit Guarded(const Chunk &bytes) {
        const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
        before = (bytes.size() + page - 1) / page * page;
        whole = before + page;
        start = ::mmap(nullptr, whole, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        auto *guard = static_cast<std::byte *>(start) + before;
        EXPECT_EQ(::mprotect(guard, page, PROT_NONE), 0);
        held = {std::copy_backward(bytes.begin(), bytes.end(), guard), bytes.size()}; // up to the guard
    }
    Guarded(const Guarded &) = delete;
    Guarded &operator=(const Guarded &) = delete;
    ~Guarded() { ::munmap(start, whole); }

    std::span<const std::byte> held;

private:
    void *start = nullptr;
    std::size_t before = 0, whole = 0;
};

std::string refusal(const Chunk &chunk, std::size_t size) {
    Chunk out(size), scratch;
    const Guarded guarded(chunk);
    try {
        unpack_blosc(guarded.held, out, scratch);
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
}

// Also where its header says that it is as short as it is.
TEST(Blosc, CutShortIsRefused) {
    for (const std::size_t block : {0U, 1024U}) {
        const Chunk bytes = content(4096, false), chunk = packed(bytes, BLOSC_LZ4_COMPNAME, 5, BLOSC_SHUFFLE, 4, block);
        for (std::uint32_t size = 0; size < chunk.size(); ++size) {
            Chunk cut(chunk.begin(), chunk.begin() + size);
            EXPECT_EQ(refusal(cut, bytes.size()), "a Blosc chunk of it is damaged") << size;
            if (size >= BLOSC_MIN_HEADER_LENGTH) {
                std::memcpy(&cut[12], &size, sizeof size);
                EXPECT_EQ(refusal(cut, bytes.size()), "a Blosc chunk of it is damaged") << size;
            }
        }
    }
}

TEST(Blosc, DamagedReadsNothingBehindItsEnd) {
    std::mt19937 generator(5);
    const Chunk bytes = content(4096, false), chunk = packed(bytes, BLOSC_LZ4_COMPNAME, 5, BLOSC_SHUFFLE, 4, 1024);
    int refused = 0;
    for (int i = 0; i < 5000; ++i) {
        Chunk other = chunk;
        for (auto left = generator() % 4 + 1; left > 0; --left) {
            other[generator() % (i % 2 == 0 ? 64 : other.size())] = static_cast<std::byte>(generator());
        }
        refused += refusal(other, bytes.size()) == "nothing was refused" ? 0 : 1;
    }
    EXPECT_GT(refused, 2000);
}

} // namespace
} // namespace sfumato
