// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>

namespace segue::task_network {

/// Whether a node that has not ended is assumed to be on the path, seen from `at`: conditions that both share
/// are met, other branches end as expected.
bool ConcurrentEngine::Implementation::assumed_on_path(NodeId writer, NodeId at) const {
  const auto own = network_.conditions(at);
  for (const Condition& condition : network_.conditions(writer)) {
    const auto mine = std::ranges::find(own, condition.node, &Condition::node);
    const OutcomeId outcome = mine != own.end() ? mine->outcome : network_[condition.node].expected;
    if (!this->at(condition.node).passed && outcome != condition.outcome) return false;
  }
  const auto self = std::ranges::find(own, writer, &Condition::node);
  return self == own.end() || self->outcome == network_[writer].expected;
}

/// The value of the fact where the access stands in program order: what the last writer before it wrote, or
/// is predicted to write.
bool ConcurrentEngine::Implementation::projected(const Access& access) const {
  std::uint32_t place = access.previous_write;
  for (; place != kNone; place = network_.access(place).previous_write) {
    const Access& write = network_.access(place);
    if (writes_[place] >= 2) break;
    if (writes_[place] == 0 && assumed_on_path(write.node, access.node)) break;
  }
  const NodeId first{place == kNone ? 0 : index(network_.access(place).node) + 1};
  if (const auto last = undeclared_.last(access.fact, first, access.node)) return *last;
  if (place == kNone) return network_.initial_world.holds(access.fact);
  return writes_[place] == 0 ? network_.access(place).value : writes_[place] == 3;
}

/// Applies the effects of a node that has ended.
void ConcurrentEngine::Implementation::add_effects(VersionedWorld& world, NodeId node) const {
  for (const std::uint32_t place : network_.effects(node)) {
    if (writes_[place] >= 2) world.set({network_.access(place).fact, writes_[place] == 3});
  }
  for (const Literal& literal : undeclared_.of(node))
    world.set(literal);
}

void ConcurrentEngine::Implementation::catch_up_prefix_world() {
  for (; prefix_world_at_ < prefix_; ++prefix_world_at_)
    add_effects(prefix_world_, NodeId{prefix_world_at_});
}

/// The world at the node's place in program order: after everything that has passed, then the effects of the
/// nodes in between, real or predicted. Predicted ones are recorded as guesses, to be validated.
VersionedWorld ConcurrentEngine::Implementation::projected_world(NodeId node) {
  catch_up_prefix_world();
  VersionedWorld world = prefix_world_;
  WorldGuess& guess = guesses_[index(node)];
  guess.facts.clear();
  for (NodeId before{prefix_}; before < node; before = NodeId{index(before) + 1}) {
    if (at(before).phase == Phase::Done) {
      add_effects(world, before);
      continue;
    }
    const bool assumed = at(before).phase != Phase::Skipped && assumed_on_path(before, node);
    for (const std::uint32_t place : network_.effects(before)) {
      const Access& access = network_.access(place);
      if (assumed) world.set({access.fact, access.value});
      guess.facts.push_back({access.fact, false});
    }
  }
  for (Literal& fact : guess.facts)
    fact.value = world.holds(fact.fact);
  guess.history = world.history();
  return world;
}

/// The facts as they are now, and what is attached to them as the effects of all that has ended before the
/// node leave it in program order: the order in which nodes end depends on how long they take.
VersionedWorld ConcurrentEngine::Implementation::real_world(NodeId node) {
  if (!prefix_world_.has_attachments()) return world_;
  VersionedWorld world = world_;
  world.take_attachments_of(world_before(node));
  return world;
}

/// The world as all that has ended before the node leaves it, in program order.
VersionedWorld ConcurrentEngine::Implementation::world_before(NodeId node) {
  catch_up_prefix_world();
  VersionedWorld world = prefix_world_;
  for (NodeId before{prefix_world_at_}; before < node; before = NodeId{index(before) + 1}) {
    if (at(before).phase == Phase::Done) add_effects(world, before);
  }
  return world;
}

bool ConcurrentEngine::Implementation::reads_are_valid(NodeId node) const {
  if (network_[node].kind != ActionClass::Pure || planted(EngineFault::NeverValidates)) return true;
  const auto accesses = network_.accesses(node);
  for (std::uint32_t i = 0; i < accesses.size(); ++i) {
    if (accesses[i].reads && projected(accesses[i]) != (reads_[network_[node].first_access + i] == 3))
      return false;
  }
  return true;
}

/// The version of the producer's outputs that this candidate provides; 0 if another candidate for the same
/// input counts, or the producer is skipped.
std::uint32_t ConcurrentEngine::Implementation::input_version(NodeId node, std::size_t place) const {
  const auto inputs = network_.inputs(node);
  const auto skipped = [&](const DataInput& input) { return at(input.producer).phase == Phase::Skipped; };
  if (skipped(inputs[place])) return 0;
  for (std::size_t later = place + 1; later < inputs.size(); ++later) {
    if (inputs[later].input == inputs[place].input && !skipped(inputs[later])) return 0;
  }
  return at(inputs[place].producer).version;
}

bool ConcurrentEngine::Implementation::inputs_are_valid(NodeId node) const {
  if (planted(EngineFault::KeepsStaleInputs)) return true;
  const std::size_t inputs = network_.inputs(node).size();
  for (std::size_t i = 0; i < inputs; ++i) {
    if (versions_[network_[node].first_input + i] != input_version(node, i)) return false;
  }
  return true;
}

/// True where the real world is not known yet.
bool ConcurrentEngine::Implementation::world_is_valid(NodeId node) {
  const auto found = guesses_.find(index(node));
  if (found == guesses_.end() || planted(EngineFault::NeverValidates)) return true;
  if (!world_is_known_to(node)) return true;
  const VersionedWorld world = world_before(node);
  // The same facts may have come about in another way, which data attached to them remember.
  if (world.has_attachments()) return world.history() == found->second.history;
  return std::ranges::all_of(found->second.facts, [&](const Literal& guess) { return world.holds(guess); });
}

}  // namespace segue::task_network
