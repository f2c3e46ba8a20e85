// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/runtime/recognition.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {

using detail::Observation;
using detail::PendingRequest;
using detail::quoted_name;
using detail::SwitchPlan;

bool detail::is_unrecovered(const SwitchResult& result) {
  const bool caught = result.undo && (result.undo->restored || result.undo->fell_back);
  const bool went_back = result.outcome == Outcome::Failed || result.outcome == Outcome::Cancelled;
  return went_back && !caught;
}

Runtime::Implementation::Implementation(std::string robot, task_host::TaskHost& task_host,
                                        const model::ComponentCatalog& components,
                                        RuntimeOptions runtime_options)
    : WorkerMemory(runtime_options.policies.restart),
      name(std::move(robot)),
      host(task_host),
      catalog(components),
      options(std::move(runtime_options)) {
  left_actions = std::make_shared<detail::LeftActions>([this] { wake_worker(); });
  definitions.fallback = options.fallback;
  definitions.halt = options.halt ? std::make_shared<const model::Halt>(*options.halt) : nullptr;
  halts.use(definitions.halt);
  host.set_listener([this](const task_host::HostEvent& event) {
    std::visit([this](const auto& what) { on_event(what); }, event);
  });
  unseen_hosts = detail::unreachable_hosts(host);
  const Observation seen = belief.observe();
  adopt(seen, without_pools(seen.network), std::nullopt);
  journal.began(host.condensed(seen.network), belief.controller().name);
  worker = std::thread([this] { work(); });
}

Runtime::Implementation::~Implementation() {
  host.set_listener({});
  std::optional<PendingRequest> left;
  std::optional<detail::PendingApply> left_apply;
  {
    const Lock lock(mutex);
    stopping = true;
    left.swap(waiting);
    left_apply.swap(waiting_apply);
    if (transaction) {
      transaction->abandon();
    }
  }
  wake.notify_all();
  log.close();
  changes.close();
  if (left) {
    SwitchResult result = cancelled(*left);
    journal.ended(std::as_const(result));
    answer(*left, std::move(result));
  }
  if (left_apply) {
    answer(*left_apply, Outcome::Refused, std::nullopt,
           fail(ErrorCode::Cancelled, "the runtime ended before the files took effect"));
  }
  worker.join();
  left_actions->close();
  halts.end();
  journal.stopped();
  if (prepare_waiting) {
    std::vector<Readiness> none;
    for (const auto& wanted : requests_to_prepare) {
      none.push_back({wanted, false, 0, 0, "the runtime ended"});
    }
    prepare_waiting->set_value(std::move(none));
  }
}

/// Not while something is left in progress that it needs.
bool Runtime::Implementation::may_serve() const {
  return waiting && (waiting->parts ? !left_actions->concern(*waiting->parts) : !left_actions->any());
}

void Runtime::Implementation::work() {
  Lock lock(mutex);
  while (true) {
    wake.wait_until(mutex, next_supervision(), [&]() SEGUE_REQUIRES(mutex) {
      return stopping || may_serve() || waiting_apply || wake_requested;
    });
    if (stopping) {
      return;
    }
    if (waiting && !may_serve()) {
      wake.wait(mutex, [&]() SEGUE_REQUIRES(mutex) { return stopping || !waiting || may_serve(); });
      continue;
    }
    if (!waiting && waiting_apply) {
      detail::PendingApply job = *std::exchange(waiting_apply, std::nullopt);
      const RuntimeState before = std::exchange(state, RuntimeState::Executing);
      lock.unlock();
      settle(serve(std::move(job), before));
      lock.lock();
      look_ahead_due = looks_ahead();
      wake_requested = true;
      continue;
    }
    if (!waiting) {
      wake_requested = false;
      lock.unlock();
      supervise();
      lock.lock();
      continue;
    }
    PendingRequest job = *std::exchange(waiting, std::nullopt);
    served.emplace(
        detail::ServedRequest{job.number, detail::name_of(job.request), job.options.who, job.options.lease});
    const RuntimeState before = std::exchange(state, RuntimeState::Executing);
    lock.unlock();
    SwitchResult result = serve(job);
    settle(result.outcome == Outcome::Refused ? before
           : detail::is_unrecovered(result)   ? RuntimeState::Failed
                                              : RuntimeState::Idle);
    answer(job, std::move(result));
    lock.lock();
    look_ahead_due = looks_ahead();
    wake_requested = true;  // supervise whatever the request left
  }
}

