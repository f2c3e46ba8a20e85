// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace segue::deploy::detail {

/// Which of a task's incarnations a plain id means.
enum class Which {
  Standing,  ///< the one that stood when the transition began
  Newest     ///< the one that the transition has made, where there is one
};

/// In which processes each task lives. Usually in one; while a transition moves it, its new incarnation lives
/// beside the one that stands. Processes know plain ids only. Thread safe.
class Seats {
 public:
  /// One incarnation.
  struct Place {
    model::TaskId task;  ///< plain
    model::DeploymentKey process;
    friend bool operator==(const Place&, const Place&) = default;
  };

  /// The incarnation that an id means; a full id means exactly that one, whatever `which`. NotFound with ids
  /// that there are.
  [[nodiscard]] Result<Place> find(const model::TaskId& id, Which which) const;
  /// Where a task may be made: the plain id. InvalidState where what is left of it there has to go first.
  [[nodiscard]] Result<Place> free_place(const model::TaskId& id, const model::DeploymentKey& process) const;
  /// An incarnation by any of its ids.
  [[nodiscard]] static Place place_of(const model::TaskId& id, const model::DeploymentKey& process);
  /// How an incarnation is called outside: by its plain id where it stands.
  [[nodiscard]] model::TaskId name(const model::TaskId& task, const model::DeploymentKey& process) const;

  /// It has been made: the newest where another one stands.
  void put(const Place& place);
  /// It may have been made: nobody knows.
  void put_unsure(const Place& place);
  /// Before a look at a process begins: what is put or dropped from now on is newer than what it will show.
  [[nodiscard]] std::uint64_t begin_look() const;
  /// What a process has been seen to hold by the look that began then; others of it are gone. Tasks that have
  /// been put or dropped since are left as they are.
  void learn(const model::DeploymentKey& process, const std::set<model::TaskId>& tasks, std::uint64_t look);
  void drop(const Place& place);
  /// A process is gone. Gives what its tasks were called.
  std::vector<model::TaskId> drop(const model::DeploymentKey& process);

  /// The newest stand from now on. Gives the incarnations that stood before.
  std::vector<Place> conclude();
  /// Nothing new any more; where none stands, another one does.
  void withdraw();

 private:
  struct Incarnations {
    std::vector<model::DeploymentKey> processes;
    model::DeploymentKey standing;  ///< not among them where it is gone while there is a newest
    std::optional<model::DeploymentKey> newest;
    [[nodiscard]] bool has(const model::DeploymentKey& process) const;
    void add(const model::DeploymentKey& process);
    /// Where nothing stands and nothing new is waited for.
    void settle();
  };
  using Table = std::map<model::TaskId, Incarnations>;
  /// What lives in a process, and when that changed by what was done to it.
  struct Process {
    std::set<model::TaskId> tasks;
    std::map<model::TaskId, std::uint64_t> changed;  ///< since the last look
    std::uint64_t dropped = 0;
    /// Forgets changes that the look saw; gives the tasks whose changes are newer.
    std::set<model::TaskId> changed_since(std::uint64_t look);
  };

  [[nodiscard]] Error unknown(const model::TaskId& id) const;
  static model::TaskId name_of(const Table::value_type& item, const model::DeploymentKey& process);
  Table::iterator take(Table::iterator item, const model::DeploymentKey& process);
  void note(const Place& place);

  mutable std::mutex mutex_;
  Table table_;
  std::map<model::DeploymentKey, Process> by_process_;
  std::uint64_t changes_ = 0;
};

}  // namespace segue::deploy::detail
