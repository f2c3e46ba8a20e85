// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/cdtn/ids.hpp>
#include <segue/cdtn/versioned_world.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::cdtn {

/// A fact as text, and whether it holds.
struct NamedEffect {
  std::string fact;
  bool value = true;
};

/// How a node ended.
struct Report {
  OutcomeId outcome = kSuccess;
  /// What was observed to be true now; nothing: what the node declares if its outcome is the expected one,
  /// else nothing at all.
  std::optional<std::vector<Literal>> effects;
  /// Observed too, of facts that the network need not know: one that grows learns them. For opaque nodes.
  std::vector<NamedEffect> named_effects{};
  std::shared_ptr<const type::Value> outputs;  ///< a map; may be null
  std::string error;                           ///< why, for `aborted`
};
/// Null: success, as predicted, without outputs.
using ReportPtr = std::unique_ptr<Report>;

/// What a node may look at when it starts. Valid during Environment::start only.
class NodeContext {
 public:
  virtual ~NodeContext() = default;
  [[nodiscard]] virtual NodeId node() const = 0;
  /// Counts the runs of this node, from 1: a pure node is run again where an assumption turned out wrong.
  [[nodiscard]] virtual std::uint32_t attempt() const = 0;
  /// The value of an input (of TaskNetwork::names); null where its producer gave none or was skipped.
  [[nodiscard]] virtual const type::Value* input(std::uint32_t name) const = 0;
  /// The value of a fact that the node declares to rely on: in reality, or as projected for a pure node.
  [[nodiscard]] virtual bool holds(FactId fact) const = 0;
  /// The whole world as the node may take it to be: a snapshot that other threads may read. A node that does
  /// not declare `reads_world` fails for asking.
  [[nodiscard]] virtual VersionedWorld world() = 0;
};

/// Where ends of nodes are told. Every start has one end; a second one is ignored.
class Completions {
 public:
  virtual ~Completions() = default;
  /// It ends at that time of the engine's clock. On the engine's thread only.
  virtual void finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) = 0;
  /// It has ended. On any thread, as long as the engine runs.
  virtual void finish(NodeId node, std::uint32_t attempt, ReportPtr report) = 0;
  [[nodiscard]] virtual TimePoint now() const = 0;
};

/// What nodes do. Called on the engine's thread, must not block.
class Environment {
 public:
  virtual ~Environment() = default;
  /// Begins a node, whose end `completions` must be told. `completions` lives as long as the engine runs.
  virtual void start(NodeContext& context, Completions& completions) = 0;
  /// How a node ends that does not begin, since a precondition does not hold: as if it had aborted at once.
  virtual ReportPtr refuse(NodeContext& context, std::string why) {
    (void)context;
    auto report = std::make_unique<Report>();
    report->outcome = kAborted;
    report->error = std::move(why);
    return report;
  }
  /// A node that runs is not wanted any more, or must end early. Its end must still be told, soon.
  virtual void cancel(NodeId node, std::uint32_t attempt, Completions& completions) = 0;
  /// The end of a start has come to the engine, which asks nothing more about it.
  virtual void ended(NodeId node, std::uint32_t attempt) {
    (void)node;
    (void)attempt;
  }
  /// How long a start that is not told to end is waited for after `cancel`, on a real clock.
  [[nodiscard]] virtual Duration patience() const { return std::chrono::seconds(10); }
};

}  // namespace segue::cdtn
