// SPDX-License-Identifier: Apache-2.0
#include "task_network.hpp"

#include <algorithm>
#include <cassert>

namespace segue::task_network {

TaskNetwork::TaskNetwork() {
  for (const std::string_view known : {"success", "aborted", "preempted"})
    outcomes.intern(known);
  nodes_.emplace_back();
}

bool TaskNetwork::observes(NodeId node) const {
  return std::ranges::any_of(accesses(node), [this](const Access& access) {
    return access.reads && facts.is_observed(access.fact);
  });
}

std::string TaskNetwork::label(NodeId node) const {
  const std::uint32_t iteration = (*this)[node].iteration;
  return iteration == 0 ? name_of(node) : name_of(node) + '#' + std::to_string(iteration);
}

std::uint32_t TaskNetwork::add_group(ResourceId resource, std::uint32_t count) {
  resources[resource].grouped = true;
  groups_.push_back({resource, count, 0, kNone});
  return static_cast<std::uint32_t>(groups_.size()) - 1;
}

std::uint32_t TaskNetwork::add_parallel_branch(std::uint32_t around, std::uint64_t number) {
  parallel_branches_.push_back({around, around == kNone ? 0 : parallel_branches_[around].depth + 1, number});
  return static_cast<std::uint32_t>(parallel_branches_.size()) - 1;
}

bool TaskNetwork::in_parallel(NodeId a, NodeId b) const {
  std::uint32_t one = (*this)[a].parallel_branch;
  std::uint32_t other = (*this)[b].parallel_branch;
  if (one == other || one == kNone || other == kNone) return false;
  const auto leave = [this](std::uint32_t& branch) { branch = parallel_branches_[branch].around; };
  while (parallel_branches_[one].depth > parallel_branches_[other].depth)
    leave(one);
  while (parallel_branches_[other].depth > parallel_branches_[one].depth)
    leave(other);
  for (; one != other; leave(one), leave(other)) {
    if (parallel_branches_[one].number == parallel_branches_[other].number) return true;
  }
  return false;
}

bool TaskNetwork::is_within(std::uint32_t branch, std::uint32_t other) const {
  while (branch != kNone && branch != other)
    branch = parallel_branches_[branch].around;
  return branch == other;
}

NodeId TaskNetwork::append(const NodeSpec& spec, std::uint32_t called) {
  const NodeId node{size()};
  NodeRecord& entry = nodes_.back();
  entry.duration = spec.duration;
  entry.name = called;
  entry.iteration = spec.iteration;
  entry.expected = spec.expected;
  entry.kind = spec.kind;
  entry.branches = spec.branches;
  entry.handles_abort = spec.handles_abort;
  entry.opaque_subtree = spec.opaque_subtree;
  entry.opaque = spec.opaque;
  entry.reads_world = spec.reads_world;
  entry.uncertain = spec.uncertain;
  entry.reads_beside = spec.reads_beside;
  entry.cannot_fail = spec.cannot_fail;
  entry.strict = spec.strict;
  entry.structural = spec.structural;
  entry.parallel_branch = spec.parallel_branch;
  append_accesses(spec, node);
  append_claims(spec);
  if (entry.reads_world && entry.kind != ActionClass::Pure) entry.opaque = true;
  inputs_.insert(inputs_.end(), spec.inputs.begin(), spec.inputs.end());
  const auto by_producer = [](const DataInput& a, const DataInput& b) { return a.producer < b.producer; };
  const auto inputs = inputs_.begin() + entry.first_input;
  if (!std::is_sorted(inputs, inputs_.end(), by_producer))
    std::stable_sort(inputs, inputs_.end(), by_producer);
  conditions_.insert(conditions_.end(), spec.conditions.begin(), spec.conditions.end());
  const auto conditions = conditions_.begin() + entry.first_condition;
  std::sort(conditions, conditions_.end());
  conditions_.erase(std::unique(conditions, conditions_.end()), conditions_.end());
  NodeRecord next;
  close(next);
  nodes_.push_back(next);
  return node;
}

void TaskNetwork::close(NodeRecord& next) const {
  next.first_access = access_count();
  next.first_claim = static_cast<std::uint32_t>(claims_.size());
  next.first_input = static_cast<std::uint32_t>(inputs_.size());
  next.first_condition = static_cast<std::uint32_t>(conditions_.size());
}

std::vector<std::uint32_t> TaskNetwork::effects(NodeId node) const {
  std::vector<std::uint32_t> places;
  const std::uint32_t first = (*this)[node].first_access;
  for (std::uint32_t i = 0; i < accesses(node).size(); ++i) {
    if (accesses_[first + i].writes) places.push_back(first + i);
  }
  std::ranges::stable_sort(places, {}, [this](std::uint32_t place) { return accesses_[place].turn; });
  return places;
}

void TaskNetwork::append_accesses(const NodeSpec& spec, NodeId node) {
  const auto access_to = [&](FactId fact) -> Access& {
    const auto known = std::ranges::find(scratch_, fact, &Access::fact);
    if (known != scratch_.end()) return *known;
    Access& access = scratch_.emplace_back();
    access.fact = fact;
    access.node = node;
    return access;
  };
  scratch_.clear();
  for (const Literal& literal : spec.preconditions) {
    Access& access = access_to(literal.fact);
    access.reads = true;
    access.needed = literal.value;
  }
  for (std::size_t turn = 0; turn < spec.effects.size(); ++turn) {
    const Literal& literal = spec.effects[turn];
    Access& access = access_to(literal.fact);
    access.value = literal.value || (access.writes && access.value);
    if (!access.writes) access.turn = static_cast<std::uint8_t>(std::min<std::size_t>(turn, 255));
    access.writes = true;
  }
  for (Access& access : scratch_) {
    if (index(access.fact) >= chains_.size()) chains_.resize(facts.size());
    FactChain& chain = chains_[index(access.fact)];
    access.previous_write = chain.last_write;
    if (chain.last != kNone) accesses_[chain.last].next = access_count();
    chain.last = access_count();
    if (access.writes) chain.last_write = access_count();
    accesses_.push_back(access);
  }
}

void TaskNetwork::append_claims(const NodeSpec& spec) {
  const std::size_t first = claims_.size();
  for (const Claim& claim : spec.claims) {
    ResourceRecord& resource = resources[claim.resource];
    const bool changes =
        claim.op == ResourceOp::Create || claim.op == ResourceOp::Consume || claim.op == ResourceOp::Delete;
    resource.varies = resource.varies || changes;
    if (changes) nodes_.back().kind = ActionClass::Irreversible;
    const auto same = std::find_if(
        claims_.begin() + static_cast<std::ptrdiff_t>(first), claims_.end(), [&](const Claim& other) {
          return other.resource == claim.resource && other.op == claim.op && other.group == claim.group;
        });
    if (same != claims_.end()) {
      const bool together =
          claim.op != ResourceOp::Exists;  // several nodes and claims rely on the same units
      same->count = together ? same->count + claim.count : std::max(same->count, claim.count);
      continue;
    }
    claims_.push_back(claim);
    if (claim.group != kNone && groups_[claim.group].members++ == 0) groups_[claim.group].first = size();
  }
}

std::size_t TaskNetwork::bytes() const {
  return nodes_.size() * sizeof(NodeRecord) + accesses_.size() * sizeof(Access) +
         claims_.size() * sizeof(Claim) + inputs_.size() * sizeof(DataInput) +
         conditions_.size() * sizeof(Condition) + parallel_branches_.size() * sizeof(ParallelBranch);
}

}  // namespace segue::task_network
