// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// Interns names as dense numbers, in the order of their first use. References to names stay valid. Not
/// thread safe, but several threads may read while none adds.
class NameTable {
 public:
  /// The number of `name`, a new one if it has none.
  std::uint32_t intern(std::string_view name) {
    if (4 * (names_.size() + 1) > 3 * places_.size()) grow();
    Place& place = places_[find_place(name, hash_of(name))];
    if (place.number == kFree) {
      place = {hash_of(name), static_cast<std::uint32_t>(names_.size())};
      names_.emplace_back(name);
    }
    return place.number;
  }
  [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const {
    if (places_.empty()) return std::nullopt;
    const Place& place = places_[find_place(name, hash_of(name))];
    if (place.number == kFree) return std::nullopt;
    return place.number;
  }
  /// Requires number < size().
  [[nodiscard]] const std::string& name(std::uint32_t number) const { return names_[number]; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }

 private:
  static constexpr std::uint32_t kFree = static_cast<std::uint32_t>(-1);
  struct Place {
    std::uint32_t hash = 0;
    std::uint32_t number = kFree;
  };
  static std::uint32_t hash_of(std::string_view name) {
    return static_cast<std::uint32_t>(std::hash<std::string_view>()(name));
  }

  /// The place of the name, or the free place where it belongs (open addressing, linear probing).
  [[nodiscard]] std::size_t find_place(std::string_view name, std::uint32_t hash) const {
    const std::size_t mask = places_.size() - 1;
    std::size_t at = hash & mask;
    while (places_[at].number != kFree && (places_[at].hash != hash || names_[places_[at].number] != name))
      at = (at + 1) & mask;
    return at;
  }

  void grow() {
    std::vector<Place> old(places_.empty() ? 16 : 2 * places_.size());
    old.swap(places_);
    const std::size_t mask = places_.size() - 1;
    for (const Place& place : old) {
      if (place.number == kFree) continue;
      std::size_t at = place.hash & mask;
      while (places_[at].number != kFree)
        at = (at + 1) & mask;
      places_[at] = place;
    }
  }

  std::deque<std::string> names_;
  std::vector<Place> places_;  ///< its size is a power of two; at least a quarter is free
};

}  // namespace segue::task_network
