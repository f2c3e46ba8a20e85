// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// What a request says beside its network, and how far it is.
namespace segue::runtime {

/// "speed", or "speed.max" for a member of it.
struct PropertySetting {
  model::TaskId task;
  std::string property;
  type::Value value;
};

struct RequestOptions {
  model::Order order = model::Order::Seamless;
  Duration action_deadline = std::chrono::seconds(30);  ///< for each action
  /// Removed processes are killed without stopping their tasks first (solve::Options::force).
  bool force = false;
  std::string who;  ///< the sender, for the journal
  /// Properties in place of those of the network, so that it runs as a variant: these are part of the
  /// transition, and hold until the next request.
  std::vector<PropertySetting> properties{};
  /// The lease of the sender (Runtime::take_lease), 0: none. While another one is held, requests are refused,
  /// unless they take the robot over.
  std::uint64_t lease = 0;
  bool take_over = false;
  /// Process pools end, too, and are not started again before the next request.
  bool end_pools = false;
  bool although_halted = false;  ///< accepted although the robot is halted, or lost to another runtime
  /// What is on computers that cannot be reached is left as it is, in place of a refusal.
  bool leaves_lost_hosts = false;
};

/// Who does something with tasks other than by a request (Runtime::allow).
struct TaskSender {
  std::string who;
  std::uint64_t lease = 0;      ///< 0: none
  bool beside_mission = false;  ///< although somebody else holds a lease
};

/// A request that has not ended.
struct OpenRequest {
  std::uint64_t request = 0;
  model::NetworkName to;
  std::string who;
  std::string_view state;    ///< "waiting", "planning", "prepare", "commit", "retire", "undo"
  std::string cancelled_by;  ///< empty: nobody
};

}  // namespace segue::runtime
