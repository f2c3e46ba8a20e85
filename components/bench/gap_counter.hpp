// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace bench {

/// Counts gaps in the numbers that a producer gives to its samples, and which of them are filled late. One
/// that has arrived before, or is thousands older than the newest, means that the
/// producer was restarted. Allocates nothing.
class GapCounter {
 public:
  void note(std::uint64_t sequence) {
    if (next_ > 0 && sequence < next_ && next_ - sequence <= kWindow && !seen(sequence)) {
      mark(sequence, true);
      --lost_;
      ++late_;
      return;
    }
    if (next_ > 0 && sequence >= next_) {
      lost_ += sequence - next_;
      for (std::uint64_t missing = std::max(next_, sequence - std::min(sequence, kWindow));
           missing < sequence; ++missing)
        mark(missing, false);
    }
    mark(sequence, true);
    next_ = sequence + 1;
  }
  /// Numbers below the newest that have not arrived.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Numbers that arrived after a newer one.
  [[nodiscard]] std::uint64_t late() const { return late_; }

 private:
  static constexpr std::uint64_t kWindow = 16'384;
  static constexpr std::uint64_t kBits = 64;

  [[nodiscard]] bool seen(std::uint64_t sequence) const {
    return (words_[word_of(sequence)] >> (sequence % kBits) & 1U) != 0;
  }
  void mark(std::uint64_t sequence, bool arrived) {
    const std::uint64_t bit = std::uint64_t{1} << (sequence % kBits);
    std::uint64_t& word = words_[word_of(sequence)];
    word = arrived ? word | bit : word & ~bit;
  }
  static std::size_t word_of(std::uint64_t sequence) { return (sequence % kWindow) / kBits; }

  std::uint64_t next_ = 0;  ///< 0: none has arrived
  std::uint64_t lost_ = 0;
  std::uint64_t late_ = 0;
  std::array<std::uint64_t, kWindow / kBits> words_{};  ///< a bit for each of the newest numbers
};

}  // namespace bench
