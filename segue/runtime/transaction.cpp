// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/transaction.hpp>

#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/runtime/leftovers.hpp>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace segue::runtime::detail {

namespace {

/// Tasks of the target that are in Fatal in the runtime's own process, where no transition can replace them.
std::set<model::TaskId> stuck_tasks(const model::Network& target, const model::Network& observed) {
  const model::TaskIndex wanted(target);
  std::set<model::TaskId> stuck;
  for (const auto& task : observed.tasks) {
    if (task.state == TaskState::Fatal && wanted.find(task.id) != nullptr) {
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

/// The target with stuck tasks left as they are, so that everything else can be reached.
model::Network with_stuck(model::Network target, const model::Network& observed) {
  const auto stuck = stuck_tasks(target, observed);
  if (stuck.empty()) {
    return target;
  }
  std::erase_if(target.tasks, [&](const model::Task& task) { return stuck.contains(task.id); });
  for (auto& deployment : target.deployments) {
    std::erase_if(deployment.tasks,
                  [&](const model::Placement& placement) { return stuck.contains(placement.task); });
  }
  const auto there = model::connection_texts(observed);
  std::erase_if(target.connections, [&](const model::Connection& wanted) {
    const bool ends_there = stuck.contains(wanted.from.task) || stuck.contains(wanted.to.task);
    return ends_there && !there.contains(to_string(wanted));
  });
  std::ranges::copy_if(observed.tasks, std::back_inserter(target.tasks),
                       [&](const model::Task& task) { return stuck.contains(task.id); });
  return target;
}

/// The closest reachable network: a task whose target state is an error keeps its present state, or becomes
/// PreOperational if that is an error as well.
model::Network reachable(model::Network target, const model::Network& observed) {
  const model::TaskIndex present(observed);
  for (auto& task : target.tasks) {
    if (!is_error(task.state)) {
      continue;
    }
    const model::Task* now = present.find(task.id);
    task.state = now != nullptr && !is_error(now->state) ? now->state : TaskState::PreOperational;
  }
  return with_stuck(std::move(target), observed);
}

/// Whether all of `before` runs as it did (or better, where it was in an error), and nothing else runs or
/// writes to it.
bool is_restored(model::Network before, const model::Network& observed) {
  const model::Network extra = subtract(observed, before);
  const bool runs_alone = std::none_of(extra.tasks.begin(), extra.tasks.end(), [](const model::Task& task) {
    return task.state == TaskState::Running || task.state == TaskState::RunTimeError;
  });
  const model::TaskIndex ran(before);
  const bool hears_no_other =
      std::none_of(extra.connections.begin(), extra.connections.end(),
                   [&](const model::Connection& other) { return ran.find(other.to.task) != nullptr; });
  const model::TaskIndex present(observed);
  for (auto& task : before.tasks) {
    const model::Task* now = present.find(task.id);
    if (is_error(task.state) && now != nullptr && !is_error(now->state)) {
      task.state = now->state;
    }
  }
  return runs_alone && hears_no_other && includes(observed, before);
}

/// Whether the action only takes something down.
bool takes_down(model::ActionKind kind) {
  using enum model::ActionKind;
  return kind == Recover || kind == Stop || kind == Disconnect || kind == Cleanup || kind == Undeploy;
}

std::map<model::HostName, std::uint64_t> connections_of(const task_host::TaskHost& host) {
  std::map<model::HostName, std::uint64_t> numbers;
  for (const auto& computer : host.computers()) {
    numbers.emplace(computer.name, computer.connection);
  }
  return numbers;
}

}  // namespace

Transaction::Transaction(const TransitionContext& context, const model::Network& before,
                         const SwitchPlan& plan, Options options)
    : context_(context),
      before_(without_leftover_incarnations(before)),
      plan_(plan),
      options_(std::move(options)),
      connections_(connections_of(context.host)) {}

void Transaction::supersede() {
  const Lock lock(mutex_);
  superseded_ = true;
  if (execution_ && (stage_ == Stage::Prepare || stage_ == Stage::Retire)) {
    execution_->cancel();
  }
}

void Transaction::make_way(NetworkParts wanted) {
  const Lock lock(mutex_);
  superseded_ = true;
  if (execution_ && stage_ == Stage::Prepare) {
    leave_all_but(std::move(wanted));
  } else if (execution_ && stage_ == Stage::Retire) {
    execution_->cancel();
  }
}

void Transaction::make_way_to_rest(NetworkParts rest) {
  const Lock lock(mutex_);
  superseded_ = true;
  rests_ = true;
  if (execution_ && stage_ != Stage::Commit && stage_ != Stage::Committed) {
    leave_all_but(std::move(rest));
  }
}

/// An undo may be about all of both networks.
void Transaction::leave_all_but(NetworkParts needed) {
  if (stage_ != Stage::Retire) {
    needed.add(before_);
  }
  if (stage_ != Stage::Prepare) {
    needed.add(plan_.target);
  }
  execution_->leave([needed = std::move(needed)](const model::Action& action) {
    return needed.are_independent_of(action);
  });
}

void Transaction::abandon() {
  const Lock lock(mutex_);
  abandoned_ = true;
  if (execution_) {
    execution_->cancel();
  }
}

Result<std::string> Transaction::cancel(const std::string& who) {
  const auto refused = [this](std::string why) {
    return fail(ErrorCode::InvalidState, std::move(why), plan_.transition.to.str());
  };
  const Lock lock(mutex_);
  if (cancelled_by_) {
    return *cancelled_by_;
  }
  switch (stage_) {
    case Stage::Committed:
    case Stage::Retire:
      return refused(
          "it is past its point of commit and completes; switch back to the previous controller instead");
    case Stage::Undo:
      return refused("it has failed and is being undone already");
    case Stage::Prepare:
    case Stage::Commit:
      break;
  }
  if (abandoned_) {
    return refused("the runtime ends");
  }
  if (superseded_ && stage_ == Stage::Prepare) {
    return refused("a newer request has taken its place");
  }
  cancelled_by_ = who;
  if (execution_) {
    execution_->cancel();
  }
  return who;
}

Transaction::Stage Transaction::stage() const {
  const Lock lock(mutex_);
  return stage_;
}

bool Transaction::enter(Stage stage) {
  const Lock lock(mutex_);
  if (abandoned_ || superseded_ || cancelled_by_) {
    return false;
  }
  stage_ = stage;
  return true;
}

bool Transaction::pass_point_of_commit() {
  const Lock lock(mutex_);
  if (stage_ == Stage::Undo) {
    return !abandoned_;
  }
  if (abandoned_ || cancelled_by_) {
    return false;
  }
  stage_ = Stage::Committed;
  return true;
}

std::optional<std::string> Transaction::enter_undo() {
  const Lock lock(mutex_);
  stage_ = Stage::Undo;
  return cancelled_by_;
}

std::shared_ptr<Execution> Transaction::begin(const model::Transition& transition) {
  auto created = std::make_shared<Execution>(
      context_.host, transition, options_.action_deadline, started_,
      [this](const ActionRecord& record) { on_event(record); }, options_.left);
  const Lock lock(mutex_);
  execution_ = created;
  if (abandoned_ || (rests_ && stage_ == Stage::Undo) || (cancelled_by_ && stage_ != Stage::Undo)) {
    created->cancel();
  }
  return created;
}

void Transaction::run(SwitchResult& result) {
  started_ = RealClock::instance().now();
  context_.host.begin_transition(before_, plan_.target);
  forward(result);
  {
    const Lock lock(mutex_);
    execution_.reset();
  }
  result.duration = RealClock::instance().now() - started_;
}

void Transaction::forward(SwitchResult& result) {
  const auto execution = begin(plan_.transition);
  const bool prepared = enter(Stage::Prepare) && execution->run(model::Phase::Prepare);
  const TimePoint created = RealClock::instance().now();
  const auto armed = prepared ? arm(plan_.transition, plan_.target) : Result<void>();
  const Duration arming = RealClock::instance().now() - created;
  const bool acted = prepared && armed && enter(Stage::Commit) && execution->run(model::Phase::Commit) &&
                     pass_point_of_commit();
  const auto stored = acted ? context_.host.commit() : Result<void>();
  const bool committed = acted && stored;
  if (committed) {
    retire(*execution, result);
  }
  result.prepare = execution->window(model::Phase::Prepare) + arming;
  result.commit = execution->window(model::Phase::Commit);
  result.retire = execution->window(model::Phase::Retire);
  const auto failed = failure_of(*execution, armed, stored);
  result.actions = execution->take_records();
  if (committed) {
    return;
  }
  if (!failed || !replan(*failed, result)) {
    go_back(failed, result);
  }
}

/// The transition failed, or was cancelled, superseded or abandoned.
void Transaction::go_back(const std::optional<Failure>& failed, SwitchResult& result) {
  const bool ends_early = [&] {
    const Lock lock(mutex_);
    return !failed && !cancelled_by_;
  }();
  if (ends_early) {
    return end_early(result);
  }
  const auto who = enter_undo();
  result.outcome = who ? Outcome::Cancelled : Outcome::Failed;
  result.cancelled_by = who.value_or("");
  if (!who) {
    result.error = failed->error;
    result.undo = undo(failed->what);
    return;
  }
  const std::string what = "cancelled by " + *who;
  result.error = fail(ErrorCode::Cancelled, what, plan_.transition.to.str());
  if (failed) {
    result.error = Error(*result.error).because_of(failed->error);
  }
  result.undo = undo(what);
}

Result<void> Transaction::arm(const model::Transition& transition, const model::Network& target) {
  context_.host.get_ready(target);
  auto armed = context_.host.arm_commit(transition, RealClock::instance().now() + options_.action_deadline);
  if (armed && options_.before_commit) {
    options_.before_commit(transition);
  }
  return armed;
}

std::optional<Transaction::Failure> Transaction::failure_of(const Execution& execution,
                                                            const Result<void>& armed,
                                                            const Result<void>& stored) {
  if (const ActionRecord* failed = execution.failure()) {
    const model::Action& action = failed->action;
    return Failure{quote(action.label()) + " failed", *failed->error,
                   action.phase == model::Phase::Commit && takes_down(action.kind)};
  }
  if (!armed) {
    return Failure{"preparing the commit failed", armed.error()};
  }
  if (!stored) {
    return Failure{"the commit failed", stored.error()};
  }
  return std::nullopt;
}

void Transaction::retire(Execution& execution, SwitchResult& result) {
  context_.log.add(EventKind::TransitionCommitted, plan_.transition.to.str(),
                   "after " + format_seconds(execution.window(model::Phase::Commit)) + " of commit");
  if (options_.committed) {
    options_.committed();
  }
  const bool retired = enter(Stage::Retire) && execution.run(model::Phase::Retire);
  context_.host.conclude(plan_.transition);
  const ActionRecord* failed = retired ? nullptr : execution.failure();
  if (failed != nullptr) {
    result.leftover =
        fail(failed->error->code, "could not be retired", failed->action.label()).because_of(*failed->error);
  }
}

/// The transition was superseded or abandoned before an action failed.
void Transaction::end_early(SwitchResult& result) {
  context_.host.withdraw();
  const Lock lock(mutex_);
  if (abandoned_) {
    result.outcome = Outcome::Failed;
    result.error = fail(ErrorCode::Cancelled, "the runtime ended", plan_.transition.to.str());
  } else {
    result.outcome = Outcome::Superseded;
    result.error = fail(ErrorCode::Superseded, "a newer request took its place while it was prepared",
                        plan_.transition.to.str());
  }
}

bool Transaction::replan(const Failure& failed, SwitchResult& result) {
  const bool ends = [&] {
    const Lock lock(mutex_);
    return cancelled_by_.has_value() || rests_;
  }();
  if (!failed.took_down || ends) {
    return false;
  }
  context_.host.withdraw();
  context_.log.add(EventKind::TransitionUndone, plan_.transition.to.str(),
                   failed.what + "; replanning from the observed network");
  const TimePoint started = RealClock::instance().now();
  const auto error = bring_to(plan_.target, result.actions);
  result.commit += RealClock::instance().now() - started;
  const model::Network observed = context_.host.observe();
  if (error || !includes(observed, plan_.target)) {
    return false;
  }
  const auto rest = subtract(observed, plan_.target).tasks;
  if (!rest.empty()) {
    result.leftover =
        fail(ErrorCode::DeadlineExceeded,
             "hung when the transition was planned again and has returned since; it is removed next",
             rest.front().id.str())
            .because_of(failed.error);
  }
  return true;
}

Undo Transaction::undo(const std::string& why) {
  const TimePoint started = RealClock::instance().now();
  Undo undo;
  context_.host.withdraw();
  context_.log.add(EventKind::TransitionUndone, plan_.transition.to.str(),
                   why + "; going back to " + quoted_name(before_.name));
  undo.error = bring_to(before_, undo.actions);
  const auto [observed, lost] = observe();
  const bool commands = !context_.host.loss();  // else it is somebody else who puts other computers right
  undo.restored = commands && is_restored(without_hosts(before_, lost), observed);
  if (!undo.restored && commands && options_.fallback && options_.fallback->name != plan_.transition.to) {
    context_.log.add(EventKind::TransitionUndone, options_.fallback->name.str(),
                     "the old network cannot be restored; trying the fallback network");
    undo.fallback = options_.fallback->name;
    if (auto error = bring_to(*options_.fallback, undo.actions)) {
      undo.error = std::move(error);
    } else {
      const auto [now, missing] = observe();
      undo.fell_back = includes(now, without_hosts(*options_.fallback, missing));
    }
  }
  undo.duration = RealClock::instance().now() - started;
  return undo;
}

Transaction::Observed Transaction::observe() const {
  Observed seen{{}, plan_.lost};
  seen.lost.merge(lost_meanwhile());  // also one that comes back now
  seen.network = context_.host.observe();
  seen.lost.merge(lost_meanwhile());
  seen.network = without_hosts(std::move(seen.network), seen.lost);
  return seen;
}

std::set<model::HostName> Transaction::lost_meanwhile() const {
  auto lost = unreachable_hosts(context_.host);
  for (const auto& [name, number] : connections_of(context_.host)) {
    const auto found = connections_.find(name);
    if (found == connections_.end() || found->second != number) {
      lost.insert(name);
    }
  }
  return lost;
}

std::optional<Error> Transaction::bring_to(const model::Network& whole, std::vector<ActionRecord>& actions) {
  const auto [observed, lost] = observe();
  const model::Network target = without_hosts(whole, lost);
  const auto way = solve_from_observed(observed, reachable(target, observed), context_.catalog,
                                       solve_options(context_.host, model::Order::Seamless, false));
  if (!way) {
    return way.error();
  }
  context_.host.begin_transition(observed, target);
  const auto execution = begin(*way);
  const bool prepared = execution->run(model::Phase::Prepare);
  const auto armed = prepared ? arm(*way, target) : Result<void>();
  const bool acted = prepared && armed && execution->run(model::Phase::Commit) && pass_point_of_commit();
  const auto stored = acted ? context_.host.commit() : Result<void>();
  const bool done = acted && stored && execution->run(model::Phase::Retire);
  // Only after success may the host let plain ids mean the new incarnations and forget removed tasks.
  done ? context_.host.conclude(*way) : context_.host.withdraw();
  std::optional<Error> error;
  if (const auto failed = failure_of(*execution, armed, stored)) {
    error = failed->error;
  } else if (!done) {
    const Lock lock(mutex_);
    error = fail(ErrorCode::Cancelled, abandoned_ ? "the runtime ended" : "the robot was halted",
                 target.name.str());
  }
  auto records = execution->take_records();
  actions.insert(actions.end(), std::make_move_iterator(records.begin()),
                 std::make_move_iterator(records.end()));
  return error;
}

void Transaction::on_event(const ActionRecord& record) {
  if (record.error) {
    context_.log.add(EventKind::ActionFailed, record.action.label(), to_string(*record.error));
  } else {
    context_.log.add(EventKind::ActionDone, record.action.label(), format_seconds(record.duration));
  }
}

}  // namespace segue::runtime::detail
