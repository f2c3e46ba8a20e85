// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_implementation.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime {

using detail::Job;

namespace {

constexpr std::size_t kKeptResults = 100;
/// A deadline beyond this is none; arithmetic on time points must not overflow.
constexpr Duration kLongestDeadline = std::chrono::hours(24);

model::NetworkName name_of(const Request& request) {
  struct Visitor {
    model::NetworkName operator()(const model::NetworkName& name) const { return name; }
    model::NetworkName operator()(const model::Network& network) const { return network.name; }
    model::NetworkName operator()(const model::Transition& transition) const { return transition.to; }
  };
  return std::visit(Visitor{}, request);
}

std::string shown(const model::NetworkName& name) {
  return name.empty() ? "the empty network" : quote(name.str());
}

Duration commit_window(const std::vector<ActionRecord>& records) {
  Duration begin = Duration::max();
  Duration end{0};
  for (const auto& record : records) {
    if (record.executed && record.action.phase == model::Phase::Commit) {
      begin = std::min(begin, record.started);
      end = std::max(end, record.started + record.duration);
    }
  }
  return begin == Duration::max() ? Duration{0} : end - begin;
}

}  // namespace

std::future<SwitchResult> Runtime::Implementation::accept(Request request, RequestOptions options) {
  options.action_deadline = std::min(options.action_deadline, kLongestDeadline);
  std::optional<Job> older;
  std::future<SwitchResult> future;
  {
    const std::lock_guard lock(mutex);
    older.swap(waiting);
    waiting.emplace(Job{++requests, std::move(request), options, {}});
    future = waiting->promise.get_future();
    log.add(EventKind::RequestAccepted, name_of(waiting->request).str(),
            "request " + std::to_string(requests));
  }
  wake.notify_all();
  if (older) {
    log.add(EventKind::RequestSuperseded, name_of(older->request).str(),
            "request " + std::to_string(older->number) + " gave way to a newer one");
    answer(*older, superseded(*older));
  }
  return future;
}

void Runtime::Implementation::work() {
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [&] { return stopping || waiting; });
    if (stopping) {
      return;  // executions that hang are waited for by their destructors
    }
    Job job = std::move(*waiting);
    waiting.reset();
    const RuntimeState before = std::exchange(state, RuntimeState::Executing);
    lock.unlock();
    SwitchResult result = serve(job);
    settle(result.outcome == Outcome::Refused  ? before
           : result.outcome == Outcome::Failed ? RuntimeState::Failed
                                               : RuntimeState::Idle);
    answer(job, std::move(result));
    hanging.remove_if([](const auto& old) { return old->ended(); });
    lock.lock();
  }
}

SwitchResult Runtime::Implementation::serve(const Job& job) {
  const TimePoint begin = RealClock::instance().now();
  SwitchResult result;
  result.request = job.number;
  result.to = name_of(job.request);
  detail::Observation current = starting_point();
  result.from = current.network.name;
  auto plan = this->plan(current.network, job.request, job.options);
  result.solve_time = RealClock::instance().now() - begin;
  if (!plan) {
    return refused(job, std::move(result), std::move(plan.error()));
  }
  report_differences(held(), current.network);
  adopt(std::move(current));
  execute(job, std::move(*plan), result);
  return result;
}

detail::Observation Runtime::Implementation::look() const {
  detail::Observation seen;
  {
    const std::lock_guard lock(mutex);
    seen.task_events = task_events;
  }
  seen.network = host.observe();
  return seen;
}

detail::Observation Runtime::Implementation::starting_point() const {
  detail::Observation start;
  {
    const std::lock_guard lock(mutex);
    start = {belief, task_events};
    if (belief_given) {
      return start;
    }
  }
  detail::Observation observed = look();
  if (equivalent(start.network, observed.network)) {
    return start;
  }
  observed.network.name = start.network.name;
  return observed;
}

tl::expected<detail::Plan, detail::Refusal> Runtime::Implementation::plan(
    const model::Network& current, const Request& request, const RequestOptions& options) const {
  if (options.action_deadline <= Duration::zero()) {
    return tl::unexpected(detail::Refusal{
        fail(ErrorCode::InvalidArgument, "the deadline of an action must be more than nothing"), {}});
  }
  if (const auto* transition = std::get_if<model::Transition>(&request)) {
    return detail::plan_transition(current, *transition, host, catalog);
  }
  if (const auto* network = std::get_if<model::Network>(&request)) {
    return detail::plan_network(current, *network, host, catalog, options.order);
  }
  auto network = resolve(std::get<model::NetworkName>(request));
  if (!network) {
    return tl::unexpected(detail::Refusal{std::move(network.error()), {}});
  }
  return detail::plan_network(current, std::move(*network), host, catalog, options.order);
}

