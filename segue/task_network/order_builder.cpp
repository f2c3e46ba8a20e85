// SPDX-License-Identifier: Apache-2.0
#include "order_builder.hpp"

#include <algorithm>
#include <utility>

namespace segue::task_network {

void OrderBuilder::prepare() {
  states_.resize(network_.facts.size());
  last_claims_.resize(network_.resources.size());
  waited_for_.resize(network_.size(), kNone);
}

void OrderBuilder::extend() {
  prepare();
  for (std::uint32_t i = order_.size(); i < network_.size(); ++i) {
    const NodeId node{i};
    begin_node(node);
    for (const Access& access : network_.accesses(node))
      add_access(node, access);
    add_resources(node, true);
    end_node();
  }
  end();
}

/// Adds the dependencies that both rules share.
void OrderBuilder::begin_node(NodeId node) {
  order_.open_node();
  add_data_and_conditions(node);
  add_place(node);
}

void OrderBuilder::add_data_and_conditions(NodeId node) {
  for (const DataInput& input : network_.inputs(node))
    order_.add(input.producer, Reason::Data, input.input);
  for (const Condition& condition : network_.conditions(node))
    order_.add(condition.node, Reason::Condition, static_cast<std::uint32_t>(condition.outcome));
}

/// Two nodes need only one dependency, however many facts they share; further reasons go to `further_`.
void OrderBuilder::add(NodeId from, Reason reason, std::uint32_t subject) {
  const std::uint32_t to = order_.size() - 1;
  if (waited_for_[index(from)] != to) {
    waited_for_[index(from)] = to;
    order_.add(from, reason, subject);
  } else if (further_ != nullptr) {
    further_->push_back(dependency(from, NodeId{to}, reason, subject));
  }
}

void OrderBuilder::list(std::uint32_t& list, NodeId node, bool relies) {
  members_.push_back({node, list, relies});
  list = static_cast<std::uint32_t>(members_.size()) - 1;
}

/// Whether the node can rely on the value that the last flip left: not if the flip may have been skipped, or
/// may have had another effect, without the node being skipped too.
bool OrderBuilder::known_to(const FactState& state, NodeId node) const {
  if (state.uncertain) return false;
  if (state.now.flips == kNone) return index(place_) == kNone;
  const auto own = network_.conditions(node);
  for (std::uint32_t i = state.now.flips; i != kNone; i = members_[i].next) {
    const NodeId flip = members_[i].node;
    if (!is_after_place(flip) || network_.in_parallel(flip, node)) continue;
    const auto others = network_.conditions(flip);
    if (!std::includes(own.begin(), own.end(), others.begin(), others.end())) continue;
    const NodeRecord& entry = network_[flip];
    if (!entry.branches || std::binary_search(own.begin(), own.end(), Condition{flip, entry.expected}))
      return true;
  }
  return false;
}

/// Whether the last flips may only have left the one value or the value before.
bool OrderBuilder::may_be_joined(const FactState& state) const {
  if (state.uncertain || state.now.flips == kNone) return false;
  for (std::uint32_t i = state.now.flips; i != kNone; i = members_[i].next) {
    if (!is_after_place(members_[i].node)) return false;
  }
  return true;
}

void OrderBuilder::add_access(NodeId node, const Access& access) {
  FactState& state = states_[index(access.fact)];
  if (!state.seen) {
    state.seen = true;
    state.value = network_.initial_world.holds(access.fact) ? 1 : 0;
  }
  const bool known = known_to(state, node);
  const bool agrees = !network_[node].uncertain && state.value == (access.value ? 1 : 0);
  if (!access.writes || (agrees && known)) return keep(state, node, access, known);
  if (agrees && may_be_joined(state)) return join_flip(state, node, access);
  flip(state, node, access);
}

/// The node leaves the fact as it is. A later write need not wait for pure readers, since they read the
/// predicted value of their place in the order.
void OrderBuilder::keep(FactState& state, NodeId node, const Access& access, bool known) {
  const bool relies = access.reads && !known;
  wait_for({state.now.flips, kNone}, node, access, !relies);
  if (access.writes || network_[node].kind != ActionClass::Pure) list(state.now.touchers, node, relies);
}

void OrderBuilder::flip(FactState& state, NodeId node, const Access& access) {
  wait_for(state.now, node, access, false);
  state.before = state.now;
  state.now = {};
  list(state.now.flips, node, access.reads);
  state.value = access.value ? 1 : 0;
  state.uncertain = network_[node].uncertain;
}

/// The node flips the fact to the value to which the last flips have set it, if there were any. From now on
/// it stands for the nodes that it waits for, except towards nodes that are in parallel to it only.
void OrderBuilder::join_flip(FactState& state, NodeId node, const Access& access) {
  if (!wait_for(state.now, node, access, !access.reads)) wait_for(state.before, node, access, false);
  bool relies = drop_those_before(state.now.touchers, node);
  relies = drop_those_before(state.now.flips, node) || relies;
  list(state.now.flips, node, relies || access.reads);
}

/// Takes out the nodes of the same branch and of those in it; returns whether one of them relies on the
/// value.
bool OrderBuilder::drop_those_before(std::uint32_t& list, NodeId node) {
  const std::uint32_t branch = network_[node].parallel_branch;
  std::vector<std::uint32_t> kept;
  bool relies = false;
  for (std::uint32_t i = list; i != kNone; i = members_[i].next) {
    if (network_.is_within(network_[members_[i].node].parallel_branch, branch))
      relies = relies || members_[i].relies;
    else
      kept.push_back(i);
  }
  list = kNone;
  for (auto i = kept.rbegin(); i != kept.rend(); ++i)
    this->list(list, members_[*i].node, members_[*i].relies);
  return relies;
}

/// Adds the dependencies on the nodes of the epoch: on all that touched the fact, and on the flips for which
/// none of these nor a later flip stands. `agrees`: those in parallel that do not mind are left out. Returns
/// whether there is one.
bool OrderBuilder::wait_for(const Epoch& epoch, NodeId node, const Access& access, bool agrees) {
  waited_.clear();
  const auto wait = [&](const Member& one) {
    if (one.node == node || (agrees && !one.relies && network_.in_parallel(one.node, node))) return;
    add(one.node, Reason::Fact, index(access.fact));
    waited_.push_back(one.node);
  };
  for (std::uint32_t i = epoch.touchers; i != kNone; i = members_[i].next)
    wait(members_[i]);
  for (std::uint32_t i = epoch.flips; i != kNone; i = members_[i].next) {
    const NodeId flip = members_[i].node;
    const auto stands_for = [&](NodeId later) { return later > flip && !network_.in_parallel(later, flip); };
    if (std::ranges::none_of(waited_, stands_for)) wait(members_[i]);
  }
  return !waited_.empty();
}

void OrderBuilder::add_place(NodeId node) {
  const NodeRecord& entry = network_[node];
  if (entry.opaque) {
    if (place_touchers_ == kNone && index(place_) != kNone) add(place_, Reason::Place, 0);
    for (std::uint32_t i = std::exchange(place_touchers_, kNone); i != kNone; i = members_[i].next)
      add(members_[i].node, Reason::Place, 0);
    place_ = node;
    return;
  }
  if (index(place_) != kNone) add(place_, Reason::Place, 0);
  const auto writes = [](const Access& access) { return access.writes; };
  if (entry.kind != ActionClass::Pure || entry.reads_beside || !network_.claims(node).empty() ||
      std::ranges::any_of(network_.accesses(node), writes))
    list(place_touchers_, node);
}

void OrderBuilder::add_resources(NodeId node, bool blocks_in_order) {
  for (const Claim& claim : network_.claims(node)) {
    const ResourceRecord& resource = network_.resources[claim.resource];
    const bool irreversible =
        network_[node].kind == ActionClass::Irreversible && claim.op != ResourceOp::Exists;
    if (!resource.varies && !resource.grouped && !(blocks_in_order && irreversible && !resource.commutes))
      continue;
    LastClaims& last = last_claims_[index(claim.resource)];
    if (claim.group != kNone && claim.op == ResourceOp::Exists) {  // the first member holds them already
      order_.add(NodeId{network_.groups()[claim.group].first}, Reason::Resource, index(claim.resource));
      last.members.push_back(node);
      continue;
    }
    if (index(last.node) != kNone && last.node != node)
      order_.add(last.node, Reason::Resource, index(claim.resource));
    for (const NodeId member : std::exchange(last.members, {})) {
      if (member != node) order_.add(member, Reason::Resource, index(claim.resource));
    }
    last.node = node;
  }
}

}  // namespace segue::task_network
