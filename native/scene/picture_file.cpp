// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/picture_file.hpp"

#include "scene/any_file.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

namespace sfumato {
namespace {

constexpr std::int64_t BAND = std::int64_t{1} << 24; // bytes that are decoded at once, where rows allow
constexpr std::int64_t LONGEST_ROWS = std::int64_t{1}
                                      << 30; // bytes of a row of pixels or tiles; 16K has 2^20 a channel

// By the name of the file, from "tiff:tif,tiff,tx;png:png;...".
bool known_format(const std::string &path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    const std::string formats = OIIO::get_string_attribute("extension_list");
    for (const auto &format : OIIO::Strutil::splitsv(formats, ";")) {
        for (const auto &known : OIIO::Strutil::splitsv(format.substr(format.find(':') + 1), ",")) {
            if (!extension.empty() && OIIO::Strutil::iequals(known, extension.substr(1))) {
                return true;
            }
        }
    }
    return false;
}

[[noreturn]] void refuse(std::string_view why) {
    // On one line, and without the full stop that we set or do not.
    std::string text(OIIO::Strutil::strip(why, " \n."));
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw std::runtime_error(text.empty() ? "its pixels cannot be decoded" : text);
}

// All pixels of the part that the input is at, thrown away.
void decode(OIIO::ImageInput &input) {
    const OIIO::ImageSpec &spec = input.spec();
    if (spec.deep) {
        return; // lists of samples, which nothing that renders pictures writes
    }
    const bool tiled = spec.tile_width > 0;
    const std::int64_t row = std::int64_t{spec.width} * static_cast<std::int64_t>(spec.pixel_bytes(true));
    const std::int64_t least = tiled ? spec.tile_height : 1;
    if (spec.width < 1 || spec.height < 1 || row > LONGEST_ROWS / least) {
        refuse("it claims to have " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels");
    }
    const std::int64_t rows =
        std::min<std::int64_t>(std::max<std::int64_t>(BAND / (row * least), 1) * least, spec.height);
    std::vector<std::byte> band(static_cast<std::size_t>(row * rows));
    const int left = spec.x, right = spec.x + spec.width, bottom = spec.y + spec.height;
    for (int y = spec.y; y < bottom; y += static_cast<int>(rows)) {
        const int next = std::min(y + static_cast<int>(rows), bottom);
        const auto any = OIIO::TypeDesc::UNKNOWN; // as it is in the file
        const bool whole = tiled ? input.read_tiles(input.current_subimage(), 0, left, right, y, next, spec.z,
                                                    spec.z + 1, 0, spec.nchannels, any, band.data())
                                 : input.read_scanlines(input.current_subimage(), 0, y, next, spec.z, 0, spec.nchannels,
                                                        any, band.data());
        if (!whole || input.has_error()) { // of TIFF and JPEG the rest is made up, and told as read
            refuse(input.geterror());
        }
    }
}

void require_whole(const std::string &path) {
    regular_file_bytes(path);
    const auto input = OIIO::ImageInput::open(path);
    if (!input) {
        const std::string why = OIIO::geterror(); // always asked for: it would be told to the next who asks
        if (known_format(path)) {
            refuse(why);
        }
        return;
    }
    for (int part = 0; input->seek_subimage(part, 0); ++part) {
        decode(*input);
    }
    static_cast<void>(input->geterror()); // that there is no further part
}

} // namespace

std::optional<std::string> unreadable(const std::string &path) {
    const auto reason = [&](const std::string &why) { return "'" + path + "' cannot be read whole: " + legible(why); };
    try {
        require_whole(path);
    } catch (const std::bad_alloc &) {
        return reason("there is no memory for it");
    } catch (const std::exception &error) {
        return reason(error.what());
    }
    return std::nullopt;
}

} // namespace sfumato
