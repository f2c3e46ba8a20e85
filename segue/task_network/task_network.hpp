// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/action_class.hpp>
#include <segue/base/clock.hpp>
#include <segue/task_network/fact.hpp>
#include <segue/task_network/name_table.hpp>
#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/resource.hpp>
#include <segue/task_network/versioned_world.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::task_network {

/// A connection to an input of a node. Several connections of one input are candidates: the last in program
/// order that is not skipped counts.
struct DataInput {
  NodeId producer{};
  std::uint32_t output = 0;  ///< of TaskNetwork::names
  std::uint32_t input = 0;   ///< of TaskNetwork::names
};

/// The node is on the path only if `node` ends with `outcome`.
struct Condition {
  NodeId node{};
  OutcomeId outcome = kSuccess;
  /// That it does, if `node` is on the path, in parts of kCertain. Only decides what runs ahead first.
  std::uint16_t likelihood = kCertain;
  static constexpr std::uint16_t kCertain = 65535;
  /// The likelihood as a number between 0 and 1.
  [[nodiscard]] double share() const { return static_cast<double>(likelihood) / kCertain; }
  friend bool operator==(const Condition& a, const Condition& b) {
    return a.node == b.node && a.outcome == b.outcome;
  }
  friend auto operator<=>(const Condition& a, const Condition& b) {
    return std::pair(a.node, a.outcome) <=> std::pair(b.node, b.outcome);
  }
};

/// The description of a node to append. It may refer only to nodes that were appended before.
struct NodeSpec {
  std::string name;
  std::uint32_t iteration = 0;
  ActionClass kind = ActionClass::Irreversible;
  Duration duration{};            ///< expected
  OutcomeId expected = kSuccess;  ///< its effects belong to this outcome
  bool branches = false;          ///< conditions of later nodes depend on its outcome
  bool handles_abort = false;     ///< `aborted` is an ordinary outcome; requires `branches`
  bool opaque_subtree = false;    ///< part of the plan that runs sequentially, as one node
  bool opaque = false;            ///< may touch facts and resources that it does not declare
  bool reads_world = false;   ///< may look at facts that it does not declare; in reality that makes it opaque
  bool uncertain = false;     ///< its effects may have other values, on the same facts
  bool reads_beside = false;  ///< may read or change what is beside the network (Report::pending)
  bool cannot_fail = false;   ///< neither by itself nor because of a precondition or resource
  bool strict = false;        ///< it acts once no node before it can fail any more
  std::uint32_t parallel_branch = kNone;  ///< of TaskNetwork::add_parallel_branch(); none: in no such branch
  bool structural = false;  ///< only part of the plan's form: takes no time and no worker, and is not a step
  std::vector<Literal> preconditions;
  std::vector<Literal> effects;  ///< of contradicting ones, the positive one counts
  std::vector<Claim> claims;
  std::vector<DataInput> inputs;
  std::vector<Condition> conditions;
};

/// How a node touches one fact.
struct Access {
  FactId fact{};
  NodeId node{};
  std::uint32_t previous_write = kNone;  ///< the access that writes this fact before, in program order
  std::uint32_t next = kNone;            ///< the next access to this fact
  bool reads : 1 = false;
  bool needed : 1 = false;  ///< the value that the precondition asks for
  bool writes : 1 = false;
  bool value : 1 = false;  ///< the value that is predicted
  std::uint8_t turn = 0;   ///< among the node's effects, as declared; the 256th and later ones are equal
};

/// A node as stored: everything of variable length lies in arrays of the network.
struct NodeRecord {
  Duration duration{};
  std::uint32_t name = 0;
  std::uint32_t iteration = 0;
  std::uint32_t first_access = 0;
  std::uint32_t first_claim = 0;
  std::uint32_t first_input = 0;
  std::uint32_t first_condition = 0;
  std::uint32_t parallel_branch = kNone;
  OutcomeId expected = kSuccess;
  ActionClass kind = ActionClass::Irreversible;
  bool branches : 1 = false;
  bool handles_abort : 1 = false;
  bool opaque_subtree : 1 = false;
  bool opaque : 1 = false;
  bool reads_world : 1 = false;
  bool uncertain : 1 = false;
  bool reads_beside : 1 = false;
  bool cannot_fail : 1 = false;
  bool strict : 1 = false;
  bool structural : 1 = false;
};

/// Nodes in program order, in flat arrays, with the facts and resources that they use. Nodes are only
/// appended, also while an engine runs the network (on the engine's thread). Not thread safe.
class TaskNetwork {
 public:
  TaskNetwork();