void Runtime::Implementation::run_if_idle(const std::function<RuntimeState(RuntimeState)>& work) {
  RuntimeState before{};
  {
    const Lock lock(mutex);
    if (stopping || waiting || waiting_apply) {
      return;
    }
    before = std::exchange(state, RuntimeState::Executing);
  }
  settle(work(before));
}

void Runtime::Implementation::carry_out(const model::Network& current, const SwitchPlan& plan,
                                        Duration action_deadline, SwitchResult& result,
                                        std::function<void()> committed) {
  const bool changes_controller =
      result.cause == Cause::Request || result.cause == Cause::Fallback || result.cause == Cause::Apply;
  const std::string way = changes_controller
                              ? "from " + quoted_name(result.from) + " to " + quoted_name(result.to)
                              : std::string(to_string(result.cause));
  log.add(EventKind::TransitionStarted, plan.controller.name.str(),
          way + ": " + std::to_string(plan.transition.actions.size()) + " actions");
  auto way_out = expanded(fallback());
  if (way_out) {
    way_out = model::unite(*std::move(way_out), pool_part(current));
  }
  const auto running = std::make_shared<detail::Transaction>(
      context, current, plan,
      detail::Transaction::Options{action_deadline, std::move(way_out),
                                   [this](const auto& next) { look_away_from_changed(next); },
                                   std::move(committed), left_actions});
  begin(running, result.cause);
  const auto known_before = journal.known();
  const bool may_be_prepared = changes_controller && !standby.empty();
  const auto before = may_be_prepared ? detail::BeforeTransition{current, belief.controller(), standby}
                                      : detail::BeforeTransition{};
  running->run(result);
  {
    const Lock lock(mutex);
    transaction.reset();
    if (served) {
      served->ended = true;
    }
  }
  savings.learn(result);
  const model::Network after = conclude(plan, result);
  if (may_be_prepared && result.outcome == Outcome::Done) {
    result.ahead =
        savings.of(result, before, plan, host, catalog, known_before ? *known_before : model::ActionTimes{});
  }
  journal.ended(result, current, plan.transition, known_before,
                {host.condensed(current), host.condensed(after)});
}

void Runtime::Implementation::begin(const std::shared_ptr<detail::Transaction>& begun, Cause cause) {
  const Lock lock(mutex);
  transaction = begun;
  transaction_yields = cause == Cause::LookAhead || cause == Cause::Collect;
  if (stopping) {
    begun->abandon();
  } else if (served && served->cancelled_by) {
    (void)begun->cancel(*served->cancelled_by);
  } else if (waiting || (waiting_apply && transaction_yields)) {
    begun->supersede();
  }
}

model::Network Runtime::Implementation::conclude(const SwitchPlan& plan, SwitchResult& result) {
  const Observation seen = belief.observe();
  const auto held = belief.held();
  if (result.outcome == Outcome::Superseded) {
    log.add(EventKind::RequestSuperseded, result.to.str(), "while it was prepared");
    adopt(seen, held.controller, held.wanted);
  } else if (result.outcome == Outcome::Failed || result.outcome == Outcome::Cancelled) {
    conclude_failed(plan, seen, result);
  } else {
    // Whatever was not retired, because a newer request came or an action failed, is still there.
    adopt(seen, plan.controller, plan.controller);
    if (result.cause == Cause::Request || result.cause == Cause::Apply) {
      repairs.reset();
      leftover_repairs.reset();
      unseen_hosts.clear();
    }
    standby = model::subtract(without_pools(plan.target), plan.controller);
    note_differences(seen.network);
    log.add(EventKind::TransitionDone, result.to.str(),
            "now runs " + quoted_name(result.to) + " after " + std::to_string(result.actions.size()) +
                " actions");
  }
  result.runs = belief.controller().name;
  result.runs_version = belief.version();
  return seen.network;
}

