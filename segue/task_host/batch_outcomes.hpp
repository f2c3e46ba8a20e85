// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/completion.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace segue::task_host {

/// The actions of a batch. Collects how they end, and reports each of them to a Completion once. Needed where
/// an end may come twice: where a deadline is kept (the action may end later), and where another process
/// reports. An error that does not say what it is about is about its action. All functions may be called from
/// any thread.
class BatchOutcomes {
 public:
  BatchOutcomes(std::vector<model::Action> actions, Completion completed);
  BatchOutcomes(const BatchOutcomes&) = delete;
  BatchOutcomes& operator=(const BatchOutcomes&) = delete;

  /// Takes note of an end; reported by the next report(), or at once where it was the last one. An end that
  /// is known already is dropped, and so is an index that no action has.
  void note(Completed one);
  /// Reports what has been noted. Where another thread is reporting, that one reports this too.
  void report();
  /// note() for each, then report().
  void add(std::vector<Completed> ended);
  /// Reports what has not ended as failed, each with its own error.
  void fail_rest(const std::function<Error(std::size_t index)>& why);
  void fail_rest(const Error& why);

  [[nodiscard]] const std::vector<model::Action>& actions() const { return actions_; }
  /// How many have ended.
  [[nodiscard]] std::size_t ended() const;

 private:
  /// Returns the Completion where all are reported, to be released without the mutex: a hook that hangs may
  /// keep this alive for ever.
  [[nodiscard]] Completion report_now() SEGUE_REQUIRES(mutex_);
  bool note_now(Completed one) SEGUE_REQUIRES(mutex_);

  const std::vector<model::Action> actions_;
  mutable Mutex mutex_;   ///< protects all below; not held while the Completion is called
  Completion completed_;  ///< used by the thread that reports; released once all are reported
  std::vector<bool> known_ SEGUE_GUARDED_BY(mutex_);
  std::vector<Completed> waiting_ SEGUE_GUARDED_BY(mutex_);  ///< noted and not reported
  std::size_t ended_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::size_t reported_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool reporting_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::task_host
