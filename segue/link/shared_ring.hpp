// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/link/port_connection.hpp>
#include <segue/link/word_ring.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

/// The layout of a connection between processes in shared memory. Both sides write to it; neither trusts it.
namespace segue::link {

struct RingHeader {
  // Written by the reader before the writer knows of the ring; `generation` last, with release.
  std::atomic<std::uint64_t> generation{0};  ///< 0 once the place is free
  std::atomic<std::uint64_t> kind{0};
  std::atomic<std::uint64_t> size{0};
  std::atomic<std::uint64_t> init{0};
  // Written by the reader at any time.
  alignas(64) std::atomic<std::uint64_t> doorbell{0};  ///< a DoorbellLine; 0: nobody wants to be woken
  std::atomic<std::uint64_t> closed{0};                ///< 1: the reader's endpoint is closed
  std::atomic<std::uint64_t> read{0};
  // Written by the writer.
  alignas(64) std::atomic<std::uint64_t> head{0};
  std::atomic<std::uint64_t> written{0};
  std::atomic<std::uint64_t> initial{0};
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<std::uint64_t> overwritten{0};
};

/// A sample that is lent to the reader: where its payload lies in the writer's pool. The fields are relaxed;
/// the word that carries the entry's number publishes them, and the bit that gives the entry back ends the
/// reader's use.
struct RingEntry {
  static constexpr std::uint64_t kNoPayload =
      ~std::uint64_t{0};  ///< as offset: the sample carries no payload
  std::atomic<std::uint64_t> offset;
  std::atomic<std::uint64_t> size;
  std::atomic<std::uint64_t> sequence;
  std::atomic<std::uint64_t> generation;
  /// Nanoseconds of the monotonic clock, which all processes of a computer have in common; 0: not to be
  /// measured.
  std::atomic<std::uint64_t> written_at;
};

/// A view of a ring of a given policy: header, words, a "returned" bit for each entry, and the entries.
///
/// Memory order of an entry's life: the writer fills it (relaxed) and pushes its token (release); the reader
/// pulls the token (acquire), uses the payload and sets the returned bit (release); the writer takes the bit
/// out (acquire) and only then reuses the entry and its payload.
class SharedRing {
 public:
  /// Entries beyond the samples that wait: one that the reader holds, one that it takes meanwhile, and one
  /// that the writer fills before it gets another one back. With Policy::init there is one more, the last.
  static constexpr std::size_t kExtra = 3;
  static constexpr std::size_t kLargest = (std::size_t{1} << 20) - kExtra - 1;

  SharedRing(std::byte* memory, const Policy& policy, std::uint64_t generation);
  /// The size of a ring of this policy in bytes. Requires policy.size <= kLargest.
  static std::size_t bytes(const Policy& policy);

  [[nodiscard]] RingHeader& header() const noexcept { return *header_; }
  [[nodiscard]] WordRing& words() noexcept { return words_; }
  [[nodiscard]] const WordRing& words() const noexcept { return words_; }
  [[nodiscard]] std::span<std::atomic<std::uint64_t>> returned() const noexcept { return returned_; }
  [[nodiscard]] std::span<RingEntry> entries() const noexcept { return entries_; }
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  /// Whether the place still belongs to this ring. Acquire pairs with the release in ~OwnedRing: once this is
  /// false, the reader's last access to any payload has happened.
  [[nodiscard]] bool current() const noexcept {
    return header_->generation.load(std::memory_order_acquire) == generation_;
  }

  /// The token of an entry: its number, prefixed with a mark made from the generation, so that a process that
  /// writes to a place that now belongs to another connection is detected.
  [[nodiscard]] std::uint64_t token_of(std::size_t entry) const noexcept {
    return mark_ << kEntryBits | entry;
  }
  /// The entry of a token; entries().size() where the token is invalid.
  [[nodiscard]] std::size_t entry_of(std::uint64_t token) const noexcept;
  /// For the reader: returns an entry to the writer. Any thread; idempotent.
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

/// Adds one to a counter with a single writing thread. Relaxed: readers may see an older value.
inline void count_one(std::atomic<std::uint64_t>& counter) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace segue::link
