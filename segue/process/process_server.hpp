// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process/process_service.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>

namespace segue::process {

struct ProcessServerOptions {
  /// The program that becomes a deployment process; empty: `segue-deployment` beside this program, then in
  /// the install prefix, then in PATH ($SEGUE_DEPLOYMENT goes before all).
  std::filesystem::path program{};
  /// Preload these component libraries once in a zygote and fork deployments from it; empty: none is used.
  std::vector<std::string> zygote_libraries{};
  bool zygote = false;
  std::size_t log_size = std::size_t{10} << 20;  ///< bytes after which a process's output starts a new file
  int log_files = 3;                             ///< older ones that are kept
  /// A control group (version 2) that this user may write to: each process gets a group of its own below it.
  /// Empty: none. To enter one costs each start some milliseconds.
  std::filesystem::path cgroup{};
};

/// Deployment processes as children of this process: posix_spawn (never fork), watched by pidfd on one
/// thread, each in a process group of its own. They outlive this object and this process; another server
/// finds them again by their sockets and adopts them.
class ProcessServer final : public ProcessService {
 public:
  static Result<std::unique_ptr<ProcessServer>> create(const ProcessServerOptions& options = {});
  /// Stops watching; leaves the processes as they are.
  ~ProcessServer() override;

  Result<ProcessInfo> start(const Launch& launch, TimePoint deadline) override;
  Result<ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                          TimePoint deadline) override;
  Result<ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                          TimePoint deadline) override;
  Result<std::vector<ProcessInfo>> processes(const std::string& robot) override;
  void set_listener(Listener listener) override;

 private:
  struct Implementation;  ///< process_server_implementation.hpp
  explicit ProcessServer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::process
