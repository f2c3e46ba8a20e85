// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/link_matching.hpp>

#include <segue/base/text.hpp>
#include <segue/hosts/gateways.hpp>

#include <algorithm>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace segue::hosts::detail {

namespace {

using deploy::detail::Which;

/// How long senders and receivers may take to find each other.
constexpr Duration kMatching = std::chrono::seconds(10);
/// How many calls at once are made of one host, which limits them for each client.
constexpr std::size_t kCallsAtOnce = 8;

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
  const std::lock_guard lock(mutex_);
  before_ = std::move(links);
  unmatched_.reset();
}

LinkMatching::Links LinkMatching::new_links(const model::Network& target) const {
  Links links = links_of(target);
  const std::lock_guard lock(mutex_);
  std::erase_if(links, [&](const auto& link) {
    const auto before = before_.find(link.first);
    return before != before_.end() && before->second >= link.second;
  });
  return links;
}

void LinkMatching::wait_for(const model::Network& target) {
  const TimePoint deadline = RealClock::instance().now() + kMatching;
  std::map<const Site*, std::vector<std::pair<model::TaskId, int>>> by_site;
  for (const auto& [task, count] : new_links(target)) {
    if (const auto site = sites_.locate(task, Which::Next)) {
      by_site[*site].emplace_back(task, count);
    }
  }
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& [site, links] : by_site) {
    const std::size_t share = (links.size() + kCallsAtOnce - 1) / kCallsAtOnce;
    for (std::size_t first = 0; first < links.size(); first += share) {
      const std::span some(links.data() + first, std::min(share, links.size() - first));
      jobs.emplace_back([this, some, deadline] {
        for (const auto& [task, count] : some) {
          if (auto found = wait_for(task, count, deadline); !found) {
            const std::lock_guard lock(mutex_);
            unmatched_ = std::move(found.error());
          }
        }
      });
    }
  }
  sites_.pool().run_all(std::move(jobs));
}

Result<void> LinkMatching::wait_for(const model::TaskId& task, int count, TimePoint deadline) const {
  const auto site = sites_.locate(task, Which::Next);
  const auto reached = site ? router_.reach(**site) : Result<HostLink::Reached>(site.error());
  if (!reached) {
    return reached.error();
  }
  const Duration left = std::max(Duration(0), deadline - RealClock::instance().now());
  type::ValueMap arguments;
  arguments.append("count", count);
  arguments.append("timeout_ms", std::chrono::duration_cast<std::chrono::milliseconds>(left).count());
  const auto found = reached->robot->call(task, "wait_matched", std::move(arguments), deadline + patience_);
  if (!found) {
    return found.error();
  }
  const double matched = found->is_number() ? found->as_double() : 0;
  if (matched < count) {
    return fail(ErrorCode::DeadlineExceeded,
                "has found " + std::to_string(static_cast<int>(matched)) + " of " + std::to_string(count) +
                    " counterparts on other hosts within " + format_duration(kMatching) +
                    "; check the addresses of the hosts, and that UDP passes between them",
                task.str());
  }
  return {};
}

Result<void> LinkMatching::outcome() const {
  const std::lock_guard lock(mutex_);
  return unmatched_ ? Result<void>(*unmatched_) : Result<void>();
}

}  // namespace segue::hosts::detail
