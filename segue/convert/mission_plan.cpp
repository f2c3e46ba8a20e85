// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/mission_plan.hpp>
#include <segue/convert/unroller.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/world.hpp>

#include <algorithm>

namespace segue::convert {

using task_network::NodeId;
using task_network::OutcomeId;
using type::Value;

namespace {

/// `given`, or else the first of its defaults that is not null.
Value replaced(const Value* given, const Defaults& defaults, const InputValues& inputs,
               const task_network::NameTable& names) {
  if (given != nullptr && !given->is_null()) return *given;
  if (!defaults || planted(ConversionFault::KeepsNull)) return {};
  for (const Default& one : *defaults) {
    if (index(one.reader) == task_network::kNone) {
      if (!one.value.is_null()) return one.value;
      continue;
    }
    const auto name = names.find("#" + std::to_string(index(one.reader)));
    const Value* read = name ? inputs(*name) : nullptr;
    if (read != nullptr && !read->is_null()) return *read;
  }
  return {};
}

}  // namespace

Value newest_value(std::span<const ValueSource> sources, const InputValues& inputs,
                   const task_network::NameTable& names) {
  Value newest;
  std::uint64_t newest_turn = 0;
  for (const ValueSource& source : sources) {
    const Value* given = nullptr;
    const auto feed = std::ranges::find_if(
        source.feeds, [&](const ValueSource::Feed& each) { return (given = inputs(each.input)) != nullptr; });
    const bool fed = feed != source.feeds.end();
    Value value = replaced(given, fed ? feed->defaults : source.rest, inputs, names);
    const std::uint64_t turn = fed ? feed->turn : source.rest_turn;
    const bool none = value.is_null() && !planted(ConversionFault::NullHidesOlder);
    if (none || turn < newest_turn) continue;
    newest = std::move(value);
    newest_turn = turn;
  }
  return newest;
}

MissionPlan::MissionPlan(std::shared_ptr<const mission::Program> program) : program_(std::move(program)) {}
MissionPlan::~MissionPlan() = default;

namespace {

Result<void> check_inputs(const std::vector<mission::Port>& ports, const std::vector<Value>& inputs) {
  if (inputs.size() > ports.size()) {
    return fail(ErrorCode::InvalidArgument, "the mission has " + std::to_string(ports.size()) +
                                                " inputs, not " + std::to_string(inputs.size()));
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (mission::accepts(ports[i].type, inputs[i])) continue;
    return fail(ErrorCode::TypeMismatch, "the input " + quote(ports[i].name) + " is of type " +
                                             ports[i].type + ", not " + type::describe(inputs[i]));
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<MissionPlan>> MissionPlan::create(std::shared_ptr<const mission::Program> program,
                                                         std::vector<Value> inputs,
                                                         const std::vector<mission::Fact>& facts,
                                                         PlanScope scope,
                                                         const mission::UnitCounts& resources) {
  if (auto fits = check_inputs(*program->node(0).input_ports, inputs); !fits) return fits.error();
  const auto world = mission::initial_facts(program->mission(), facts);
  if (!world) return world.error();
  const auto units = mission::initial_units(program->mission(), resources);
  if (!units) return units.error();
  auto plan = std::unique_ptr<MissionPlan>(new MissionPlan(std::move(program)));
  plan->network_.name = plan->program().mission().name;
  plan->network_.effects_are_declared = true;
  for (const std::string& fact : *world) {
    const auto known = plan->network_.facts.intern_named(fact);
    if (!known) return known.error();
    plan->network_.initial_world.set({*known, true});
  }
  for (const mission::Resource& resource : plan->program().mission().resources) {
    task_network::ResourceRecord& entry =
        plan->network_.resources[plan->network_.resources.intern(resource.name)];
    entry.kind = static_cast<task_network::ResourceClass>(resource.kind);
    entry.commutes = resource.commutes;
    entry.observed = resource.observe.has_value();
  }
  for (const auto& [name, count] : *units)
    plan->network_.resources[plan->network_.resources.intern(name)].count = count;
  plan->unroller_ = std::make_unique<Unroller>(*plan, std::move(inputs), scope);
  if (auto begun = plan->unroller_->begin(); !begun) return begun.error();
  return plan;
}

void MissionPlan::expand(task_network::TaskNetwork& network, std::size_t wanted) {
  const std::size_t limit = network.size() + wanted;
  waits_for_.clear();
  while (network.size() < limit && unroller_->step()) {
  }
  if (network.size() >= limit) waits_for_.clear();
}

void MissionPlan::ended(NodeId node, OutcomeId outcome, const Value* outputs) {
  unroller_->ended(node, outcome, outputs);
}

void MissionPlan::set_race_record(RaceRecord record) {
  unroller_->set_race_record(std::move(record));
}

const RaceRecord& MissionPlan::race_record() const {
  return unroller_->race_record();
}

void MissionPlan::failed(NodeId node) {
  unroller_->failed(node);
}

void MissionPlan::skipped(NodeId node) {
  unroller_->skipped(node);
}

bool MissionPlan::races() const {
  return unroller_->races();
}

std::vector<NodeId> MissionPlan::take_lost() {
  return unroller_->take_lost();
}

bool MissionPlan::finished() const {
  return unroller_->finished();
}

OpaqueSubtreeReason MissionPlan::subtree_reason(mission::StateIndex state) const {
  return unroller_->subtree_reason(state);
}

bool MissionPlan::off_path(NodeId node) const {
  return !unroller_->paths().live((*this)[node].when);
}

std::shared_ptr<ContainerRun> MissionPlan::container_of(NodeId node) const {
  return unroller_->container_of(node);
}

std::optional<mission::Ending> MissionPlan::end_of(const ContainerRun& container) {
  const Exit* exit = unroller_->exit_of(container);
  if (exit == nullptr) return std::nullopt;
  mission::Ending end{exit->outcome, {}};
  if (end.outcome != mission::kAborted) return end;
  const auto error = unroller_->value_of({exit->arrival.errors, {}});
  if (error && error->is_string()) end.error = error->as_string();
  return end;
}

bool MissionPlan::off_path(const ContainerRun& container) const {
  return !unroller_->paths().live(container.when);
}

bool MissionPlan::on_path(const ContainerRun& container) const {
  return unroller_->paths().certain(container.when);
}

PathIndex MissionPlan::path_index() const {
  return PathIndex(unroller_->paths());
}

mission::Outcome MissionPlan::outcome(NodeId node, OutcomeId outcome) const {
  if (outcome == task_network::kAborted) return mission::kAborted;
  if (outcome == task_network::kPreempted) return mission::kPreempted;
  const auto& names = *program_->node((*this)[node].state).outcomes;
  const auto found = std::ranges::find(names, network_.outcomes.name(static_cast<std::uint32_t>(outcome)));
  return found == names.end() ? mission::kAborted : static_cast<mission::Outcome>(found - names.begin());
}

mission::Outcome MissionPlan::final_outcome(const task_network::RunResult& result) {
  if (result.stopped) return mission::kPreempted;
  if (result.failed) {
    const bool preempted = result.error && result.error->code == ErrorCode::Cancelled;
    return preempted ? mission::kPreempted : mission::kAborted;
  }
  for (const Exit& exit : unroller_->end().exits) {
    if (unroller_->paths().certain(exit.arrival.when)) return exit.outcome;
  }
  return mission::kAborted;
}

std::vector<Value> MissionPlan::final_outputs() {
  std::vector<Value> values;
  for (const Symbol& symbol : unroller_->end().outputs)
    values.push_back(unroller_->value_of(symbol).value_or(Value()));
  return values;
}

std::string MissionPlan::final_error() {
  if (!finished()) return {};
  for (const Exit& exit : unroller_->end().exits) {
    if (!unroller_->paths().certain(exit.arrival.when)) continue;
    const auto error = unroller_->value_of({exit.arrival.errors, {}});
    if (error && error->is_string()) return error->as_string();
  }
  return {};
}

std::unique_ptr<MissionPlan> MissionPlan::from_the_beginning() const {
  auto plan = std::unique_ptr<MissionPlan>(new MissionPlan(program_));
  plan->network_.name = network_.name;
  plan->unroller_ = std::make_unique<Unroller>(*plan, unroller_->given(), PlanScope::EveryEnd);
  plan->unroller_->set_race_record({race_record().firsts});
  (void)plan->unroller_->begin();  // as it has succeeded before
  return plan;
}

}  // namespace segue::convert
