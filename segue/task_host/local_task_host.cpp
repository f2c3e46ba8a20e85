// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/local_task_host.hpp>

#include <segue/base/text.hpp>
#include <segue/task/held_ports.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task_host/action_pool.hpp>
#include <segue/task_host/port_tap.hpp>
#include <segue/task_host/task_actions.hpp>
#include <segue/task_host/task_maker.hpp>
#include <segue/task_host/task_table.hpp>
#include <segue/task_host/write_meter.hpp>
#include <segue/task_host/written_samples.hpp>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <map>

namespace segue::task_host {

namespace {

/// How long a query for ports waits for a hook that creates or removes them.
constexpr Duration kPatience = std::chrono::milliseconds(200);

/// Whether it runs code of a component, whose duration is not bounded, or waits for a reader.
bool may_take_long(const model::Action& action) {
  if (std::holds_alternative<model::ConnectionAction>(action.what)) {
    return action.kind == model::ActionKind::Disconnect && action.phase == model::Phase::Retire;
  }
  return !std::holds_alternative<model::DeploymentAction>(action.what);
}

/// The connections that are disconnected after the commit: they end with it.
std::vector<model::Connection> ending_connections(const model::Transition& transition) {
  std::vector<model::Connection> ending;
  for (const auto& action : transition.actions) {
    if (action.kind == model::ActionKind::Disconnect && action.phase == model::Phase::Retire) {
      ending.push_back(std::get<model::ConnectionAction>(action.what).connection);
    }
  }
  return ending;
}

/// `hanging`: tasks that hang, and why.
template <class Entry, class Hanging>
TaskReport report_of(const Entry& entry, const Hanging& hanging) {
  TaskReport report;
  report.id = entry.definition.id;
  report.component = entry.definition.component;
  report.process = entry.process;
  report.pid = ::getpid();
  report.state = entry.task->state();
  report.state_name = entry.task->state_name();
  report.error = entry.task->error_message();
  report.stand_in = entry.stand_in;
  report.activity = entry.task->activity();
  report.timing = entry.task->timing();
  if (const auto found = hanging.find(entry.definition.id); found != hanging.end()) {
    report.state = TaskState::Fatal;
    report.state_name = to_string(TaskState::Fatal);
    report.error = found->second;
  }
  return report;
}

template <class Ports>
std::vector<std::string> names_of(const Ports& ports) {
  std::vector<std::string> names;
  for (const auto* port : ports) {
    names.push_back(port->name());
  }
  return names;
}

Error no_port(std::string_view direction, const model::PortRef& port, const std::vector<std::string>& names) {
  const std::string hint = did_you_mean(port.port, names);
  return fail(ErrorCode::NotFound,
              "no " + std::string(direction) + " port " + quote(port.port) +
                  (!hint.empty()   ? hint
                   : names.empty() ? "; there are none"
                                   : "; there are " + listed(names)),
              port.task.str());
}

/// Keeps the entry's ports from changing; DeadlineExceeded while a hook changes them.
Result<TimedReadLock> hold_ports(const detail::TaskEntry& entry) {
  TimedReadLock lock(*entry.ports, RealClock::instance().now() + kPatience);
  if (!lock) {
    return fail(ErrorCode::DeadlineExceeded, "is being configured or cleaned up; ask again later",
                entry.definition.id.str());
  }
  return lock;
}

}  // namespace

struct LocalTaskHost::Implementation {
  Implementation(const LibrarySet& libraries, const model::ComponentCatalog& catalog, LocalOptions options)
      : maker(libraries, catalog, std::move(options)) {}

  Result<TaskLevel> level(const LevelQuestion& question);

