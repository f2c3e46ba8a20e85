// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/services.hpp>
#include <segue/rpc/detail/broadcast.hpp>
#include <segue/rpc/detail/decoding_server.hpp>
#include <segue/rpc_codecs/deployment_wire.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

using process_server::ProcessInfo;
using process_server::ProcessService;

void encode_processes(const std::vector<ProcessInfo>& processes,
                      capnp::List<wire::ProcessInfo>::Builder builder) {
  encode_list(processes, builder, [](const ProcessInfo& process, auto part) { encode(process, part); });
}

using ProcessEvents = Broadcast<ProcessInfo>;

class ProcessesServer final : public DecodingServer<wire::Processes> {
 public:
  ProcessesServer(Caller caller, ProcessService& service, ProcessEvents& events)
      : caller_(std::move(caller)), service_(service), events_(events) {}
  ~ProcessesServer() noexcept { caller_.client()->listeners -= listeners_.size(); }

  kj::Promise<void> start(StartContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_, launch = decode(params.getLaunch(), kServerMessageWords),
                deadline = deadline_after(params.getTimeout())]() -> Result<ProcessInfo> {
      if (!launch) return launch.error();
      const auto checked = process_server::launch_from(*launch);
      if (!checked) return checked.error();
      return service.start(*checked, deadline);
    };
    return caller_.answer(Role::Administer, context, std::move(job),
                          [](ProcessInfo& process, auto results) { encode(process, results.initProcess()); });
  }

  kj::Promise<void> stop(StopContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_, robot = as_string(params.getRobot()),
                key = model::DeploymentKey{model::HostName(as_string(params.getHost())),
                                           model::ProcessName(as_string(params.getProcess()))},
                deadline = deadline_after(params.getTimeout()), kill = params.getKill()] {
      return kill ? service.kill(robot, key, deadline) : service.stop(robot, key, deadline);
    };
    return caller_.answer(
        Role::Administer, context, std::move(job),
        [](process_server::ExitReason& reason, auto results) { encode(reason, results.initExit()); });
  }

  kj::Promise<void> processes(ProcessesContext context) override {
    return caller_.answer(
        context,
        [&service = service_, robot = as_string(context.getParams().getRobot())] {
          return service.processes(robot);
        },
        [](std::vector<ProcessInfo>& processes, auto results) {
          encode_processes(processes, results.initProcesses(count_of(processes)));
        });
  }

  kj::Promise<void> listen(ListenContext context) override {
    if (caller_.client()->listeners >= kMaxListenersPerClient) {
      encode(fail(ErrorCode::ResourceExhausted, "this client listens too often"),
             context.getResults().initError());
      return kj::READY_NOW;
    }
    auto send = [listener = context.getParams().getListener()](const std::vector<ProcessInfo>& events,
                                                               std::uint64_t lost) mutable {
      auto request = listener.reportRequest();
      request.setLost(lost);
      encode_processes(events, request.initEvents(count_of(events)));
      return request.send().ignoreResult();
    };
    listeners_.push_back(std::make_unique<ProcessEvents::Listener>(events_, std::move(send)));
    ++caller_.client()->listeners;
    return kj::READY_NOW;
  }

 private:
  Caller caller_;
  ProcessService& service_;
  ProcessEvents& events_;
  std::vector<std::unique_ptr<ProcessEvents::Listener>> listeners_;
};

class OfferedProcesses final : public OfferedService {
 public:
  explicit OfferedProcesses(ProcessService& service) : OfferedService(kProcessesKind), service_(service) {}
  capnp::Capability::Client make_server(const Caller& caller) override {
    return wire::Processes::Client(kj::heap<ProcessesServer>(caller, service_, events_));
  }
  void report_events(EventLoop* loop) override {
    if (loop == nullptr) return service_.set_listener({});
    service_.set_listener([this, loop](const ProcessInfo& event) { events_.tell(event, *loop); });
  }

 private:
  ProcessService& service_;
  ProcessEvents events_;
};

}  // namespace

std::unique_ptr<OfferedService> offer(ProcessService& service) {
  return std::make_unique<OfferedProcesses>(service);
}

}  // namespace segue::control::detail
