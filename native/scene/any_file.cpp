// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/any_file.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace sfumato {
namespace {

// How many bytes of UTF-8 the first letter has, or 0 where there is none.
std::size_t letter_bytes(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const unsigned lead = byte(0);
    const std::size_t count = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    std::uint32_t letter = count == 1 ? lead : lead & (0x7fU >> count);
    for (std::size_t i = 1; i < count; ++i) {
        if ((byte(i) & 0xc0U) != 0x80) {
            return 0;
        }
        letter = (letter << 6U) | (byte(i) & 0x3fU);
    }
    constexpr std::uint32_t shortest[] = {0x20, 0x80, 0x800, 0x10000};
    const bool no_lead = (lead >= 0x80 && lead < 0xc0) || lead >= 0xf8, surrogate = letter >= 0xd800 && letter < 0xe000;
    return no_lead || letter < shortest[count - 1] || letter == 0x7f || letter > 0x10ffff || surrogate ? 0 : count;
}

} // namespace

std::int64_t regular_file_bytes(const std::string &path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::runtime_error("there is no such file");
    }
    if (std::filesystem::is_directory(status)) {
        throw std::runtime_error("it is a directory");
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw std::runtime_error("it is no regular file");
    }
    const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
    if (bytes == 0) {
        throw std::runtime_error("it is empty");
    }
    return bytes;
}

std::string legible(const std::string &text) {
    std::string out;
    for (std::string_view left = text; !left.empty();) {
        const std::size_t bytes = letter_bytes(left);
        out += bytes == 0 ? "?" : left.substr(0, bytes);
        left.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    return out;
}

} // namespace sfumato
