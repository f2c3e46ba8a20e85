// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

namespace segue::solve::detail {

inline constexpr int kNone = -1;

/// A number as a position in an array.
inline std::size_t as_index(int number) {
  return static_cast<std::size_t>(number);
}

/// Finds numbers by hash; the caller compares the objects that they stand for. Uses open addressing in one
/// block of memory, because looking up every name of two networks is most of the solver's work.
class HashIndex {
 public:
  explicit HashIndex(std::size_t expected) {
    std::size_t size = 16;
    while (size < expected * 2)
      size *= 2;
    slots_.resize(size);
  }

  /// The number with this hash for which `equal(number)` is true, or kNone.
  template <class Equal>
  [[nodiscard]] int find(std::size_t hash, const Equal& equal) const {
    const auto tag = static_cast<std::uint32_t>(hash);
    for (std::size_t at = place(hash); slots_[at].number != kNone; at = next(at)) {
      if (slots_[at].tag == tag && equal(slots_[at].number)) return slots_[at].number;
    }
    return kNone;
  }

  /// Visits every number that may have this hash, and possibly others.
  template <class Visit>
  void each(std::size_t hash, const Visit& visit) const {
    (void)find(hash, [&](int number) {
      visit(number);
      return false;
    });
  }

  /// Adds a number; there must be no equal one yet.
  void insert(std::size_t hash, int number) {
    if ((count_ + 1) * 2 > slots_.size()) grow();
    put({static_cast<std::uint32_t>(hash), number});
    ++count_;
  }

 private:
  struct Slot {
    std::uint32_t tag = 0;
    int number = kNone;
  };

  [[nodiscard]] std::size_t place(std::size_t hash) const {
    return static_cast<std::uint32_t>(hash) & (slots_.size() - 1);
  }
  [[nodiscard]] std::size_t next(std::size_t at) const { return (at + 1) & (slots_.size() - 1); }

  void put(Slot slot) {
    std::size_t at = place(slot.tag);
    while (slots_[at].number != kNone)
      at = next(at);
    slots_[at] = slot;
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.number != kNone) put(slot);
    }
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

/// Maps names to numbers from 0, in the order of their first use. The texts must outlive it.
class Interner {
 public:
  explicit Interner(std::size_t expected) : index_(expected) { names_.reserve(expected); }

  int intern(std::string_view name) {
    const std::size_t hash = std::hash<std::string_view>{}(name);
    const int known = find(name, hash);
    if (known != kNone) return known;
    names_.push_back(name);
    const int number = static_cast<int>(names_.size()) - 1;
    index_.insert(hash, number);
    return number;
  }

  [[nodiscard]] int find(std::string_view name) const {
    return find(name, std::hash<std::string_view>{}(name));
  }
  [[nodiscard]] std::size_t size() const { return names_.size(); }

 private:
  [[nodiscard]] int find(std::string_view name, std::size_t hash) const {
    return index_.find(hash, [&](int number) { return names_[as_index(number)] == name; });
  }

  HashIndex index_;
  std::vector<std::string_view> names_;
};

}  // namespace segue::solve::detail
