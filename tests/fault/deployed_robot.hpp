// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/deployment_client.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/runtime/runtime.hpp>

#include <support/asking_host.hpp>
#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "processes.hpp"
#include "robot_checks.hpp"

/// A robot with its runtime in this program and real deployment processes. Unlike tests through the command
/// line it can interrupt between two actions and use short deadlines.
namespace segue::testing {

/// A runtime and everything that ends with it.
class RobotLife {
 public:
  RobotLife(const process_server::Launch& launch, std::unique_ptr<process_server::ProcessService> processes,
            const fleet::DeployedOptions& options);

  runtime::Runtime& runtime() { return *runtime_; }
  task_host::TaskHost& host() { return *host_; }
  /// Between the runtime and the tasks: called before every action.
  AskingHost& asking() { return *asking_; }
  /// The tasks of the runtime's own process.
  deploy::DeploymentService& own() { return *own_; }

 private:
  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  std::unique_ptr<task_host::LocalTaskHost> local_;
  std::unique_ptr<deploy::LocalDeployment> own_;
  std::unique_ptr<process_server::ProcessService> processes_;
  std::unique_ptr<fleet::DeployedTaskHost> host_;
  std::unique_ptr<AskingHost> asking_;
  std::unique_ptr<runtime::Runtime> runtime_;
};

/// Every network of a test has a chain that no switch touches: `beater` in process `heart` beats into
/// `watcher` in process `eye` and into `witness` in the runtime's own process. Disturbances
/// are visible: watchers count gaps, restarts and torn samples.
class DeployedRobotTest : public ::testing::Test {
 protected:
  void SetUp() override;
  /// Checks that no process and no socket of the robot is left.
  void TearDown() override;

  /// The chain and more, in YAML ("  task: {...}" lines).
  static model::Network network(const std::string& name, const std::string& tasks = {},
                                const std::string& deployments = {}, const std::string& connections = {});

  /// The process service of a runtime.
  virtual std::unique_ptr<process_server::ProcessService> make_processes();
  void begin_life() { life_ = std::make_unique<RobotLife>(launch_, make_processes(), options_); }
  runtime::Runtime& runtime() { return life_->runtime(); }
  task_host::TaskHost& host() { return life_->host(); }

  runtime::SwitchResult try_switch(const model::Network& target,
                                   Duration action_deadline = std::chrono::seconds(60));
  void switch_to(const model::Network& target);
  /// How often a test that switches again and again does so: SEGUE_FAULT_SWITCHES, or 100 times, with a
  /// sanitizer 12 times.
  static int number_of_switches();
  /// Switches until the robot is in the wanted state; the first attempt may fail because of a process that
  /// has just died.
  void recover_to(const model::Network& target);

  [[nodiscard]] std::map<std::string, pid_t> deployments() const { return deployments_of(folder_); }
  [[nodiscard]] pid_t pid_of(const std::string& deployment) const {
    return testing::pid_of(folder_, deployment);
  }
  /// SIGKILL, and waits until the process is gone.
  void kill(const std::string& deployment);

  Sight sight(const std::string& watcher = "watcher");
  /// Waits for new beats, then checks that the chain was never disturbed.
  void expect_undisturbed(const std::string& watcher = "watcher");
  /// Waits for an event of which subject or message have `words`.
  void expect_event(runtime::EventKind kind, const std::string& words);

  std::filesystem::path folder_;
  process_server::Launch launch_;
  fleet::DeployedOptions options_;
  std::unique_ptr<RobotLife> life_;
};

}  // namespace segue::testing
