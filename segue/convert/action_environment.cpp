// SPDX-License-Identifier: Apache-2.0
#include <segue/base/time_after.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/convert/action_environment.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/reporter.hpp>
#include <segue/convert/world_flow.hpp>
#include <segue/convert/world_views.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/world_values.hpp>
#include <segue/mission_robot/fact_observer.hpp>

#include <algorithm>
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

/// Position 0 is before all nodes.
std::uint64_t place_number(NodeId node) {
  return std::uint64_t{index(node)} + 1;
}

}  // namespace

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
    return planned_.passes_on == PassedOn::Count ? reporter_->passed_on : planned_.iteration;
  }
  [[nodiscard]] std::optional<std::uint64_t> memory() const override {
    return planned_.passes_on == PassedOn::Memory ? std::optional(reporter_->passed_on) : std::nullopt;
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
  const PlannedNode& planned = plan_[context.node()];
  std::vector<Value> values;
  for (const ValueSource& source : planned.inputs)
    values.push_back(value(context, source));
  if (planned.role != Role::Action) return values;
  const auto& ports = *plan_.program().node(planned.state).input_ports;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    if (ports[i].from_world) values[i] = mission::value_of(values[i], ports[i].name);
  }
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
  made->recorded = journal_ != nullptr || options_.observe_units != nullptr;
  for (const mission::Port& port : *state.output_ports)
    made->ports.push_back(port.name);
  for (const std::string& outcome : *state.outcomes) {
    const auto id = plan_.network().outcomes.find(outcome);
    made->outcomes.push_back(id ? task_network::OutcomeId(*id) : task_network::kSuccess);
  }
  return made;
}

std::shared_ptr<ActionEnvironment::Reporter> ActionEnvironment::reporter_with_passed_on(
    NodeContext& context) const {
  const PlannedNode& planned = plan_[context.node()];
  auto made = reporter(context.node());
  made->passes_on = planned.passes_on;
  const Value passed_on = value(context, planned.passed_on);
  made->passed_on = passed_on.is_integer() ? passed_on.as_uint() : 0;
  return made;
}

/// An action that does not begin leaves its default outputs, like one that aborts.
ReportPtr ActionEnvironment::refuse(NodeContext& context, std::string why) {
  if (journal_ != nullptr) journal_->refused(context.node());
  const auto reports = reporter_with_passed_on(context);
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
    case Role::Change:
      return change_value(context, completions);
  }
}

/// True if the node ended in an earlier run: it ends at once as it did then.
bool ActionEnvironment::replay(NodeContext& context, Completions& completions) {
  auto end = journal_->replayed(context.node());
  if (!end) return false;
  if (events_ != nullptr) events_->replays(context.node());
  const auto reports = reporter_with_passed_on(context);
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
    completions.finish_at(
        completions.now(), node, attempt,
        reports->report({end.outcome, end.error}, end.outputs, {end.facts, end.units, {}, end.values}));
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
  if (events_ != nullptr) events_->begins(context.node(), completions.now());
  if (journal_ != nullptr) journal_->began(context.node());
  auto reports = reporter_with_passed_on(context);
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
