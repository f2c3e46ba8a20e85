// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

#include <support/random_networks.hpp>

#include <set>
#include <string>
#include <vector>

/// Random controllers of stand-ins, and random missions that use them.
namespace segue::testing {

/// "c0", "c1", ... of a few tasks each, most of which several controllers share. Some define a task
/// differently or write to the same input, so that they cannot run at once.
std::vector<model::Network> random_controllers(Random& random);
/// The union of these controllers of one robot, which can run at once: all their tasks and connections.
model::Network united(const std::vector<model::Network>& controllers, const std::set<std::string>& names);

/// A mission of some actions with a controller each, which run for a few milliseconds.
struct RobotMission {
  struct Action {
    std::string controller;
    bool stop = false;  ///< else what it leaves runs on
  };
  std::string text;
  std::vector<Action> actions;  ///< that of the state "s0" is the first
  bool is_a_sequence = false;   ///< no states are parallel
};
/// Where actions abort, the mission goes on: every action is executed once, and the mission ends "done".
RobotMission random_robot_mission(Random& random, std::size_t controllers);

}  // namespace segue::testing
