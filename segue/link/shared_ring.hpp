// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/link/connection.hpp>
#include <segue/link/word_ring.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

/// What a connection between processes looks like in memory. Both sides write to it; neither trusts it.
namespace segue::link {

struct RingHeader {
  // Of the reader, before anybody else knows of it.
  std::atomic<std::uint64_t> generation{0};  ///< 0 once the place is free again
  std::atomic<std::uint64_t> kind{0};
  std::atomic<std::uint64_t> size{0};
  std::atomic<std::uint64_t> init{0};
  // Of the reader, at any time.
  alignas(64) std::atomic<std::uint64_t> doorbell{0};  ///< of DoorbellLine; 0: nobody waits
  std::atomic<std::uint64_t> closed{0};                ///< 1: the reader's endpoint has ended
  std::atomic<std::uint64_t> read{0};
  // Of the writer.
  alignas(64) std::atomic<std::uint64_t> head{0};
  std::atomic<std::uint64_t> written{0};
  std::atomic<std::uint64_t> initial{0};
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<std::uint64_t> overwritten{0};
};

/// A sample on its way: where its payload lies in the writer's pool.
struct RingEntry {
  static constexpr std::uint64_t kNoPayload = ~std::uint64_t{0};  ///< as offset: there is none
  std::atomic<std::uint64_t> offset;
  std::atomic<std::uint64_t> size;
  std::atomic<std::uint64_t> sequence;
  std::atomic<std::uint64_t> generation;
};

/// The parts of a ring of a given policy: header, words, a bit for each entry that the reader has given back,
/// entries.
class SharedRing {
 public:
  /// Entries beyond the samples that wait: one that the reader holds, one that it takes meanwhile, one that
  /// the writer puts in before it gets another one back. With Policy::init one more, the last.
  static constexpr std::size_t kExtra = 3;
  static constexpr std::size_t kLargest = (std::size_t{1} << 20) - kExtra - 1;

  SharedRing(std::byte* memory, const Policy& policy, std::uint64_t generation);
  /// Bytes that a ring of this policy takes; its size must be at most kLargest.
  static std::size_t bytes(const Policy& policy);

  [[nodiscard]] RingHeader& header() const noexcept { return *header_; }
  [[nodiscard]] WordRing& words() noexcept { return words_; }
  [[nodiscard]] const WordRing& words() const noexcept { return words_; }
  [[nodiscard]] std::span<std::atomic<std::uint64_t>> returned() const noexcept { return returned_; }
  [[nodiscard]] std::span<RingEntry> entries() const noexcept { return entries_; }
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  /// Whether the place is still what it was when this was made.
  [[nodiscard]] bool current() const noexcept {
    return header_->generation.load(std::memory_order_acquire) == generation_;
  }

  /// What a word carries: an entry's number under a mark of the generation, so that whoever writes to a place
  /// that has passed to another connection is found out.
  [[nodiscard]] std::uint64_t token_of(std::size_t entry) const noexcept {
    return mark_ << kEntryBits | entry;
  }
  /// The number of an entry; entries().size() where the token makes no sense.
  [[nodiscard]] std::size_t entry_of(std::uint64_t token) const noexcept;
  /// The reader gives an entry back. Any thread, idempotent.
  void give_back(std::size_t entry) const noexcept;
  [[nodiscard]] Counters counters() const noexcept;

 private:
  static constexpr unsigned kEntryBits = 20;
  static constexpr unsigned kMarkBits = WordRing::kTokenBits - kEntryBits;

  const std::uint64_t generation_;
  const std::uint64_t mark_;
  RingHeader* const header_;
  WordRing words_;
  std::span<std::atomic<std::uint64_t>> returned_;
  std::span<RingEntry> entries_;
};

/// Of one writer: adds one to a counter that others read.
inline void count_one(std::atomic<std::uint64_t>& counter) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace segue::link
