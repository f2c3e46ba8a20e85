// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace segue::cdtn {

/// Names as dense numbers, in the order they came. Not thread safe; reading is, while nobody adds.
class NameTable {
 public:
  NameTable() = default;
  NameTable(const NameTable& other) { *this = other; }
  NameTable(NameTable&&) = default;
  NameTable& operator=(NameTable&&) = default;
  NameTable& operator=(const NameTable& other) {
    if (this == &other) return *this;
    names_.clear();
    numbers_.clear();
    for (const std::string& name : other.names_)
      intern(name);
    return *this;
  }
  ~NameTable() = default;

  /// The number of `name`, a new one if it has none.
  std::uint32_t intern(std::string_view name) {
    const auto found = numbers_.find(name);
    if (found != numbers_.end()) return found->second;
    const auto number = static_cast<std::uint32_t>(names_.size());
    numbers_.emplace(names_.emplace_back(name), number);
    return number;
  }
  [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const {
    const auto found = numbers_.find(name);
    if (found == numbers_.end()) return std::nullopt;
    return found->second;
  }
  /// Requires number < size().
  [[nodiscard]] const std::string& name(std::uint32_t number) const { return names_[number]; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }

 private:
  std::deque<std::string> names_;  // elements stay where they are, so the map may view them
  std::unordered_map<std::string_view, std::uint32_t> numbers_;
};

}  // namespace segue::cdtn
