// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/look_ahead_savings.hpp>
#include <segue/runtime/supervision.hpp>

#include <set>
#include <string>

namespace segue::runtime::detail {

/// What the worker of a Runtime remembers from one request or look at the robot to the next. Used by that
/// thread only.
struct WorkerMemory {
  explicit WorkerMemory(const model::RestartPolicy& restart)
      : repairs(restart, AfterLimit::GiveUp),
        leftover_repairs(restart, AfterLimit::GoOn),
        pool_repairs(restart, AfterLimit::GoOn) {}

  RepairScheduler repairs;
  RepairScheduler leftover_repairs;
  RepairScheduler pool_repairs;
  std::set<model::TaskId> pool_instances_seen;  ///< those that have run
  /// Not reachable since the start, while nothing has been requested: what they hold is not known.
  std::set<model::HostName> unseen_hosts;
  std::set<std::string> reported_differences;  ///< differences that last and were reported
  LookAheadSavings savings;
  model::Network standby;  ///< the part of `extra` that is kept on standby on purpose; the rest are leftovers
  TimePoint next_observation = RealClock::instance().now();
};

}  // namespace segue::runtime::detail
