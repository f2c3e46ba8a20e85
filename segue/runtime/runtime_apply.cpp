// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime {

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

/// Whether what happened leaves the robot without its new version.
bool is_failure(const SwitchResult& result) {
  switch (result.outcome) {
    case Outcome::Failed:
    case Outcome::Refused:
    case Outcome::Cancelled:
      return true;
    case Outcome::Done:
    case Outcome::Superseded:
      break;
  }
  return false;
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
    controllers.add(std::move(network));
  }
  return findings;
}

Diagnostics Runtime::Implementation::load(const ControllerSet& set) {
  Diagnostics findings = controllers.check(set);
  if (findings.has_errors()) {
    return findings;
  }
  for (const auto& network : set.controllers) {
    journal.loaded(network);
  }
  controllers.replace(set);
  halts.use(controllers.halt());
  return findings;
}

std::future<ApplyResult> Runtime::Implementation::apply(ControllerSet set, RequestOptions request_options) {
  PendingApply job;
  job.options = std::move(request_options);
  job.options.action_deadline = std::min(job.options.action_deadline, detail::kLongestDeadline);
  auto future = job.promise.get_future();
  const auto refuse = [&](Error why) {
    log.add(EventKind::RequestRefused, "", "the files are not applied: " + why.message);
    job.promise.set_value(
        {Outcome::Refused, controllers.compare(set, belief.controller().name), {}, std::move(why)});
  };
  if (const Diagnostics findings = controllers.check(set); findings.has_errors()) {
    refuse(findings.to_error());
    return future;
  }
  for (const auto& network : set.controllers) {
    journal.loaded(network);
  }
  const auto runs = belief.controller().name;
  std::optional<Error> refusal;
  auto older = queue.put(job, [&](PendingApply* waiting) {
    refusal = refusal_of(job.options);
    if (!refusal) {
      take_files(job, waiting, set, runs);
    }
    return !refusal;
  });
  if (refusal) {
    refuse(std::move(*refusal));
  } else if (older) {
    answer(*older, Outcome::Superseded, std::nullopt,
           fail(ErrorCode::Superseded, "newer files were applied before these took effect"));
  }
  return future;
}

void Runtime::Implementation::take_files(PendingApply& job, PendingApply* older, const ControllerSet& set,
                                         const model::NetworkName& runs) {
  leases.take_over(job.options);
  job.before = controllers.replace(set);
  if (older != nullptr) {
    job.before = std::move(older->before);
  }
  job.changes = controllers.changes_since(job.before, runs);
  log.add(EventKind::Files, "", summary(job.changes));
  halts.use(controllers.halt());
}

RuntimeState Runtime::Implementation::serve(PendingApply job, RuntimeState before) {
  const auto controller = controllers.known(belief.controller().name);
  auto result = controller ? update(job, *controller) : std::nullopt;
  if (!result) {
    answer(job, Outcome::Done, std::nullopt, std::nullopt);
    return before;
  }
  const RuntimeState next = detail::state_after(*result, before);
  remember(*result);
  if (result->outcome == Outcome::Superseded && queue.postpone(job)) {
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
  const auto [current, plan] = switching.plan_from_now(controller, job.options);
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
  queue.serve({job.number, controller.name, job.options.who, job.options.lease});
  journal.accepted(job.number, job.options.who, controller.name);
  switching.adopt_observed(current);
  switching.carry_out(current.network, *plan, job.options.action_deadline, result);
  if (result.ok()) {
    supervisor.begin_anew();
  }
  return result;
}

void Runtime::Implementation::take_back(PendingApply& job) {
  queue.take_back(job, [this](detail::Definitions before) {
    controllers.restore(std::move(before));
    halts.use(controllers.halt());
    log.add(EventKind::Files, "", "controllers rolled back");
  });
}

void Runtime::Implementation::answer(PendingApply& job, Outcome outcome,
                                     std::optional<SwitchResult> transition, std::optional<Error> error) {
  job.promise.set_value({outcome, std::move(job.changes), std::move(transition), std::move(error)});
}

}  // namespace segue::runtime
