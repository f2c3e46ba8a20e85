// SPDX-License-Identifier: Apache-2.0
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <utility>
#include <variant>

namespace segue::runtime {

using detail::DevicesStopped;
using detail::PendingRequest;

namespace {

constexpr const char* kWho = "halt";  ///< requests that the runtime makes to bring the robot to rest

}  // namespace

detail::Halts::Ways Runtime::Implementation::ways_to_rest() {
  return {[this](const std::string& by) { leases.take_away(by); },
          [this](const std::string& by, Request request, Duration action_deadline) {
            return request_rest(by, std::move(request), action_deadline);
          },
          [this] { return with_devices_stopped(); }};
}

/// The request that waits is dropped, and a transition that prepares, retires or undoes gives way.
std::future<SwitchResult> Runtime::Implementation::request_rest(const std::string& by, Request request,
                                                                Duration action_deadline) {
  PendingRequest job{0, std::move(request), {}, {}};
  if (auto* controller = std::get_if<model::NetworkName>(&job.request)) {
    *controller = model::joined_name(model::controllers_in(controller->str()));
  }
  job.parts = switching.parts_of(job.request);
  const bool is_controller = std::holds_alternative<model::NetworkName>(job.request);
  job.at_commit = is_controller;
  job.options.action_deadline = action_deadline;
  job.options.who = kWho;
  job.privileges = {.although_halted = true, .leaves_lost_hosts = true, .leaves_faulty = !is_controller};
  auto future = job.promise.get_future();
  const auto wanted = detail::name_of(job.request);
  auto dropped = queue.put_before_all(std::move(job), [&](std::uint64_t number) {
    journal.accepted(number, kWho, wanted);
    log.add(EventKind::RequestAccepted, wanted.str(),
            "request " + std::to_string(number) + ", to halt the robot");
  });
  drop(by, std::move(dropped));
  return future;
}

void Runtime::Implementation::drop(const std::string& by, detail::RequestQueue::Waiting dropped) {
  const std::string why = "the robot was taken from it by " + by;
  if (auto& request = dropped.request) {
    SwitchResult result = cancelled(*request);
    result.outcome = Outcome::Cancelled;
    result.cancelled_by = by;
    result.error = fail(ErrorCode::Cancelled, why, result.to.str());
    journal.ended(std::as_const(result));
    answer(*request, std::move(result));
  }
  if (auto& files = dropped.files) {
    take_back(*files);
    answer(*files, Outcome::Refused, std::nullopt, fail(ErrorCode::Cancelled, why));
  }
}

DevicesStopped Runtime::Implementation::with_devices_stopped() const {
  DevicesStopped all{host.condensed(belief.controller()), {}};
  model::Network& network = all.network;
  network.name = model::NetworkName("stopped");
  network.version.clear();
  for (auto& task : network.tasks) {
    const auto* component = catalog.find(task.component);
    const bool has_device =
        !task.exclusive.empty() || (component != nullptr && !component->exclusive.empty());
    const bool commands = task.state != TaskState::PreOperational && task.state != TaskState::Exception;
    if (has_device && commands) {
      task.state = TaskState::Stopped;
      all.tasks.push_back(task.id);
    } else if (is_error(task.state)) {
      task.state = TaskState::PreOperational;  // where it has recovered meanwhile; else it is left as it is
    }
  }
  return all;
}

bool Runtime::Implementation::may_halt() const {
  if (belief.controller().empty() && queue.open().empty()) {
    return false;
  }
  return controllers.halt() && !queue.is_stopped();
}

void Runtime::Implementation::stop_holder(const std::optional<detail::Leases::Holder>& holder) {
  if (holder && holder->halts_at_stop && !holder->is_stopped && may_halt()) {
    halts.begin({holder->name, "its mission is stopped"}, [&] { leases.stop(holder->number); });
  }
}

std::shared_future<HaltResult> Runtime::Implementation::end_lease(std::uint64_t lease, bool keep) {
  const auto holder = leases.holder_of(lease);
  if (holder && holder->is_stopped) {
    leases.end(lease);
    return halts.latest();
  }
  const bool halts_after = holder && !keep && !holder->keeps && may_halt();
  if (!halts_after) {
    leases.end(lease);
    cancel_requests_of(lease, holder ? "the end of the lease of " + holder->name : "the end of its lease");
    standby_requests.look_again();  // what was prepared under it is not kept
    queue.wake();
    return {};
  }
  return halts.begin({holder->name, "it commands the robot no longer"}, [&] { leases.end(lease); });
}

}  // namespace segue::runtime
