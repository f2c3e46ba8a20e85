// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace segue::sample_link {

/// A single-writer, single-reader queue of words for one buffer policy. The words may lie in this process or
/// in shared memory that another process can overwrite with anything. A word packs a token, which is never 0
/// and names a sample, with the low bits of its position, so that the reader notices when it was overtaken. A
/// reader or writer that dies inside a function leaves every word whole.
///
/// Memory order: each word has one owner of its token at any time: the one whose exchange or compare-exchange
/// took it out. tail_ and nonsense_ are relaxed, since one thread writes them, and others only look.
/// - R1: push() and offer() release the word, the reader acquires it, so whatever the writer wrote about a
///   sample before is visible after pull().
/// - R2: the reader releases a word that it empties, the writer acquires it, so its next sample comes after
///   the reader's use of the place.
/// - R3: with policy circular_buffer, the writer releases head_ after the word, so a reader that sees this
///   head sees the word, too, and cannot take the place for empty.
/// - R4: push(), offer() and pending() are sequentially consistent because they are one side of the wake-up
///   protocol: the writer stores a word and then loads who listens (N1 in task/port_access.hpp, H4 in
///   shared_ring.hpp), a reader that starts to listen stores that and then loads the word; at least one of
///   them sees the other's store.
class WordRing {
 public:
  using Word = std::uint64_t;  ///< 0: empty
  static constexpr unsigned kTokenBits = 42;
  /// The longest queue, in tokens. Well below the number of different positions in a word, or a reader would
  /// not notice that it was overtaken.
  static constexpr std::size_t kLargest = 1'000'000;
  enum class Push { Taken, Replaced, Refused };

  /// `words`: places() of them; `head`: the number of tokens ever pushed. All must be 0 at first.
  WordRing(BufferKind kind, std::size_t size, std::atomic<Word>* words, std::atomic<std::uint64_t>* head)
      : kind_(kind), size_(places(kind, size)), words_(words), head_(head) {}
  static constexpr std::size_t places(BufferKind kind, std::size_t size) {
    return kind == BufferKind::Data ? 1 : size;
  }

  /// The writer only; real-time safe. Replaced: `before` is the token that was pushed out.
  Push push(std::uint64_t token, std::uint64_t& before) noexcept;
  /// The writer only: whether push() would refuse. Pairs with R2, the reader's release in pull_next().
  [[nodiscard]] bool full() const noexcept {
    return kind_ == BufferKind::Buffer && word(next_).load(std::memory_order_acquire) != 0;  // pairs with R2
  }
  /// The reader only; real-time safe: the next token; 0 where nothing waits, or where the words make no
  /// sense.
  std::uint64_t pull() noexcept;
  /// How often the words made no sense to the reader: no proper writer has written them. Any thread.
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_.load(std::memory_order_relaxed); }
  /// How many words hold tokens, and whether one that the reader must take first is missing. Any thread;
  /// neither is exact while the writer or the reader is at work.
  [[nodiscard]] std::size_t count() const noexcept;
  [[nodiscard]] bool has_hole() const noexcept;
  /// The place of the token that was pushed last. The writer only.
  [[nodiscard]] std::size_t last_place() const noexcept { return size_ == 1 ? 0 : (next_ - 1) % size_; }
  /// Whether a token waits. Any thread; exact in the reader's, and with policy data.
  [[nodiscard]] bool pending() const noexcept {
    return word(tail_.load(std::memory_order_relaxed)).load(std::memory_order_seq_cst) != 0;  // R4
  }
  /// Policy data only; one thread at a time, concurrently with push(): puts a token in unless one waits.
  /// True: it is in.
  bool offer(std::uint64_t token) noexcept;
  /// Takes out the token at `place` < places(); 0 where there is none. Requires that the reader has ended.
  std::uint64_t remove(std::size_t place) noexcept {
    return words_[place].exchange(0, std::memory_order_acq_rel) >> kPositionBits;  // pairs with R1
  }
  [[nodiscard]] std::size_t places() const noexcept { return size_; }

 private:
  static constexpr unsigned kPositionBits = 64 - kTokenBits;
  static constexpr Word kPositionMask = (Word{1} << kPositionBits) - 1;
  static_assert(2 * kLargest < kPositionMask);
  static Word pack(std::uint64_t token, std::uint64_t position) noexcept {
    return token << kPositionBits | (position & kPositionMask);
  }
  std::atomic<Word>& word(std::uint64_t position) const noexcept {
    return words_[size_ == 1 ? 0 : position % size_];  // divisions are slow
  }
  std::uint64_t pull_newest() noexcept;
  std::uint64_t pull_oldest() noexcept;
  std::uint64_t pull_next() noexcept;
  /// The number of pushes that *head_ names; where it has gone back, the number of before, and it counts as
  /// nonsense.
  std::uint64_t read_head() noexcept;
  void note_nonsense() noexcept {
    nonsense_.store(nonsense_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  const BufferKind kind_;
  const std::size_t size_;
  std::atomic<Word>* const words_;
  std::atomic<std::uint64_t>* const head_;  ///< written by the writer, read by the reader
  alignas(64) std::uint64_t next_ = 0;      ///< writer only: its own copy of *head_
  /// The position that the reader reads next; written by the reader only.
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  std::uint64_t seen_head_ = 0;  ///< reader only: the last *head_ that made sense
  std::atomic<std::uint64_t> nonsense_{0};
};

}  // namespace segue::sample_link
