// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/transaction.hpp>

#include <segue/base/text.hpp>
#include <segue/runtime/beside.hpp>
#include <segue/solve/solve.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>

namespace segue::runtime::detail {

namespace {

constexpr std::array kPhases = {model::Phase::Prepare, model::Phase::Commit, model::Phase::Retire};

/// Tasks that hang in the runtime's own process, which no transition can replace.
std::set<model::TaskId> stuck_tasks(const model::Network& observed) {
  std::set<model::TaskId> stuck;
  for (const auto& task : observed.tasks) {
    if (task.state == TaskState::Fatal) {
      stuck.insert(task.id);
    }
  }
  for (const auto& deployment : observed.deployments) {
    for (const auto& placement : deployment.tasks) {
      stuck.erase(placement.task);
    }
  }
  return stuck;
}

/// The target with those tasks as they are: all else can be done.
model::Network with_stuck(model::Network target, const model::Network& observed) {
  const auto stuck = stuck_tasks(observed);
  if (stuck.empty()) {
    return target;
  }
  std::erase_if(target.tasks, [&](const model::Task& task) { return stuck.contains(task.id); });
  for (auto& deployment : target.deployments) {
    std::erase_if(deployment.tasks,
                  [&](const model::Placement& placement) { return stuck.contains(placement.task); });
  }
  std::erase_if(target.connections, [&](const model::Connection& wanted) {
    const bool ends_there = stuck.contains(wanted.from.task) || stuck.contains(wanted.to.task);
    const auto& there = observed.connections;
    return ends_there && std::find(there.begin(), there.end(), wanted) == there.end();
  });
  for (const auto& id : stuck) {
    target.tasks.push_back(*observed.find_task(id));
  }
  return target;
}

/// What of a network can be reached: a task that is in an error there stays as it is now, or is left clean.
model::Network reachable(model::Network target, const model::Network& observed) {
  for (auto& task : target.tasks) {
    if (!is_error(task.state)) {
      continue;
    }
    const model::Task* now = observed.find_task(task.id);
    task.state = now != nullptr && !is_error(now->state) ? now->state : TaskState::PreOperational;
  }
  return with_stuck(std::move(target), observed);
}

/// Whether all of `before` runs as it did (no worse, where it was in an error), and what stands beside it
/// does not interfere.
bool is_restored(model::Network before, const model::Network& observed) {
  const model::Network beside = without(observed, before);
  const bool runs_alone = std::none_of(beside.tasks.begin(), beside.tasks.end(), [](const model::Task& task) {
    return task.state == TaskState::Running || task.state == TaskState::RunTimeError;
  });
  const bool hears_no_other = std::none_of(
      beside.connections.begin(), beside.connections.end(),
      [&](const model::Connection& other) { return before.find_task(other.to.task) != nullptr; });
  for (auto& task : before.tasks) {
    const model::Task* now = observed.find_task(task.id);
    if (is_error(task.state) && now != nullptr && !is_error(now->state)) {
      task.state = now->state;
    }
  }
  return runs_alone && hears_no_other && has_all_of(observed, before);
}

Error error_of(const ActionRecord& failed) {
  Error error = *failed.error;
  if (error.subject.empty()) {
    error.subject = failed.action.label();
  }
  return error;
}

/// Actions that only take something down.
bool takes_down(model::ActionKind kind) {
  using enum model::ActionKind;
  return kind == Recover || kind == Stop || kind == Disconnect || kind == Cleanup || kind == Undeploy;
}

}  // namespace

Transaction::Transaction(const Ground& ground, const model::Network& before, const Plan& plan,
                         Options options)
    : ground_(ground), before_(before), plan_(plan), options_(std::move(options)) {}

void Transaction::give_way() {
  const std::lock_guard lock(mutex_);
  giving_way_ = true;
  if (execution_ && (stage_ == Stage::Prepare || stage_ == Stage::Retire)) {
    execution_->cancel();
  }
}

void Transaction::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (execution_) {
    execution_->cancel();
  }
}

bool Transaction::enter(Stage stage) {
  const std::lock_guard lock(mutex_);
  const bool gives_way = giving_way_ && stage != Stage::Back;
  if (cancelled_ || gives_way) {
    return false;
  }
  stage_ = stage;
  return true;
}

std::shared_ptr<Execution> Transaction::begin(const model::Transition& transition) {
  auto made = std::make_shared<Execution>(ground_.host, transition, options_.action_deadline,
                                          [this](const ActionRecord& record) { on_action(record); });
  const std::lock_guard lock(mutex_);
  execution_ = made;
  if (cancelled_) {
    made->cancel();
  }
  return made;
}

void Transaction::run(SwitchResult& result) {
  const TimePoint started = RealClock::instance().now();
  ground_.host.expect(plan_.target);
  forward(result);
  {
    const std::lock_guard lock(mutex_);
    execution_.reset();
  }
  result.duration = RealClock::instance().now() - started;
}

