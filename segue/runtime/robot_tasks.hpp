// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/distributed/distributed_task_host.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <memory>

namespace segue::runtime::detail {

/// The task host of a robot: all tasks in this process, or some in processes of their own, as its options
/// say.
class RobotTasks {
 public:
  /// `libraries` and `catalog` must outlive this. With processes: AlreadyExists if another runtime has the
  /// robot, Unavailable if the daemon is to start them and does not run.
  static Result<std::unique_ptr<RobotTasks>> create(const model::Robot& robot,
                                                    const task_host::LibrarySet& libraries,
                                                    const model::ComponentCatalog& catalog,
                                                    task_host::LocalOptions local,
                                                    const EmbeddedOptions& options);

  [[nodiscard]] task_host::TaskHost& host();
  /// False while something that hangs keeps a task of this process: the destructor waits for it.
  [[nodiscard]] bool at_rest() const { return local_.at_rest(); }
  /// Kills the remaining deployment processes. Blocks, at most ten seconds.
  void end_processes();

 private:
  RobotTasks(const task_host::LibrarySet& libraries, const model::ComponentCatalog& catalog,
             task_host::LocalOptions local)
      : local_(libraries, catalog, std::move(local)) {}
  Result<void> spread(const model::Robot& robot, const model::ComponentCatalog& catalog,
                      const EmbeddedOptions& options);
  Result<void> reach_hosts(const model::Robot& robot, const model::ComponentCatalog& catalog,
                           const process_server::Launch& launch, const EmbeddedOptions& options);

  Descriptor lock_;
  std::shared_ptr<sample_link::SharedMemory> memory_;
  task_host::LocalTaskHost local_;
  std::unique_ptr<deploy::LocalDeployment> own_;
  std::unique_ptr<process_server::ProcessService> processes_;
  std::unique_ptr<fleet::DeployedTaskHost> deployed_;              ///< null: all tasks live in this process
  std::unique_ptr<distributed::DistributedTaskHost> distributed_;  ///< null: all live on this computer
};

}  // namespace segue::runtime::detail
