// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <vector>

namespace segue::solve {

/// Where an action takes place, and what its duration depends on.
struct ActionSite {
  model::ActionKey key;
  model::ProcessName process;  ///< empty: the runtime's own
  friend bool operator==(const ActionSite&, const ActionSite&) = default;
};

/// The site of each action of a transition from `current`. Of a connection it is that of the task that
/// reads. What neither the network nor the transition knows has an empty component. Pure; linear.
std::vector<ActionSite> action_sites(const model::Network& current, const model::Transition& transition);

}  // namespace segue::solve
