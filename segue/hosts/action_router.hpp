// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/hosts/sites.hpp>
#include <segue/model/transition.hpp>

#include <condition_variable>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace segue::hosts::detail {

/// Sends actions to the computers where they have to be carried out, and keeps a transition together: a
/// computer whose connection was made anew since the transition began has given it up, and takes no more of
/// its actions. Thread safe.
class ActionRouter {
 public:
  explicit ActionRouter(Sites& sites) : sites_(sites) {}

  /// As TaskHost::begin_all: one message for each computer.
  void begin(std::vector<model::Action> actions, TimePoint deadline, host::Completion completed);

  /// Waits until all actions that were begun are reported.
  void close();

  /// From now on until end_transition(), only computers that can be reached now, through the connections of
  /// now, take part.
  void begin_transition(const model::Network& before, const model::Network& target);
  void end_transition();
  /// Whether a connection carries samples whenever it is there, not from commit to commit. What a new
  /// receiver delivers begins and ends with what its sender gets on the other computer, so that no sample is
  /// lost between the commits of both. A receiver that goes on delivers to each reader from commit to commit,
  /// so that no sample gets to two readers of which one takes the other's place.
  [[nodiscard]] bool at_once(const model::Connection& connection) const;
  /// The computer as the transition in progress may use it; Unavailable where its connection is another one.
  Result<HostLink::Reached> reach(const Site& site) const;

 private:
  using Indices = std::vector<std::size_t>;
  struct HandOver {
    std::size_t index = 0;
    Site* from = nullptr;
    Site* to = nullptr;
  };
  struct Batch {
    std::vector<model::Action> actions;
    TimePoint deadline;
    host::Completion completed;
    std::map<Site*, Indices> at_site;
    std::vector<HandOver> hand_overs;
    /// Actions that begin when another one, that with the key's index, has ended.
    std::map<std::size_t, std::map<Site*, Indices>> afterwards;
  };
  using BatchPtr = std::shared_ptr<const Batch>;

  [[nodiscard]] model::Action for_host(model::Action action) const;
  [[nodiscard]] Result<void> place(std::size_t index, Batch& batch) const;
  [[nodiscard]] Result<Site*> site_of(const model::Action& action) const;
  [[nodiscard]] Result<Site*> site_of(const model::Action& action, const model::Connection& connection) const;
  /// What a sender had taken is delivered before its receivers stop and are disconnected.
  static void defer_receivers(Batch& batch);
  void begin_at(Site& site, const Indices& indices, const BatchPtr& batch);
  void begin_hand_over(const HandOver& what, const BatchPtr& batch);
  Result<void> hand_over(const HandOver& what, const model::HandOverAction& action, TimePoint deadline) const;
  void note_placement(const model::Action& action, const Result<void>& outcome) const;
  void report(const BatchPtr& batch, std::vector<host::Completed> ended);

  Sites& sites_;
  mutable std::mutex mutex_;  ///< protects everything below
  std::condition_variable idle_;
  std::size_t in_progress_ = 0;                                      ///< actions that are not reported yet
  std::optional<std::map<const Site*, std::uint64_t>> connections_;  ///< of the transition in progress
  std::set<model::TaskId> kept_;  ///< receivers that the transition in progress leaves as they are
};

}  // namespace segue::hosts::detail
