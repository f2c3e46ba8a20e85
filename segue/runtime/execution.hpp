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
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

/// Carries out the actions of a transition, phase by phase and as its partial order allows. Whatever is ready
/// is begun at once as one batch; what the end of an action makes ready is begun by the thread that reports
/// the end, so nothing waits for its neighbours and no thread waits for the host but the caller of run(). The
/// first failure lets nothing new begin.
///
/// A host that breaks its contract does no harm: what it reports twice is dropped, and what it does not
/// report long after the deadline counts as failed.
class Execution : public std::enable_shared_from_this<Execution> {
 public:
  /// Called after every action that was carried out, one call at a time, from any thread; must not block.
  using Progress = std::function<void(const ActionRecord& record)>;

  /// An action of `transition` waits for none of a later phase. `action_deadline` is
  /// for each action, from its begin. Made by std::make_shared: reports that come late keep this alive.
  Execution(host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
            Progress progress);
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Carries out one phase; those before it are done. Blocks until none of its actions is in progress any
  /// more, so until their deadlines and a little at most. False where one failed, or cancel() came in
  /// between.
  bool run(model::Phase phase);
  /// No further action begins. From any thread.
  void cancel();

  /// One record for each action, in the order of the transition. None may be in progress.
  [[nodiscard]] const std::vector<ActionRecord>& records() const { return records_; }
  /// Moves them out.
  [[nodiscard]] std::vector<ActionRecord> take_records() { return std::move(records_); }
  /// The record of the action that failed first; nullptr: none did.
  [[nodiscard]] const ActionRecord* failure() const;
  /// From the begin of a phase's first action to the end of its last; 0 where it had none.
  [[nodiscard]] Duration window(model::Phase phase) const;

 private:
  using Indices = std::vector<std::size_t>;
  /// Actions that were begun together.
  struct Batch {
    Indices indices;
    std::vector<bool> reported;
    TimePoint deadline;
  };
  using BatchPtr = std::shared_ptr<Batch>;

  // With the lock held; they may let go of it in between.
  /// Begins what is ready, until there is nothing left.
  void begin_ready(std::unique_lock<std::mutex>& lock);
  BatchPtr take_ready();
  /// Actions that did not end in time count by what is seen of them.
  void settle_doubtful(std::unique_lock<std::mutex>& lock);
  /// Waits until there is something to do in run().
  void wait(std::unique_lock<std::mutex>& lock);
  void fail_batch(Batch& batch, const std::string& why);
  void finish(std::size_t index, host::Completed ended);
  void record(std::size_t index, std::optional<Error> error, std::optional<Duration> took);
  void release_successors(std::size_t index);
  [[nodiscard]] bool may_begin() const { return !cancelled_ && failed_ == kNobody && !ready_.empty(); }

  /// The host reports how actions of a batch ended.
  void complete(Batch& batch, std::vector<host::Completed> ended);

  static constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

  host::TaskHost& host_;
  const Duration action_deadline_;
  const Progress progress_;
  const TimePoint started_;

  mutable std::mutex mutex_;  ///< protects all below; not held while the host is called
  std::condition_variable changed_;
  std::vector<ActionRecord> records_;
  std::vector<Indices> successors_;
  std::vector<int> waits_for_;  ///< how many actions that are not done
  model::Phase phase_ = model::Phase::Prepare;
  Indices ready_;                                        ///< of this phase
  std::vector<std::pair<std::size_t, Error>> doubtful_;  ///< their deadlines have passed
  std::vector<BatchPtr> batches_;                        ///< begun in this phase
  std::size_t in_progress_ = 0;                          ///< actions; the doubtful ones too
  std::size_t failed_ = kNobody;
  bool cancelled_ = false;
  std::set<std::thread::id> beginning_;  ///< threads in begin_ready(), where the host may report at once
};

/// Whether the effect of an action can be seen in what the host observes. ApplyConfig, HandOver and
/// CallOperation leave nothing to be seen for certain: false.
bool took_effect(const model::Action& action, const model::Network& observed);

}  // namespace segue::runtime::detail
