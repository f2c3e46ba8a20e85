// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/world_view.hpp>
#include <segue/task_network/fact.hpp>
#include <segue/task_network/versioned_world.hpp>

/// The world of a task network as actions of missions see it.
namespace segue::convert {

/// Attaches data that follow the facts of the world and of its copies, which belong to one thread. `facts`
/// must outlive them.
void attach(task_network::VersionedWorld& world, const task_network::FactTable& facts,
            const mission::AttachedData& data);

/// The facts that hold and, of the data attached by attach(), those with names in `data`. Linear in the
/// number of facts.
mission::WorldView view_of(const task_network::VersionedWorld& world, const task_network::FactTable& facts,
                           const mission::AttachedData& data);

}  // namespace segue::convert