  std::string name;
  FactTable facts;
  ResourceTable resources;
  NameTable names;     ///< of nodes, inputs and outputs
  NameTable outcomes;  ///< as OutcomeId; begins with success, aborted, preempted
  VersionedWorld initial_world;
  std::vector<Literal> goal;          ///< required at the end, by OrderRule::Goal; empty: the whole world
  bool effects_are_declared = false;  ///< nodes that are not opaque have no others

  /// Appends to the end of the program order. Requires what NodeSpec says of references.
  NodeId append(const NodeSpec& spec) { return append(spec, names.intern(spec.name)); }
  /// Appends to the end of the program order, with an interned name in place of the one in `spec`.
  NodeId append(const NodeSpec& spec, std::uint32_t called);
  /// Adds a lock to which claims refer (Claim::group).
  std::uint32_t add_group(ResourceId resource, std::uint32_t count = 1);
  /// Adds a branch whose nodes are in parallel to those of the other branches with the same number: neither
  /// come first. `around`: the branch that they are all in; kNone: none.
  std::uint32_t add_parallel_branch(std::uint32_t around, std::uint64_t number);
  /// For a network without any, of which nodes are to lie in those of the other one.
  void take_parallel_branches_of(const TaskNetwork& other) { parallel_branches_ = other.parallel_branches_; }
  /// Whether they lie in different branches of the same number, or in branches within these.
  [[nodiscard]] bool in_parallel(NodeId a, NodeId b) const;
  /// Whether the branch is that one, or one in it; everything is within kNone.
  [[nodiscard]] bool is_within(std::uint32_t branch, std::uint32_t other) const;
  OutcomeId outcome(std::string_view text) { return OutcomeId(outcomes.intern(text)); }

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()) - 1; }
  [[nodiscard]] const NodeRecord& operator[](NodeId node) const { return nodes_[index(node)]; }
  [[nodiscard]] const std::string& name_of(NodeId node) const { return names.name((*this)[node].name); }
  /// The name, with the iteration where it is not the first: "dig#2".
  [[nodiscard]] std::string label(NodeId node) const;

  [[nodiscard]] std::span<const Access> accesses(NodeId node) const {
    return part(accesses_, node, &NodeRecord::first_access);
  }
  /// Whether the node relies on facts that are observed: it begins only once all it depends on has happened.
  [[nodiscard]] bool observes(NodeId node) const;
  [[nodiscard]] std::span<const Claim> claims(NodeId node) const {
    return part(claims_, node, &NodeRecord::first_claim);
  }
  [[nodiscard]] std::span<const DataInput> inputs(NodeId node) const {
    return part(inputs_, node, &NodeRecord::first_input);
  }
  [[nodiscard]] std::span<const Condition> conditions(NodeId node) const {
    return part(conditions_, node, &NodeRecord::first_condition);
  }
  [[nodiscard]] const Access& access(std::uint32_t place) const { return accesses_[place]; }
  /// The places of the accesses by which the node writes, in the order in which it declares its effects.
  [[nodiscard]] std::vector<std::uint32_t> effects(NodeId node) const;
  [[nodiscard]] std::uint32_t access_count() const { return static_cast<std::uint32_t>(accesses_.size()); }
  [[nodiscard]] std::uint32_t input_count() const { return static_cast<std::uint32_t>(inputs_.size()); }
  [[nodiscard]] std::span<const GroupLock> groups() const { return groups_; }
  /// Memory of the nodes and their arrays in bytes, without names and facts.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct ParallelBranch {
    std::uint32_t around = kNone;
    std::uint32_t depth = 0;  ///< how many are around it
    std::uint64_t number = 0;
  };
  struct FactChain {
    std::uint32_t last = kNone;
    std::uint32_t last_write = kNone;
  };
  template <class T>
  [[nodiscard]] std::span<const T> part(const std::vector<T>& all, NodeId node,
                                        std::uint32_t NodeRecord::*first) const {
    const NodeRecord* entry = &nodes_[index(node)];
    return {all.data() + entry->*first, all.data() + (entry + 1)->*first};
  }
  void append_accesses(const NodeSpec& spec, NodeId node);
  void append_claims(const NodeSpec& spec);
  void close(NodeRecord& next) const;

  std::vector<NodeRecord> nodes_;  ///< with a sentinel at the end, which holds where the next node begins
  std::vector<Access> accesses_;
  std::vector<Claim> claims_;
  std::vector<DataInput> inputs_;
  std::vector<Condition> conditions_;
  std::vector<GroupLock> groups_;
  std::vector<ParallelBranch> parallel_branches_;
  std::vector<FactChain> chains_;  ///< by fact
  std::vector<Access> scratch_;
};

}  // namespace segue::task_network
