// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/runtime/beside.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <utility>

namespace segue::runtime {

using detail::Ailment;
using detail::Observation;
using detail::Plan;
using detail::shown;

namespace {

/// For each action of what nobody waits for.
constexpr Duration kActionDeadline = std::chrono::seconds(30);

/// What a process holds in memory at the moment, in bytes; 0: it is not there.
std::uint64_t resident(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::uint64_t size = 0;
  std::uint64_t pages = 0;
  file >> size >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

detail::MemoryOf memory_of(const host::TaskHost& host) {
  std::map<model::DeploymentKey, int> pids;
  for (const auto& task : host.tasks()) {
    pids.emplace(task.process, task.pid);
  }
  return [pids = std::move(pids)](const model::DeploymentKey& process) {
    const auto found = pids.find(process);
    return found == pids.end() ? 0 : resident(found->second);
  };
}

solve::RepairScope scope_of(const std::vector<Ailment>& ailing) {
  solve::RepairScope scope;
  for (const auto& ailment : ailing) {
    if (const auto* task = std::get_if<model::TaskId>(&ailment.subject)) {
      scope.tasks.push_back(*task);
    } else {
      scope.processes.push_back(std::get<model::DeploymentKey>(ailment.subject));
    }
  }
  return scope;
}

std::string names_of(const std::vector<Ailment>& ailing) {
  std::vector<std::string> names;
  for (const auto& ailment : ailing) {
    names.push_back(ailment.name() + " " + ailment.symptom);
  }
  return listed(names);
}

/// Nobody asked for it.
SwitchResult unasked(Cause cause, const model::NetworkName& from, const model::NetworkName& to) {
  SwitchResult result;
  result.cause = cause;
  result.who = "runtime";
  result.time = std::chrono::system_clock::now();
  result.from = from;
  result.to = to;
  return result;
}

}  // namespace

TimePoint Runtime::Implementation::next_care() const {
  TimePoint next = next_look;
  for (const auto* one : {&watch, &tidying}) {
    if (const auto due = one->next()) {
      next = std::min(next, *due);
    }
  }
  return next;
}

void Runtime::Implementation::care() {
  const Observation seen = belief.look();
  next_look = RealClock::instance().now() + options.policies.watch;
  if (belief.is_given()) {
    return;
  }
  const auto held = belief.held();
  if (!belief.renew(detail::split(seen.network, held.controller, held.wanted), seen)) {
    note_news();  // somebody said meanwhile what is to be believed
    return;
  }
  note_differences(seen.network);
  repair(seen);
  tidy(seen);
  bool due = false;
  {
    const std::lock_guard lock(mutex);
    due = std::exchange(look_ahead_due, false) && !waiting;
  }
  if (due) {
    look_ahead();
  }
}

void Runtime::Implementation::repair(const Observation& seen) {
  const auto held = belief.held();
  if (!held.wanted) {
    return;
  }
  const auto ailing = detail::ailments(*held.wanted, seen.network, options.policies.on_failure);
  const auto verdict = watch.judge(ailing, RealClock::instance().now());
  tell_given_up(verdict.given_up);
  if (verdict.fallback) {
    fall_back(seen);
  } else if (!verdict.repair.empty()) {
    log.add(EventKind::Repair, held.controller.name.str(), names_of(verdict.repair));
    for (const auto& ailment : verdict.repair) {
      journal.differs(ailment.name(), ailment.name() + " " + ailment.symptom, "repaired");
    }
    mend(Cause::Repair, seen, scope_of(verdict.repair));
  }
}

void Runtime::Implementation::tell_given_up(const std::vector<Ailment>& ailing) {
  for (const auto& ailment : ailing) {
    const int attempts = watch.attempts(ailment);
    journal.differs(ailment.name(), ailment.name() + " " + ailment.symptom, "given up");
    log.add(EventKind::GivenUp, ailment.name(),
            ailment.symptom +
                (attempts == 0 ? ", and only a new process would help, which its policy 'recover' excludes"
                               : " still, after " + std::to_string(attempts) + " attempts") +
                "; the next request tries again");
  }
}

void Runtime::Implementation::fall_back(const Observation& seen) {
  const auto held = belief.held();
  const auto fallback = options.fallback ? known(*options.fallback) : std::nullopt;
  if (!fallback || fallback->name == held.controller.name) {
    return;  // its differences are told
  }
  const auto plan = detail::plan_network(seen.network, *fallback, {}, host, catalog,
                                         detail::solve_options(host, model::Order::Seamless, false));
  if (!plan) {
    log.add(EventKind::TransitionFailed, fallback->name.str(), to_string(plan.error().error));
    return;
  }
  by_itself([&](RuntimeState) {
    SwitchResult result = unasked(Cause::Fallback, held.controller.name, fallback->name);
    carry_out(seen.network, *plan, kActionDeadline, result);
    remember(result);
    return result.outcome == Outcome::Failed ? RuntimeState::Failed : RuntimeState::Idle;
  });
}

/// What stands beside and nobody wants there: what could not be retired, what a superseded request prepared.
void Runtime::Implementation::tidy(const Observation& seen) {
  const model::Network left = detail::without(belief.held().beside, warm);
  std::vector<Ailment> ailing;
  for (const auto& task : left.tasks) {
    ailing.push_back({task.id, model::FailurePolicy::Restart, "was left over", false});
  }
  for (const auto& deployment : left.deployments) {
    ailing.push_back({deployment.key(), model::FailurePolicy::Restart, "was left over", true});
  }
  const auto verdict = tidying.judge(ailing, RealClock::instance().now());
  if (!verdict.repair.empty()) {
    mend(Cause::Tidy, seen, scope_of(verdict.repair));
  }
}

void Runtime::Implementation::mend(Cause cause, const Observation& seen, const solve::RepairScope& scope) {
  const auto held = belief.held();
  Plan plan;
  plan.controller = held.wanted.value_or(held.controller);
  plan.target = detail::together(plan.controller, warm);
  auto transition = solve::repair(seen.network, plan.target, catalog,
                                  detail::solve_options(host, model::Order::Seamless, false), scope);
  if (!transition) {
    log.add(EventKind::TransitionFailed, plan.controller.name.str(), to_string(transition.error()));
    return;
  }
  if (transition->actions.empty()) {
    return;
  }
  plan.transition = std::move(*transition);
  by_itself([&](RuntimeState before) {
    SwitchResult result = unasked(cause, held.controller.name, plan.controller.name);
    carry_out(seen.network, plan, kActionDeadline, result);
    remember(result);
    return before;
  });
}

std::vector<detail::Wish> Runtime::Implementation::known_wishes() const {
  const std::lock_guard lock(mutex);
  std::vector<detail::Wish> all;
  for (const auto& wanted : wishes) {
    const auto found = controllers.find(wanted);
    all.push_back({wanted, found == controllers.end() ? std::nullopt : std::optional(found->second)});
  }
  return all;
}

detail::LookAheadPlan Runtime::Implementation::plan_ahead(const model::Network& controller) const {
  const auto all = known_wishes();
  if (all.empty()) {
    return {};
  }
  return detail::look_ahead(controller, all, catalog, options.look_ahead, memory_of(host));
}

void Runtime::Implementation::look_ahead() {
  const auto held = belief.held();
  Plan plan;
  plan.controller = held.wanted.value_or(held.controller);
  auto ahead = plan_ahead(plan.controller);
  plan.target = detail::together(plan.controller, ahead.beside);
  const Observation seen = belief.starting_point();
  auto transition = solve::diff(seen.network, plan.target, catalog,
                                detail::solve_options(host, model::Order::Seamless, false));
  // Nothing that runs is touched for the sake of what may come.
  const bool harmless = transition && std::none_of(transition->actions.begin(), transition->actions.end(),
                                                   [](const model::Action& action) {
                                                     return action.phase == model::Phase::Commit;
                                                   });
  if (harmless && !transition->actions.empty()) {
    plan.transition = std::move(*transition);
    by_itself([&](RuntimeState before) {
      SwitchResult result = unasked(Cause::LookAhead, held.controller.name, plan.controller.name);
      carry_out(seen.network, plan, kActionDeadline, result);
      for (auto& one : ahead.readiness) {
        if (result.outcome != Outcome::Done) {
          one = {one.controller, false, 0, one.tasks, result.error ? to_string(*result.error) : ""};
        } else if (const auto wished = one.prepared > 0 ? known(one.controller) : std::nullopt) {
          host.get_ready(*wished);
        }
      }
      remember(std::move(result));
      return before;
    });
  } else if (!harmless) {
    for (auto& one : ahead.readiness) {
      one = {one.controller, false, 0, one.tasks, "what runs is not as it should be"};
    }
  }
  answer_wish(std::move(ahead.readiness));
}

std::future<std::vector<Readiness>> Runtime::Implementation::wish(std::vector<model::NetworkName> wanted) {
  std::optional<std::promise<std::vector<Readiness>>> older;
  std::future<std::vector<Readiness>> future;
  std::vector<Readiness> last;
  {
    const std::lock_guard lock(mutex);
    older.swap(wish_waiting);
    wishes = std::move(wanted);
    wish_waiting.emplace();
    future = wish_waiting->get_future();
    look_ahead_due = true;
    news = true;
    last = readiness;
  }
  wake.notify_all();
  if (older) {
    older->set_value(std::move(last));
  }
  return future;
}

void Runtime::Implementation::answer_wish(std::vector<Readiness> answer) {
  std::optional<std::promise<std::vector<Readiness>>> asked;
  {
    const std::lock_guard lock(mutex);
    readiness = answer;
    asked.swap(wish_waiting);
  }
  for (const auto& one : answer) {
    log.add(EventKind::Prepared, one.controller.str(),
            one.ready ? std::to_string(one.prepared) + " of " + std::to_string(one.tasks) + " tasks are ready"
                      : one.reason);
  }
  if (asked) {
    asked->set_value(std::move(answer));
  }
}

}  // namespace segue::runtime
