// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime {

using detail::Definitions;
using detail::PendingApply;
using detail::quoted_name;

namespace {

/// "changed: a and b; added: c", for events.
std::string summary(const std::vector<ControllerChange>& changes) {
  using Kind = ControllerChange::Kind;
  std::string text;
  for (const Kind kind : {Kind::Changed, Kind::Added, Kind::Removed}) {
    std::vector<std::string> names;
    for (const auto& change : changes) {
      if (change.kind == kind) {
        names.push_back(change.controller.str());
      }
    }
    if (!names.empty()) {
      text += (text.empty() ? "" : "; ") + std::string(to_string(kind)) + ": " + listed(names);
    }
  }
  return text.empty() ? "no controller has changed" : text;
}

/// The same as before where it is equal, so that nobody begins to watch anew.
std::shared_ptr<const model::Halt> halt_of(const ControllerSet& set,
                                           const std::shared_ptr<const model::Halt>& before) {
  if (!set.halt) {
    return nullptr;
  }
  return before && *before == *set.halt ? before : std::make_shared<const model::Halt>(*set.halt);
}

/// Whether what happened leaves the robot without its new version.
bool is_failure(const SwitchResult& result) {
  return result.outcome == Outcome::Failed || result.outcome == Outcome::Refused ||
         result.outcome == Outcome::Cancelled;
}

}  // namespace

Diagnostics Runtime::Implementation::add(model::Network network) {
  Diagnostics findings = detail::check_runnable(network, host, catalog);
  if (network.name.empty() && !network.empty()) {
    findings.error("missing-name", "a controller needs a name to be requested by", {network.file, 0, 0});
  }
  if (network.name.str().find(model::kControllerSeparator) != std::string::npos) {
    findings.error("invalid-name", "the name of a controller must not contain '+', which joins controllers",
                   {network.file, 0, 0});
  }
  if (!findings.has_errors()) {
    journal.loaded(network);
    const Lock lock(mutex);
    definitions.loaded.erase(network.name);
    definitions.controllers.insert_or_assign(network.name, std::move(network));
  }
  return findings;
}

Diagnostics Runtime::Implementation::check(const ControllerSet& set) const {
  Diagnostics findings;
  for (const auto& network : set.controllers) {
    findings.append(detail::check_runnable(network, host, catalog));
  }
  return findings;
}

Definitions Runtime::Implementation::definitions_with(const ControllerSet& set) const {
  Definitions all{definitions.controllers, {}, set.fallback, halt_of(set, definitions.halt), set.files};
  std::erase_if(all.controllers, [&](const auto& entry) SEGUE_REQUIRES(mutex) {
    return definitions.loaded.contains(entry.first);
  });
  for (const auto& network : set.controllers) {
    all.loaded.insert(network.name);
    all.controllers.insert_or_assign(network.name, network);
  }
  return all;
}

std::vector<ControllerChange> Runtime::Implementation::compare(const ControllerSet& set) const {
  const auto runs = belief.controller().name;
  const Lock lock(mutex);
  return runtime::compare(definitions.controllers, definitions_with(set).controllers, runs);
}

Diagnostics Runtime::Implementation::load(const ControllerSet& set) {
  Diagnostics findings = check(set);
  if (findings.has_errors()) {
    return findings;
  }
  for (const auto& network : set.controllers) {
    journal.loaded(network);
  }
  const Lock lock(mutex);
  definitions = definitions_with(set);
  halts.use(definitions.halt);
  return findings;
}

std::future<ApplyResult> Runtime::Implementation::apply(ControllerSet set, RequestOptions request_options) {
  PendingApply job;
  job.options = std::move(request_options);
  job.options.action_deadline = std::min(job.options.action_deadline, detail::kLongestDeadline);
  auto future = job.promise.get_future();
  const auto refuse = [&](Error why, Diagnostics findings) {
    log.add(EventKind::RequestRefused, "", "the files are not applied: " + why.message);
    job.promise.set_value({Outcome::Refused, compare(set), {}, std::move(why), std::move(findings)});
  };
  if (Diagnostics findings = check(set); findings.has_errors()) {
    Error why = findings.to_error();
    refuse(std::move(why), std::move(findings));
    return future;
  }
  for (const auto& network : set.controllers) {
    journal.loaded(network);
  }
  const auto runs = belief.controller().name;
  std::optional<PendingApply> older;
  std::optional<Error> refusal;
  {
    const Lock lock(mutex);
    refusal = refusal_of(job.options);
    if (!refusal) {
      leases.take_over(job.options);
      older = take_files(std::move(job), set, runs);
    }
  }
  if (refusal) {
    refuse(std::move(*refusal), {});
    return future;
  }
  wake.notify_all();
  if (older) {
    answer(*older, Outcome::Superseded, std::nullopt,
           fail(ErrorCode::Superseded, "newer files were applied before these took effect"));
  }
  return future;
}

