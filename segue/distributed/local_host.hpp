// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/distributed/host_service.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/process_server/process_service.hpp>

#include <filesystem>
#include <memory>

namespace segue::distributed {

struct LocalHostOptions {
  model::HostName name;         ///< as robot files call this computer
  std::filesystem::path state;  ///< a folder for epochs and model files, which outlive the daemon
  /// Measures leases and promises to commit; must outlive the daemon and its robots.
  const Clock& clock = RealClock::instance();
};

/// The daemon of this computer: starts, watches and commands the deployment processes of robots here on
/// behalf of their runtimes. Processes outlive this, and another LocalHost finds them again.
class LocalHost final : public HostService {
 public:
  /// `processes` and `connector` as for DeployedTaskHost; `processes` must outlive this, its listener belongs
  /// to this. Fails where the state folder cannot be used.
  static Result<std::unique_ptr<LocalHost>> create(process_server::ProcessService& processes,
                                                   fleet::Connector connector,
                                                   const LocalHostOptions& options);
  /// Waits for calls in progress. The robots that were given out answer Unavailable from then on.
  ~LocalHost() override;

  Result<HostInfo> info() override;
  Result<std::chrono::system_clock::time_point> clock() override;
  Result<std::vector<LeaseInfo>> robots() override;
  Result<std::uint64_t> highest_term(const std::string& robot) override;
  Result<process_server::LogPart> log(const LogRequest& request) override;
  Result<std::shared_ptr<HostedRobot>> acquire(const RobotRequest& request, TimePoint deadline) override;

 private:
  struct Implementation;
  explicit LocalHost(std::unique_ptr<Implementation> implementation);
  const std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::distributed
