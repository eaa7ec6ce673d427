// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in files, by OpenImageIO.
#pragma once

#include <optional>
#include <string>

namespace sfumato {

// Why a picture cannot be read whole, naming its file; nothing where all its parts and pixels can. Memory is a band of
// rows. Of a format that is not known here only whether there is a file that holds something: a frame of which nothing
// is known is not to be taken for a broken one.
std::optional<std::string> unreadable(const std::string &path);

} // namespace sfumato
