// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "deployed_robot.hpp"

namespace segue::testing {

/// A relay in a process of its own, fed by the chain.
inline constexpr const char* kRelay =
    "  relay: {component: \"fault::Relay\"}\n  sink: {component: \"fault::Watcher\"}\n";
inline constexpr const char* kWork = "  work: {tasks: [relay]}\n";
inline constexpr const char* kFlow =
    "  - {from: beater.out, to: relay.in, policy: buffer, size: 100}\n"
    "  - {from: relay.out, to: sink.in, policy: buffer, size: 100}\n";

/// A transition that is repeated with a disturbance of the robot before each of its actions in turn.
class DisturbedTransition : public DeployedRobotTest {
 protected:
  /// The second network keeps the chain, reconfigures the relay, moves `extra` to another process and adds
  /// connections.
  const model::Network one_ = network("one", std::string(kRelay) + "  extra: {component: \"fault::Relay\"}\n",
                                      std::string(kWork) + "  old: {tasks: [extra]}\n",
                                      std::string(kFlow) + "  - beater.out -> extra.in\n");
  const model::Network two_ =
      network("two",
              "  relay: {component: \"fault::Relay\", properties: {gain: 2}}\n"
              "  sink: {component: \"fault::Watcher\"}\n  extra: {component: \"fault::Relay\"}\n",
              std::string(kWork) + "  fresh: {tasks: [extra]}\n",
              std::string(kFlow) + "  - beater.out -> extra.in\n  - extra.out -> sink.in\n");

  using Disturb = std::function<void(std::size_t action)>;
  using Restore = std::function<void()>;
  /// Switches from one to two repeatedly, with a disturbance before the first action, then the second ...
  /// After `restore` the robot must reach the second network.
  void before_every_action(const std::string& what, const Disturb& disturb, const Restore& restore = {},
                           Duration action_deadline = std::chrono::seconds(60));

 private:
  /// Checks that the robot runs one of the two networks, or the runtime reports that it runs neither.
  void expect_no_secret_mixture(const runtime::SwitchResult& result);
};

}  // namespace segue::testing
