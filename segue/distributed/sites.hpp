// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/distributed/commit_participant.hpp>
#include <segue/distributed/host_link.hpp>
#include <segue/fleet/placement_table.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace segue::distributed::detail {

/// One computer of a robot: the runtime's own, or one that is reached through a daemon.
class Site {
 public:
  Site(model::HostName name, HostedRobot& own) : name_(std::move(name)), own_(&own) {}
  Site(HostPlace place, concurrent::ThreadPool& pool, RobotLoss& loss)
      : name_(place.name), link_(std::make_unique<HostLink>(std::move(place), pool, loss)) {}

  [[nodiscard]] const model::HostName& name() const { return name_; }
  /// nullptr: the runtime's own.
  [[nodiscard]] HostLink* link() const { return link_.get(); }
  [[nodiscard]] Result<HostLink::Reached> reach() const;
  [[nodiscard]] bool reachable() const { return link_ == nullptr || link_->reachable(); }
  /// Notes that a call over connection `number` failed (HostLink::note()).
  void note(const Error& error, std::uint64_t number) const;

 private:
  const model::HostName name_;
  HostedRobot* const own_ = nullptr;
  const std::unique_ptr<HostLink> link_;
};

/// All computers of a robot, and which task lives on which of them. Thread safe.
class Sites {
 public:
  /// `own_names`: the names of the runtime's own computer. `lost` as for RobotLoss.
  Sites(HostedRobot& own, std::vector<model::HostName> own_names, std::vector<HostPlace> hosts,
        std::function<void(const Error&)> lost);

  [[nodiscard]] const std::vector<std::unique_ptr<Site>>& all() const { return sites_; }
  /// NotFound where the robot has no such host. The key of the runtime's own process has an empty one.
  [[nodiscard]] Result<Site*> find(const model::HostName& host) const;
  [[nodiscard]] fleet::detail::PlacementTable& placements() const { return placements_; }
  [[nodiscard]] concurrent::ThreadPool& pool() const { return pool_; }
  [[nodiscard]] const RobotLoss& loss() const { return loss_; }

  /// The site of an incarnation of a task.
  [[nodiscard]] Result<Site*> locate(const model::TaskId& task, fleet::detail::Which which) const;
  /// The part of a network that is on a site.
  [[nodiscard]] model::Network part(const model::Network& network, const Site& site) const;

  /// Calls work(site, robot) for each site that can be reached, all at the same time, and returns when all
  /// have ended. A site whose call fails because nobody answered is given up.
  using Work = std::function<Result<void>(const Site& site, HostedRobot& robot)>;
  void for_all(const Work& work) const;

  /// The views of all sites in one, with tasks named by the placement table, which learns from it. Blocks
  /// until all sites have answered or are given up.
  struct Snapshot {
    HostView view;
    bool complete = false;  ///< all sites have answered
  };
  Snapshot snapshot() const;
  /// Reports of tasks that are not link tasks, with those on sites that cannot be reached as they were seen
  /// last.
  [[nodiscard]] std::vector<task_host::TaskReport> with_lost(
      std::vector<task_host::TaskReport> reports) const;

 private:
  struct Seen {
    const Site* site;
    HostView view;
  };
  void learn(const Seen& seen, std::uint64_t poll) const;

  mutable concurrent::ThreadPool pool_{"segue-hosts", {64, 4}};
  RobotLoss loss_;
  const std::vector<model::HostName> own_names_;
  std::vector<std::unique_ptr<Site>> sites_;
  mutable fleet::detail::PlacementTable placements_;
  mutable Mutex mutex_;  ///< protects the member below
  /// The processes of each site when it was seen last.
  mutable std::map<const Site*, std::set<model::DeploymentKey>> processes_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::distributed::detail
