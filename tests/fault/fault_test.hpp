// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "../system/system_test.hpp"
#include "processes.hpp"
#include "robot_checks.hpp"

/// A robot with tasks in several real processes, for tests of faults.
///
/// Every network has a chain that no switch touches: `beater` in process `heart` beats into `watcher` in
/// process `eye` (and into `witness`, in the runtime's own process). Disturbances are visible: the
/// watcher counts gaps, restarts and torn samples.
namespace segue::testing {

class FaultTest : public SystemTest {
 protected:
  void SetUp() override;
  /// Checks that no process of the robot and no file in its folder is left.
  void TearDown() override;

  /// A network with the chain and more, in YAML ("  task: {...}" lines).
  void write_network(const std::string& name, const std::string& tasks = {},
                     const std::string& deployments = {}, const std::string& connections = {});
  /// Starts the robot with `controller` and waits until that runs.
  void start(const std::string& controller);
  /// Kills the runtime, not the deployments.
  void kill_runtime();

  /// The processes of the robot's deployments as the system sees them, by name.
  [[nodiscard]] std::map<std::string, pid_t> deployments() const;
  [[nodiscard]] pid_t pid_of(const std::string& deployment) const {
    return testing::pid_of(folder_ / "runtime", deployment);
  }
  /// Waits until exactly these deployments run.
  void expect_deployments(const std::vector<std::string>& names);

  /// Switches and expects the outcome ("done").
  type::Value switch_to(const std::string& controller, const std::string& outcome = "done");
  /// Switches, repeatedly if processes died meanwhile; true once the robot is in the wanted state.
  [[nodiscard]] bool recover_to(const std::string& controller);
  /// Whether all tasks run in the right processes, without drift.
  [[nodiscard]] std::string what_is_wrong(const std::string& controller);

  Sight sight(const std::string& watcher = "watcher");
  /// Waits until the watcher sees new beats, then checks that the chain was never disturbed.
  void expect_undisturbed(const std::string& watcher = "watcher");
  /// Waits for an event of this kind whose text contains `words`; returns its message.
  std::string expect_event(const std::string& kind, const std::string& words);

  std::vector<std::string> run_options_;
};

}  // namespace segue::testing
