// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged .vdb files: each is read or refused, in time, in bounded memory, by name. The same damages in each run; with
// --minutes=N, others for so long. Only what is ours reads them.
#include "scene/volume_file.hpp"
#include "support/vdb_grids.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iostream>
#include <map>
#include <new>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <malloc.h>

namespace {

// All that is allocated by new. The size of an answer may be claimed by a few bytes, so it is not bounded by the
// file's.
constexpr std::size_t MOST_MEMORY = std::size_t{1} << 28;
std::atomic<std::size_t> memory{0}, peak{0};
double minutes = 0.0;

} // namespace

void *operator new(std::size_t size) {
    void *place = memory + size > MOST_MEMORY ? nullptr : std::malloc(size);
    if (place == nullptr) {
        throw std::bad_alloc();
    }
    const std::size_t now = memory += malloc_usable_size(place);
    for (std::size_t before = peak; before < now && !peak.compare_exchange_weak(before, now);) {
    }
    return place;
}
void operator delete(void *place) noexcept {
    if (place != nullptr) {
        memory -= malloc_usable_size(place);
        std::free(place);
    }
}
void operator delete(void *place, std::size_t) noexcept {
    operator delete(place);
}

namespace sfumato {
namespace {

using namespace vdb_testing;
using Clock = std::chrono::steady_clock;

constexpr double MOST_SECONDS = 2.0; // of all processors: other programs take none of them
double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Whole files of all compressions and kinds. Small, so that damages meet each of their parts.
std::vector<std::string> seeds(const std::string &path) {
    std::vector<std::string> files;
    const auto add = [&] { files.push_back(bytes_of(path)); };
    for (const std::uint32_t compression : COMPRESSIONS) {
        for (const bool half : {false, true}) {
            const auto grid = varied_grid<openvdb::FloatGrid>(half ? 0.25F : 0.0F, half);
            grid->setSaveFloatAsHalf(half);
            write(path, {grid}, compression, half);
            add();
        }
        const auto flags = varied_grid<openvdb::BoolGrid>(false);
        flags->setName("flags");
        const auto smoke = varied_grid<openvdb::DoubleGrid>(0.0, false);
        write_streamed(path, {flags, smoke}, compression);
        add();
        const auto small = openvdb::FloatGrid::create();
        small->setName("density");
        small->tree().setValueOn({1, 2, 3}, 1.0F);
        small->setTransform(openvdb::math::Transform::createLinearTransform(openvdb::math::Mat4d::identity()));
        const auto other = openvdb::gridPtrCast<openvdb::FloatGrid>(small->copyGrid());
        other->setName("other");
        write(path, {other, small}, compression);
        add();
    }
    return files;
}

class Damage {
public:
    explicit Damage(std::uint32_t seed) : generator(seed) {}

    std::string of(std::string bytes) {
        const std::size_t whole = bytes.size();
        for (auto left = below(2) == 0 ? 1 : below(8) + 1; left > 0 && !bytes.empty(); --left) {
            once(bytes);
        }
        if (bytes.size() != whole && below(2) == 0) { // so that the next check is met too
            replace_number(bytes, static_cast<std::int64_t>(whole), static_cast<std::int64_t>(bytes.size()));
        }
        return bytes;
    }

private:
    std::size_t below(std::size_t end) { return generator() % end; }

    // Often in the header, in which is most to be wrong.
    std::size_t place(const std::string &bytes) {
        const std::size_t end = below(3) == 0 ? std::min<std::size_t>(bytes.size(), 1500) : bytes.size();
        return below(end);
    }

    static void replace_number(std::string &bytes, std::int64_t from, std::int64_t to) {
        const std::string old(reinterpret_cast<const char *>(&from), sizeof from);
        if (const auto at = bytes.find(old); at != std::string::npos) {
            std::memcpy(&bytes[at], &to, sizeof to);
        }
    }

    void once(std::string &bytes) {
        const std::size_t at = place(bytes), rest = bytes.size() - at;
        const std::size_t length = std::min(below(2) == 0 ? below(16) + 1 : below(3000) + 1, rest);
        switch (below(10)) {
        case 0:
        case 1:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
            break;
        case 2:
            bytes[at] = static_cast<char>(below(256));
            break;
        case 3:
        case 4:
        case 5:
            write_boundary(bytes, at);
            break;
        case 6:
            bytes.resize(at + (below(4) == 0 ? 0 : rest - std::min<std::size_t>(rest, below(64))));
            break;
        case 7:
            bytes.replace(place(bytes), 0, bytes.substr(at, length));
            break; // a copy between others
        case 8:
            bytes.erase(at, length);
            break;
        default: { // a copy over others, or nothing
            const std::size_t to = place(bytes), fits = std::min(length, bytes.size() - to);
            const std::string part =
                below(3) == 0 ? std::string(fits, below(2) == 0 ? '\0' : '\xff') : bytes.substr(at, fits);
            bytes.replace(to, std::min(fits, part.size()), part);
        }
        }
    }

    void write_boundary(std::string &bytes, std::size_t at) {
        const auto size = static_cast<std::int64_t>(bytes.size());
        const std::int64_t numbers[] = {0,         1,          -1,         2,          size,       size - 1,
                                        size + 1,  INT32_MAX,  INT32_MIN,  UINT32_MAX, INT64_MAX,  INT64_MIN,
                                        -size,     512,        32768,      4096,       -4096,      1LL << 40,
                                        INT16_MAX, -(1 << 20), 0x7f800000, 0x7fc00000, 0x3f800000, 1 << 28};
        const std::int64_t number = numbers[below(std::size(numbers))];
        const std::size_t width = std::min(std::size_t{1} << below(4), bytes.size() - at);
        std::memcpy(&bytes[at], &number, width);
    }

