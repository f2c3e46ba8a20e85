// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <optional>

namespace segue::task_host {

/// While a task moves from one process to another, it has two incarnations. The plain id denotes the current
/// one; the full id "b@HOST/PROCESS" denotes exactly one of them. No file can contain a full id, since ids
/// there have no '@'.
model::TaskId full_id(const model::TaskId& task, const model::DeploymentKey& process);

/// An id split into task and process.
struct SplitId {
  model::TaskId task;                           ///< plain
  std::optional<model::DeploymentKey> process;  ///< only of a full id; the runtime's own process has no name
};
SplitId split_id(const model::TaskId& id);

/// The id without the process.
model::TaskId plain_id(const model::TaskId& id);

}  // namespace segue::task_host
