// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/action_environment.hpp>
#include <segue/convert/diagram.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace segue::convert {

namespace {

using cdtn::Diagram;

std::string note_of(const Plan& plan, const PlannedNode& planned) {
  const auto id = [&](mission::StateIndex state) { return plan.program().state(state).id.str(); };
  if (planned.role == Role::Global) return "the variable " + planned.global;
  if (planned.role == Role::Join) return fmt::format("of {} ways", planned.joined.size());
  if (planned.role != Role::Routine) return {};
  const RoutineReason reason = plan.routine_reason(planned.state);
  switch (reason.kind) {
    case RoutineReason::Kind::Preemptive:
      return "since the first of its states that ends preempts the others";
    case RoutineReason::Kind::HandlesPreemption:
      return "since a preemption of " + id(reason.state) + " is handled in it";
    case RoutineReason::Kind::OpaqueBeside:
      return "since " + id(reason.state) + " in it, side by side with others, may touch anything";
    case RoutineReason::Kind::None:
      break;
  }
  return {};
}

/// Names that the plan makes up, as a reader of the mission takes them.
std::string readable(const std::string& name, const Plan& plan, const PlannedNode& planned) {
  if (name.starts_with(kCountOutput)) return "executions" + name.substr(kCountOutput.size());
  for (std::size_t i = 0; i < planned.branches.size(); ++i) {
    if (name.starts_with(fmt::format("branch{}.", i)))
      return "end of " + plan.program().state(planned.branches[i].state).id.str();
  }
  return name.starts_with('#') ? name.substr(1) : name;
}

void name_causes(Diagram::Node& node, const Plan& plan, const PlannedNode& planned) {
  for (Diagram::Dependency& dependency : node.before) {
    for (Diagram::Cause& cause : dependency.causes) {
      if (cause.kind == Diagram::Kind::Data) {
        const PlannedNode& from = plan[cdtn::NodeId{dependency.from}];
        const bool global = from.role == Role::Global;
        cause.subject = global ? "default" : readable(cause.subject, plan, planned);
        cause.detail = readable(cause.detail, plan, from);
      } else if (cause.kind == Diagram::Kind::Opaque && plan[cdtn::NodeId{cause.node}].role == Role::Global) {
        cause.detail = "it reads a global variable, which anything may write";
      }
    }
  }
}

Diagram::Role role_of(Role role, Diagram::Role otherwise) {
  switch (role) {
    case Role::Routine:
      return Diagram::Role::Routine;
    case Role::Join:
      return Diagram::Role::Join;
    case Role::Copy:
      return Diagram::Role::Copy;
    case Role::Global:
      return Diagram::Role::Global;
    case Role::Action:
      break;
  }
  return otherwise;
}

/// A plan that has come to its end, as far as an engine is told, when there are so many nodes.
class Bounded final : public cdtn::Expansion {
 public:
  Bounded(Plan& plan, std::size_t most) : plan_(plan), most_(most) {}
  void expand(cdtn::Network& network, std::size_t wanted) override {
    if (network.size() < most_) plan_.expand(network, std::min(wanted, most_ - network.size()));
  }
  void ended(cdtn::NodeId node, cdtn::OutcomeId outcome, const type::Value* outputs) override {
    plan_.ended(node, outcome, outputs);
  }
  [[nodiscard]] bool finished() const override { return plan_.finished() || plan_.network().size() >= most_; }

 private:
  Plan& plan_;
  const std::size_t most_;
};

}  // namespace

Diagram diagram_of(const Plan& plan) {
  std::vector<cdtn::Dependency> further;
  const cdtn::Order order = cdtn::derive_order(plan.network(), cdtn::OrderRule::Epoch, &further);
  Diagram diagram = cdtn::diagram_of(plan.network(), order, further);
  for (std::uint32_t i = 0; i < diagram.nodes.size(); ++i) {
    const PlannedNode& planned = plan[cdtn::NodeId{i}];
    Diagram::Node& node = diagram.nodes[i];
    node.role = role_of(planned.role, node.role);
    if (planned.role != Role::Action) node.note = note_of(plan, planned);
    if (!planned.refused.empty()) node.note = "will not begin: " + planned.refused;
    if (const auto slash = planned.path.rfind('/'); slash != std::string::npos)
      node.container = planned.path.substr(0, slash);
    name_causes(node, plan, planned);
  }
  diagram.complete = plan.finished();
  if (!diagram.complete) diagram.waits_for = plan.waits_for();
  return diagram;
}

Result<std::optional<Error>> plan_ahead(Plan& plan, std::size_t most, const mission::Runners* assumed) {
  if (assumed == nullptr) {
    plan.expand(plan.network(), most);
    return std::optional<Error>();
  }
  auto by_action = assumed->assign(plan.program().mission());
  if (!by_action) return by_action.error();
  RunOptions options;
  options.clock = cdtn::ClockKind::Virtual;
  ActionEnvironment environment(plan, *assumed, std::move(*by_action), options);
  Bounded bounded(plan, most);
  cdtn::EngineOptions settings;
  settings.clock = cdtn::ClockKind::Virtual;
  settings.horizon = most;
  cdtn::Engine engine(plan.network(), bounded, environment, settings);
  cdtn::RunResult result = engine.run();
  environment.close();
  return std::move(result.error);
}

}  // namespace segue::convert
