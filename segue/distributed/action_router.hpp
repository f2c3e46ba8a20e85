// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/distributed/sites.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/split_batch.hpp>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <vector>

namespace segue::distributed::detail {

/// Sends actions to the computers where they have to be carried out, and keeps a transition together: a
/// computer whose connection was made anew since the transition began has given it up, and takes no more of
/// its actions. Thread safe.
class ActionRouter {
 public:
  explicit ActionRouter(Sites& sites) : sites_(sites) {}

  /// Carries out actions in their partial order (TaskHost::perform_in_order), with one message for each
  /// computer, unless its actions have to wait for something that happens on another. Samples that a sender
  /// has taken are delivered before its receivers stop and are disconnected.
  void perform(std::vector<model::Action> actions, Duration action_deadline,
               const task_host::EarlyEnd& early_end, task_host::Completion completed);

  /// Begins actions (TaskHost::begin_all); those on one computer may depend on each other.
  void begin(std::vector<model::Action> actions, Duration action_deadline, task_host::Completion completed);
  /// Waits until all actions that were begun are reported.
  void close();

  /// Begins a transition: until end_transition(), only computers that can be reached now, through their
  /// present connections, take part.
  void begin_transition(const model::Network& before, const model::Network& target);
  void end_transition();
  /// Whether a connection carries samples whenever it is there, not from commit to commit. A new receiver
  /// delivers all samples that its sender gets on the other computer, so that no sample is lost between the
  /// commits of both. A receiver that goes on delivers to each reader from commit to commit, so that no
  /// sample gets to two readers of which one takes the other's place.
  [[nodiscard]] bool at_once(const model::Connection& connection) const;
  /// The computer as the transition in progress may use it; Unavailable where its connection is another one.
  Result<HostLink::Reached> reach(const Site& site) const;

 private:
  using Indices = task_host::SplitBatch::Indices;

  [[nodiscard]] model::Action for_host(model::Action action) const;
  [[nodiscard]] Result<Site*> site_of(const model::Action& action) const;
  [[nodiscard]] Result<Site*> site_of(const model::Action& action, const model::Connection& connection) const;
  /// nullptr: the state travels from one computer to another.
  [[nodiscard]] Result<Site*> site_of(const model::HandOverAction& what) const;
  /// Where an incarnation of a task lives or, before it has been created, will live.
  [[nodiscard]] Result<Site*> site_of(const model::TaskId& task, fleet::detail::Which which) const;
  void begin_at(Site& site, const Indices& indices, task_host::SplitBatch& batch, Duration action_deadline);
  Result<void> hand_over(const model::HandOverAction& action, TimePoint deadline) const;
  void note_placement(const model::Action& action, const Result<void>& outcome) const;
  /// Counts actions as in progress until `completed` has got them.
  task_host::Completion counted(std::size_t actions, task_host::Completion completed);
  void begin_no_more() const;

  Sites& sites_;
  mutable Mutex mutex_;  ///< protects everything below
  ConditionVariable idle_;
  std::size_t in_progress_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< actions that are not reported yet
  /// The connections of the computers that take part in the transition in progress.
  std::optional<std::map<const Site*, std::uint64_t>> connections_ SEGUE_GUARDED_BY(mutex_);
  /// Receivers that the transition in progress leaves as they are.
  std::set<model::TaskId> kept_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::distributed::detail
