// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/distributed/robot_claim.hpp>

#include <algorithm>
#include <limits>

namespace segue::distributed::detail {

void RobotClaim::choose_term(TimePoint deadline) {
  if (!request_.take_over) {
    return;
  }
  Mutex mutex;
  std::uint64_t highest = 0;
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& site : sites_.all()) {
    if (site->link() == nullptr) {
      continue;
    }
    jobs.emplace_back([&, &site = *site] {
      const auto term = site.link()->highest_term(request_.launch.robot, deadline);
      if (term) {
        const Lock lock(mutex);
        highest = std::max(highest, *term);
        told_.insert(&site);
      }
    });
  }
  sites_.pool().run_all(std::move(jobs));
  request_.term = highest == std::numeric_limits<std::uint64_t>::max() ? highest : highest + 1;
}

RobotRequest RobotClaim::first(const Site& site) const {
  RobotRequest request = request_;
  request.take_over = request.take_over && told_.contains(&site);
  return request;
}

RobotRequest RobotClaim::later() const {
  RobotRequest request = request_;
  request.take_over = false;
  return request;
}

}  // namespace segue::distributed::detail
