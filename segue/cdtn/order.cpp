// SPDX-License-Identifier: Apache-2.0
#include "order.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace segue::cdtn {

std::string_view to_string(Reason reason) {
  static constexpr std::array<std::string_view, 5> kNames{"fact", "resource", "data", "condition", "place"};
  return kNames[static_cast<std::size_t>(reason)];
}

std::string subject_text(const TaskNetwork& network, const Dependency& dependency) {
  switch (dependency.reason()) {
    case Reason::Fact:
      return network.facts.text(FactId{dependency.subject});
    case Reason::Resource:
      return network.resources.name(ResourceId{dependency.subject});
    case Reason::Data:
      return network.names.name(dependency.subject);
    case Reason::Condition:
      return network.outcomes.name(dependency.subject);
    case Reason::Place:
      break;
  }
  return "its place in the program";
}

void Order::open_node() {
  first_block_.push_back(kNone);
}

namespace {

Dependency dependency(NodeId from, NodeId to, Reason reason, std::uint32_t subject) {
  Dependency made;
  made.from = from;
  made.to = to;
  made.subject = subject & ((1U << 29) - 1);
  made.reason_bits = static_cast<std::uint32_t>(reason) & 7U;
  return made;
}

}  // namespace

void Order::add(NodeId from, Reason reason, std::uint32_t subject) {
  dependencies_.push_back(dependency(from, NodeId{size() - 1}, reason, subject));
}

void Order::close_node() {
  begin_.push_back(static_cast<std::uint32_t>(dependencies_.size()));
}

/// The block has no end yet: it is where the next dependency of the node goes.
void Order::open_block(NodeId node, std::uint32_t place) {
  std::uint32_t& first = first_block_[index(node)];
  blocks_.push_back({place, place, first});
  first = static_cast<std::uint32_t>(blocks_.size()) - 1;
}

/// Linear, but for dependencies on nodes of earlier calls, which are sorted.
void Order::link() {
  const std::uint32_t first = std::exchange(linked_nodes_, size());
  const std::span<const Dependency> added = std::span(dependencies_).subspan(linked_.size());
  std::vector<Dependency> on_earlier;
  std::vector<std::uint32_t> counts(size() - first);  // by new node
  for (const Dependency& each : added) {
    if (index(each.from) < first)
      on_earlier.push_back(each);
    else
      ++counts[index(each.from) - first];
  }
  std::ranges::stable_sort(on_earlier, {}, &Dependency::from);
  auto place = static_cast<std::uint32_t>(linked_.size());
  linked_.insert(linked_.end(), on_earlier.begin(), on_earlier.end());
  for (const Dependency& each : on_earlier) {
    if (blocks_.empty() || linked_[blocks_.back().begin].from != each.from) open_block(each.from, place);
    blocks_.back().end = ++place;
  }
  linked_.resize(dependencies_.size());
  for (std::uint32_t i = 0; i < counts.size(); place += counts[i++]) {
    if (counts[i] > 0) open_block(NodeId{first + i}, place);
  }
  for (const Dependency& each : added) {
    if (index(each.from) >= first) linked_[blocks_[first_block_[index(each.from)]].end++] = each;
  }
}

void Order::reserve(std::size_t nodes, std::size_t dependencies) {
  dependencies_.reserve(dependencies);
  begin_.reserve(nodes + 1);
  first_block_.reserve(nodes);
}

std::size_t Order::bytes() const {
  return (dependencies_.size() + linked_.size()) * sizeof(Dependency) + blocks_.size() * sizeof(Block) +
         (begin_.size() + first_block_.size()) * sizeof(std::uint32_t);
}

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

void OrderBuilder::touch(std::uint32_t& list, NodeId node) {
  touchers_.push_back({node, list});
  list = static_cast<std::uint32_t>(touchers_.size()) - 1;
}

void OrderBuilder::wait_for(std::uint32_t list, NodeId flip, NodeId node, Reason reason,
                            std::uint32_t subject) {
  if (list == kNone && index(flip) != kNone && flip != node) add(flip, reason, subject);
  for (; list != kNone; list = touchers_[list].next) {
    if (touchers_[list].node != node) add(touchers_[list].node, reason, subject);
  }
}

/// Whether the node can rely on the value that the last flip left: not if the flip may have been skipped, or
/// may have had another effect, without the node being skipped too.
bool OrderBuilder::known_to(const FactState& state, NodeId node) const {
  if (state.uncertain) return false;
  const bool before_opaque = index(state.flip) == kNone || state.flip <= place_;
  if (index(place_) != kNone && before_opaque) return false;
  if (index(state.flip) == kNone) return true;
  const auto own = network_.conditions(node);
  const auto others = network_.conditions(state.flip);
  if (!std::includes(own.begin(), own.end(), others.begin(), others.end())) return false;
  const NodeRecord& flip = network_[state.flip];
  return !flip.branches || std::binary_search(own.begin(), own.end(), Condition{state.flip, flip.expected});
}

/// A later write need not wait for pure readers, since they read the predicted value of their place in the
/// order.
void OrderBuilder::add_access(NodeId node, const Access& access) {
  FactState& state = states_[index(access.fact)];
  if (!state.seen) {
    state.seen = true;
    state.value = network_.initial_world.holds(access.fact) ? 1 : 0;
  }
  const NodeRecord& entry = network_[node];
  const bool flips =
      access.writes && (entry.uncertain || state.value != (access.value ? 1 : 0) || !known_to(state, node));
  if (!flips) {
    if (index(state.flip) != kNone) add(state.flip, Reason::Fact, index(access.fact));
    if (access.writes || entry.kind != ActionClass::Pure) touch(state.touchers, node);
    return;
  }
  wait_for(state.touchers, state.flip, node, Reason::Fact, index(access.fact));
  state = {node, kNone, static_cast<std::uint8_t>(access.value ? 1 : 0), entry.uncertain, true};
}

void OrderBuilder::add_place(NodeId node) {
  const NodeRecord& entry = network_[node];
  if (entry.opaque) {
    wait_for(place_touchers_, place_, node, Reason::Place, 0);
    place_touchers_ = kNone;
    place_ = node;
    return;
  }
  if (index(place_) != kNone) add(place_, Reason::Place, 0);
  const auto writes = [](const Access& access) { return access.writes; };
  if (entry.kind != ActionClass::Pure || entry.reads_beside || !network_.claims(node).empty() ||
      std::ranges::any_of(network_.accesses(node), writes))
    touch(place_touchers_, node);
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

}  // namespace segue::cdtn
