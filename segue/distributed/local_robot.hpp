// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/timed_mutex.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/distributed/commit_participant.hpp>
#include <segue/distributed/host_service.hpp>
#include <segue/distributed/lease.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/process_server/process_service.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <memory>

namespace segue::distributed::detail {

/// The deployment processes of one robot on this computer, as the daemon commands them. The daemon itself
/// holds no tasks.
class LocalRobot {
 public:
  /// Adopts the processes that run already. `processes` hears of this robot's only.
  LocalRobot(process_server::Launch launch, std::unique_ptr<process_server::ProcessService> processes,
             fleet::Connector connector, const model::HostName& host, const Clock& clock);

  [[nodiscard]] const process_server::Launch& launch() const { return launch_; }
  [[nodiscard]] CommitParticipant& part() { return part_; }

 private:
  const process_server::Launch launch_;
  const std::unique_ptr<process_server::ProcessService> processes_;
  const task_host::LibrarySet no_libraries_;
  const model::ComponentCatalog no_components_;
  task_host::LocalTaskHost no_tasks_{no_libraries_, no_components_};
  deploy::LocalDeployment own_;
  fleet::DeployedTaskHost tasks_;
  CommitParticipant part_;
};

/// A robot with its lease, as long as the daemon lives.
struct LeasedRobot {
  LeasedRobot(const std::string& robot, const std::filesystem::path& epoch, const Clock& clock)
      : lease(robot, epoch, clock) {}

  Lease lease;
  TimedMutex acquiring;              ///< one runtime gets the robot at a time
  std::shared_ptr<LocalRobot> here;  ///< null until the robot was acquired first; replaced while nobody works
};

/// The robot for the runtime that got `epoch`: every call is work under that epoch.
std::shared_ptr<HostedRobot> make_session(std::shared_ptr<LeasedRobot> robot, std::uint64_t epoch);

}  // namespace segue::distributed::detail