  detail::TaskEvents events;
  /// Shared with readers of ports, which may outlive this.
  const std::shared_ptr<detail::Watches> watches = std::make_shared<detail::Watches>();
  detail::TaskMaker maker;
  detail::TaskTable table;
  detail::TaskConnections connections{table, maker};
  detail::TaskActions actions{table, maker, connections, events, *watches};
  detail::WrittenSamples written;
  /// The word of the transitions that this host commits itself.
  const std::shared_ptr<task::CommitWord> word = std::make_shared<task::CommitWord>(0);
  std::atomic<std::uint64_t> transitions{0};
  std::atomic<std::uint64_t> armed{0};  ///< the one that can commit; 0: none. Whoever takes it out commits
  concurrent::ThreadPool threads{"segue-actions", kActionThreads};
  ActionPool pool{threads, [this](const model::Action& action, TimePoint deadline) {
                    auto done = actions.perform(action, deadline);
                    watches->ring();  // there may be a task more, or one less
                    return done;
                  }};
};

Result<TaskLevel> LocalTaskHost::Implementation::level(const LevelQuestion& question) {
  const auto entry = table.find(question.task);
  if (!entry) {
    return entry.error();
  }
  if (question.each_update) {
    entry->task->announce_next_update();  // before they are counted
  }
  const TaskReport report = report_of(*entry, actions.hanging());
  return TaskLevel{report.state, report.state_name, report.timing.cycles};
}

LocalTaskHost::LocalTaskHost(const LibrarySet& libraries, const model::ComponentCatalog& catalog,
                             LocalOptions options)
    : implementation_(std::make_unique<Implementation>(libraries, catalog, std::move(options))) {}

LocalTaskHost::~LocalTaskHost() {
  implementation_->watches->close();
  implementation_->events.set_listener({});
  implementation_->pool.close();
  implementation_->table.clear();
}

bool LocalTaskHost::stands_in(const model::ComponentName& component) const {
  return implementation_->maker.is_unchecked(component);
}

Diagnostics LocalTaskHost::check(const model::Network& network) const {
  Diagnostics findings;
  for (const auto& task : network.tasks) {
    if (auto problem = implementation_->maker.problem_of_behaviour(task)) {
      findings.error("bad-stand-in", "task " + quote(task.id.str()) + ": " + *problem, task.where);
    }
  }
  return findings;
}

Result<void> LocalTaskHost::can_make(const model::ComponentName& component) const {
  return implementation_->maker.can_make(component);
}

void LocalTaskHost::expect(const model::Network& target) {
  implementation_->maker.expect(target);
}

Result<void> LocalTaskHost::arm_commit(const model::Transition& transition, TimePoint /*deadline*/) {
  if (transition.order == model::Order::Seamless) {
    const std::uint64_t number = ++implementation_->transitions;
    arm_commit(implementation_->word, number, ending_connections(transition));
    implementation_->armed = number;
  }
  return {};
}

Result<void> LocalTaskHost::commit() {
  if (const std::uint64_t number = implementation_->armed.exchange(0); number != 0) {
    implementation_->word->store(number);  // G2 (CommitGate)
  }
  settle();
  return {};
}

void LocalTaskHost::withdraw() {
  implementation_->armed = 0;
  settle();
}

task::CommitGatePtr LocalTaskHost::arm_commit(std::shared_ptr<const task::CommitWord> word,
                                              std::uint64_t number,
                                              std::span<const model::Connection> ending) {
  return implementation_->connections.arm(std::move(word), number, ending);
}

task::CommitGatePtr LocalTaskHost::gate() {
  return implementation_->connections.gate();
}

void LocalTaskHost::settle() {
  implementation_->connections.settle();
}

void LocalTaskHost::let_reader_finish(const sample_link::PortConnection& connection,
                                      const model::TaskId& reader, TimePoint deadline) const {
  implementation_->connections.let_reader_finish(connection, reader, deadline);
}

void LocalTaskHost::conclude(const model::Transition& transition) {
  implementation_->actions.conclude(transition);
  implementation_->watches->ring();
  implementation_->written.forget([this](const model::TaskId& task) {
    const auto entry = implementation_->table.look_up(task);
    return entry && entry->task->state() == TaskState::Running;
  });
}

Result<void> LocalTaskHost::carry_out(const model::Action& action, TimePoint deadline) {
  auto done = implementation_->actions.perform(action, deadline);
  implementation_->watches->ring();
  return done;
}

void LocalTaskHost::begin_all(std::vector<model::Action> actions, TimePoint deadline, Completion completed) {
  ActionPool& pool = implementation_->pool;
  if (std::any_of(actions.begin(), actions.end(), may_take_long)) {
    pool.begin(std::move(actions), deadline, std::move(completed));
  } else {
    pool.begin_here(std::move(actions), deadline, std::move(completed));
  }
}

model::Network LocalTaskHost::observe() const {
  model::Network network;
  network.deployments = implementation_->table.processes();
  std::map<model::DeploymentKey, model::Deployment*> deployments;
  for (auto& deployment : network.deployments) {
    deployments.emplace(deployment.key(), &deployment);
  }
  const auto hanging = implementation_->actions.hanging();
  for (auto& entry : implementation_->table.all()) {
    network.tasks.push_back(entry.definition);
    network.tasks.back().state = hanging.contains(entry.definition.id) ? TaskState::Fatal : entry.state();
    if (const auto found = deployments.find(entry.process); found != deployments.end()) {
      found->second->tasks.push_back({entry.definition.id, entry.name});
    }
  }
  for (const auto& entry : implementation_->table.all_connections()) {
    if (entry.handle.port_connection().carries()) {
      network.connections.push_back(entry.connection);
    }
  }
  return network;
}

std::vector<TaskReport> LocalTaskHost::tasks() const {
  std::vector<TaskReport> reports;
  const auto hanging = implementation_->actions.hanging();
  for (const auto& entry : implementation_->table.all()) {
    reports.push_back(report_of(entry, hanging));
  }
  return reports;
}

void LocalTaskHost::watch(const LevelQuestion& question, const Wait& wait, LevelAnswer answered) {
  using End = detail::Watches::End;
  implementation_->watches->add(wait, [this, question, answered = std::move(answered)](End end) {
    if (end == End::Stop || end == End::Closed) {
      answered(end == End::Stop ? no_longer_wanted()
                                : fail(ErrorCode::Unavailable, "its host ends", question.task.str()));
      return true;
    }
    auto level = implementation_->level(question);
    if (level && end == End::No && !question.is_news(*level)) {
      return false;
    }
    answered(std::move(level));
    return true;
  });
}

std::vector<ConnectionReport> LocalTaskHost::connections() const {
  std::vector<ConnectionReport> reports;
  for (const auto& entry : implementation_->table.all_connections()) {
    if (entry.handle.port_connection().carries()) {
      const sample_link::Counters counts = entry.handle.counters();
      reports.push_back({entry.connection, counts.written, counts.read, counts.dropped,
                         entry.handle.port_connection().latency()});
    }
  }
  return reports;
}

Result<model::ComponentModel> LocalTaskHost::describe(const model::TaskId& task) const {
  const auto entry = implementation_->table.find(task);
  if (!entry) {
    return entry.error();
  }
  const auto ports = hold_ports(*entry);
  if (!ports) {
    return ports.error();
  }
  return task_host::describe(entry->task->component());
}

Result<type::Value> LocalTaskHost::properties(const model::TaskId& task) const {
  const auto entry = implementation_->table.find(task);
  if (!entry) {
    return entry.error();
  }
  return entry->task->properties();
}

Result<TaskDetails> LocalTaskHost::details(const model::TaskId& task) const {
  const auto entry = implementation_->table.find(task);
  if (!entry) {
    return entry.error();
  }
  task::RealtimeLog::instance().drain();
  const std::string_view source = entry->task->id();
  return TaskDetails{entry->task->timing_histograms(),
                     recent_log(source.substr(0, task::RealtimeLog::kSourceBytes))};
}

Result<void> LocalTaskHost::set_property(const model::TaskId& task, std::string_view path,
                                         const type::Value& value, TimePoint deadline) {
  return implementation_->actions.set_property(task, path, value, deadline);
}

Result<type::Value> LocalTaskHost::call(const model::TaskId& task, std::string_view operation,
                                        const type::Value& arguments, TimePoint deadline) {
  return implementation_->actions.call(task, operation, arguments, deadline);
}

Result<void> LocalTaskHost::write(const model::PortRef& port, const type::Value& value, TimePoint deadline) {
  const auto entry = implementation_->table.find(port.task);
  if (!entry) {
    return entry.error();
  }
  if (entry->task->state() != TaskState::Running) {
    return fail(ErrorCode::InvalidState,
                "is " + std::string(to_string(entry->task->state())) + ", so it reads no samples",
                port.task.str());
  }
  Result<std::shared_ptr<sample_link::PortConnection>> connection(nullptr);
  {
    const auto ports = hold_ports(*entry);
    if (!ports) {
      return ports.error();
    }
    task::Component& component = entry->task->component();
    const task::HeldPorts held(component);
    task::InputPortBase* input = held.find_input(component, port.port);
    if (input == nullptr) {
      return no_port("input", port, names_of(held.inputs(component)));
    }
    connection = implementation_->written.write(*input, port, value);
  }
  if (!connection) {
    return std::move(connection.error());
  }
  return implementation_->written.wait_until_taken(port, **connection, deadline);
}

Result<std::unique_ptr<PortReader>> LocalTaskHost::open_reader(const model::PortRef& port,
                                                               std::size_t buffer) {
  const auto entry = implementation_->table.find(port.task);
  if (!entry) {
    return entry.error();
  }
  const auto ports = hold_ports(*entry);
  if (!ports) {
    return ports.error();
  }
  task::Component& component = entry->task->component();
  const task::HeldPorts held(component);
  task::OutputPortBase* output = held.find_output(component, port.port);
  if (output == nullptr) {
    return no_port("output", port, names_of(held.outputs(component)));
  }
  if (buffer == kMeasureWrites) return detail::measure_writes(*output);
  return detail::tap(*output, buffer, implementation_->watches, entry->task);
}

Result<void> LocalTaskHost::with_output(const model::PortRef& port, TimePoint deadline,
                                        const std::function<Result<void>(task::OutputPortBase&)>& use) {
  return implementation_->connections.with_output(port, deadline, use);
}

Result<void> LocalTaskHost::with_input(const model::PortRef& port, TimePoint deadline,
                                       const std::function<Result<void>(task::InputPortBase&)>& use) {
  return implementation_->connections.with_input(port, deadline, use);
}

Result<std::optional<task::SavedState>> LocalTaskHost::save_state(const model::TaskId& task,
                                                                  TimePoint deadline) {
  return implementation_->actions.save_state(task, deadline);
}

Result<void> LocalTaskHost::restore_state(const model::TaskId& task, const task::SavedState& state,
                                          TimePoint deadline) {
  return implementation_->actions.restore_state(task, state, deadline);
}

std::map<model::TaskId, std::string> LocalTaskHost::hanging() const {
  return implementation_->actions.hanging();
}

bool LocalTaskHost::at_rest() const {
  return implementation_->actions.at_rest();
}

void LocalTaskHost::set_listener(Listener listener) {
  if (!listener) {
    implementation_->events.set_listener({});
    return;
  }
  implementation_->events.set_listener(
      [listener = std::move(listener)](const TaskEvent& event) { listener(event); });
}

}  // namespace segue::task_host
