// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

namespace segue::host {

/// Collects how the actions of a batch end, and passes it on to a Completion: each action once, one call at a
/// time. All functions may be called from any thread.
class BatchOutcomes {
 public:
  BatchOutcomes(std::size_t count, Completion completed);
  BatchOutcomes(const BatchOutcomes&) = delete;
  BatchOutcomes& operator=(const BatchOutcomes&) = delete;

  /// Notes how one has ended; told by the next tell(), or at once where it was the last one. What is known
  /// already, and an index that is none, is dropped.
  void note(Completed one);
  /// Passes on what has been noted. Where another thread is at that, it passes on this too.
  void tell();
  /// note() for each, then tell().
  void add(std::vector<Completed> ended);
  /// Tells what is left as failed, each with its own error.
  void fail_rest(const std::function<Error(std::size_t index)>& why);

  /// How many have ended.
  [[nodiscard]] std::size_t ended() const;
  /// Blocks until all are told; the Completion is not called any more then.
  void wait() const;

 private:
  /// Gives the lock back where all are told.
  void tell_now(std::unique_lock<std::mutex>& lock);
  bool note_now(Completed one);

  mutable std::mutex mutex_;
  mutable std::condition_variable all_told_;
  Completion completed_;
  std::vector<bool> known_;
  std::vector<Completed> waiting_;  ///< noted and not told
  std::size_t ended_ = 0;
  std::size_t told_ = 0;
  bool telling_ = false;
};

}  // namespace segue::host
