// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace segue::task_host {

/// How many of these actions have to wait for each other at most. Each comes after those that it waits for,
/// as in a transition.
int longest_chain(const std::vector<model::Action>& actions);

/// Carries out actions as their partial order allows. Whatever is ready is begun at once as one batch; what
/// the end of an action makes ready is begun by the thread that reports the end, so nothing waits for its
/// neighbours and no thread waits for the host but the caller of run(). The first failure lets nothing new
/// begin.
///
/// A host that breaks its contract does no harm: what it reports twice is dropped, and what it does not
/// report long after the deadline counts as failed.
class OrderedActions : public std::enable_shared_from_this<OrderedActions> {
 public:
  /// The functions that carry the actions out, called from any thread.
  struct Performer {
    /// Begins a batch, as TaskHost::begin_all() does. Where `place` is set, actions of a batch that are at
    /// one place may depend on each other, and are reported with their `span`.
    std::function<void(std::vector<model::Action> actions, TimePoint deadline, Completion completed)> begin;
    /// The network that runs now; tells how an action ended that was not reported in time.
    std::function<model::Network()> observe;
    /// The place where an action is carried out. An action that waits only for others of the same place is
    /// begun together with them. May be empty; nullptr: at no such place. Must not block.
    std::function<const void*(const model::Action& action)> place{};
    /// Called once nothing new may begin while batches are in progress. May be empty; must not block.
    std::function<void()> begin_no_more{};
  };

  /// An action waits for those of `actions` that its `after` names; others are done. `action_deadline` is for
  /// each action, from its begin. `completed` gets each action once, with its span, one call at a time. Made
  /// by std::make_shared: reports that come late keep this alive.
  OrderedActions(std::vector<model::Action> actions, Duration action_deadline, Performer performer,
                 Completion completed);
  OrderedActions(const OrderedActions&) = delete;
  OrderedActions& operator=(const OrderedActions&) = delete;

  /// Blocks until all actions are reported, so until their deadlines and a little at most. After an early end
  /// no further action begins. To be called once.
  void run(const EarlyEnd& early_end);

 private:
  using Indices = std::vector<std::size_t>;
  /// Actions that were begun together.
  struct Batch {
    Indices indices;
    std::vector<bool> reported;
    std::vector<bool> left;  ///< in progress, and reported as if they had not begun
    TimePoint begin;
    TimePoint deadline;
  };
  using BatchPtr = std::shared_ptr<Batch>;

  // Begins actions that are ready, until there are none. Some functions here give the mutex back in between.
  /// Begins what is ready, until there is nothing left.
  void begin_ready() SEGUE_REQUIRES(mutex_);
  BatchPtr take_ready() SEGUE_REQUIRES(mutex_);
  /// Adds what waits only for actions of the batch at its own place.
  void add_dependent(Indices& indices) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::vector<model::Action> actions_of(const Batch& batch) const;
  /// Actions that did not end in time count by what is seen of them.
  void settle_doubtful() SEGUE_REQUIRES(mutex_);
  /// Waits until there is something to do in run().
  void wait() SEGUE_REQUIRES(mutex_);
  void fail_batch(Batch& batch, const std::string& why) SEGUE_REQUIRES(mutex_);
  void finish(const Batch& batch, std::size_t index, Completed ended) SEGUE_REQUIRES(mutex_);
  void report(std::size_t index, Completed ended) SEGUE_REQUIRES(mutex_);
  void release_successors(std::size_t index) SEGUE_REQUIRES(mutex_);
  /// Tells the performer, once, that nothing new may begin.
  void begin_no_more() SEGUE_REQUIRES(mutex_);
  /// Tells the caller what is known, in one thread at a time.
  void deliver() SEGUE_REQUIRES(mutex_);
  void report_unbegun() SEGUE_REQUIRES(mutex_);
  /// Nothing goes on by itself any more.
  [[nodiscard]] bool is_idle() const SEGUE_REQUIRES(mutex_) {
    return in_progress_ == 0 && beginning_.empty() && !delivering_;
  }
  [[nodiscard]] bool may_begin() const SEGUE_REQUIRES(mutex_) {
    return !cancelled_ && !failed_ && !ready_.empty();
  }

  void tell_left_ended(const Indices& indices);
  /// The performer reports how actions of a batch ended.
  void complete(Batch& batch, std::vector<Completed> ended);
  void cancel();
  /// Cancels the run, and counts actions in progress that may be left as if they had not begun.
  void leave(const Leaving::MayBeLeft& may_be_left);

  enum class Progress : std::uint8_t { Waiting, Begun, Reported };

  const std::vector<model::Action> actions_;
  const Duration action_deadline_;
  const Performer performer_;
  const Completion completed_;
  const TimePoint started_;

  Mutex mutex_;  ///< protects all below; not held while others are called, but for `place`
  ConditionVariable changed_;
  std::vector<Indices> successors_ SEGUE_GUARDED_BY(mutex_);
  std::vector<int> waits_for_ SEGUE_GUARDED_BY(mutex_);  ///< how many actions that are not done
  std::vector<Progress> progress_ SEGUE_GUARDED_BY(mutex_);
  Indices ready_ SEGUE_GUARDED_BY(mutex_);
  /// Their deadlines have passed.
  std::vector<std::pair<std::size_t, Completed>> timed_out_ SEGUE_GUARDED_BY(mutex_);
  std::vector<BatchPtr> batches_ SEGUE_GUARDED_BY(mutex_);
  std::size_t in_progress_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< actions; the doubtful ones too
  bool failed_ SEGUE_GUARDED_BY(mutex_) = false;
  bool cancelled_ SEGUE_GUARDED_BY(mutex_) = false;
  bool told_ SEGUE_GUARDED_BY(mutex_) = false;
  std::vector<Completed> undelivered_ SEGUE_GUARDED_BY(mutex_);
  std::function<void(const model::Action&)> left_ended_;  ///< of EarlyEnd; set before anything begins
  bool delivering_ SEGUE_GUARDED_BY(mutex_) = false;
  /// Threads in begin_ready(), where the performer may report at once.
  std::set<std::thread::id> beginning_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host