    std::mt19937 generator;
};

struct Count {
    std::size_t files = 0, read = 0, refused = 0, most_memory = 0;
    double most_seconds = 0.0;
    std::map<std::string, int> refusals; // without numbers
};

void require_sound(const VolumeFile &volume) {
    const glm::dvec3 n(volume.resolution);
    ASSERT_EQ(static_cast<double>(volume.density.size()), n.x * n.y * n.z);
    ASSERT_TRUE(
        std::all_of(volume.density.begin(), volume.density.end(), [](float value) { return value - value == 0; }));
}

void require_sound(const VolumeBlocks &volume) {
    for (const CellBlock &block : volume.blocks) {
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(block.first[axis], 0);
            ASSERT_GT(block.size[axis], 0);
            ASSERT_LE(block.size[axis], volume.resolution[axis] - block.first[axis]);
        }
        const glm::ivec3 last = block.size - 1;
        for (const glm::ivec3 &at : {glm::ivec3(0), last, glm::ivec3(last.x, 0, 0), glm::ivec3(0, last.y, 0)}) {
            const float value = block.values[at.x * block.strides.x + at.y * block.strides.y + at.z * block.strides.z];
            ASSERT_TRUE(std::isfinite(value) && value <= 1e30F);
        }
    }
}

void require_sound(const VolumeHeader &) {}

// The refusal's reason, its numbers left out.
std::string kind_of(std::string why) {
    std::erase_if(why, [](char letter) { return letter < ' ' || letter > '~' || (letter >= '0' && letter <= '9'); });
    if (const auto name = why.find('\''); name != std::string::npos) {
        why.erase(name, why.rfind('\'') - name + 1);
    }
    return why.substr(0, 18);
}

template <typename Read>
void require_read_or_refused(const Read &read, const std::string &path, std::size_t bytes, Count &count) {
    const std::size_t before = memory;
    peak = before;
    const double start = processor_seconds();
    double cells = -1.0;
    try {
        const auto volume = read(path, "density");
        cells = glm::dvec3(volume.resolution).x * glm::dvec3(volume.resolution).y * glm::dvec3(volume.resolution).z;
        require_sound(volume);
        ++count.read;
    } catch (const std::runtime_error &error) {
        const std::string what = error.what(), lead = "'" + path + "' cannot be read: ";
        ASSERT_EQ(what.find(lead), 0U) << what;
        const std::string why = what.substr(lead.size());
        ASSERT_TRUE(why.starts_with("it") || why.starts_with("a ") || why.starts_with("two nodes of it")) << what;
        ASSERT_EQ(what.find("there is no memory for it"), std::string::npos) << what;
        ++count.refused;
        ++count.refusals[kind_of(why)];
    }
    const double seconds = processor_seconds() - start;
    count.most_seconds = std::max(count.most_seconds, seconds);
    ASSERT_LT(seconds, MOST_SECONDS);
    if (cells >= 0.0) { // else the box is not known
        const std::size_t used = peak - before;
        // A node of 1,030 bytes can say one value for 4096 tiles of 20, and a vector that grows is there twice.
        ASSERT_LT(static_cast<double>(used), 8.0 * cells + 256.0 * static_cast<double>(bytes) + 1e6);
        count.most_memory = std::max(count.most_memory, used);
    }
}

TEST(Vdb, DamagedIsReadOrRefused) {
    openvdb::initialize();
    const Folder folder("vdb_fuzz_test");
    const std::string path = folder.path();
    const std::vector<std::string> whole = seeds(path);
    Count count;
    for (const std::string &bytes : whole) {
        write_bytes(path, bytes);
        ASSERT_NO_THROW(read_volume(path, "density"));
    }
    const auto start = Clock::now();
    constexpr std::uint32_t in_suite = 2500;
    const auto goes_on = [&](std::uint32_t file) {
        return minutes > 0.0 ? Clock::now() - start < std::chrono::duration<double>(60.0 * minutes) : file < in_suite;
    };
    const std::uint32_t first = minutes > 0.0 ? 1000000 : 0;
    for (std::uint32_t file = 0; goes_on(file); ++file) {
        SCOPED_TRACE("seed " + std::to_string(first + file));
        const std::string bytes = Damage(first + file).of(whole[file % whole.size()]);
        write_bytes(path, bytes);
        ASSERT_NO_FATAL_FAILURE(require_read_or_refused(read_volume_header, path, bytes.size(), count));
        ASSERT_NO_FATAL_FAILURE(require_read_or_refused(read_volume, path, bytes.size(), count));
        ASSERT_NO_FATAL_FAILURE(require_read_or_refused(read_volume_blocks, path, bytes.size(), count));
        ++count.files;
    }
    std::cout << count.files << " damaged files: " << count.read << " answers, " << count.refused
              << " refusals; at most " << count.most_seconds << " s and " << count.most_memory << " bytes\n";
    for (const auto &[why, times] : count.refusals) {
        std::cout << "  " << times << "  " << why << '\n';
    }
    EXPECT_GT(count.read, count.files / 10); // it goes on behind the first check
    EXPECT_GT(count.refused, count.files);
    EXPECT_GT(count.refusals.size(), 15U);
}

} // namespace
} // namespace sfumato

int main(int count, char **arguments) {
    testing::InitGoogleTest(&count, arguments);
    const std::string flag = "--minutes=";
    if (count == 2 && std::string(arguments[1]).starts_with(flag)) {
        minutes = std::strtod(arguments[1] + flag.size(), nullptr);
    }
    return RUN_ALL_TESTS();
}
