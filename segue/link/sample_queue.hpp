// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/task/sample.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::link {

/// Samples on their way from one writer to one reader, by a policy. push() never waits; pull() starts over
/// only when the writer has meanwhile overwritten what it was about to take.
class SampleQueue {
 public:
  enum class Push { Taken, Replaced, Refused };

  SampleQueue(BufferKind kind, std::size_t size);
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// The writer's thread; real-time safe. Holds a reference of its own.
  Push push(task::SampleSlot& sample) noexcept;
  /// The reader's thread; real-time safe. Empty where nothing waits.
  task::SampleRef pull() noexcept;
  [[nodiscard]] bool pending() const noexcept;

  /// Data only, any thread but at most one: puts in an older sample unless a newer one waits or was read.
  /// True: it waits now.
  bool offer_older(task::SampleSlot& sample) noexcept;
  /// Nobody may push or pull meanwhile.
  void clear() noexcept;

 private:
  // A word is a slot's address, whose last six bits are zero and of which user space has 47, moved up by 16;
  // the 22 bits below hold the low part of the position, so that the reader sees whether it was overtaken.
  using Word = std::uint64_t;
  static constexpr unsigned kShift = 16;
  static constexpr Word kPositionMask = (Word{1} << 22U) - 1;
  static Word pack(const task::SampleSlot* slot, std::uint64_t position) noexcept {
    return reinterpret_cast<std::uintptr_t>(slot) << kShift | (position & kPositionMask);
  }
  static task::SampleSlot* slot_of(Word word) noexcept {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the word holds both so that they change as one
    return reinterpret_cast<task::SampleSlot*>((word & ~kPositionMask) >> kShift);
  }
  std::atomic<Word>& word(std::uint64_t position) const noexcept { return words_[position % size_]; }

  task::SampleRef pull_newest() noexcept;
  task::SampleRef pull_oldest() noexcept;
  task::SampleRef pull_next() noexcept;

  const BufferKind kind_;
  const std::size_t size_;
  const std::unique_ptr<std::atomic<Word>[]> words_;  ///< 0: empty
  alignas(64) std::atomic<std::uint64_t> head_{0};    ///< the writer's: samples put in
  alignas(64) std::uint64_t tail_ = 0;                ///< the reader's: the next position
  std::uint64_t newest_read_ = 0;                     ///< the reader's, Data: the port's count of that sample
};

}  // namespace segue::link
