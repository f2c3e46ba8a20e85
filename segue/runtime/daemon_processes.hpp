// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/process_server/process_service.hpp>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {

/// The process server of this computer (`segue host`). If it was restarted, the next call connects to the new
/// one, which finds the processes again. Calls fail with Unavailable while there is none. Thread safe.
class DaemonProcesses final : public process_server::ProcessService {
 public:
  /// Opens a new connection to the running process server.
  using Open = std::function<Result<std::unique_ptr<process_server::ProcessService>>()>;

  /// To find out whether the process server still answers, the processes of `robot` are listed. Blocks.
  static Result<std::unique_ptr<DaemonProcesses>> connect(std::string robot, Open open);
  ~DaemonProcesses() override { set_listener({}); }

  Result<process_server::ProcessInfo> start(const process_server::Launch& launch,
                                            TimePoint deadline) override;
  Result<process_server::ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override;
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override;
  Result<std::vector<process_server::ProcessInfo>> processes(const std::string& robot) override;
  void set_listener(Listener listener) override;

 private:
  using Service = std::shared_ptr<process_server::ProcessService>;

  DaemonProcesses(std::string robot, Open open, Service first)
      : robot_(std::move(robot)), open_(std::move(open)), current_(std::move(first)) {}

  template <class T, class Ask>
  Result<T> ask(Ask ask_service);
  Service current();
  /// Replaces the connection `old` unless it still answers; null if there is no other process server.
  Service successor(const Service& old);

  const std::string robot_;
  const Open open_;
  Mutex mutex_;  ///< protects the members below; held while a lost connection is replaced
  Service current_ SEGUE_GUARDED_BY(mutex_);
  Listener listener_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime
