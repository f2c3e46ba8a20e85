// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace segue::link {

/// The places of a connection's samples on their way, by a policy, wherever the words lie: in this process,
/// or in memory that another one may fill with anything. A word is what it carries, never 0, and the low part
/// of its position, so that the reader sees whether it was overtaken. A reader or writer that dies inside a
/// function leaves every word whole.
class WordRing {
 public:
  using Word = std::uint64_t;  ///< 0: empty
  static constexpr unsigned kTokenBits = 42;
  enum class Push { Taken, Replaced, Refused };

  /// `words`: as many as places(); `head`: how many were ever put in, 0 at first like the words.
  WordRing(BufferKind kind, std::size_t size, std::atomic<Word>* words, std::atomic<std::uint64_t>* head)
      : kind_(kind), size_(places(kind, size)), words_(words), head_(head) {}
  static constexpr std::size_t places(BufferKind kind, std::size_t size) {
    return kind == BufferKind::Data ? 1 : size;
  }

  /// The writer; real-time safe. Replaced: `before` is the token that was pushed out.
  Push push(std::uint64_t token, std::uint64_t& before) noexcept;
  /// The writer: whether push() would refuse.
  [[nodiscard]] bool full() const noexcept {
    return kind_ == BufferKind::Buffer && word(next_).load(std::memory_order_acquire) != 0;
  }
  /// The reader; real-time safe: the token whose turn it is, 0 where nothing waits, or where words that make
  /// no sense are in the way.
  std::uint64_t pull() noexcept;
  /// The reader's thread, or any where the policy is data.
  [[nodiscard]] bool pending() const noexcept { return word(tail_).load(std::memory_order_seq_cst) != 0; }
  /// Data only, any thread but at most one: puts it in unless something waits. True: it waits now.
  bool offer(std::uint64_t token) noexcept;
  /// Takes the token at a place (below places()) out, 0 where there is none. The reader must not pull().
  std::uint64_t remove(std::size_t place) noexcept {
    return words_[place].exchange(0, std::memory_order_acq_rel) >> kPositionBits;
  }
  [[nodiscard]] std::size_t places() const noexcept { return size_; }

 private:
  static constexpr unsigned kPositionBits = 64 - kTokenBits;
  static constexpr Word kPositionMask = (Word{1} << kPositionBits) - 1;
  static Word pack(std::uint64_t token, std::uint64_t position) noexcept {
    return token << kPositionBits | (position & kPositionMask);
  }
  std::atomic<Word>& word(std::uint64_t position) const noexcept { return words_[position % size_]; }
  std::uint64_t pull_newest() noexcept;
  std::uint64_t pull_oldest() noexcept;
  std::uint64_t pull_next() noexcept;

  const BufferKind kind_;
  const std::size_t size_;
  std::atomic<Word>* const words_;
  std::atomic<std::uint64_t>* const head_;  ///< written by the writer
  alignas(64) std::uint64_t next_ = 0;      ///< the writer's own copy of *head_
  alignas(64) std::uint64_t tail_ = 0;      ///< the reader's: the next position
};

}  // namespace segue::link
