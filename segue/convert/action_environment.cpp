// SPDX-License-Identifier: Apache-2.0
#include <segue/base/time_after.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/convert/action_environment.hpp>
#include <segue/convert/all_changes.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/subtree_watch.hpp>
#include <segue/convert/world_views.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission_robot/fact_observer.hpp>

#include <algorithm>
#include <atomic>
#include <exception>

namespace segue::convert {

using mission::Ending;
using mission::kAborted;
using mission::kPreempted;
using mission::Outcome;
using task_network::Completions;
using task_network::NodeContext;
using task_network::NodeId;
using task_network::ReportPtr;
using type::Value;
using type::ValueMap;

namespace {

/// The effect in a text such as "p(a)" or "!p(a)".
task_network::NamedEffect named_effect(const std::string& text) {
  const bool value = !text.starts_with('!');
  return {text.substr(value ? 0 : 1), value};
}

/// Position 0 is before all nodes.
std::uint64_t place_number(NodeId node) {
  return std::uint64_t{index(node)} + 1;
}

}  // namespace

/// Turns the ending of an action into a report for the engine. Immutable but for `cancelled`, which only ever
/// becomes true; the report of a run that was cancelled meanwhile is discarded anyway, so relaxed order would
/// do.
struct ActionEnvironment::Reporter {
  explicit Reporter(mission::Globals used) : globals(std::move(used)) {}

  std::vector<std::string> ports;
  std::vector<task_network::OutcomeId> outcomes;  ///< by the outcomes of the state
  bool counts = false;
  bool recorded = false;  ///< the run has a journal
  std::int64_t count = 0;
  mission::Globals globals;  ///< as the action uses them
  std::atomic<bool> cancelled{false};

  [[nodiscard]] ReportPtr report(const Ending& ending, std::vector<Value> outputs,
                                 const SubtreeChanges& changes = {}) {
    Outcome outcome = ending.outcome;
    std::string error = ending.error;
    if (cancelled && !planted(ConversionFault::CountsCancelled)) {
      outcome = kPreempted;
    } else if (outcome < kPreempted || outcome >= static_cast<Outcome>(outcomes.size())) {
      outcome = planted(ConversionFault::AcceptsAnyOutcome) ? 0 : kAborted;
      error = "its action ended with an outcome that it does not declare";
    }
    auto report = std::make_unique<task_network::Report>();
    report->outcome = outcome == kAborted     ? task_network::kAborted
                      : outcome == kPreempted ? task_network::kPreempted
                                              : outcomes[static_cast<std::size_t>(outcome)];
    report->error = error;
    ValueMap map;
    for (std::size_t i = 0; i < ports.size() && i < outputs.size(); ++i) {
      const bool is_error = ports[i] == "error" && !error.empty();
      map.append(ports[i], is_error ? Value(error) : std::move(outputs[i]));
    }
    map.append(std::string(kOutcomeOutput), static_cast<std::uint64_t>(report->outcome));
    if (outcome != kPreempted && !error.empty())
      map.append(std::string(outcome == kAborted ? kErrorOutput : kHandledErrorOutput), error);
    if (counts)
      map.append(std::string(kCountOutput), count + (planted(ConversionFault::CountsTwice) ? 2 : 1));
    for (const std::string& fact : changes.facts)
      report->named_effects.push_back(named_effect(fact));
    for (const auto& [resource, change] : changes.units)
      report->named_units.push_back({resource, change});
    if (recorded) map.append(std::string(kRecordOutput), NodeJournal::record_of(globals, changes));
    report->outputs = std::make_shared<const Value>(std::move(map));
    report->pending = std::make_unique<AllChanges>(globals.pending_changes(), ending.pending);
    return report;
  }
};

void ActionEnvironment::EndReceiver::deliver(NodeId node, std::uint32_t attempt, ReportPtr report) {
  const Lock lock(mutex);
  if (completions != nullptr) completions->finish(node, attempt, std::move(report));
}

/// An execution as its runner sees it. It owns its data, since the runner may outlive the launch.
class ActionEnvironment::NodeCall final : public mission::ActionCall {
 public:
  NodeCall(ActionEnvironment& environment, NodeContext& context, Completions& completions,
           std::shared_ptr<Reporter> reporter)
      : environment_(environment),
        planned_(environment.plan_[context.node()]),
        context_(context),
        node_(context.node()),
        attempt_(context.attempt()),
        completions_(completions),
        reporter_(std::move(reporter)),
        inputs_(environment.inputs(context)),
        outputs_(environment.default_outputs(context.node(), reporter_->globals)) {
    const Value error = environment.value(context, planned_.error_before);
    if (error.is_string()) error_before_ = error.as_string();
    for (const BranchSource& branch : planned_.branches)
      branches_.push_back(ended(context, branch));
  }

