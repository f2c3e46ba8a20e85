// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

#include <map>
#include <set>

/// Tasks that earlier requests left in the observed network, and how a transition may use them. A task that
/// was to move to another process when its request was superseded, or undone, has two incarnations: the plain
/// id denotes the one that belongs to the running controller, a full id (task_host/full_id.hpp) the leftover.
namespace segue::runtime::detail {

/// The tasks of `current` that do not belong to the running controller: standby tasks and leftovers.
std::set<model::TaskId> idle_tasks(const model::Network& current, const model::Network& controller);

/// For tasks of `target`: the leftover incarnation that exists already where `target` places the task, while
/// the plain id denotes another incarnation.
std::map<model::TaskId, model::TaskId> prepared_incarnations(const model::Network& current,
                                                             const model::Network& target);

/// The network without leftover incarnations and their connections.
model::Network without_leftover_incarnations(model::Network network);

}  // namespace segue::runtime::detail
