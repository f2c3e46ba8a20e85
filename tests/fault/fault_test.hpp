// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "../system/system_test.hpp"
#include "processes.hpp"
#include "robot_checks.hpp"

/// A robot whose tasks live in several real processes, and what may happen to them.
///
/// Every network has a chain that no switch touches: `beater` in process `heart` beats into `watcher` in
/// process `eye` (and into `witness`, in the runtime's own process). Whoever is disturbed shows it: the
/// watcher counts gaps, restarts and torn samples.
namespace segue::testing {

class FaultTest : public SystemTest {
 protected:
  void SetUp() override;
  /// Whatever happened: no process of the robot, nor anything in its folder, may be left.
  void TearDown() override;

  /// A network with the chain and more, in YAML ("  task: {...}" lines).
  void write_network(const std::string& name, const std::string& tasks = {},
                     const std::string& deployments = {}, const std::string& connections = {});
  /// Runs the robot, switched to `controller`, until it is there.
  void start(const std::string& controller);
  /// Kills what runs of the runtime (not the deployments).
  void kill_runtime();

  /// The processes of the robot's deployments as the system sees them, by name.
  [[nodiscard]] std::map<std::string, pid_t> deployments() const;
  [[nodiscard]] pid_t pid_of(const std::string& deployment) const {
    return testing::pid_of(folder_ / "runtime", deployment);
  }
  /// Waits until the deployments are just these.
  void expect_deployments(const std::vector<std::string>& names);

  /// Switches and expects the outcome ("done").
  type::Value switch_to(const std::string& controller, const std::string& outcome = "done");
  /// Switches, again where processes died meanwhile: true as soon as everything is as it should be.
  [[nodiscard]] bool recover_to(const std::string& controller);
  /// Whether all tasks run, in the right processes, and nothing differs from the belief.
  [[nodiscard]] std::string what_is_wrong(const std::string& controller);

  Sight sight(const std::string& watcher = "watcher");
  /// Waits until the watcher sees new beats; then checks that nothing has ever been wrong.
  void expect_undisturbed(const std::string& watcher = "watcher");
  /// Waits for an event of this kind whose text has `words`; answers its message.
  std::string expect_event(const std::string& kind, const std::string& words);

  std::vector<std::string> run_options_;
};

}  // namespace segue::testing
