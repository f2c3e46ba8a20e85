// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/program.hpp>

#include <string>
#include <utility>
#include <vector>

namespace segue::mission {

/// A controller that a mission is likely to use.
struct UpcomingController {
  std::string controller;
  double probability = 0;  ///< that it is used at all, from now on as far as was looked
  Duration after{};        ///< expected time until it is used first
};

/// Whether `a` comes before `b` where the likeliest are first, and of those the sooner ones.
[[nodiscard]] inline bool sooner_or_likelier(const UpcomingController& a, const UpcomingController& b) {
  return std::pair(-a.probability, a.after) < std::pair(-b.probability, b.after);
}

/// The controllers that lie ahead of a leaf that begins now, the likeliest first, and among equals the sooner
/// ones. Follows the plan: an action ends with each outcome as often as outcome_likelihoods() says, and takes
/// as long as is expected of it. The search ends where what remains is less likely than one in a hundred. A
/// controller whose name depends on an input is known only where that input is constant. Behind the end of a
/// library, all states that use it are looked at; of a loop, three rounds. Pure; takes time in proportion to
/// the size of the mission.
std::vector<UpcomingController> upcoming_controllers(const Program& program, StateIndex from);

}  // namespace segue::mission
