// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/sample_link/word_ring.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

/// The layout of a connection between processes in shared memory. Both sides write to it, and other peers of
/// the reader can; neither side trusts it. Each side also keeps all that it writes in private memory
/// (KeptCount, SharedInput, SharedOutput), and compares.
namespace segue::sample_link {

/// A count that one thread at a time adds to, kept in private memory and shown to the other process. Relaxed,
/// since nothing is read by it: it is compared and shown only.
class KeptCount {
 public:
  explicit KeptCount(std::atomic<std::uint64_t>& shown) : shown_(shown) {}
  void add_one() noexcept {
    const std::uint64_t next = count_.load(std::memory_order_relaxed) + 1;
    count_.store(next, std::memory_order_relaxed);
    shown_.store(next, std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t get() const noexcept { return count_.load(std::memory_order_relaxed); }
  /// Whether the other process sees something else. Any thread; may be wrong while it is being counted.
  [[nodiscard]] bool is_overwritten() const noexcept {
    const std::uint64_t before = get();
    const std::uint64_t shown = shown_.load(std::memory_order_relaxed);
    return shown < before || shown > get();
  }

 private:
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t>& shown_;
};

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
  std::atomic<std::uint64_t> taken_back{0};  ///< entries that the reader has returned
};

/// A sample that is lent to the reader: where its payload lies in the writer's pool. The fields are relaxed;
/// the word that carries the entry's number publishes them, and the bit that gives the entry back ends the
/// reader's use. `seal` tells the reader that they belong together, and to this entry of this connection:
/// where one of them was overwritten, it does not fit.
struct RingEntry {
  static constexpr std::uint64_t kNoPayload =
      ~std::uint64_t{0};  ///< as offset: the sample carries no payload
  std::atomic<std::uint64_t> offset;
  std::atomic<std::uint64_t> size;
  std::atomic<std::uint64_t> sequence;
  std::atomic<std::uint64_t> seal;
  /// Nanoseconds of the monotonic clock, which all processes of a computer have in common; 0: not to be
  /// measured.
  std::atomic<std::uint64_t> written_at;
};

/// A view of a ring of a given policy: header, words, a "returned" bit for each entry, and the entries.
///
/// Memory order; an entry's life is H1, R1 (WordRing), H3:
/// - H1: OwnedRing fills the header (relaxed) and releases `generation`; find_ring() acquires it.
/// - H2: ~OwnedRing releases `generation` as 0; current() acquires it: the reader's last access is over then.
/// - H3: the writer fills an entry (relaxed) and pushes its token (R1). The reader uses the payload and
///   releases the returned bit; the writer acquires it and only then reuses the entry and its payload.
/// - H4: the reader stores `doorbell` and then looks for words; the writer pushes a word and then loads
///   `doorbell`. All are sequentially consistent, so one of them sees the other (R4).
/// - H5: the reader stores `closed` after its last pull(); the writer acquires it before it empties the
///   words.
/// - Counters are relaxed: one thread writes each, and others only compare and show them.
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
  /// Whether the place still belongs to this ring. Pairs with H2, the release in ~OwnedRing: once this is
  /// false, the reader's last access to any payload has happened.
  [[nodiscard]] bool current() const noexcept {
    return header_->generation.load(std::memory_order_acquire) == generation_;
  }

  /// The token of an entry: its number, prefixed with a mark made from the generation, so that a process that
  /// writes to a place that now belongs to another connection is detected.
  [[nodiscard]] std::uint64_t token_of(std::size_t entry) const noexcept {
    return mark_ << kEntryBits | entry;
  }
  /// The seal of an entry with these fields. Whatever single field is changed, and all but one of 2^64
  /// changes of several, give another one.
  [[nodiscard]] std::uint64_t seal_of(std::size_t entry, std::uint64_t offset, std::uint64_t size,
                                      std::uint64_t sequence) const noexcept {
    return (generation_ + entry) * 0x9e3779b97f4a7c15 + offset * 0xc2b2ae3d27d4eb4f +
           size * 0x165667b19e3779f9 + sequence * 0xd6e8feb86659fd93;
  }
  /// The entry of a token; entries().size() where the token is invalid.
  [[nodiscard]] std::size_t entry_of(std::uint64_t token) const noexcept;
  /// For the reader: returns an entry to the writer. Any thread; idempotent.
  void give_back(std::size_t entry) const noexcept;
  /// The counters of both sides, as they show them in the header. Any thread.
  [[nodiscard]] Counters counters() const noexcept;
  /// How many returned bits are set. Any thread.
  [[nodiscard]] std::size_t count_returned() const noexcept;

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

}  // namespace segue::sample_link