void Runtime::Implementation::conclude_failed(const SwitchPlan& plan, const Observation& seen,
                                              SwitchResult& result) {
  const auto held = belief.held();
  std::string runs;
  if (result.undo && result.undo->restored) {
    adopt(seen, held.controller, held.wanted);
    runs = "it was undone: the robot runs " + quoted_name(held.controller.name) + " as before";
  } else if (result.undo && result.undo->fell_back) {
    const auto fallback = expanded(known(*result.undo->fallback)).value_or(model::Network{});
    adopt(seen, fallback, fallback);
    runs = "it could not be undone: the robot now runs its fallback " + quoted_name(fallback.name);
  } else {
    model::Network all = without_pools(seen.network);
    all.name = name_of_running(all, held.controller, plan.controller);
    runs = "the robot now runs " + detail::summary(all) +
           (all.name.empty() ? "" : " as " + quoted_name(all.name) + " names it");
    note_differences(seen.network);
    adopt(seen, all, std::nullopt);
  }
  Error cause = std::move(*result.error);
  const ErrorCode code = cause.code;
  const auto failed = std::find_if(result.actions.begin(), result.actions.end(),
                                   [](const ActionRecord& record) { return record.error.has_value(); });
  std::string subject = failed == result.actions.end() ? result.to.str() : failed->action.label();
  const std::string how =
      result.outcome == Outcome::Cancelled ? "was cancelled by " + result.cancelled_by : "failed";
  result.error =
      fail(code, "the transition to " + quoted_name(result.to) + " " + how + "; " + runs, std::move(subject));
  if (cause.cause || result.outcome == Outcome::Failed) {
    result.error = Error(*std::move(result.error)).because_of(std::move(cause));
  }
  log.add(EventKind::TransitionFailed, result.to.str(), to_string(*result.error));
}

void Runtime::Implementation::adopt(const Observation& seen, const model::Network& controller,
                                    std::optional<model::Network> wanted) {
  belief.adopt(detail::split_observation(seen.network, controller, std::move(wanted)), seen.task_events);
  look_at_what_runs();
}

std::optional<model::Network> Runtime::Implementation::known(const model::NetworkName& wanted) const {
  if (wanted.empty()) {
    return std::nullopt;
  }
  auto found = resolve(wanted);
  return found ? std::optional(std::move(*found)) : std::nullopt;
}

std::optional<model::Network> Runtime::Implementation::expanded(std::optional<model::Network> network) const {
  return network ? std::optional(host.expanded(*std::move(network))) : std::nullopt;
}

std::optional<model::Network> Runtime::Implementation::fallback() const {
  std::optional<model::NetworkName> wanted;
  {
    const Lock lock(mutex);
    wanted = definitions.fallback;
  }
  return wanted ? known(*wanted) : std::nullopt;
}

model::NetworkName Runtime::Implementation::name_of_running(const model::Network& observed,
                                                            const model::Network& first,
                                                            const model::Network& second) const {
  for (const model::Network* candidate : {&first, &second}) {
    const bool names = !candidate->name.empty() || candidate->empty();
    if (names && equivalent(observed, *candidate)) {
      return candidate->name;
    }
  }
  const model::Network condensed = host.condensed(observed);
  const Lock lock(mutex);
  return detail::name_of(condensed, definitions.controllers, catalog);
}

std::vector<std::string> Runtime::Implementation::differences_from(
    const model::Network& observed, const std::vector<task_host::ConnectionReport>* known) const {
  const model::Network shall = host.condensed(detail::reachable_part(belief.held().desired(), host));
  const auto why_missing = [reports = known,
                            asked = std::optional<std::vector<task_host::ConnectionReport>>(),
                            this](const model::Connection& connection) mutable {
    if (reports == nullptr) reports = &asked.emplace(host.connections());
    const auto found = std::ranges::find_if(*reports, [&](const task_host::ConnectionReport& report) {
      return report.connection.from == connection.from && report.connection.to == connection.to &&
             !report.error.empty();
    });
    return found == reports->end() ? std::string() : found->error;
  };
  return differences(shall, host.condensed(observed), model::kMostDifferences, why_missing);
}

