// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/network.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

namespace segue::runtime::detail {

/// A snapshot of the host. Tasks may have changed state on their own since; Belief::adopt() applies the task
/// events that came after the snapshot.
struct Observation {
  model::Network network;
  std::uint64_t task_events = 0;  ///< number of events received before the snapshot
  std::uint64_t adoptions = 0;    ///< number of times the belief had been replaced before it
};

/// The network believed to be running, split into the requested controller and everything else.
struct BeliefState {
  model::Network controller;  ///< tasks in their present states; its name is that of the robot's controller
  model::Network extra;       ///< standby tasks of other controllers, and leftovers
  /// The controller as requested; nothing if what runs was not requested (found at start, or after a
  /// failure).
  std::optional<model::Network> wanted;
  [[nodiscard]] model::Network all() const;
  /// The network that should run: the requested controller, or else what runs, with `extra`.
  [[nodiscard]] model::Network desired() const;
};

/// Splits a snapshot: whatever is not part of `controller` goes to `extra`.
BeliefState split_observation(model::Network seen, const model::Network& controller,
                              std::optional<model::Network> wanted);

/// The belief, kept up to date by snapshots of the host and by task events. Thread safe. The host's observe()
/// is the only call out of this class, and the mutex is not held meanwhile.
class Belief {
 public:
  explicit Belief(const task_host::TaskHost& host) : host_(host) {}

  /// Taken while no computer was lost or found: what is there is either wholly in the snapshot or not at all.
  [[nodiscard]] Observation observe() const;
  [[nodiscard]] BeliefState held() const;
  [[nodiscard]] model::Network controller() const;
  /// Of the requested controller; empty: it has none, or nothing was requested.
  [[nodiscard]] std::string version() const;
  /// Whether the belief was set by a user (adopt_assumed()) and not observed; the next request starts from
  /// it.
  [[nodiscard]] bool is_assumed() const;

  /// Replaces the belief by a snapshot and applies the task events received since.
  void adopt(BeliefState seen, std::uint64_t task_events);
  /// Replaces the belief by a snapshot and applies the task events received since. False, and nothing is
  /// done, where the belief was replaced after the snapshot was taken.
  bool refresh(BeliefState seen, const Observation& observed);
  /// Replaces the belief by a network given by the user.
  void adopt_assumed(model::Network network);
  void on_event(const task_host::TaskEvent& event);

  /// The network that a new request starts from: the assumed one, else a snapshot. Its name is the
  /// controller's.
  [[nodiscard]] Observation starting_point() const;

 private:
  void replace(BeliefState seen, std::uint64_t task_events) SEGUE_REQUIRES(mutex_);
  void hold(BeliefState state) SEGUE_REQUIRES(mutex_);
  void set_state(const model::TaskId& id, TaskState state) SEGUE_REQUIRES(mutex_);

  const task_host::TaskHost& host_;
  mutable Mutex mutex_;  ///< protects all members below
  BeliefState held_ SEGUE_GUARDED_BY(mutex_);
  /// In `held_`; a task may be in both its parts.
  std::unordered_multimap<model::TaskId, TaskState*> states_ SEGUE_GUARDED_BY(mutex_);
  bool assumed_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint64_t task_events_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t adoptions_ SEGUE_GUARDED_BY(mutex_) = 0;
  /// For each task, the number of its last event and the state that it reported. Events numbered above a
  /// snapshot's `task_events` are newer than the snapshot and override it.
  std::map<model::TaskId, std::pair<std::uint64_t, TaskState>> reported_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail
