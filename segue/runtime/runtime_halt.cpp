// SPDX-License-Identifier: Apache-2.0
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>
#include <segue/task_host/full_id.hpp>

#include <set>
#include <utility>
#include <variant>

namespace segue::runtime {

using detail::DevicesStopped;
using detail::PendingRequest;

detail::Halts::Ways Runtime::Implementation::ways_to_rest() {
  return {[this](const std::string& by) { leases.take_away(by); },
          [this](const std::string& by, Request request, Duration action_deadline) {
            return request_rest(by, std::move(request), action_deadline);
          },
          [this] { return with_devices_stopped(); }};
}

/// What waits is dropped, and what is prepared, retired or undone gives way.
std::future<SwitchResult> Runtime::Implementation::request_rest(const std::string& by, Request request,
                                                                Duration action_deadline) {
  PendingRequest job{0, std::move(request), {}, {}};
  if (auto* controller = std::get_if<model::NetworkName>(&job.request)) {
    *controller = model::joined_name(model::controllers_in(controller->str()));
  }
  job.parts = parts_of(job.request);
  job.at_commit = std::holds_alternative<model::NetworkName>(job.request);
  job.options.action_deadline = action_deadline;
  job.options.who = "halt";
  job.options.although_halted = true;
  job.options.leaves_lost_hosts = true;
  auto future = job.promise.get_future();
  std::optional<PendingRequest> dropped;
  std::optional<detail::PendingApply> dropped_files;
  {
    const Lock lock(mutex);
    dropped.swap(waiting);
    dropped_files.swap(waiting_apply);
    job.number = ++requests;
    journal.accepted(job.number, job.options.who, detail::name_of(job.request));
    log.add(EventKind::RequestAccepted, detail::name_of(job.request).str(),
            "request " + std::to_string(job.number) + ", to halt the robot");
    waiting = std::move(job);
    if (transaction) {
      transaction->make_way_to_rest(waiting->parts.value_or(detail::NetworkParts()));
    }
  }
  wake.notify_all();
  drop(by, std::move(dropped), std::move(dropped_files));
  return future;
}

void Runtime::Implementation::drop(const std::string& by, std::optional<PendingRequest> request,
                                   std::optional<detail::PendingApply> files) {
  const std::string why = "the robot was taken from it by " + by;
  if (request) {
    SwitchResult result = cancelled(*request);
    result.outcome = Outcome::Cancelled;
    result.cancelled_by = by;
    result.error = fail(ErrorCode::Cancelled, why, result.to.str());
    journal.ended(std::as_const(result));
    answer(*request, std::move(result));
  }
  if (files) {
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
    if (has_device && task.state != TaskState::PreOperational) {
      task.state = TaskState::Stopped;
      all.tasks.push_back(task.id);
    }
  }
  return all;
}

/// Where what runs was not requested, it is all that was found, so what is only prepared is not counted.
void Runtime::Implementation::look_at_what_runs() {
  const auto held = belief.held();
  std::set<model::TaskId> tasks;
  for (const auto& task : held.controller.tasks) {
    const bool is_prepared = task.state == TaskState::PreOperational || task.state == TaskState::Stopped;
    if (held.wanted || !is_prepared) {
      tasks.insert(task.id);
    }
  }
  halts.look_at(tasks);
  changes.add();
}

void Runtime::Implementation::look_away_from_changed(const model::Transition& transition) {
  std::set<model::TaskId> tasks;
  for (const auto& action : transition.actions) {
    const auto* changed = std::get_if<model::TaskAction>(&action.what);
    if (changed != nullptr && action.phase != model::Phase::Prepare) {
      tasks.insert(task_host::plain_id(changed->task));
    }
  }
  halts.look_away_from(tasks);
}

bool Runtime::Implementation::may_halt() const {
  if (belief.controller().empty() && open_requests().empty()) {
    return false;
  }
  const Lock lock(mutex);
  return definitions.halt && !stopping;
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
    {
      const Lock lock(mutex);
      look_ahead_due = looks_ahead();  // what was prepared under it is not kept
      wake_requested = true;
    }
    wake.notify_all();
    return {};
  }
  return halts.begin({holder->name, "it commands the robot no longer"}, [&] { leases.end(lease); });
}

}  // namespace segue::runtime
