// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <utility>
#include <vector>

namespace segue::model {

struct Network;
struct Robot;

/// Changes to a robot's files in memory, such as for one run of an experiment.
struct RobotChanges {
  std::vector<std::pair<std::string, int>> pool_sizes;          ///< of these pools
  std::vector<std::pair<std::string, type::Value>> properties;  ///< "TASK.PROPERTY"; TASK may be a pool
};

/// Changes the pools, and the properties of each such task in all of `controllers`. NotFound for a pool, or
/// a task that neither a controller nor a pool has; InvalidArgument for a size or a name without a dot.
/// Whether components have the properties is up to validate().
Result<void> apply(const RobotChanges& changes, Robot& robot, std::vector<Network>& controllers);

}  // namespace segue::model
