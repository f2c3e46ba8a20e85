// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/fleet/fleet.hpp>
#include <segue/fleet/remote_connector.hpp>
#include <segue/model/transition.hpp>
#include <segue/sample_link/commit_page.hpp>

#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <set>

namespace segue::fleet::detail {

/// Lets connections begin and end with the commit of a transition, in all processes at the same instant: a
/// store to the page that all of them map. Before it, each process concerned gets one message that says which
/// of its connections end; after it, one that lets it drop what is not needed any more. Neither is waited for
/// by the tasks. Thread safe; no lock is held while a process is called.
class CommitCoordinator {
 public:
  CommitCoordinator(Fleet& fleet, RemoteConnector& connector) : fleet_(fleet), connector_(connector) {}

  /// Notes that connections of these processes wait for the commit.
  void note_waiting(std::initializer_list<RecordPtr> records);

  /// Tells processes which of their connections end; to be called before the first action of Commit. A
  /// process that could not be told is an error, unless it has ended and no connection of it begins: its
  /// connections ended with it.
  Result<void> arm(const model::Transition& transition, TimePoint deadline);
  /// Commits by one store to the page.
  void commit();
  /// Gives the transition up instead of commit(): connections that would have begun are removed.
  void give_up();
  /// Tells processes that a transition has ended, if they have not heard of it yet.
  void settle();

 private:
  struct Part {
    bool begins = false;  ///< a connection of the process begins with the commit
    deploy::ArmCommit what{};
  };
  using Parts = std::map<RecordPtr, Part>;

  static Result<void> arm(ProcessRecord& process, const Part& part, TimePoint deadline);
  [[nodiscard]] Parts parts_of(const model::Transition& transition) const;
  void add_ending(const model::Connection& connection, Parts& parts) const;
  Result<std::shared_ptr<sample_link::CommitPage>> page();

  Fleet& fleet_;
  RemoteConnector& connector_;
  mutable Mutex mutex_;                                                     ///< protects all below
  std::shared_ptr<sample_link::CommitPage> page_ SEGUE_GUARDED_BY(mutex_);  ///< made for the first transition
  std::uint64_t armed_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< the number of the transition that is armed; 0: none
  std::set<RecordPtr> waiting_ SEGUE_GUARDED_BY(mutex_);  ///< processes that have to learn how it ended
};

}  // namespace segue::fleet::detail
