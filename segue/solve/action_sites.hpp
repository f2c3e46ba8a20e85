// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <vector>

namespace segue::solve {

/// The process that executes an action, and the key that its duration depends on.
struct ActionSite {
  model::ActionKey key;
  model::ProcessName process;  ///< empty: the runtime's own
  friend bool operator==(const ActionSite&, const ActionSite&) = default;
};

/// The site of each action of a transition from `current`. A connection has the site of its reader. The
/// component is empty if neither the network nor the transition defines the task. Pure; linear.
std::vector<ActionSite> action_sites(const model::Network& current, const model::Transition& transition);

}  // namespace segue::solve
