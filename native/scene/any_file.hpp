// SPDX-License-Identifier: GPL-3.0-or-later
// What all that read files have in common.
#pragma once

#include <cstdint>
#include <string>

namespace sfumato {

// Of a file that can be read and holds something. Throws std::runtime_error, which says what it is instead, as it
// follows a name and a colon.
std::int64_t regular_file_bytes(const std::string &path);

// A text that may be of a file, for people: what is no letter is a question mark. UTF-8, always.
std::string legible(const std::string &text);

} // namespace sfumato
