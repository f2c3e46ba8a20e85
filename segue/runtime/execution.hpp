// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/runtime.hpp>

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

/// Carries out the actions of a transition, phase by phase and as its partial order allows: whatever is ready
/// goes to the host at once, which works side by side; what an action's end makes ready follows without
/// waiting for its neighbours. The first failure lets nothing new begin.
class Execution {
 public:
  /// Called after every action that was carried out, one call at a time, from any thread; must not block.
  using Progress = std::function<void(const ActionRecord& record)>;

  /// `transition` must outlive this; an action waits for none of a later phase. `action_deadline` is for each
  /// action, from its begin.
  Execution(host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
            Progress progress);
  ~Execution();
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Carries out one phase; those before it are done. Blocks until none of its actions is under way any more.
  /// True: all are done. False: one failed, or cancel() came in between.
  bool run(model::Phase phase);
  /// No further action begins. From any thread.
  void cancel();

  /// One record for each action, in the order of the transition. None may be under way.
  [[nodiscard]] const std::vector<ActionRecord>& records() const { return records_; }
  /// Moves them out.
  [[nodiscard]] std::vector<ActionRecord> take_records() { return std::move(records_); }
  /// The record of the action that failed first; nullptr: none did.
  [[nodiscard]] const ActionRecord* failure() const;
  /// From the begin of a phase's first action to the end of its last; 0 where it had none.
  [[nodiscard]] Duration window(model::Phase phase) const;

 private:
  using Indices = std::vector<std::size_t>;
  struct Batch;

  /// Takes what is ready to the host until there is nothing left to do in this phase. With the lock held.
  void work(std::unique_lock<std::mutex>& lock);
  void help();
  void perform(Batch& batch);
  /// The host tells how actions of a batch ended.
  void complete(Batch& batch, std::vector<host::Completed> ended);
  void finish(std::size_t index, host::Completed ended);
  void record(std::size_t index, std::optional<Error> error, std::optional<Duration> took);
  void release_successors(std::size_t index);
  /// Actions that did not end in time count by what is seen of them.
  void settle_doubtful(std::unique_lock<std::mutex>& lock);
  /// Somebody has to take what is ready while others are busy.
  void call_help();
  [[nodiscard]] bool may_begin() const { return !cancelled_ && failed_ == kNobody && !ready_.empty(); }
  [[nodiscard]] bool has_work() const { return !over_ && (may_begin() || !doubtful_.empty()); }

  static constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

  host::TaskHost& host_;
  const model::Transition& transition_;
  const Duration action_deadline_;
  const Progress progress_;
  const TimePoint started_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ActionRecord> records_;
  std::vector<Indices> successors_;
  std::vector<int> waits_for_;  ///< how many actions that are not done
  model::Phase phase_ = model::Phase::Prepare;
  Indices ready_;                                        ///< of this phase
  std::vector<std::pair<std::size_t, Error>> doubtful_;  ///< their deadlines have passed
  std::size_t under_way_ = 0;
  std::size_t failed_ = kNobody;
  bool cancelled_ = false;
  bool over_ = true;      ///< no phase is under way
  std::size_t idle_ = 0;  ///< threads that wait for something to do
  std::vector<std::thread> helpers_;
  bool leaving_ = false;
};

/// Whether the effect of an action can be seen in what the host observes. ApplyConfig, HandOver and
/// CallOperation leave nothing to be seen for certain: false.
bool took_effect(const model::Action& action, const model::Network& observed);

}  // namespace segue::runtime::detail
