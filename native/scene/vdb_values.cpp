// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vdb_values.hpp"

#include "scene/vdb_blosc.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

#include <glm/gtc/packing.hpp>
#include <zlib.h>

namespace sfumato {
namespace {

// What of a node's inactive values is stored: none of them, one or two and a mask that chooses, or all.
enum Inactive : std::int8_t {
    BACKGROUND,
    NEGATIVE_BACKGROUND,
    ONE,
    NEGATIVE_OR_BACKGROUND,
    ONE_OR_BACKGROUND,
    ONE_OR_OTHER,
    ALL,
};

float negative(float background, VdbScalar scalar) {
    return scalar == VdbScalar::BOOL ? 1.0F - background : -background;
}

// As many values as `out` has place for, of each the one channel that is read.
void to_floats(std::span<const std::byte> bytes, const VdbNumbers &numbers, bool halved, std::span<float> out) {
    const auto convert = [&](auto value, const auto &as_float) {
        const std::size_t stride = sizeof value * static_cast<std::size_t>(numbers.channels);
        const std::byte *from = bytes.data() + sizeof value * static_cast<std::size_t>(numbers.channel);
        for (float &number : out) {
            std::memcpy(&value, from, sizeof value);
            number = as_float(value);
            from += stride;
        }
    };
    const auto as_it_is = [](auto value) { return static_cast<float>(value); };
    if (halved) {
        return convert(std::uint16_t{}, [](std::uint16_t half) { return glm::unpackHalf1x16(half); });
    }
    switch (numbers.scalar) {
    case VdbScalar::FLOAT:
        return convert(float{}, as_it_is);
    case VdbScalar::DOUBLE:
        return convert(double{}, as_it_is);
    case VdbScalar::INT32:
        return convert(std::int32_t{}, as_it_is);
    case VdbScalar::INT64:
        return convert(std::int64_t{}, as_it_is);
    case VdbScalar::BOOL:
        return convert(std::uint8_t{}, [](std::uint8_t value) { return value != 0 ? 1.0F : 0.0F; });
    case VdbScalar::NONE:
        break;
    }
    throw std::logic_error("what is not known cannot be read");
}

void unzip(std::span<const std::byte> chunk, std::span<std::byte> out) {
    uLongf size = out.size();
    const int status = uncompress(reinterpret_cast<Bytef *>(out.data()), &size,
                                  reinterpret_cast<const Bytef *>(chunk.data()), chunk.size());
    if (status != Z_OK || size != out.size()) {
        throw std::runtime_error("a zip chunk of it is damaged");
    }
}

} // namespace

int VdbMask::count() const {
    int sum = 0;
    for (int index = 0; index < words; ++index) {
        sum += std::popcount(word(index));
    }
    return sum;
}

float read_value(VdbSource &source, const VdbNumbers &numbers) {
    const std::byte *bytes = source.take(numbers.bytes);
    float value = 0.0F;
    if (numbers.scalar != VdbScalar::NONE) {
        to_floats({bytes, static_cast<std::size_t>(numbers.bytes)}, numbers, false, {&value, 1});
    }
    return value;
}

VdbValues find_values(VdbSource &source, const VdbNumbers &numbers, const VdbMask &active, float background) {
    VdbValues values;
    values.active = active;
    const auto inactive = source.number<std::int8_t>();
    if (inactive < BACKGROUND || inactive > ALL) {
        throw std::runtime_error("a node of it says " + std::to_string(inactive) + " of its inactive values");
    }
    values.inactive[0] = inactive == BACKGROUND ? background : negative(background, numbers.scalar);
    values.inactive[1] = background;
    if (inactive == ONE || inactive == ONE_OR_BACKGROUND || inactive == ONE_OR_OTHER) {
        values.inactive[0] = read_value(source, numbers);
    }
    if (inactive == ONE_OR_OTHER) {
        values.inactive[1] = read_value(source, numbers);
    }
    if (inactive == NEGATIVE_OR_BACKGROUND || inactive == ONE_OR_BACKGROUND || inactive == ONE_OR_OTHER) {
        values.second = VdbMask(source, active.places());
    }
    const bool all = (numbers.compression & VDB_ACTIVE_ONLY) == 0 || inactive == ALL;
    values.stored = all ? active.places() : active.count();
    std::int64_t bytes = std::int64_t{values.stored} * numbers.bytes_in_nodes;
    const bool halved = numbers.bytes_in_nodes < numbers.bytes;
    if ((numbers.compression & (VDB_ZIP | VDB_BLOSC)) != 0 && !(halved && values.stored == 0)) {
        // The size of a chunk, or that of bytes which compression did not make fewer, as a negative number.
        const auto size = source.number<std::int64_t>();
        if (size <= 0 && size != -bytes) {
            throw std::runtime_error("a node of it has " + std::to_string(size) + " bytes instead of " +
                                     std::to_string(-bytes));
        }
        values.packed = size > 0;
        bytes = values.packed ? size : bytes;
    }
    values.data = {source.take(bytes), static_cast<std::size_t>(bytes)};
    return values;
}

VdbValues find_bools(VdbSource &source, const VdbMask &active) {
    source.skip(3 * sizeof(std::int32_t)); // where the leaf is, once more
    VdbValues values;
    values.inactive[1] = 1.0F;
    values.second = VdbMask(source, active.places());
    return values;
}

void VdbUnpacker::unpack(const VdbValues &values, std::span<float> out) {
    const auto count = static_cast<std::size_t>(values.stored);
    std::span<const std::byte> bytes = values.data;
    if (values.packed) {
        plain.resize(count * static_cast<std::size_t>(numbers.bytes_in_nodes));
        if ((numbers.compression & VDB_BLOSC) != 0) {
            unpack_blosc(bytes, plain, shuffled);
        } else {
            unzip(bytes, plain);
        }
        bytes = plain;
    }
    const bool halved = numbers.bytes_in_nodes < numbers.bytes;
    if (count == out.size()) {
        return to_floats(bytes, numbers, halved, out);
    }
    stored.resize(count);
    to_floats(bytes, numbers, halved, stored);
    std::fill(out.begin(), out.end(), values.inactive[0]);
    values.second.for_each([&](int place) { out[static_cast<std::size_t>(place)] = values.inactive[1]; });
    std::size_t next = 0;
    values.active.for_each([&](int place) { out[static_cast<std::size_t>(place)] = stored[next++]; });
}

} // namespace sfumato
