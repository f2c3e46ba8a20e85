// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/solve/solve.hpp>

#include <vector>

namespace segue::solve {

/// What a repair may touch: these tasks, these processes with all that lives in them, and the connections of
/// both.
struct RepairScope {
  std::vector<model::TaskId> tasks;
  std::vector<model::DeploymentKey> processes;
  friend bool operator==(const RepairScope&, const RepairScope&) = default;
};

/// The scope as far as it must be widened: by the process of a task in Fatal, by the tasks of processes, and
/// by who sits on the place or holds a device of a task that is to be there. Tasks in the order of
/// `observed`, then of `belief`.
RepairScope widened(const RepairScope& scope, const model::Network& observed, const model::Network& belief,
                    const model::ComponentCatalog& catalog);

/// The transition that brings what the widened scope holds from what is `observed` to what it is in `belief`
/// (what shall run: no errors) and leaves all else as it is, errors included. With a scope of everything it
/// is diff(observed, belief), with an empty one it is empty. Processes that tasks of the scope need and that
/// are not there are deployed; connections to what is missing outside of the scope are left out. Fails as
/// diff() does.
Result<model::Transition> repair(const model::Network& observed, const model::Network& belief,
                                 const model::ComponentCatalog& catalog, const Options& options,
                                 const RepairScope& scope);

}  // namespace segue::solve
