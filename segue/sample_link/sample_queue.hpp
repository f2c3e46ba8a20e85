// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/sample_link/word_ring.hpp>
#include <segue/task/sample.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::sample_link {

/// The samples that wait between one writer and one reader of the same process, by a buffer policy. push()
/// never waits; pull() starts over only when the writer has overwritten the word that it was about to take.
/// The queue holds a reference to each sample that waits; whoever takes a word out of the ring owns that
/// reference.
class SampleQueue {
 public:
  using Push = WordRing::Push;

  SampleQueue(BufferKind kind, std::size_t size);
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// The writer's thread; real-time safe. Adds a reference of its own.
  Push push(task::SampleSlot& sample) noexcept;
  /// The reader's thread; real-time safe. Empty where nothing waits.
  task::SampleRef pull() noexcept;
  [[nodiscard]] bool pending() const noexcept { return ring_.pending(); }

  /// Policy data only; one thread at a time, concurrently with push(): puts in an older sample unless a newer
  /// one waits. The reader drops it where it has read a newer one. True: it is in.
  bool offer_older(task::SampleSlot& sample) noexcept;
  /// Drops all samples. Requires that nobody pushes or pulls.
  void clear() noexcept;

 private:
  // The token is the slot's address: 47 bits in user space, of which the last six are zero.
  static constexpr unsigned kAddressShift = 6;
  static std::uint64_t token_of(const task::SampleSlot& slot) noexcept {
    return reinterpret_cast<std::uintptr_t>(&slot) >> kAddressShift;
  }
  static task::SampleSlot* slot_of(std::uint64_t token) noexcept {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): token and position must change as one word
    return reinterpret_cast<task::SampleSlot*>(token << kAddressShift);
  }

  const BufferKind kind_;
  const std::unique_ptr<std::atomic<WordRing::Word>[]> words_;
  alignas(64) std::atomic<std::uint64_t> head_{0};
  WordRing ring_;
  std::uint64_t newest_read_ = 0;  ///< reader only, policy data: sequence of the newest sample read
};

}  // namespace segue::sample_link
