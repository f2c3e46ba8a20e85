// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue::testing {

/// A mission of the robot of `segue init rover`: drives to two goals, one after the other.
inline constexpr const char* kTwoGoals = R"(mission: drive
actions:
  drive_to:
    inputs: {goal: map}
    outputs: {pose: map}
    outcomes: [arrived]
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: "{goal}"}}
      until:
        - {task: seeker, state: arrived, outcome: arrived}
        - {after: 5min}
      outputs: {pose: odometry.pose}
outcomes: [done]
outputs: {pose: map}
flows: [second.pose -> outputs.pose]
start: first
states:
  first: {action: drive_to, inputs: {goal: {x: 0.4, y: 0.0}}, on: {arrived: second}}
  second: {action: drive_to, inputs: {goal: {x: 0.4, y: 0.4}}, on: {arrived: return done}}
)";

}  // namespace segue::testing