Result<model::Network> Runtime::Implementation::resolve(const model::NetworkName& wanted) const {
  const std::lock_guard lock(mutex);
  if (const auto found = controllers.find(wanted); found != controllers.end()) {
    return found->second;
  }
  if (wanted.empty()) {
    return model::Network{};
  }
  std::vector<std::string> names;
  for (const auto& [known, network] : controllers) {
    names.push_back(known.str());
  }
  const std::string hint = did_you_mean(wanted.str(), names);
  return fail(ErrorCode::NotFound,
              "no controller " + quote(wanted.str()) +
                  (hint.empty() ? "; there is " + (names.empty() ? "none" : listed(names)) : hint));
}

void Runtime::Implementation::execute(const Job& job, detail::Plan plan, SwitchResult& result) {
  log.add(EventKind::TransitionStarted, plan.target.name.str(),
          "from " + shown(result.from) + " to " + shown(result.to) + ": " +
              std::to_string(plan.transition.actions.size()) + " actions");
  const TimePoint begin = RealClock::instance().now();
  host.expect(plan.target);
  run_actions(job, plan.transition, result);
  result.commit = commit_window(result.actions);
  conclude(std::move(plan), result);
  result.duration = RealClock::instance().now() - begin;
}

void Runtime::Implementation::run_actions(const Job& job, const model::Transition& transition,
                                          SwitchResult& result) {
  if (transition.actions.empty()) {
    return;
  }
  auto running =
      std::make_shared<detail::Execution>(host, transition.actions, job.options.action_deadline,
                                          [this](const ActionRecord& record) { on_action(record); });
  {
    const std::lock_guard lock(mutex);
    execution = running;
    if (stopping) {
      running->cancel();
    }
  }
  running->wait();
  result.actions = running->records();
  {
    const std::lock_guard lock(mutex);
    execution.reset();
  }
  if (!running->ended()) {
    hanging.push_back(std::move(running));
  }
}

void Runtime::Implementation::conclude(detail::Plan plan, SwitchResult& result) {
  const auto& records = result.actions;
  const bool complete = std::all_of(records.begin(), records.end(), [](const ActionRecord& record) {
    return record.executed && !record.error;
  });
  if (!complete) {
    conclude_failed(plan, result);
    return;
  }
  host.conclude(plan.transition);
  const detail::Observation observed = look();
  report_differences(plan.target, observed.network);
  for (const auto& task : observed.network.tasks) {
    model::Task* held = is_error(task.state) ? plan.target.find_task(task.id) : nullptr;
    if (held != nullptr) {
      held->state = task.state;
    }
  }
  adopt({std::move(plan.target), observed.task_events});
  log.add(EventKind::TransitionDone, result.to.str(),
          "now runs " + shown(result.to) + " after " + std::to_string(records.size()) + " actions");
}

void Runtime::Implementation::conclude_failed(const detail::Plan& plan, SwitchResult& result) {
  detail::Observation seen = look();
  model::Network& observed = seen.network;
  observed.name = true_name(observed, held(), plan.target);
  const auto failed = std::find_if(result.actions.begin(), result.actions.end(),
                                   [](const ActionRecord& record) { return record.error.has_value(); });
  const bool cancelled = failed == result.actions.end();
  Error cause = cancelled ? fail(ErrorCode::Cancelled, "the runtime ended") : *failed->error;
  const std::string subject = cancelled ? plan.target.name.str() : failed->action.label();
  const std::string runs = observed.name.empty() ? "" : " as " + shown(observed.name) + " names it";
  const ErrorCode code = cause.code;
  result.outcome = Outcome::Failed;
  result.error = fail(code,
                      "the transition to " + shown(result.to) + " ended early; the robot now runs " +
                          detail::summary(observed) + runs,
                      subject)
                     .because_of(std::move(cause));
  log.add(EventKind::TransitionFailed, result.to.str(), to_string(*result.error));
  adopt(std::move(seen));
}

/// The name of the network that truly runs, if it is one that anybody knows.
model::NetworkName Runtime::Implementation::true_name(const model::Network& observed,
                                                      const model::Network& first,
                                                      const model::Network& second) const {
  for (const model::Network* candidate : {&first, &second}) {
    const bool names = !candidate->name.empty() || candidate->empty();
    if (names && equivalent(observed, *candidate)) {
      return candidate->name;
    }
  }
  const std::lock_guard lock(mutex);
  for (const auto& [known, network] : controllers) {
    if (equivalent(observed, network)) {
      return known;
    }
  }
  return {};
}

