// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process_server/process_service.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>

namespace segue::process_server {

struct ProcessServerOptions {
  /// The program of deployment processes. Empty: $SEGUE_DEPLOYMENT, else `segue-deployment` beside this
  /// program, in the install prefix or in PATH.
  std::filesystem::path program{};
  /// Component libraries that a zygote preloads once; deployment processes are then forked from it.
  std::vector<std::string> zygote_libraries{};
  /// Use a zygote even without libraries to preload, as programs of users do: it suits all libraries.
  bool zygote = false;
  /// In bytes; beyond it the output of a process goes on in a new file.
  std::size_t log_size = std::size_t{10} << 20;
  int log_files = 3;  ///< older files that are kept
  /// A control group (version 2) that this user may write to; each process gets a group of its own below it,
  /// which makes each start some milliseconds slower. Empty: none.
  std::filesystem::path cgroup{};
};

/// Runs deployment processes as children of this process: started by posix_spawn (fork is not safe beside
/// other threads) or by a zygote, each in a process group of its own, and watched by pidfd on one thread.
/// They outlive this object and this process: another server finds them by their sockets and adopts them.
class ProcessServer final : public ProcessService {
 public:
  /// NotFound where there is no program for deployment processes. A zygote that cannot be started is only
  /// logged.
  static Result<std::unique_ptr<ProcessServer>> create(const ProcessServerOptions& options = {});
  /// Stops watching and leaves the processes running.
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

}  // namespace segue::process_server