  [[nodiscard]] mission::StateIndex state() const override { return planned_.state; }
  [[nodiscard]] const mission::Program& program() const override { return environment_.plan_.program(); }
  [[nodiscard]] std::string path() const override { return std::string(planned_.path); }
  [[nodiscard]] std::span<const Value> inputs() const override { return inputs_; }
  [[nodiscard]] std::span<Value> outputs() override { return outputs_; }
  [[nodiscard]] mission::Globals& globals() const override { return reporter_->globals; }
  [[nodiscard]] bool may_be_discarded() const override { return environment_.may_be_discarded(node_); }
  [[nodiscard]] const std::string& error_before() const override { return error_before_; }
  [[nodiscard]] std::span<const mission::BranchResult> branches() const override { return branches_; }
  [[nodiscard]] std::uint64_t iteration() const override {
    return planned_.counts ? static_cast<std::uint64_t>(reporter_->count) : planned_.iteration;
  }
  [[nodiscard]] const Value& progress() const override {
    return environment_.journal_ != nullptr ? environment_.journal_->progress(node_) : ActionCall::progress();
  }
  [[nodiscard]] std::function<void(const Value&)> recorder() const override {
    if (environment_.journal_ == nullptr) return {};
    return environment_.journal_->recorder(node_);
  }
  [[nodiscard]] const mission::ObservedNeeds* observed() const override {
    return environment_.runners_.observer() ? planned_.observed.get() : nullptr;
  }
  [[nodiscard]] bool backward() const override { return false; }

  mission::Completer defer(std::function<void()> preempt) override {
    environment_.running_[index(node_)] = {reporter_, std::move(preempt)};
    completions_.await(node_, attempt_);
    return [receiver = environment_.receiver_, reporter = reporter_, node = node_, attempt = attempt_](
               const Ending& ending, std::vector<Value> outputs) {
      reporter->globals.close();
      receiver->deliver(node, attempt, reporter->report(ending, std::move(outputs)));
    };
  }
  void end_after(Duration duration, Ending ending) override {
    const auto when = time_after(completions_.now(), duration);
    if (!when) ending = {kAborted, when.error().message};
    auto report = reporter_->report(ending, std::move(outputs_));
    environment_.running_[index(node_)] = {reporter_, nullptr, report->outputs};
    completions_.finish_at(when.value_or(completions_.now()), node_, attempt_, std::move(report));
  }

  std::vector<Value>& results() { return outputs_; }

 private:
  [[nodiscard]] mission::WorldView look_at_world() const override { return environment_.world(context_); }
  mission::BranchResult ended(NodeContext& context, const BranchSource& branch) const {
    for (const BranchEnd& end : branch.ends) {
      if (end.input != task_network::kNone) {
        const Value* said = context.input(end.input);
        if (said == nullptr || !(*said == Value(static_cast<std::uint64_t>(end.reached)))) continue;
      }
      const Value error = environment_.value(context, end.error);
      if (planted(ConversionFault::MistakesBranches)) return {branch.state, 0, {}};
      return {branch.state, end.outcome, error.is_string() ? error.as_string() : std::string()};
    }
    return {branch.state, kAborted, {}};
  }

