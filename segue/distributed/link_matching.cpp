// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/link_matching.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/gateways.hpp>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace segue::distributed::detail {

namespace {

using fleet::detail::Which;

/// How long senders and receivers may take to find each other.
constexpr Duration kMatching = std::chrono::seconds(10);

}  // namespace

LinkMatching::Links LinkMatching::links_of(const model::Network& network) {
  std::set<model::TaskId> tasks;
  for (const auto& task : network.tasks) {
    tasks.insert(task.id);
  }
  Links links;
  for (const auto& task : tasks) {
    const auto sender = sender_of(task);
    if (sender && tasks.contains(*sender)) {
      ++links[*sender];
      links[task] = 1;
    }
  }
  return links;
}

void LinkMatching::begin_transition(const model::Network& before) {
  Links links = links_of(before);
  const Lock lock(mutex_);
  before_ = std::move(links);
  unmatched_.reset();
}

LinkMatching::Links LinkMatching::new_links(const model::Network& target) const {
  Links links = links_of(target);
  const Lock lock(mutex_);
  std::erase_if(links, [&](const auto& link) SEGUE_REQUIRES(mutex_) {
    const auto before = before_.find(link.first);
    return before != before_.end() && before->second >= link.second;
  });
  return links;
}

void LinkMatching::get_ready(const model::Network& target) {
  const TimePoint deadline = RealClock::instance().now() + kMatching;
  std::map<const Site*, std::vector<LinkWait>> by_site;
  for (const auto& [task, count] : new_links(target)) {
    if (const auto site = sites_.locate(task, Which::Next)) {
      by_site[*site].push_back({task, count});
    }
  }
  sites_.for_all([&](const Site& site, HostedRobot& robot) -> Result<void> {
    const auto links = by_site.find(&site);
    const std::vector<LinkWait> none;
    const bool waits = links != by_site.end();
    auto ready = router_.reach(site)
                     ? robot.get_ready(sites_.part(target, site), waits ? links->second : none, deadline)
                     : Result<void>();
    if (ready || !waits) {
      return {};  // what a host has not got ready, actions do later
    }
    const Lock lock(mutex_);
    unmatched_ = ready.error();
    return {};
  });
}

Result<void> LinkMatching::outcome() const {
  const Lock lock(mutex_);
  return unmatched_ ? Result<void>(*unmatched_) : Result<void>();
}

}  // namespace segue::distributed::detail
