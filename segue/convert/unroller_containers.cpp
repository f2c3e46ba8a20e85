// SPDX-License-Identifier: Apache-2.0
//
// When containers end, and what they declare for everything in them. A node begins the container: it checks
// the preconditions and takes the units that the container blocks, by a group lock. The nodes in the
// container are members of that lock, which ends with the last of them. More members may be planned then, and
// take the units again: whoever uses them later in program order begins after all members.
#include <segue/base/text.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>

#include <algorithm>

namespace segue::convert {

using task_network::NodeId;
using task_network::NodeSpec;

/// Follows the container, so that it is known when it has ended. The mission itself, whose path is empty,
/// ends with the run.
void Unroller::follow(ContainerExecution& activation) {
  const StateEntry& entry = activation.entry;
  if (entry.path.empty()) return;
  activation.run = std::make_shared<ContainerRun>(
      ContainerRun{entry.container, entry.state, entry.path, entered_[entry.path]++, entry.when});
}

void Unroller::put_in(const std::shared_ptr<ContainerRun>& container, NodeId node) {
  if (container == nullptr) return;
  inside_.emplace(index(node), container);
  for (ContainerRun* each = container.get(); each != nullptr; each = each->around.get())
    ++each->open;
}

std::shared_ptr<ContainerRun> Unroller::container_of(NodeId node) const {
  const auto found = inside_.find(index(node));
  return found == inside_.end() ? nullptr : found->second;
}

const Exit* Unroller::exit_of(const ContainerRun& container) {
  if (container.open > 0 || container.lost) return nullptr;
  const auto taken = std::ranges::find_if(
      container.exits, [&](const Exit& exit) { return paths_.certain(exit.arrival.when); });
  return taken == container.exits.end() ? nullptr : &*taken;
}

/// A container that declares nothing needs no node.
void Unroller::begin_container(ContainerExecution& activation) {
  const StateEntry& entry = activation.entry;
  if (node(entry.state).required == nullptr || planted(ConversionFault::ForgetsEnclosingScope)) return;
  NodeSpec& spec = new_spec();
  spec.structural = true;
  PlannedNode planned;
  planned.role = Role::Begin;
  planned.state = entry.state;
  planned.shown_as = shown_as(entry);
  planned.loops = entry.loops;
  planned.when = entry.when;
  spec.branches = spec.handles_abort = entry.aborts_handled;
  spec.strict = entry.strict;
  // An outline does not wait until it is known: the container may fail, and depends on nothing.
  if (scope_ != PlanScope::Outline || naming_values(entry)) declare_begin(activation, spec, planned);
  const NodeId id = append(spec, std::move(planned), entry.path);
  put_in(activation.run, id);
  if (!entry.aborts_handled) return;
  // As a rule, its declarations hold.
  BranchEnds ends{{task_network::kSuccess, task_network::kAborted, task_network::kPreempted}, {1, 0, 0}};
  if (scope_ != PlanScope::EveryEnd) ends.outcomes.pop_back();
  const auto branch =
      paths_.add(id, entry.when, std::make_shared<const BranchEnds>(std::move(ends)), task_network::kSuccess);
  activation.inside = {branch, task_network::kSuccess};
  if (scope_ == PlanScope::EveryEnd)
    activation.exits.push_back({mission::kPreempted, {{branch, task_network::kPreempted}, false, {}}});
  const BranchEdge refused{branch, task_network::kAborted};
  const auto error = plan_.network_.names.intern(kErrorOutput);
  activation.exits.push_back({mission::kAborted, {refused, true, {{id, error, refused, {}}}}});
}

/// Requires that the values that names consist of are known.
void Unroller::declare_begin(ContainerExecution& activation, NodeSpec& spec, PlannedNode& planned) {
  const StateEntry& entry = activation.entry;
  const auto needs = needs_of(entry);
  if (!needs) {
    planned.refused = needs.error().message;
    return;
  }
  Touch touch;
  look_up(*needs, touch);
  spec.preconditions = std::move(touch.preconditions);
  spec.claims = std::move(touch.claims);
  activation.around = mission::inside(*needs, entry.path, entry.around);
  block(activation, spec, *needs);
}

/// The claims of `spec` that block become the first members of locks; what is in the container becomes
/// members of these, and takes units of the resources that the container lends.
void Unroller::block(ContainerExecution& activation, NodeSpec& spec, const mission::Needs& needs) {
  if (planted(ConversionFault::ForgetsResources)) return;
  std::vector<task_network::Claim> memberships;
  if (activation.memberships != nullptr) memberships = *activation.memberships;
  spec.claims.insert(spec.claims.end(), memberships.begin(), memberships.end());
  for (std::size_t i = 0; i < needs.uses.size(); ++i) {
    if (needs.uses[i].operation != mission::ResourceOperation::Block) continue;
    task_network::Claim& claim = spec.claims[i];
    claim.group = plan_.network_.add_group(claim.resource, claim.count);
    memberships.push_back({claim.resource, task_network::ResourceOp::Exists, 1, claim.group});
  }
  for (const mission::EnclosingScope::Held& held : activation.around->held)
    lend(held);
  if (!memberships.empty())
    activation.memberships = std::make_shared<const std::vector<task_network::Claim>>(std::move(memberships));
}

/// The units exist as long as the plan; a node that takes them holds the units of which they are part. Where
/// a container inside blocks them in turn, they are taken in program order from the first user on.
void Unroller::lend(const mission::EnclosingScope::Held& held) {
  task_network::ResourceRecord& lent = plan_.network_.resources[plan_.network_.resources.intern(held.lent)];
  lent.count = held.count;
  lent.lent = true;
  lent.varies = lent.varies || std::ranges::any_of(blocked_within_, [&](const std::string& pattern) {
                  return matches_glob(pattern, held.resource);
                });
}

}  // namespace segue::convert
