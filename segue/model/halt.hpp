// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/robot_condition.hpp>

#include <chrono>
#include <vector>

namespace segue::model {

/// A condition in a robot file.
struct HaltCondition {
  RobotCondition condition;
  SourceLocation where;
  friend bool operator==(const HaltCondition& a, const HaltCondition& b) {
    return a.condition == b.condition;
  }
};

/// The conditions under which a robot is at rest, and the way it comes to rest ("halt" of a robot file).
struct Halt {
  NetworkName controller;              ///< brings it to rest
  std::vector<HaltCondition> at_rest;  ///< all hold once it is; none: it is as soon as the controller runs
  Duration within = std::chrono::seconds(2);  ///< then its devices are stopped
  std::vector<HaltCondition> when;            ///< where one of these holds, the robot halts
  SourceLocation where;
  friend bool operator==(const Halt& a, const Halt& b) {
    return a.controller == b.controller && a.at_rest == b.at_rest && a.within == b.within && a.when == b.when;
  }
};

}  // namespace segue::model
