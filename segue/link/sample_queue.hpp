// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/link/word_ring.hpp>
#include <segue/task/sample.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::link {

/// Samples on their way from one writer to one reader of the same process, by a policy. push() never waits;
/// pull() starts over only when the writer has meanwhile overwritten what it was about to take.
class SampleQueue {
 public:
  using Push = WordRing::Push;

  SampleQueue(BufferKind kind, std::size_t size);
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// The writer's thread; real-time safe. Holds a reference of its own.
  Push push(task::SampleSlot& sample) noexcept;
  /// The reader's thread; real-time safe. Empty where nothing waits.
  task::SampleRef pull() noexcept;
  [[nodiscard]] bool pending() const noexcept { return ring_.pending(); }

  /// Data only, any thread but at most one: puts in an older sample unless a newer one waits or was read.
  /// True: it waits now.
  bool offer_older(task::SampleSlot& sample) noexcept;
  /// Nobody may push or pull meanwhile.
  void clear() noexcept;

 private:
  // What a word carries is a slot's address, whose last six bits are zero and of which user space has 47.
  static constexpr unsigned kAddressShift = 6;
  static std::uint64_t token_of(const task::SampleSlot& slot) noexcept {
    return reinterpret_cast<std::uintptr_t>(&slot) >> kAddressShift;
  }
  static task::SampleSlot* slot_of(std::uint64_t token) noexcept {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the word holds it with its position so that both change as
    // one
    return reinterpret_cast<task::SampleSlot*>(token << kAddressShift);
  }

  const BufferKind kind_;
  const std::unique_ptr<std::atomic<WordRing::Word>[]> words_;
  alignas(64) std::atomic<std::uint64_t> head_{0};
  WordRing ring_;
  std::uint64_t newest_read_ = 0;  ///< the reader's, Data: the port's count of that sample
};

}  // namespace segue::link
