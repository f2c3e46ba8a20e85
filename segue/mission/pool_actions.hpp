// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/units.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/robot.hpp>

#include <vector>

/// Actions that pools of processes carry out.
namespace segue::mission {

[[nodiscard]] bool uses_pools(const Mission& mission);

/// Has each such action block a unit of the resource that is named like its pool, whose users need no order.
/// Where the mission does not declare how many units there are, there is one.
void claim_pools(Mission& mission);

/// As many units of each pool that the mission uses as it may have instances. NotFound where the robot has no
/// such pool.
[[nodiscard]] Result<UnitCounts> pool_units(const Mission& mission, const std::vector<PoolView>& pools);

/// Whether the robot has what such actions ask of it: pools, operations with their arguments, and the fields
/// of their results. Components that the catalog lacks may have anything.
void check_pools(const Mission& mission, const std::vector<model::Pool>& pools,
                 const model::ComponentCatalog& catalog, Diagnostics& diagnostics);

}  // namespace segue::mission
