// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/pending_changes.hpp>
#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/resource.hpp>
#include <segue/task_network/versioned_world.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::task_network {

/// A fact as text, and whether it holds.
struct NamedEffect {
  std::string fact;
  bool value = true;
};

/// How many more units of a resource there are than before, or fewer.
struct NamedUnits {
  std::string resource;
  std::int64_t change = 0;
};

/// How a run of a node ended.
struct Report {
  Report();
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;
  ~Report();

  OutcomeId outcome = kSuccess;
  /// The effects that were observed. Nullopt: the declared effects if the outcome is the expected one, else
  /// none.
  std::optional<std::vector<Literal>> effects;
  /// Further observed effects, of opaque nodes, on facts that the network need not know; a growing network
  /// adds them.
  std::vector<NamedEffect> named_effects{};
  /// Units that an opaque node has created or removed without claiming them; a growing network adds them.
  std::vector<NamedUnits> named_units{};
  std::shared_ptr<const type::Value> outputs;  ///< a map; may be null
  std::string error;                           ///< why, for `aborted`
  /// The changes of a pure or sensing node beside the network, such as of variables. Null: none. A run with
  /// such changes counts when every node before has passed, if they need that (PendingChanges::needs_turn),
  /// and only if it is valid then; else the node runs again.
  std::unique_ptr<PendingChanges> pending{};
};
/// Null: success, as predicted, without outputs.
using ReportPtr = std::unique_ptr<Report>;

/// Everything that a node may access when it starts. Valid only during Environment::start.
class NodeContext {
 public:
  NodeContext(NodeId node, std::uint32_t attempt) : node_(node), attempt_(attempt) {}
  virtual ~NodeContext() = default;
  [[nodiscard]] NodeId node() const { return node_; }
  /// The number of this run of the node, from 1: a pure node runs again if a prediction was wrong.
  [[nodiscard]] std::uint32_t attempt() const { return attempt_; }
  /// The value of an input (of TaskNetwork::names); null where its producer gave none or was skipped.
  [[nodiscard]] virtual const type::Value* input(std::uint32_t name) const = 0;
  /// The value of a fact that the node declares to rely on: in reality, or as projected for a pure node.
  [[nodiscard]] virtual bool holds(FactId fact) const = 0;
  /// The whole world as the node may assume it: a snapshot that other threads may read. A node that does not
  /// declare `reads_world` fails by asking.
  [[nodiscard]] virtual VersionedWorld world() = 0;
  /// How many units of the resource there are. For an opaque node: others neither hold nor change them while
  /// it runs, but for groups.
  [[nodiscard]] virtual std::uint32_t units(ResourceId resource) const = 0;

 private:
  NodeId node_;
  std::uint32_t attempt_;
};

/// Receives the ends of nodes. Every start has one end; further ones are ignored.
class Completions {
 public:
  virtual ~Completions() = default;
  /// The node ends at that time of the engine's clock. On the engine's thread only.
  virtual void finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) = 0;
  /// This run of the node will end by `finish`, so time on a virtual clock must not pass before. On the
  /// engine's thread only.
  virtual void await(NodeId node, std::uint32_t attempt) = 0;
  /// The node has just ended. On any thread, while the engine runs. Does not block.
  virtual void finish(NodeId node, std::uint32_t attempt, ReportPtr report) = 0;
  /// The present time. On the engine's thread only.
  [[nodiscard]] virtual TimePoint now() const = 0;
};

/// Executes nodes. Called on the engine's thread; must not block.
class Environment {
 public:
  virtual ~Environment() = default;
  /// Begins a node, whose end must be reported to `completions`, which lives as long as the engine runs.
  virtual void start(NodeContext& context, Completions& completions) = 0;
  /// The report of a node that does not begin because a precondition is false: by default, it aborted.
  virtual ReportPtr refuse(NodeContext& context, std::string why) {
    (void)context;
    auto report = std::make_unique<Report>();
    report->outcome = kAborted;
    report->error = std::move(why);
    return report;
  }
  /// The run of a node is not needed any more, or must end early. Its end must still be reported, soon.
  virtual void cancel(NodeId node, std::uint32_t attempt, Completions& completions) = 0;
  /// The engine has received the end of this run and does not refer to it again.
  virtual void ended(NodeId node, std::uint32_t attempt) {
    (void)node;
    (void)attempt;
  }
  /// Whether a run in progress has read data beside the network that nodes before it have changed since.
  [[nodiscard]] virtual bool outdated(NodeId node) const {
    (void)node;
    return false;
  }
  /// Whether the node had begun in an earlier run, which this one resumes: then it has its units, whatever
  /// their limits (ConcurrentEngine::limit).
  [[nodiscard]] virtual bool had_begun(NodeId node) const {
    (void)node;
    return false;
  }
  /// All nodes before this one have passed.
  virtual void passed_before(NodeId node) { (void)node; }
  /// How long the engine waits for the end of a cancelled run, on a real clock.
  [[nodiscard]] virtual Duration patience() const { return std::chrono::seconds(10); }
};

}  // namespace segue::task_network
