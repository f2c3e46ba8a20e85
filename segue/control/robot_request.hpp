// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/transition.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace segue::control {

/// "speed", or "speed.max" for a member of it.
struct PropertySetting {
  model::TaskId task;
  std::string property;
  type::Value value;
};

/// Options of a request, beside its network. The same value travels from the client to the runtime.
struct RequestOptions {
  model::Order order = model::Order::Seamless;
  Duration action_deadline = std::chrono::seconds(30);  ///< for each action
  /// Removed processes are killed without stopping their tasks first (solve::Options::force).
  bool force = false;
  std::string who{};  ///< the sender, for the journal
  /// Properties in place of those of the network, so that it runs as a variant: these are part of the
  /// transition, and hold until the next request. Not for files that are applied.
  std::vector<PropertySetting> properties{};
  /// RobotLease::number() of the sender, 0: none. While another one is held, requests are refused, unless
  /// they take the robot over.
  std::uint64_t lease = 0;
  bool take_over = false;
};

/// A transition that is applied as it is: one of the robot's by its name, or else the text of a transition
/// file of 4 MiB at most, with its name for messages.
struct GivenTransition {
  std::string name{};
  std::string text{};
  std::string file{};
};

/// Who sets a property, calls an operation or writes a sample. Whoever holds the robot's lease says so; where
/// somebody else does, it is refused unless it is wanted beside what that is doing, which is an event.
struct Sender {
  std::string who{};
  std::uint64_t lease = 0;      ///< RobotLease::number(); once it is lost, nothing is done with it any more
  bool beside_mission = false;  ///< although somebody else commands the robot
};

}  // namespace segue::control
