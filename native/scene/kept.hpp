// SPDX-License-Identifier: GPL-3.0-or-later
// Parts with identity: what was made from the same inputs before is not made again.
#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace sfumato {

// All that a part was made from: other parts, by their addresses, and numbers, by their bytes. A key keeps the parts
// alive, so that no address stands for two of them.
class Key {
public:
    Key &part(std::shared_ptr<const void> input) {
        parts_.push_back(std::move(input));
        return *this;
    }
    // Of types without padding, whose bytes are their value.
    template <typename Number>
    requires std::is_arithmetic_v<Number> || std::is_enum_v<Number> Key &numbers(std::span<const Number> values) {
        const std::size_t size = values.size_bytes(); // so that no two rows of lists run together alike
        numbers_.append(reinterpret_cast<const char *>(&size), sizeof size);
        numbers_.append(reinterpret_cast<const char *>(values.data()), size);
        return *this;
    }
    template <typename... Number>
    requires((std::is_arithmetic_v<Number> || std::is_enum_v<Number>)&&...) Key &number(Number... values) {
        (numbers(std::span<const Number>(&values, 1)), ...);
        return *this;
    }

    friend bool operator<(const Key &a, const Key &b) {
        return std::tie(a.parts_, a.numbers_) < std::tie(b.parts_, b.numbers_);
    }

private:
    std::vector<std::shared_ptr<const void>> parts_;
    std::string numbers_;
};

// Parts of one kind. What a round of work did not ask for is forgotten at its end.
template <typename Part>
class Kept {
public:
    // The part of this key, made by `make` where there is none. `make` returns a Part or a shared pointer to one.
    template <typename Make>
    std::shared_ptr<const Part> get(const Key &key, const Make &make) {
        Entry &entry = entries_[key];
        if (!entry.part) {
            if constexpr (std::is_convertible_v<std::invoke_result_t<Make>, std::shared_ptr<const Part>>) {
                entry.part = make();
            } else {
                entry.part = std::make_shared<const Part>(make());
            }
            ++made_;
        }
        entry.asked_for = true;
        return entry.part;
    }

    void end_round() {
        for (auto entry = entries_.begin(); entry != entries_.end();) {
            entry = std::exchange(entry->second.asked_for, false) ? std::next(entry) : entries_.erase(entry);
        }
    }

    [[nodiscard]] std::size_t made() const { return made_; } // ever

private:
    struct Entry {
        std::shared_ptr<const Part> part;
        bool asked_for = false; // in this round
    };
    std::map<Key, Entry> entries_;
    std::size_t made_ = 0;
};

} // namespace sfumato