std::optional<PendingApply> Runtime::Implementation::take_files(PendingApply job, const ControllerSet& set,
                                                                const model::NetworkName& runs) {
  std::optional<PendingApply> older;
  job.number = ++requests;
  job.before = std::exchange(definitions, definitions_with(set));
  older.swap(waiting_apply);
  if (older) {
    job.before = std::move(older->before);
  }
  job.changes = runtime::compare(job.before.controllers, definitions.controllers, runs);
  log.add(EventKind::Files, "", summary(job.changes));
  waiting_apply = std::move(job);
  halts.use(definitions.halt);
  if (transaction && transaction_yields) {
    transaction->supersede();
  }
  return older;
}

RuntimeState Runtime::Implementation::serve(PendingApply job, RuntimeState before) {
  const auto controller = known(belief.controller().name);
  auto result = controller ? update(job, *controller) : std::nullopt;
  if (!result) {
    answer(job, Outcome::Done, std::nullopt, std::nullopt);
    return before;
  }
  const RuntimeState next = result->outcome == Outcome::Refused ? before
                            : detail::is_unrecovered(*result)   ? RuntimeState::Failed
                                                                : RuntimeState::Idle;
  remember(*result);
  if (result->outcome == Outcome::Superseded && postpone(job)) {
    return next;
  }
  if (is_failure(*result) && result->runs_version != controller->version) {
    take_back(job);
  }
  auto error = result->error;
  const Outcome outcome = result->outcome;
  answer(job, outcome, std::move(result), std::move(error));
  return next;
}

std::optional<SwitchResult> Runtime::Implementation::update(const PendingApply& job,
                                                            const model::Network& controller) {
  const TimePoint begin = RealClock::instance().now();
  const auto [current, plan] = plan_from_now(controller, job.options);
  SwitchResult result;
  result.cause = Cause::Apply;
  result.request = job.number;
  result.who = job.options.who;
  result.time = std::chrono::system_clock::now();
  result.order = job.options.order;
  result.from = result.to = result.runs = controller.name;
  result.from_version = result.runs_version = belief.version();
  result.to_version = controller.version;
  result.solve_time = RealClock::instance().now() - begin;
  if (!plan) {
    return refused(std::move(result), plan.error());
  }
  if (plan->transition.actions.empty() && result.from_version == result.to_version) {
    return std::nullopt;
  }
  {
    const Lock lock(mutex);
    served.emplace(detail::ServedRequest{job.number, controller.name, job.options.who, job.options.lease});
  }
  journal.accepted(job.number, job.options.who, controller.name);
  const auto held = belief.held();
  if (!belief.is_assumed()) {
    note_differences(current.network);
    adopt(current, held.controller, held.wanted);
  }
  carry_out(current.network, *plan, job.options.action_deadline, result);
  return result;
}

bool Runtime::Implementation::postpone(PendingApply& job) {
  const Lock lock(mutex);
  if (stopping) {
    return false;
  }
  if (waiting_apply) {
    waiting_apply->before = std::move(job.before);
    return false;
  }
  waiting_apply = std::move(job);
  return true;
}

void Runtime::Implementation::take_back(PendingApply& job) {
  const Lock lock(mutex);
  if (waiting_apply) {
    waiting_apply->before = std::move(job.before);
    return;
  }
  definitions = std::move(job.before);
  log.add(EventKind::Files, "", "controllers rolled back");
}

void Runtime::Implementation::answer(PendingApply& job, Outcome outcome,
                                     std::optional<SwitchResult> transition, std::optional<Error> error) {
  Diagnostics findings = transition ? transition->diagnostics : Diagnostics{};
  job.promise.set_value(
      {outcome, std::move(job.changes), std::move(transition), std::move(error), std::move(findings)});
}

}  // namespace segue::runtime
