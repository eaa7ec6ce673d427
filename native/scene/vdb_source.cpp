// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vdb_source.hpp"

#include "scene/any_file.hpp"

#include <algorithm>
#include <stdexcept>

namespace sfumato {
namespace {

constexpr std::int64_t WINDOW = 1 << 14;
constexpr std::uint32_t LONGEST_TEXT = 1 << 12; // names and types; no file has one of a kilobyte

} // namespace

VdbSource::VdbSource(const std::string &path) {
    length = end = regular_file_bytes(path);
    stream.open(path, std::ios::binary);
    if (!stream) {
        throw std::runtime_error("it cannot be opened");
    }
}

void VdbSource::fail() const {
    throw std::runtime_error("its " + part + " is cut short");
}

void VdbSource::require(std::int64_t count) const {
    if (count < 0 || count > end - at) {
        fail();
    }
}

void VdbSource::load(std::int64_t count) {
    window.resize(static_cast<std::size_t>(count));
    window_first = at;
    stream.seekg(at);
    if (!stream.read(reinterpret_cast<char *>(window.data()), count)) {
        fail();
    }
}

const std::byte *VdbSource::take(std::int64_t count) {
    require(count);
    const auto held = window_first + static_cast<std::int64_t>(window.size());
    if (at < window_first || count > held - at) {
        load(std::max(count, std::min(WINDOW, end - at)));
    }
    const std::byte *bytes = window.data() + (at - window_first);
    at += count;
    return bytes;
}

void VdbSource::skip(std::int64_t count) {
    require(count);
    at += count;
}

void VdbSource::seek(std::int64_t position) {
    if (position < 0 || position > length) {
        fail();
    }
    at = position;
    end = length;
}

std::string VdbSource::text() {
    const auto count = number<std::uint32_t>();
    require(count);
    if (count > LONGEST_TEXT) {
        throw std::runtime_error("its " + part + " is damaged: a name has " + std::to_string(count) + " bytes");
    }
    return {reinterpret_cast<const char *>(take(count)), count};
}

void VdbSource::hold(std::int64_t new_end) {
    if (new_end < at || new_end > length) {
        fail();
    }
    end = new_end;
    load(end - at);
}

} // namespace sfumato
