// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/switching.hpp>

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/recognition.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <memory>
#include <variant>

namespace segue::runtime::detail {

std::optional<Error> RuntimeParts::refusal_of_lost_robot() const {
  auto lost = host.loss();
  if (!lost) {
    return std::nullopt;
  }
  return fail(ErrorCode::Superseded,
              "this runtime has lost the robot, and does not get it back; end it, and start one with "
              "`segue run --take-over`",
              name)
      .because_of(std::move(*lost));
}

void Switching::carry_out(const model::Network& current, const SwitchPlan& plan, Duration action_deadline,
                          SwitchResult& result, std::function<void()> committed) {
  const bool changes_controller =
      result.cause == Cause::Request || result.cause == Cause::Fallback || result.cause == Cause::Apply;
  const std::string way = changes_controller
                              ? "from " + quoted_name(result.from) + " to " + quoted_name(result.to)
                              : std::string(to_string(result.cause));
  parts_.log.add(EventKind::TransitionStarted, plan.controller.name.str(),
                 way + ": " + std::to_string(plan.transition.actions.size()) + " actions");
  const auto running = std::make_shared<Transaction>(
      context_, current, plan, transaction_options(current, action_deadline, std::move(committed)));
  parts_.queue.begin(running, result.cause);
  const auto known_before = parts_.journal.known();
  const bool may_be_prepared = changes_controller && !standby_.empty();
  const auto before =
      may_be_prepared ? BeforeTransition{current, parts_.belief.controller(), standby_} : BeforeTransition{};
  running->run(result);
  parts_.queue.end_transaction();
  savings_.learn(result);
  const model::Network after = conclude(plan, result);
  if (may_be_prepared && result.ok()) {
    result.ahead = savings_.of(result, before, plan, parts_.host, parts_.catalog,
                               known_before ? *known_before : model::ActionTimes{});
  }
  parts_.journal.ended(result, current, plan.transition, known_before,
                       {parts_.host.condensed(current), parts_.host.condensed(after)});
}

Transaction::Options Switching::transaction_options(const model::Network& current, Duration action_deadline,
                                                    std::function<void()> committed) {
  const auto fallback = parts_.controllers.fallback_name();
  auto way_out = fallback ? parts_.controllers.expanded(*fallback) : std::nullopt;
  if (way_out) {
    way_out = model::unite(*std::move(way_out), parts_.pools.part(current));
  }
  return {action_deadline, std::move(way_out),
          [this](const model::Transition& next) { look_away_from_changed(next); }, std::move(committed),
          parts_.queue.left_actions()};
}

void Switching::run_if_idle(const std::function<RuntimeState(RuntimeState)>& work) {
  if (const auto before = parts_.queue.begin_unless_waiting()) {
    settle(work(*before));
  }
}

model::Network Switching::conclude(const SwitchPlan& plan, SwitchResult& result) {
  const Observation seen = parts_.belief.observe();
  const auto held = parts_.belief.held();
  switch (result.outcome) {
    case Outcome::Refused:  // before it began
      break;
    case Outcome::Superseded:
      parts_.log.add(EventKind::RequestSuperseded, result.to.str(), "while it was prepared");
      adopt(seen, held.controller, held.wanted);
      break;
    case Outcome::Failed:
    case Outcome::Cancelled:
      conclude_failed(plan, seen, result);
      break;
    case Outcome::Done:
      // Whatever was not retired, because a newer request came or an action failed, is still there.
      adopt(seen, plan.controller, plan.controller);
      standby_ = model::subtract(parts_.pools.without(plan.target), plan.controller);
      note_differences(seen.network);
      parts_.log.add(EventKind::TransitionDone, result.to.str(),
                     "now runs " + quoted_name(result.to) + " after " +
                         std::to_string(result.actions.size()) + " actions");
      break;
  }
  result.runs = parts_.belief.controller().name;
  result.runs_version = parts_.belief.version();
  return seen.network;
}

void Switching::conclude_failed(const SwitchPlan& plan, const Observation& seen, SwitchResult& result) {
  const std::string runs = adopt_after_failure(plan, seen, result);
  Error cause = std::move(*result.error);
  const ErrorCode code = cause.code;
  const auto failed = std::ranges::find_if(
      result.actions, [](const ActionRecord& record) { return record.error.has_value(); });
  std::string subject = failed == result.actions.end() ? result.to.str() : failed->action.label();
  const std::string how =
      result.outcome == Outcome::Cancelled ? "was cancelled by " + result.cancelled_by : "failed";
  result.error =
      fail(code, "the transition to " + quoted_name(result.to) + " " + how + "; " + runs, std::move(subject));
  if (cause.cause || result.outcome == Outcome::Failed) {
    result.error = Error(*std::move(result.error)).because_of(std::move(cause));
  }
  parts_.log.add(EventKind::TransitionFailed, result.to.str(), to_string(*result.error));
}

std::string Switching::adopt_after_failure(const SwitchPlan& plan, const Observation& seen,
                                           const SwitchResult& result) {
  const auto held = parts_.belief.held();
  if (result.undo && result.undo->restored) {
    adopt(seen, held.controller, held.wanted);
    return "it was undone: the robot runs " + quoted_name(held.controller.name) + " as before";
  }
  if (result.undo && result.undo->fell_back) {
    const auto fallback = parts_.controllers.expanded(*result.undo->fallback).value_or(model::Network{});
    adopt(seen, fallback, fallback);
    return "it could not be undone: the robot now runs its fallback " + quoted_name(fallback.name);
  }
  model::Network all = parts_.pools.without(seen.network);
  all.name = name_of_running(all, held.controller, plan.controller);
  note_differences(seen.network);
  adopt(seen, all, std::nullopt);
  return "the robot now runs " + summary(all) +
         (all.name.empty() ? "" : " as " + quoted_name(all.name) + " names it");
}

void Switching::adopt(const Observation& seen, const model::Network& controller,
                      std::optional<model::Network> wanted) {
  parts_.belief.adopt(split_observation(seen.network, controller, std::move(wanted)), seen.task_events);
  look_at_what_runs();
}

void Switching::adopt_observed(const Observation& seen) {
  if (parts_.belief.is_assumed()) {
    return;
  }
  const auto held = parts_.belief.held();
  note_differences(seen.network);
  adopt(seen, held.controller, held.wanted);
}

model::NetworkName Switching::name_of_running(const model::Network& observed, const model::Network& first,
                                              const model::Network& second) const {
  for (const model::Network* candidate : {&first, &second}) {
    const bool names = !candidate->name.empty() || candidate->empty();
    if (names && equivalent(observed, *candidate)) {
      return candidate->name;
    }
  }
  return parts_.controllers.name_of(parts_.host.condensed(observed));
}

std::vector<std::string> Switching::differences_from(
    const model::Network& observed, const std::vector<task_host::ConnectionReport>* known) const {
  const model::Network shall =
      parts_.host.condensed(reachable_part(parts_.belief.held().desired(), parts_.host));
  const auto why_missing = [reports = known,
                            asked = std::optional<std::vector<task_host::ConnectionReport>>(),
                            this](const model::Connection& connection) mutable {
    if (reports == nullptr) reports = &asked.emplace(parts_.host.connections());
    const auto found = std::ranges::find_if(*reports, [&](const task_host::ConnectionReport& report) {
      return report.connection.from == connection.from && report.connection.to == connection.to &&
             !report.error.empty();
    });
    return found == reports->end() ? std::string() : found->error;
  };
  return differences(shall, parts_.host.condensed(observed), model::kMostDifferences, why_missing);
}

void Switching::note_differences(const model::Network& observed) {
  const std::string controller = parts_.belief.held().desired().name.str();
  std::set<std::string> now;
  for (auto& sentence : differences_from(observed)) {
    if (!reported_differences_.contains(sentence)) {
      parts_.log.add(EventKind::Difference, controller, sentence);
      parts_.journal.drifted(controller, sentence, "reported");
    }
    now.insert(std::move(sentence));
  }
  reported_differences_ = std::move(now);
}

void Switching::settle(RuntimeState next) {
  if (auto reset_now = parts_.queue.settle(next)) {
    reset(std::move(*reset_now));
  }
}

void Switching::reset(std::optional<model::Network> network) {
  if (parts_.queue.postpone_reset(network)) {
    return;
  }
  if (network) {
    parts_.log.add(EventKind::BeliefReset, network->name.str(), "given: " + summary(*network));
    parts_.belief.adopt_assumed(std::move(*network));
    look_at_what_runs();
  } else {
    adopt_recognised();
  }
  parts_.queue.forget_failure();
}

void Switching::adopt_recognised() {
  const auto held = parts_.belief.held();
  const Observation now = parts_.belief.observe();
  model::Network all = parts_.pools.without(now.network);
  all.name = name_of_running(all, held.wanted.value_or(held.controller), {});
  const model::Network condensed = parts_.host.condensed(all);
  auto wanted = all.name.empty() ? parts_.controllers.running_controller(condensed)
                                 : parts_.controllers.known(all.name);
  if (wanted) {
    all.name = wanted->name;
    wanted = parts_.host.expanded(with_properties_of(condensed, *std::move(wanted)));
  }
  parts_.log.add(EventKind::BeliefReset, all.name.str(), "observed: " + summary(all));
  adopt(now, wanted.value_or(all), wanted);
}

/// Where what runs was not requested, it is all that was found, so what is only prepared is not counted.
void Switching::look_at_what_runs() {
  const auto held = parts_.belief.held();
  std::set<model::TaskId> tasks;
  for (const auto& task : held.controller.tasks) {
    const bool is_prepared = task.state == TaskState::PreOperational || task.state == TaskState::Stopped;
    if (held.wanted || !is_prepared) {
      tasks.insert(task.id);
    }
  }
  halts_.look_at(tasks);
  task_requests_.look_at(held.controller);
  parts_.changes.add();
}

void Switching::look_away_from_changed(const model::Transition& transition) {
  std::set<model::TaskId> tasks;
  for (const auto& action : transition.actions) {
    const auto* changed = std::get_if<model::TaskAction>(&action.what);
    if (changed != nullptr && action.phase != model::Phase::Prepare) {
      tasks.insert(task_host::plain_id(changed->task));
    }
  }
  halts_.look_away_from(tasks);
}

}  // namespace segue::runtime::detail
