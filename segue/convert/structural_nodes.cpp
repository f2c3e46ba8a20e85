// SPDX-License-Identifier: Apache-2.0
//
// Nodes that execute nothing: they end as soon as they begin.
#include <segue/convert/action_environment.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::convert {

using task_network::Completions;
using task_network::NodeContext;
using task_network::ReportPtr;
using type::Value;

/// The value of a global variable, or the newest of the inputs.
void ActionEnvironment::hand_on(NodeContext& context, Completions& completions) {
  const PlannedNode& planned = plan_[context.node()];
  Value handed = planned.role == Role::Global
                     ? globals_of(context.node()).get(planned.variable).value_or(Value())
                     : newest(context, planned.inputs);
  auto report = std::make_unique<task_network::Report>();
  report->outputs =
      std::make_shared<const Value>(Value::map({{std::string(kValueOutput), std::move(handed)}}));
  completions.finish_at(completions.now(), context.node(), context.attempt(), std::move(report));
}

void ActionEnvironment::change_value(NodeContext& context, Completions& completions) {
  const PlannedNode& planned = plan_[context.node()];
  const mission::Program& program = plan_.program();
  const mission::Action& action = program.mission().actions[program.node(planned.state).action];
  const auto names = mission::sources_of_change(action, planned.variable);
  std::vector<Value> values = inputs(context);
  const auto port = [&](std::string_view name) -> const Value& {
    return values[1 + static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto input = mission::position(action.inputs, names[i]);
    if (input && action.inputs[*input].from_world) values[i + 1] = mission::value_of(values[i + 1], names[i]);
  }
  auto report = std::make_unique<task_network::Report>();
  report->outputs = std::make_shared<const Value>(
      Value::map({{std::string(kValueOutput),
                   mission::changed_value(action, planned.variable, std::move(values.front()), port)}}));
  completions.finish_at(completions.now(), context.node(), context.attempt(), std::move(report));
}

void ActionEnvironment::join(NodeContext& context, Completions& completions) {
  bool reached = planted(ConversionFault::JoinsAlways);
  for (const auto& [input, outcome] : plan_[context.node()].joined) {
    const Value* said = context.input(input);
    reached = reached || (said != nullptr && *said == Value(static_cast<std::uint64_t>(outcome)));
  }
  const auto& outcomes = plan_.network().outcomes;
  auto report = std::make_unique<task_network::Report>();
  report->outcome = task_network::OutcomeId(*outcomes.find(reached ? "reached" : "missed"));
  report->outputs = std::make_shared<const Value>(
      Value::map({{std::string(kOutcomeOutput), static_cast<std::uint64_t>(report->outcome)}}));
  completions.finish_at(completions.now(), context.node(), context.attempt(), std::move(report));
}

/// The engine has checked the preconditions of the container, and taken what it blocks.
void ActionEnvironment::begin_container(NodeContext& context, Completions& completions) {
  const PlannedNode& planned = plan_[context.node()];
  ReportPtr report;
  if (planned.refused.empty()) {
    report = std::make_unique<task_network::Report>();
    report->outputs = std::make_shared<const Value>(
        Value::map({{std::string(kOutcomeOutput), static_cast<std::uint64_t>(task_network::kSuccess)}}));
  } else {
    report = refuse(context, planned.refused);
  }
  completions.finish_at(completions.now(), context.node(), context.attempt(), std::move(report));
}

}  // namespace segue::convert