void Runtime::Implementation::note_differences(const model::Network& observed) {
  const std::string controller = belief.held().desired().name.str();
  std::set<std::string> now;
  for (auto& sentence : differences_from(observed)) {
    if (!reported_differences.contains(sentence)) {
      log.add(EventKind::Difference, controller, sentence);
      journal.drifted(controller, sentence, "reported");
    }
    now.insert(std::move(sentence));
  }
  reported_differences = std::move(now);
}

/// Leaves the state Executing and performs a reset of the belief that was requested meanwhile.
void Runtime::Implementation::settle(RuntimeState next) {
  std::optional<std::optional<model::Network>> reset_now;
  {
    const Lock lock(mutex);
    state = next;
    reset_now.swap(pending_reset);
  }
  if (reset_now) {
    reset(std::move(*reset_now));
  }
}

void Runtime::Implementation::on_event(const task_host::TaskEvent& event) {
  belief.on_event(event);
  wake_worker();
  log.add(EventKind::TaskState, event.task.str(),
          std::string(to_string(event.state)) + (event.message.empty() ? "" : ": " + event.message),
          event.state == TaskState::Exception || event.state == TaskState::Fatal);
}

/// Makes the worker supervise as soon as it is idle.
void Runtime::Implementation::wake_worker() {
  {
    const Lock lock(mutex);
    wake_requested = true;
  }
  wake.notify_all();
}

void Runtime::Implementation::on_event(const task_host::ProcessEvent& event) {
  if (event.gone) {
    const Lock lock(mutex);
    ended.insert_or_assign(event.process, event.message);
  }
  wake_worker();
  log.add(EventKind::Process, to_string(event.process), event.message, event.gone);
}

void Runtime::Implementation::on_event(const task_host::ComputerEvent& event) {
  if (event.reachable) {
    const Lock lock(mutex);
    returned_hosts.insert(event.host);
  }
  wake_worker();
  log.add(event.reachable ? EventKind::HostFound : EventKind::HostLost, event.host.str(), event.message);
}

/// Whoever commands the robot here commands it no longer, and what waits is refused when it is planned.
void Runtime::Implementation::on_event(const task_host::LossEvent& event) {
  log.add(EventKind::Lease, "", event.message);
  leases.take_away("another runtime");
  wake_worker();
}

void Runtime::Implementation::reset(std::optional<model::Network> network) {
  {
    const Lock lock(mutex);
    if (state == RuntimeState::Executing) {
      pending_reset = std::move(network);
      return;
    }
  }
  if (network) {
    log.add(EventKind::BeliefReset, network->name.str(), "given: " + detail::summary(*network));
    belief.adopt_assumed(std::move(*network));
    look_at_what_runs();
  } else {
    const auto held = belief.held();
    const Observation now = belief.observe();
    model::Network all = without_pools(now.network);
    all.name = name_of_running(all, held.wanted.value_or(held.controller), {});
    auto wanted = known(all.name);
    const model::Network condensed = host.condensed(all);
    if (all.name.empty()) {
      const Lock lock(mutex);
      wanted = detail::running_controller(condensed, definitions.controllers, catalog);
    }
    if (wanted) {
      all.name = wanted->name;
      wanted = host.expanded(detail::with_properties_of(condensed, *std::move(wanted)));
    }
    log.add(EventKind::BeliefReset, all.name.str(), "observed: " + detail::summary(all));
    adopt(now, wanted.value_or(all), wanted);
  }
  const Lock lock(mutex);
  if (state == RuntimeState::Failed) {
    state = RuntimeState::Idle;
  }
}

}  // namespace segue::runtime
