// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/left_actions.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/task_host.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

namespace segue::runtime::detail {

/// Carries out the actions of a transition, phase by phase, and keeps a record of each. The host carries out
/// the actions of a phase as their partial order allows; the first failure lets nothing new begin.
class Execution : public std::enable_shared_from_this<Execution> {
 public:
  /// Called after every action that was carried out, one call at a time, from any thread; must not block.
  using Progress = std::function<void(const ActionRecord& record)>;

  /// An action of `transition` waits for none of a later phase. `left` gets what leave() leaves in progress.
  /// `action_deadline` is for each action, from its begin. Times of the records are since `started`. Made by
  /// std::make_shared: reports that come late keep this alive.
  Execution(task_host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
            TimePoint started, Progress progress, std::shared_ptr<LeftActions> left);
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Carries out one phase; those before it are done. Blocks until none of its actions is in progress any
  /// more, so until their deadlines and a little at most. False where one failed, or cancel() came in
  /// between.
  bool run(model::Phase phase);
  /// No further action begins. From any thread.
  void cancel() { stop_.request_stop(); }
  /// No further action begins, and those in progress that may be left are not waited for, and count as if
  /// they had not begun; how they end must be observed. From any thread, also several times.
  void leave(const task_host::Leaving::MayBeLeft& may_be_left);

  /// One record for each action, in the order of the transition; moves them out. No phase may run.
  [[nodiscard]] std::vector<ActionRecord> take_records();
  /// The record of the action that failed first; nullptr: none did. No phase may run.
  [[nodiscard]] const ActionRecord* failure() const;
  /// From the begin of a phase's first action until the end of its last was known; 0 where it had none.
  [[nodiscard]] Duration window(model::Phase phase) const;

 private:
  using Indices = std::vector<std::size_t>;

  void complete(const Indices& indices, Duration begin, std::vector<task_host::Completed> ended);

  static constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

  task_host::TaskHost& host_;
  const Duration action_deadline_;
  const Progress progress_;
  const std::shared_ptr<LeftActions> left_;
  const TimePoint started_;
  std::stop_source stop_;
  task_host::Leaving leaving_;

  mutable Mutex mutex_;  ///< protects all below; not held while the host is called
  std::vector<ActionRecord> records_ SEGUE_GUARDED_BY(mutex_);
  std::array<Duration, model::kPhaseNames.size()> windows_ SEGUE_GUARDED_BY(mutex_){};
  std::size_t failed_ SEGUE_GUARDED_BY(mutex_) = kNobody;
};

}  // namespace segue::runtime::detail
