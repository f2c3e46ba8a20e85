// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/reader.hpp>
#include <segue/model/robot.hpp>

#include <vector>

/// Pools of processes in robot files. Internal.
namespace segue::model::detail {

/// Reads the key `pools` of a robot file.
std::vector<Pool> read_pools(Fields& robot, const Source& source);

/// Reads the key `pool_budget` of a robot file.
PoolBudget read_pool_budget(Fields& robot, const Source& source);

/// Tasks and processes of a controller that have the names of a pool's.
void check_pools(const std::vector<Pool>& pools, const Network& controller, Diagnostics& diagnostics);

}  // namespace segue::model::detail
