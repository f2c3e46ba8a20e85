// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/rpc/detail/callback_slot.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/deployment_wire.hpp>

#include <string>
#include <utility>

namespace segue::control {

namespace {

using detail::as_text;
using detail::decode;
using detail::kGrace;
using detail::kQueryTimeout;
using detail::RpcChannel;
using detail::time_left;
using process_server::ProcessInfo;

/// Receives events from the process server.
class ListenerServer final : public wire::ProcessListener::Server {
 public:
  explicit ListenerServer(std::shared_ptr<detail::CallbackSlot<ProcessInfo>> listener)
      : listener_(std::move(listener)) {}

  kj::Promise<void> report(ReportContext context) override {
    const auto params = context.getParams();
    if (const auto lost = params.getLost(); lost > 0) {
      log(LogLevel::Warning, "control",
          std::to_string(lost) + " events of the process server came too fast and were lost");
    }
    for (const auto event : params.getEvents())
      listener_->call(decode(event));
    return kj::READY_NOW;
  }

 private:
  std::shared_ptr<detail::CallbackSlot<ProcessInfo>> listener_;
};

class ProcessesClient final : public process_server::ProcessService {
 public:
  explicit ProcessesClient(std::shared_ptr<RpcChannel> channel) : channel_(std::move(channel)) {}
  ~ProcessesClient() override { listener_->set(nullptr); }

  Result<ProcessInfo> start(const process_server::Launch& launch, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return ask<ProcessInfo>(left + kGrace, [&](wire::Processes::Client processes) {
      auto request = processes.startRequest();
      detail::put(process_server::to_value(launch), request.initLaunch());
      request.setTimeout(left.count());
      return RpcChannel::send<ProcessInfo>(request,
                                           [](auto& results) { return decode(results.getProcess()); });
    });
  }

  Result<process_server::ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override {
    return end(robot, key, deadline, false);
  }
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override {
    return end(robot, key, deadline, true);
  }
  Result<process_server::ExitReason> end(const std::string& robot, const model::DeploymentKey& key,
                                         TimePoint deadline, bool kill) {
    const Duration left = time_left(deadline);
    return ask<process_server::ExitReason>(left + kGrace, [&](wire::Processes::Client processes) {
      auto request = processes.stopRequest();
      request.setRobot(as_text(robot));
      request.setHost(as_text(key.host.str()));
      request.setProcess(as_text(key.process.str()));
      request.setTimeout(left.count());
      request.setKill(kill);
      return RpcChannel::send<process_server::ExitReason>(
          request, [](auto& results) { return decode(results.getExit()); });
    });
  }

  Result<std::vector<ProcessInfo>> processes(const std::string& robot) override {
    return ask<std::vector<ProcessInfo>>(kQueryTimeout, [&](wire::Processes::Client processes) {
      auto request = processes.processesRequest();
      request.setRobot(as_text(robot));
      return RpcChannel::send<std::vector<ProcessInfo>>(request, [](auto& results) {
        return detail::decode_list<ProcessInfo>(results.getProcesses(),
                                                [](const auto& part) { return decode(part); });
      });
    });
  }

  void set_listener(Listener listener) override {
    const bool wanted = listener != nullptr;
    listener_->set(std::move(listener));
    const Lock lock(listening_mutex_);
    if (!wanted || listening_) return;
    const auto done = ask<void>(kQueryTimeout, [this](wire::Processes::Client processes) {
      auto request = processes.listenRequest();
      request.setListener(kj::heap<ListenerServer>(listener_));
      return RpcChannel::send<void>(request, [](auto&) { return Result<void>(); });
    });
    listening_ = done.has_value();
    if (!listening_) log(LogLevel::Warning, "control", "cannot listen: " + to_string(done.error()));
  }

 private:
  template <class T, class Build>
  Result<T> ask(Duration timeout, const Build& build) {
    return channel_->ask<T>(
        timeout, [&](RpcChannel::Connection& connection) { return build(connection.as<wire::Processes>()); });
  }

  std::shared_ptr<RpcChannel> channel_;
  std::shared_ptr<detail::CallbackSlot<ProcessInfo>> listener_ =
      std::make_shared<detail::CallbackSlot<ProcessInfo>>();
  Mutex listening_mutex_;
  bool listening_ SEGUE_GUARDED_BY(listening_mutex_) = false;
};

}  // namespace

Result<std::unique_ptr<process_server::ProcessService>> connect_processes(const Endpoint& endpoint,
                                                                          Duration timeout) {
  const bool remote = std::holds_alternative<TcpEndpoint>(endpoint);
  auto channel = RpcChannel::open(
      endpoint, detail::kProcessesKind,
      "the process server" + (remote ? " of " + quote(detail::name_of(endpoint)) : ""), timeout);
  if (!channel) return channel.error();
  return std::make_unique<ProcessesClient>(std::move(*channel));
}

}  // namespace segue::control
