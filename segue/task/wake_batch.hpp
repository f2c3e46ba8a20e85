// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace segue::task::detail {

/// Puts off the wake-ups that a thread asks for until the end of a scope, and makes one of those that are for
/// the same sleeper. So a thread for which several samples are meant is woken once, when all are there,
/// rather than by the first of them, perhaps on the processor of the writer. A batch ends before anything
/// that it wakes can; real-time safe. One thread.
class WakeBatch {
 public:
  using Wake = void (*)(void* sleeper) noexcept;

  WakeBatch() noexcept;
  ~WakeBatch();
  WakeBatch(const WakeBatch&) = delete;
  WakeBatch& operator=(const WakeBatch&) = delete;

  /// Calls `wake` with `sleeper` when the innermost batch of this thread ends; at once where there is none,
  /// or where it is full.
  static void add(Wake wake, void* sleeper) noexcept;

 private:
  static constexpr std::size_t kMost = 16;
  struct Entry {
    Wake wake;
    void* sleeper;
  };

  WakeBatch* const outer_;
  std::size_t count_ = 0;
  std::array<Entry, kMost> entries_;  ///< the first count_ of them
};

}  // namespace segue::task::detail
