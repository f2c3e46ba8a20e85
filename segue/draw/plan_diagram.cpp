// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/plan_diagram.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace segue::draw {

namespace {

using convert::MissionPlan;
using convert::PlannedNode;
using convert::Role;

std::string note_of(const MissionPlan& plan, const PlannedNode& planned) {
  if (planned.role == Role::Global) return "the variable " + planned.variable;
  if (planned.role == Role::Join) return fmt::format("of {} ways", planned.joined.size());
  if (planned.role == Role::Begin) return "begins the container: takes what it blocks";
  if (planned.role == Role::Change) return "the world's " + planned.variable + " as it will be";
  if (planned.role != Role::OpaqueSubtree) return {};
  return convert::text_of(plan.subtree_reason(planned.state), plan.program());
}

/// Names that the plan makes up, as a reader of the mission takes them.
std::string readable(const std::string& name, const MissionPlan& plan, const PlannedNode& planned) {
  for (std::size_t i = 0; i < planned.branches.size(); ++i) {
    if (name.starts_with(fmt::format("branch{}.", i)))
      return "end of " + plan.program().state(planned.branches[i].state).id.str();
  }
  return name.starts_with('#') ? name.substr(1) : name;
}

void name_causes(Diagram::Node& node, const MissionPlan& plan, const PlannedNode& planned) {
  for (Diagram::Dependency& dependency : node.before) {
    for (Diagram::Cause& cause : dependency.causes) {
      if (cause.kind == Diagram::Kind::Data) {
        const PlannedNode& from = plan[task_network::NodeId{dependency.from}];
        const bool global = from.role == Role::Global;
        cause.subject = global ? "default" : readable(cause.subject, plan, planned);
        cause.detail = readable(cause.detail, plan, from);
      } else if (cause.kind == Diagram::Kind::Opaque &&
                 plan[task_network::NodeId{cause.node}].role == Role::Global) {
        cause.detail = "it reads a global variable, which anything may write";
      }
    }
  }
}

Diagram::Role role_of(Role role, Diagram::Role otherwise) {
  switch (role) {
    case Role::OpaqueSubtree:
      return Diagram::Role::OpaqueSubtree;
    case Role::Join:
      return Diagram::Role::Join;
    case Role::Copy:
    case Role::Change:
      return Diagram::Role::Copy;
    case Role::Global:
      return Diagram::Role::Global;
    case Role::Action:
    case Role::Begin:
      break;
  }
  return otherwise;
}

}  // namespace

Diagram diagram_of(const MissionPlan& plan) {
  std::vector<task_network::Dependency> further;
  const task_network::Order order =
      task_network::derive_order(plan.network(), task_network::OrderRule::Epoch, &further);
  Diagram diagram = diagram_of(plan.network(), order, further);
  for (std::uint32_t i = 0; i < diagram.nodes.size(); ++i) {
    const PlannedNode& planned = plan[task_network::NodeId{i}];
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

}  // namespace segue::draw
