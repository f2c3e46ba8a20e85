// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_implementation.hpp>

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace segue::runtime {

RuntimeState detail::state_after(const SwitchResult& result, RuntimeState before) {
  switch (result.outcome) {
    case Outcome::Refused:
      return before;
    case Outcome::Done:
    case Outcome::Superseded:
      return RuntimeState::Idle;
    case Outcome::Failed:
    case Outcome::Cancelled:
      break;
  }
  const bool caught = result.undo && (result.undo->restored || result.undo->fell_back);
  return caught ? RuntimeState::Idle : RuntimeState::Failed;
}

Runtime::Implementation::Implementation(std::string robot, task_host::TaskHost& task_host,
                                        const model::ComponentCatalog& components,
                                        RuntimeOptions runtime_options)
    : RuntimeParts(std::move(robot), task_host, components, std::move(runtime_options)) {
  halts.use(controllers.halt());
  host.set_listener([this](const task_host::HostEvent& event) {
    std::visit([this](const auto& what) { on_event(what); }, event);
  });
  const detail::Observation seen = belief.observe();
  switching.adopt(seen, pools.without(seen.network), std::nullopt);
  journal.began(host.condensed(seen.network), belief.controller().name);
  worker = std::thread([this] { work(); });
}

Runtime::Implementation::~Implementation() {
  task_requests.end();
  host.set_listener({});
  auto left = queue.stop();
  log.close();
  changes.close();
  pools.close();
  if (left.request) {
    SwitchResult result = cancelled(*left.request);
    journal.ended(std::as_const(result));
    answer(*left.request, std::move(result));
  }
  if (left.files) {
    answer(*left.files, Outcome::Refused, std::nullopt,
           fail(ErrorCode::Cancelled, "the runtime ended before the files took effect"));
  }
  worker.join();
  queue.left_actions()->close();
  halts.end();
  journal.stopped();
  standby_requests.end();
}

void Runtime::Implementation::work() {
  while (auto turn = queue.next(supervisor.next())) {
    if (auto& job = turn->job.request) {
      SwitchResult result = serve(*job);
      switching.settle(detail::state_after(result, turn->before));
      answer(*job, std::move(result));
    } else if (auto& files = turn->job.files) {
      switching.settle(serve(std::move(*files), turn->before));
    } else {
      supervisor.supervise();
      continue;
    }
    standby_requests.look_again();
    queue.wake();  // to supervise whatever the request left
  }
}

void Runtime::Implementation::on_event(const task_host::TaskEvent& event) {
  belief.on_event(event);
  pools.on_event(event);
  queue.wake();
  log.add(EventKind::TaskState, event.task.str(),
          std::string(to_string(event.state)) + (event.message.empty() ? "" : ": " + event.message),
          event.state == TaskState::Exception || event.state == TaskState::Fatal);
}

void Runtime::Implementation::on_event(const task_host::ProcessEvent& event) {
  if (event.gone) {
    faults.process_ended(event.process, event.message);
  }
  pools.on_event(event);
  queue.wake();
  log.add(EventKind::Process, to_string(event.process), event.message, event.gone);
}

void Runtime::Implementation::on_event(const task_host::ComputerEvent& event) {
  if (event.reachable) {
    supervisor.host_returned(event.host);
  }
  queue.wake();
  log.add(event.reachable ? EventKind::HostFound : EventKind::HostLost, event.host.str(), event.message);
}

/// Whoever commands the robot here commands it no longer, and what waits is refused when it is planned.
void Runtime::Implementation::on_event(const task_host::LossEvent& event) {
  log.add(EventKind::Lease, "", event.message);
  leases.take_away("another runtime");
  queue.wake();
}

}  // namespace segue::runtime