void Transaction::forward(SwitchResult& result) {
  const auto execution = begin(plan_.transition);
  const bool prepared = enter(Stage::Prepare) && execution->run(model::Phase::Prepare);
  const TimePoint made = RealClock::instance().now();
  if (prepared) {
    ground_.host.get_ready(plan_.target);
  }
  const Duration getting_ready = RealClock::instance().now() - made;
  const bool committed = prepared && enter(Stage::Commit) && execution->run(model::Phase::Commit);
  if (committed) {
    retire(*execution, result);
  }
  result.prepare = execution->window(model::Phase::Prepare) + getting_ready;
  result.commit = execution->window(model::Phase::Commit);
  result.retire = execution->window(model::Phase::Retire);
  std::optional<ActionRecord> failed;
  if (execution->failure() != nullptr) {
    failed = *execution->failure();
  }
  result.actions = execution->take_records();
  if (committed) {
    return;
  }
  if (!failed) {
    end_early(result);
  } else if (!find_another_way(*failed, result)) {
    result.outcome = Outcome::Failed;
    result.error = failed->error;
    result.undo = go_back(*failed);
  }
}

void Transaction::retire(Execution& execution, SwitchResult& result) {
  ground_.log.add(EventKind::TransitionCommitted, plan_.transition.to.str(),
                  "after " + format_duration(execution.window(model::Phase::Commit)) + " of commit");
  const bool retired = enter(Stage::Retire) && execution.run(model::Phase::Retire);
  ground_.host.conclude(plan_.transition);
  const ActionRecord* failed = retired ? nullptr : execution.failure();
  if (failed != nullptr) {
    result.leftover =
        fail(failed->error->code, "could not be retired", failed->action.label()).because_of(*failed->error);
  }
}

/// Superseded or cancelled before anything failed.
void Transaction::end_early(SwitchResult& result) {
  ground_.host.withdraw();
  const std::lock_guard lock(mutex_);
  if (cancelled_) {
    result.outcome = Outcome::Failed;
    result.error = fail(ErrorCode::Cancelled, "the runtime ended", plan_.transition.to.str());
  } else {
    result.outcome = Outcome::Superseded;
    result.error = fail(ErrorCode::Superseded, "a newer request took its place while it was prepared",
                        plan_.transition.to.str());
  }
}

bool Transaction::find_another_way(const ActionRecord& failed, SwitchResult& result) {
  if (failed.action.phase != model::Phase::Commit || !takes_down(failed.action.kind)) {
    return false;
  }
  ground_.host.withdraw();
  ground_.log.add(EventKind::TransitionUndone, plan_.transition.to.str(),
                  quote(failed.action.label()) + " failed; looking for another way on");
  const TimePoint started = RealClock::instance().now();
  const auto error = bring_to(plan_.target, result.actions);
  result.commit += RealClock::instance().now() - started;
  const model::Network observed = ground_.host.observe();
  if (error || !has_all_of(observed, plan_.target)) {
    return false;
  }
  if (const auto stuck = stuck_tasks(observed); !stuck.empty()) {
    result.leftover =
        fail(ErrorCode::Unsupported,
             "could not be retired: it hangs in the runtime's own process, which no transition can restart",
             stuck.begin()->str())
            .because_of(error_of(failed));
  }
  return true;
}

Undo Transaction::go_back(const ActionRecord& failed) {
  const TimePoint started = RealClock::instance().now();
  Undo undo;
  enter(Stage::Back);
  ground_.host.withdraw();
  ground_.log.add(EventKind::TransitionUndone, plan_.transition.to.str(),
                  quote(failed.action.label()) + " failed; going back to " + shown(before_.name));
  undo.error = bring_to(before_, undo.actions);
  const model::Network observed = ground_.host.observe();
  undo.restored = is_restored(before_, observed);
  if (!undo.restored && options_.fallback && options_.fallback->name != plan_.transition.to) {
    ground_.log.add(EventKind::TransitionUndone, options_.fallback->name.str(),
                    "what ran before cannot be restored; trying the fallback network");
    undo.fallback = options_.fallback->name;
    if (auto error = bring_to(*options_.fallback, undo.actions)) {
      undo.error = std::move(error);
    } else {
      undo.fell_back = has_all_of(ground_.host.observe(), *options_.fallback);
    }
  }
  undo.duration = RealClock::instance().now() - started;
  return undo;
}

std::optional<Error> Transaction::bring_to(const model::Network& target, std::vector<ActionRecord>& actions) {
  const model::Network observed = ground_.host.observe();
  const auto way = solve::diff(observed, reachable(target, observed), ground_.catalog,
                               solve_options(ground_.host, model::Order::Seamless, false));
  if (!way) {
    return way.error();
  }
  ground_.host.expect(target);
  const auto execution = begin(*way);
  bool done = true;
  for (const auto phase : kPhases) {
    done = done && execution->run(phase);
  }
  // Only then are new incarnations what plain ids mean, and who was removed is forgotten.
  done ? ground_.host.conclude(*way) : ground_.host.withdraw();
  std::optional<Error> error;
  if (const ActionRecord* failed = execution->failure()) {
    error = error_of(*failed);
  } else if (!done) {
    error = fail(ErrorCode::Cancelled, "the runtime ended", target.name.str());
  }
  auto records = execution->take_records();
  actions.insert(actions.end(), std::make_move_iterator(records.begin()),
                 std::make_move_iterator(records.end()));
  return error;
}

void Transaction::on_action(const ActionRecord& record) {
  if (record.error) {
    ground_.log.add(EventKind::ActionFailed, record.action.label(), to_string(*record.error));
  } else {
    ground_.log.add(EventKind::ActionDone, record.action.label(), format_duration(record.duration));
  }
}

}  // namespace segue::runtime::detail
