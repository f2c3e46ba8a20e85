// SPDX-License-Identifier: Apache-2.0
//
// Nodes that execute nothing: they end as soon as they begin.
#include <segue/convert/action_environment.hpp>
#include <segue/convert/conversion_fault.hpp>

namespace segue::convert {

using task_network::Completions;
using task_network::NodeContext;
using task_network::ReportPtr;
using type::Value;

/// The value of a global variable, or the newest of the inputs.
void ActionEnvironment::hand_on(NodeContext& context, Completions& completions) {
  const PlannedNode& planned = plan_[context.node()];
  Value handed = planned.role == Role::Global
                     ? globals_of(context.node()).get(planned.global).value_or(Value())
                     : newest(context, planned.inputs);
  auto report = std::make_unique<task_network::Report>();
  report->outputs =
      std::make_shared<const Value>(Value::map({{std::string(kValueOutput), std::move(handed)}}));
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
