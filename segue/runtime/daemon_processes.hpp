// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process/process_service.hpp>

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {

/// The process server of this computer (`segue host`), whichever lives: where one is gone, the next call goes
/// to its successor, which finds the processes again. Unavailable while there is none. Thread safe.
class DaemonProcesses final : public process::ProcessService {
 public:
  /// A new connection to the process server that runs.
  using Open = std::function<Result<std::unique_ptr<process::ProcessService>>()>;

  /// `robot` is whose processes are asked for to find out whether a process server still lives.
  static Result<std::unique_ptr<DaemonProcesses>> connect(std::string robot, Open open);
  ~DaemonProcesses() override { set_listener({}); }

  Result<process::ProcessInfo> start(const process::Launch& launch, TimePoint deadline) override;
  Result<process::ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                   TimePoint deadline) override;
  Result<process::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                   TimePoint deadline) override;
  Result<std::vector<process::ProcessInfo>> processes(const std::string& robot) override;
  void set_listener(Listener listener) override;

 private:
  using Service = std::shared_ptr<process::ProcessService>;

  DaemonProcesses(std::string robot, Open open, Service first)
      : robot_(std::move(robot)), open_(std::move(open)), current_(std::move(first)) {}

  template <class T, class Ask>
  Result<T> ask(Ask ask_service);
  Service current();
  /// What comes after `old`, unless that one lives; null where there is nothing.
  Service successor(const Service& old);

  const std::string robot_;
  const Open open_;
  std::mutex mutex_;
  Service current_;
  Listener listener_;
};

}  // namespace segue::runtime
