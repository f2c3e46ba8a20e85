// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/random_networks.hpp>

#include <map>
#include <set>
#include <string>

/// Random missions with the controllers of the rover of example 08.
namespace segue::testing {

/// What an action touches, as the mission declares it.
struct Touches {
  bool is_irreversible = false;
  std::string expected{};                   ///< the outcome that has its effects
  std::map<std::string, bool> relies_on{};  ///< facts
  std::map<std::string, bool> makes{};      ///< facts
  std::set<std::string> sees{};             ///< values
  std::set<std::string> changes{};          ///< values
  std::set<std::string> holds{};            ///< resources of one unit
  std::string controller{};                 ///< empty: it uses none
};

struct RoverMission {
  std::string text;
  std::map<std::string, Touches> states{};  ///< by name; no two states have the same
  std::set<std::string> world{};            ///< the facts that hold initially
  bool gets_low = false;                    ///< the battery does, so that a watch ends the work
};

/// A mission of plans by the pools `planner` and `scout`, motions by controllers, decisions that look at the
/// world, and notes, half of them beside a watch. Plans begin where the values of the world say that arm and
/// base will be then; some motions end otherwise than expected, some actions abort or may not begin. All of
/// that is handled: the mission ends "done", or "low" where the battery gets low, which the action `drain`
/// does.
/// Callbacks: `think`, `note`, `drain`, and `see`, which gives the final values as the output of the mission.
RoverMission random_rover_mission(Random& random);

}  // namespace segue::testing
