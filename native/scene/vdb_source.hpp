// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a .vdb file. Whatever a file claims of itself, nothing is read or allocated beyond what is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

namespace sfumato {

// A place in a file, from which is read onwards. Numbers are little-endian in files, as on every machine that is built
// for. All throw std::runtime_error, which names the part, where the file or what of it was chosen by hold() ends
// early.
class VdbSource {
public:
    explicit VdbSource(const std::string &path);
    // What is read from now on, as it follows "its" in what is thrown.
    void name_part(const std::string &name) { part = name; }

    template <typename Number>
    Number number() {
        static_assert(std::is_arithmetic_v<Number>);
        Number value{};
        std::memcpy(&value, take(sizeof value), sizeof value);
        return value;
    }
    // A length and so many characters.
    std::string text();
    // The next bytes, which are valid until the next call; after hold(), until the next hold().
    const std::byte *take(std::int64_t count);
    void skip(std::int64_t count);
    void seek(std::int64_t position);

    // Reads all up to `end` into memory, and nothing behind it from now on. Read, not mapped: where another program
    // overwrites a file that is mapped, as a farm does with a cache that someone looks at, the next access to it kills.
    void hold(std::int64_t end);

    [[nodiscard]] std::int64_t position() const { return at; }
    [[nodiscard]] std::int64_t size() const { return length; }

private:
    [[noreturn]] void fail() const;
    void require(std::int64_t count) const;
    void load(std::int64_t count);

    std::ifstream stream;
    std::string part = "header";
    std::int64_t length = 0; // of the file
    std::int64_t at = 0;
    std::int64_t end = 0;          // nothing is read from here on
    std::vector<std::byte> window; // a part of the file, in memory
    std::int64_t window_first = 0;
};

} // namespace sfumato
