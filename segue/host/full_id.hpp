// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <optional>

namespace segue::host {

/// While a task moves from one process to another, two incarnations of it exist. The plain id means the one
/// that stands; the other one is told by its full id, "b@HOST/PROCESS", which names exactly one incarnation.
/// No file can name a task so, since ids there have no '@'.
model::TaskId full_id(const model::TaskId& task, const model::DeploymentKey& process);

/// An id as it was given, apart.
struct SplitId {
  model::TaskId task;                           ///< plain
  std::optional<model::DeploymentKey> process;  ///< only of a full id; the runtime's own has no name
};
SplitId split_id(const model::TaskId& id);

/// The id without the process.
model::TaskId plain_id(const model::TaskId& id);

}  // namespace segue::host
