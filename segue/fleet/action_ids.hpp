// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/fleet/placement_table.hpp>
#include <segue/model/transition.hpp>

/// Which incarnations of tasks actions mean, and how processes know them.
namespace segue::fleet::detail {

/// Actions that take down mean the current incarnation of a task, all others the next one.
Which which_of(model::ActionKind kind);

/// The connection with plain task ids, as processes know them.
model::Connection plain(model::Connection connection);
model::Action plain(model::Action action);

}  // namespace segue::fleet::detail
