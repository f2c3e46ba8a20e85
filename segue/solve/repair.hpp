// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/solve/solve.hpp>

#include <vector>

namespace segue::solve {

/// The parts of a robot that a repair may touch: tasks, processes with all their tasks, and the connections
/// of these.
struct RepairScope {
  std::vector<model::TaskId> tasks;
  std::vector<model::DeploymentKey> processes;
  friend bool operator==(const RepairScope&, const RepairScope&) = default;
};

/// Widens a scope until a repair is possible: adds the processes of tasks in Fatal, the tasks of processes,
/// and tasks that occupy the placement or hold a device of a task in the scope. Tasks are in the order of
/// `observed`, then of `belief`.
RepairScope widened(const RepairScope& scope, const model::Network& observed, const model::Network& belief,
                    const model::ComponentCatalog& catalog);

/// The transition that brings the widened scope from `observed` to its form in `belief` (the desired network,
/// without errors) and leaves everything else as it is, errors included. For a scope of everything it is
/// diff(observed, belief), for an empty one it is empty. Missing processes of tasks in the scope are
/// deployed; connections to tasks that are missing outside of the scope are left out. Fails as diff() does.
Result<model::Transition> repair(const model::Network& observed, const model::Network& belief,
                                 const model::ComponentCatalog& catalog, const Options& options,
                                 const RepairScope& scope);

}  // namespace segue::solve