  ActionEnvironment& environment_;
  const PlannedNode& planned_;
  NodeContext& context_;
  NodeId node_;
  std::uint32_t attempt_;
  Completions& completions_;
  std::shared_ptr<Reporter> reporter_;
  std::vector<Value> inputs_;
  std::vector<Value> outputs_;
  std::string error_before_;
  std::vector<mission::BranchResult> branches_;
};

ActionEnvironment::ActionEnvironment(const MissionPlan& plan, const mission::Runners& runners,
                                     std::vector<std::shared_ptr<mission::ActionRunner>> by_action,
                                     RunOptions options, Listeners listeners)
    : globals(plan.program().mission().globals),
      plan_(plan),
      runners_(runners),
      by_action_(std::move(by_action)),
      options_(std::move(options)),
      journal_(listeners.journal),
      events_(listeners.events),
      iterations_(std::make_shared<mission::Iterations>(plan.program().nodes().size())) {}

ActionEnvironment::~ActionEnvironment() {
  close();
}

void ActionEnvironment::stop() {
  const Lock lock(stopping_);
  stopped_ = true;
  if (subtree_ != nullptr) subtree_->stop();
}

void ActionEnvironment::ended(NodeId node, std::uint32_t /*attempt*/) {
  running_.erase(index(node));
  unsure_.erase(index(node));
}

bool ActionEnvironment::outdated(NodeId node) const {
  const auto found = unsure_.find(index(node));
  return found != unsure_.end() && !found->second->valid();
}

void ActionEnvironment::passed_before(NodeId node) {
  globals.settle_before(place_number(node));
}

mission::Place ActionEnvironment::place(NodeId node) const {
  return {place_number(node), plan_[node].branch, plan_.network().label(node)};
}

bool ActionEnvironment::may_be_discarded(NodeId node) const {
  return plan_.network()[node].kind != ActionClass::Irreversible &&
         !planted(ConversionFault::ChangesGlobalsAtOnce);
}

/// The global variables as the action of the node may use them.
mission::Globals ActionEnvironment::globals_of(NodeId node) const {
  return may_be_discarded(node) ? globals.kept_aside_at(place(node)) : globals.at(place(node));
}

void ActionEnvironment::close() {
  const Lock lock(receiver_->mutex);
  receiver_->completions = nullptr;
}

/// The value of the newest candidate that exists; a null is replaced by its default.
Value ActionEnvironment::value(NodeContext& context, const ValueSource& source) const {
  return newest(context, std::span(&source, 1));
}

Value ActionEnvironment::newest(NodeContext& context, std::span<const ValueSource> sources) const {
  return newest_value(
      sources, [&](std::uint32_t input) { return context.input(input); }, plan_.network().names);
}

std::vector<Value> ActionEnvironment::inputs(NodeContext& context) const {
  std::vector<Value> values;
  for (const ValueSource& source : plan_[context.node()].inputs)
    values.push_back(value(context, source));
  return values;
}

std::vector<Value> ActionEnvironment::default_outputs(NodeId node, const mission::Globals& variables) const {
  std::vector<Value> outputs;
  for (const mission::PortSource& output : plan_.program().node(plan_[node].shown_as).outputs) {
    auto global = output.global.empty() ? std::nullopt : variables.get(output.global);
    outputs.push_back(std::move(global).value_or(output.fallback));
  }
  return outputs;
}

std::shared_ptr<ActionEnvironment::Reporter> ActionEnvironment::reporter(NodeId node) const {
  const mission::CompiledState& state = plan_.program().node(plan_[node].state);
  auto made = std::make_shared<Reporter>(globals_of(node));
  made->recorded = journal_ != nullptr;
  for (const mission::Port& port : *state.output_ports)
    made->ports.push_back(port.name);
  for (const std::string& outcome : *state.outcomes) {
    const auto id = plan_.network().outcomes.find(outcome);
    made->outcomes.push_back(id ? task_network::OutcomeId(*id) : task_network::kSuccess);
  }
  return made;
}

std::shared_ptr<ActionEnvironment::Reporter> ActionEnvironment::counting_reporter(
    NodeContext& context) const {
  const PlannedNode& planned = plan_[context.node()];
  auto made = reporter(context.node());
  made->counts = planned.counts;
  if (!planned.counts) return made;
  const Value begun = value(context, planned.begun);
  made->count = begun.is_integer() ? begun.as_int() : 0;
  return made;
}

/// An action that does not begin leaves its default outputs, like one that aborts.
ReportPtr ActionEnvironment::refuse(NodeContext& context, std::string why) {
  if (journal_ != nullptr) journal_->refused(context.node());
  const auto reports = counting_reporter(context);
  return reports->report({kAborted, std::move(why)}, default_outputs(context.node(), reports->globals));
}

void ActionEnvironment::start(NodeContext& context, Completions& completions) {
  if (receiver_->completions == nullptr) {
    const Lock lock(receiver_->mutex);
    receiver_->completions = &completions;
  }
  if (journal_ != nullptr && replay(context, completions)) return;
  const PlannedNode& planned = plan_[context.node()];
  switch (planned.role) {
    case Role::Action:
      return start_action(context, completions);
    case Role::OpaqueSubtree:
      return start_subtree(context, completions);
    case Role::Join:
      return join(context, completions);
    case Role::Begin:
      return begin_container(context, completions);
    case Role::Copy:
    case Role::Global:
      return hand_on(context, completions);
  }
}

/// True if the node ended in an earlier run: it ends at once as it did then.
bool ActionEnvironment::replay(NodeContext& context, Completions& completions) {
  auto end = journal_->replayed(context.node());
  if (!end) return false;
  if (events_ != nullptr) events_->replays(context.node());
  const auto reports = counting_reporter(context);
  for (auto& [name, value] : end->globals) {
    if (const auto set = reports->globals.set(name, std::move(value)); !set && options_.warn)
      options_.warn(plan_.network().label(context.node()) + ": " + set.error().message);
  }
  for (const std::string& name : end->erased) {
    if (const auto erased = reports->globals.erase(name); !erased && options_.warn)
      options_.warn(plan_.network().label(context.node()) + ": " + erased.error().message);
  }
  if (end->outputs.empty()) end->outputs = default_outputs(context.node(), reports->globals);
  for (const auto& [state, count] : end->begun) {
    if (state < iterations_->size()) (*iterations_)[state] = count;
  }
  const PlannedNode& planned = plan_[context.node()];
  const bool as_foreseen = end->outcome >= 0 && reports->outcomes[static_cast<std::size_t>(end->outcome)] ==
                                                    plan_.network()[context.node()].expected;
  if (runners_.observer() && planned.observed && as_foreseen)
    runners_.observer()->assume(planned.observed->effects);
  const bool waits = end->outcome == kPreempted;  // until the race is lost again
  const auto again = [&completions, node = context.node(), attempt = context.attempt(), reports,
                      end = std::move(*end)] {
    completions.finish_at(completions.now(), node, attempt,
                          reports->report({end.outcome, end.error}, end.outputs, {end.facts, end.units, {}}));
  };
  if (waits)
    running_[index(context.node())] = {reports, again};
  else
    again();
  return true;
}

void ActionEnvironment::start_action(NodeContext& context, Completions& completions) {
  const PlannedNode& planned = plan_[context.node()];
  if (!planned.refused.empty()) {
    return completions.finish_at(completions.now(), context.node(), context.attempt(),
                                 refuse(context, planned.refused));
  }
  if (events_ != nullptr) events_->begins(context.node());
  if (journal_ != nullptr) journal_->began(context.node());
  auto reports = counting_reporter(context);
  if (auto used = reports->globals.pending_changes()) unsure_[index(context.node())] = std::move(used);
  NodeCall call(*this, context, completions, reports);
  std::optional<Ending> ending;
  try {
    ending = by_action_[plan_.program().node(planned.state).action]->start(call);
  } catch (const std::exception& exception) {
    ending = Ending{planted(ConversionFault::SwallowsExceptions) ? 0 : kAborted, exception.what()};
  } catch (...) {
    ending = Ending{kAborted, "it threw an object that is not a std::exception"};
  }
  if (!ending) return;
  reports->globals.close();
  completions.finish_at(completions.now(), context.node(), context.attempt(),
                        reports->report(*ending, std::move(call.results())));
}

/// The subtree of the node, with everything that it begins with.
mission::MissionPart ActionEnvironment::part(NodeContext& context, const mission::Globals& used) const {
  const PlannedNode& planned = plan_[context.node()];
  const auto slash = planned.path.rfind('/');
  std::string parent(planned.path);  // the root of a library has no path element of its own
  if (plan_.program().node(planned.state).parent != mission::kNoState)
    parent.resize(slash == std::string::npos ? 0 : slash);
  const Value error = value(context, planned.error_before);
  return {planned.state,
          planned.shown_as,
          parent,
          inputs(context),
          error.is_string() ? error.as_string() : "",
          planted(ConversionFault::ForgetsSharedGlobals) ? mission::Globals() : used,
          iterations_,
          world(context),
          units(context),
          planned.around};
}

mission::Units::Counts ActionEnvironment::units(NodeContext& context) const {
  const task_network::ResourceTable& resources = plan_.network().resources;
  mission::Units::Counts counts;
  for (std::uint32_t i = 0; i < resources.size(); ++i) {
    const task_network::ResourceId resource{i};
    counts[resources.name(resource)] =
        planted(ConversionFault::SeesOldUnits) ? resources[resource].count : context.units(resource);
  }
  return counts;
}

mission::WorldView ActionEnvironment::world(NodeContext& context) const {
  const task_network::TaskNetwork& network = plan_.network();
  const task_network::VersionedWorld world = context.world();
  return view_of(planted(ConversionFault::SeesOldWorld) ? network.initial_world : world, network.facts,
                 options_.world_data);
}

/// In virtual time the subtree runs immediately, and its end is reported for the time at which it occurs.
void ActionEnvironment::start_subtree(NodeContext& context, Completions& completions) {
  const bool in_virtual_time = options_.clock == task_network::ClockKind::Virtual;
  auto clock = std::make_shared<VirtualClock>();
  mission::EngineOptions options;
  if (in_virtual_time) options.clock = clock.get();
  options.warn = options_.warn;
  options.history = false;
  options.observe = options_.observe;
  options.preemption_grace = options_.preemption_grace;
  auto reports = reporter(context.node());
  options.part = part(context, reports->globals);
  const SubtreeWatch watch(*options.part);
  auto made = mission::Engine::create(plan_.shared_program(), runners_, std::move(options));
  if (!made) {
    return completions.finish_at(completions.now(), context.node(), context.attempt(),
                                 reports->report({kAborted, made.error().message}, {}));
  }
  if (events_ != nullptr) events_->begins(context.node());
  if (journal_ != nullptr) journal_->began(context.node());
  std::shared_ptr<mission::Engine> engine = std::move(*made);
  const auto carry_out = [engine, reports, watch] {
    engine->run();
    const mission::MissionResult& ended = engine->result();
    return reports->report({ended.outcome, ended.error}, ended.outputs, watch.changes(*engine));
  };
  if (in_virtual_time) {
    occupy(engine.get());
    auto report = carry_out();
    occupy(nullptr);
    const Duration taken = clock->now() - VirtualClock().now();
    const auto when = time_after(completions.now(), taken);
    if (!when) report = reports->report({kAborted, when.error().message}, {});
    return completions.finish_at(when.value_or(completions.now()), context.node(), context.attempt(),
                                 std::move(report));
  }
  running_[index(context.node())] = {reports, [engine] { engine->stop(); }};
  const auto run = [carry_out, receiver = receiver_, node = context.node(), attempt = context.attempt()](
                       const std::stop_token& /*own*/) { receiver->deliver(node, attempt, carry_out()); };
  subtrees_.push_back(concurrent::start_stoppable_thread("segue-subtree", run));
}

/// Registers the subtree that occupies this thread, so that another thread can stop it.
void ActionEnvironment::occupy(mission::Engine* opaque_subtree) {
  const Lock lock(stopping_);
  subtree_ = opaque_subtree;
  if (subtree_ != nullptr && stopped_) subtree_->stop();
}

void ActionEnvironment::cancel(NodeId node, std::uint32_t attempt, Completions& completions) {
  const Outcome outcome = planted(ConversionFault::CountsCancelled) ? 0 : kPreempted;
  const auto found = running_.find(index(node));
  if (found == running_.end()) {
    auto report = plan_.network()[node].structural ? std::make_unique<task_network::Report>()
                                                   : reporter(node)->report({outcome, {}}, {});
    if (outcome == kPreempted) report->outcome = task_network::kPreempted;
    return completions.finish_at(completions.now(), node, attempt, std::move(report));
  }
  const Running running = std::move(found->second);
  running_.erase(found);
  running.reporter->cancelled = true;
  if (running.preempt) return running.preempt();
  std::vector<Value> outputs;
  for (const std::string& port : running.reporter->ports) {
    const Value* value = running.written->find(port);
    outputs.push_back(value == nullptr ? Value() : *value);
  }
  completions.finish_at(completions.now(), node, attempt,
                        running.reporter->report({outcome, {}}, std::move(outputs)));
}

}  // namespace segue::convert
