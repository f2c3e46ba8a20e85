// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace segue::fleet::detail {

/// Which of a task's incarnations a plain id means.
enum class Which {
  Current,  ///< the one that existed when the transition began
  Next      ///< the one that the transition has created, or the current one where it has created none
};

/// In which processes each task lives. Usually that is one process; while a transition moves a task, its next
/// incarnation exists beside the current one. Processes themselves know plain ids only. Thread safe: one
/// mutex protects everything; no function blocks or calls anybody.
class PlacementTable {
 public:
  /// One incarnation of a task.
  struct Place {
    model::TaskId task;  ///< plain
    model::DeploymentKey process;
    friend bool operator==(const Place&, const Place&) = default;
  };

  /// The process that holds the incarnation of a task with which the transition in progress ends, where its
  /// target has the task; whether or not it has been created.
  [[nodiscard]] std::optional<model::DeploymentKey> wanted(const model::TaskId& task) const;
  /// The incarnation that an id means; a full id means exactly that one, whatever `which`. NotFound, with a
  /// suggestion among the known ids, where there is none.
  [[nodiscard]] Result<Place> find(const model::TaskId& id, Which which) const;
  /// Where a task may be created. InvalidState where a leftover incarnation has to be removed from there
  /// first.
  [[nodiscard]] Result<Place> free_place(const model::TaskId& id, const model::DeploymentKey& process) const;
  /// An incarnation by any of its ids, whether or not it is in the table.
  [[nodiscard]] static Place place_of(const model::TaskId& id, const model::DeploymentKey& process);
  /// The name of an incarnation towards callers: its plain id if it is the current one, else its full id.
  [[nodiscard]] model::TaskId name(const model::TaskId& task, const model::DeploymentKey& process) const;
  /// For every task the process of its current incarnation, all of one moment.
  [[nodiscard]] std::map<model::TaskId, model::DeploymentKey> current() const;
  /// name() in a table that current() gave.
  [[nodiscard]] static model::TaskId name(const std::map<model::TaskId, model::DeploymentKey>& current,
                                          const model::TaskId& task, const model::DeploymentKey& process);

  /// The incarnation has been created. It is the next one where there is a current one already.
  void put(const Place& place);
  /// The incarnation may have been created, but its process did not confirm it. Never makes it the next one.
  void put_unconfirmed(const Place& place);
  /// An action that creates the incarnation has ended: as put(), or put_unconfirmed() where nobody says how.
  void note_creation(const Place& place, const Result<void>& outcome);
  /// The number with which update() takes over a poll that begins now: later changes to this table are newer
  /// than its answer.
  [[nodiscard]] std::uint64_t begin_poll() const;
  /// Takes over what a process reported in the poll that begin_poll() began: its other tasks are removed.
  /// Tasks that were put or dropped since then keep their state, since the report may be older.
  void update(const model::DeploymentKey& process, const std::set<model::TaskId>& tasks, std::uint64_t poll);
  void drop(const Place& place);
  /// The process has ended. Gives the names of the tasks that it held.
  std::vector<model::TaskId> drop(const model::DeploymentKey& process);

  /// A transition begins, from `before`, as it was observed, to `target`: a leftover incarnation that lives
  /// where its task is to be becomes the next one. Until conclude() or withdraw(), Which::Current means no
  /// other incarnation instead of one of `before` that has ended.
  void begin_transition(const model::Network& before, const model::Network& target);
  /// The transition is complete: every next incarnation becomes the current one. Gives those that were
  /// current.
  std::vector<Place> conclude();
  /// The transition was given up: there are no next incarnations any more. Where the current one is gone, a
  /// remaining one takes over the plain id.
  void withdraw();

 private:
  /// The incarnations of one task. Invariants: `processes` is not empty; `next`, if set, is one of
  /// `processes` and not `current`; `current` is one of `processes` unless it ended while there is a next
  /// one.
  struct Incarnations {
    std::vector<model::DeploymentKey> processes;
    model::DeploymentKey current;
    std::optional<model::DeploymentKey> next;
    [[nodiscard]] bool has(const model::DeploymentKey& process) const;
    void add(const model::DeploymentKey& process);
    /// Makes a remaining incarnation the current one where the current one is gone and no next one is
    /// expected.
    void settle();
  };
  using Table = std::map<model::TaskId, Incarnations>;
  /// The content of one process: the same facts as in the table, the other way round.
  struct Process {
    std::set<model::TaskId> tasks;
    std::map<model::TaskId, std::uint64_t>
        changed;                ///< number of the latest put or drop, since the last poll
    std::uint64_t dropped = 0;  ///< number of the change that dropped the whole process
    /// The tasks that changed after the poll began; forgets older changes.
    std::set<model::TaskId> changed_since(std::uint64_t poll);
  };

  [[nodiscard]] Error unknown(const model::TaskId& id) const SEGUE_REQUIRES(mutex_);
  static model::TaskId name_of(const Table::value_type& item, const model::DeploymentKey& process);
  void add(const Place& place) SEGUE_REQUIRES(mutex_);
  Table::iterator remove(Table::iterator item, const model::DeploymentKey& process) SEGUE_REQUIRES(mutex_);
  void note_change(const Place& place) SEGUE_REQUIRES(mutex_);

  mutable Mutex mutex_;  ///< protects everything below
  Table table_ SEGUE_GUARDED_BY(mutex_);
  std::map<model::DeploymentKey, Process> by_process_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t changes_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< counts puts and drops
  bool in_transition_ SEGUE_GUARDED_BY(mutex_) = false;
  /// The processes in which the transition in progress wants tasks.
  std::map<model::TaskId, model::DeploymentKey> wanted_ SEGUE_GUARDED_BY(mutex_);
  /// Their current incarnations have ended since the transition was planned.
  std::set<model::TaskId> ended_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::fleet::detail