void Runtime::Implementation::report_differences(const model::Network& expected,
                                                 const model::Network& observed) {
  for (auto& sentence : differences(expected, observed)) {
    log.add(EventKind::Difference, expected.name.str(), std::move(sentence));
  }
}

void Runtime::Implementation::adopt(detail::Observation seen) {
  const std::lock_guard lock(mutex);
  belief = std::move(seen.network);
  belief_given = false;
  for (const auto& [id, last] : told) {
    model::Task* task = last.first > seen.task_events ? belief.find_task(id) : nullptr;
    if (task != nullptr) {
      task->state = last.second;
    }
  }
}

void Runtime::Implementation::adopt_given(model::Network network) {
  const std::lock_guard lock(mutex);
  belief = std::move(network);
  belief_given = true;
}

/// After a request: the state it leaves, and a reset of the belief that came meanwhile.
void Runtime::Implementation::settle(RuntimeState next) {
  std::optional<std::optional<model::Network>> reset_now;
  {
    const std::lock_guard lock(mutex);
    state = next;
    reset_now.swap(reset_wanted);
  }
  if (reset_now) {
    reset(std::move(*reset_now));
  }
}

void Runtime::Implementation::answer(Job& job, SwitchResult result) {
  {
    const std::lock_guard lock(mutex);
    history.push_back(result);
    if (history.size() > kKeptResults) {
      history.pop_front();
    }
  }
  job.promise.set_value(std::move(result));
}

SwitchResult Runtime::Implementation::superseded(const Job& job) const {
  SwitchResult result;
  result.outcome = Outcome::Superseded;
  result.request = job.number;
  result.to = name_of(job.request);
  result.error = fail(ErrorCode::Superseded, "a newer request took its place", result.to.str());
  return result;
}

SwitchResult Runtime::Implementation::ended_before(const Job& job) const {
  SwitchResult result = superseded(job);
  result.outcome = Outcome::Refused;
  result.error = fail(ErrorCode::Cancelled, "the runtime ended before its turn", result.to.str());
  return result;
}

SwitchResult Runtime::Implementation::refused(const Job& job, SwitchResult result, detail::Refusal refusal) {
  result.outcome = Outcome::Refused;
  result.error = std::move(refusal.error);
  result.diagnostics = std::move(refusal.diagnostics);
  log.add(EventKind::RequestRefused, name_of(job.request).str(), to_string(*result.error));
  return result;
}

void Runtime::Implementation::on_event(const host::TaskEvent& event) {
  {
    const std::lock_guard lock(mutex);
    told.insert_or_assign(event.task, std::pair(++task_events, event.state));
    if (model::Task* task = belief.find_task(event.task)) {
      task->state = event.state;
    }
  }
  log.add(EventKind::TaskState, event.task.str(),
          std::string(to_string(event.state)) + (event.message.empty() ? "" : ": " + event.message));
}

void Runtime::Implementation::on_event(const host::ProcessEvent& event) {
  log.add(EventKind::Process, to_string(event.process), event.message);
}

void Runtime::Implementation::on_action(const ActionRecord& record) {
  if (record.error) {
    log.add(EventKind::ActionFailed, record.action.label(), to_string(*record.error));
  } else {
    log.add(EventKind::ActionDone, record.action.label(), format_duration(record.duration));
  }
}

void Runtime::Implementation::reset(std::optional<model::Network> network) {
  {
    const std::lock_guard lock(mutex);
    if (state == RuntimeState::Executing) {
      reset_wanted = std::move(network);
      return;
    }
  }
  const bool given = network.has_value();
  detail::Observation now;
  if (given) {
    now.network = std::move(*network);
  } else {
    now = look();
    now.network.name = true_name(now.network, held(), {});
  }
  log.add(EventKind::BeliefReset, now.network.name.str(),
          std::string(given ? "given" : "observed") + ": " + detail::summary(now.network));
  if (given) {
    adopt_given(std::move(now.network));
  } else {
    adopt(std::move(now));
  }
  const std::lock_guard lock(mutex);
  if (state == RuntimeState::Failed) {
    state = RuntimeState::Idle;
  }
}

Diagnostics Runtime::Implementation::add(model::Network network) {
  Diagnostics findings = detail::check_runnable(network, host, catalog);
  if (network.name.empty() && !network.empty()) {
    findings.error("missing-name", "a controller needs a name to be requested by", {network.file, 0, 0});
  }
  if (!findings.has_errors()) {
    const std::lock_guard lock(mutex);
    controllers.insert_or_assign(network.name, std::move(network));
  }
  return findings;
}

}  // namespace segue::runtime
