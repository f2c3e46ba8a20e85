// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/daemon_processes.hpp>

#include <segue/base/log.hpp>

namespace segue::runtime {

Result<std::unique_ptr<DaemonProcesses>> DaemonProcesses::connect(std::string robot, Open open) {
  auto first = open();
  if (!first) {
    return std::move(first.error());
  }
  return std::unique_ptr<DaemonProcesses>(
      new DaemonProcesses(std::move(robot), std::move(open), std::move(*first)));
}

DaemonProcesses::Service DaemonProcesses::current() {
  const Lock lock(mutex_);
  return current_;
}

DaemonProcesses::Service DaemonProcesses::successor(const Service& old) {
  const Lock lock(mutex_);
  if (current_ != old) {
    return current_;  // another thread has reconnected already
  }
  const auto alive = old->processes(robot_);
  if (alive || alive.error().code != ErrorCode::Unavailable) {
    return nullptr;
  }
  auto next = open_();
  if (!next) {
    return nullptr;
  }
  log(LogLevel::Info, "runtime", "connected to the restarted process server");
  old->set_listener({});
  current_ = std::move(*next);
  current_->set_listener(listener_);
  return current_;
}

template <class T, class Ask>
Result<T> DaemonProcesses::ask(Ask ask_service) {
  const Service service = current();
  Result<T> answer = ask_service(*service);
  if (answer || answer.error().code != ErrorCode::Unavailable) {
    return answer;
  }
  const Service next = successor(service);
  return next == nullptr ? std::move(answer) : ask_service(*next);
}

Result<process_server::ProcessInfo> DaemonProcesses::start(const process_server::Launch& launch,
                                                           TimePoint deadline) {
  return ask<process_server::ProcessInfo>(
      [&](process_server::ProcessService& service) { return service.start(launch, deadline); });
}

Result<process_server::ExitReason> DaemonProcesses::stop(const std::string& robot,
                                                         const model::DeploymentKey& key,
                                                         TimePoint deadline) {
  return ask<process_server::ExitReason>(
      [&](process_server::ProcessService& service) { return service.stop(robot, key, deadline); });
}

Result<process_server::ExitReason> DaemonProcesses::kill(const std::string& robot,
                                                         const model::DeploymentKey& key,
                                                         TimePoint deadline) {
  return ask<process_server::ExitReason>(
      [&](process_server::ProcessService& service) { return service.kill(robot, key, deadline); });
}

Result<std::vector<process_server::ProcessInfo>> DaemonProcesses::processes(const std::string& robot) {
  return ask<std::vector<process_server::ProcessInfo>>(
      [&](process_server::ProcessService& service) { return service.processes(robot); });
}

void DaemonProcesses::set_listener(Listener listener) {
  const Lock lock(mutex_);
  listener_ = std::move(listener);
  current_->set_listener(listener_);
}

}  // namespace segue::runtime
