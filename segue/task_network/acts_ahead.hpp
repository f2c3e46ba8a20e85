// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/order.hpp>
#include <segue/task_network/task_network.hpp>

#include <span>
#include <string>
#include <vector>

namespace segue::task_network {

/// `acts` comes after `fails` in program order, but may have acted already when `fails` ends the run by an
/// abort that nobody handles. In the sequential run it would not have acted.
struct ActsAhead {
  NodeId acts{};
  NodeId fails{};
  friend bool operator==(const ActsAhead&, const ActsAhead&) = default;
};
/// ActsAhead with names instead of ids: one entry for all iterations of a node together.
struct NamedActsAhead {
  std::string acts;
  std::vector<std::string> fails;
  friend bool operator==(const NamedActsAhead&, const NamedActsAhead&) = default;
};

/// `senses` comes after `acts` in program order, but may have observed reality before that has acted. In the
/// sequential run it would not have.
struct SensesAhead {
  NodeId senses{};
  NodeId acts{};
  friend bool operator==(const SensesAhead&, const SensesAhead&) = default;
};
/// SensesAhead with names instead of ids: one entry for all iterations of a node together.
struct NamedSensesAhead {
  std::string senses;
  std::vector<std::string> acts;
  friend bool operator==(const NamedSensesAhead&, const NamedSensesAhead&) = default;
};

/// Knowledge of the paths that a run may take.
class Paths {
 public:
  Paths() = default;
  Paths(const Paths&) = delete;
  Paths& operator=(const Paths&) = delete;
  virtual ~Paths() = default;
  /// Whether `other` is on the path of every run that has `node` on it.
  [[nodiscard]] virtual bool implies(NodeId node, NodeId other) const = 0;
  /// Whether `other` is at least part of these runs, so that a node that waits for it waits for its
  /// predecessors, too.
  [[nodiscard]] virtual bool comes_with(NodeId node, NodeId other) const = 0;
  /// Whether a run in which `dependency.to` is on the path certainly has that dependency.
  [[nodiscard]] virtual bool is_certain(const Dependency& dependency) const {
    (void)dependency;
    return true;
  }
  /// Whether `b`, the later one, never acts ahead of a failure of `a`: above all, if no run has both on its
  /// path.
  [[nodiscard]] virtual bool exclude(NodeId a, NodeId b) const = 0;
};

/// The paths of a network all of whose nodes are part of every run, be it that they are skipped.
class WholeNetwork final : public Paths {
 public:
  explicit WholeNetwork(const TaskNetwork& network) : network_(network) {}
  [[nodiscard]] bool implies(NodeId node, NodeId other) const override;
  [[nodiscard]] bool comes_with(NodeId, NodeId) const override { return true; }
  [[nodiscard]] bool exclude(NodeId a, NodeId b) const override;

 private:
  const TaskNetwork& network_;
};

/// Nodes further apart are not examined.
inline constexpr std::uint32_t kAheadWithin = 1024;

/// Whether something remains of the node that no later node takes back: it is irreversible, or changes facts
/// or units of resources.
[[nodiscard]] bool acts(const TaskNetwork& network, NodeId node);

/// All pairs that the order permits, by `acts`, then `fails`. A strict node is in none. Time is linear in the
/// nodes times the dependencies of kAheadWithin nodes.
[[nodiscard]] std::vector<ActsAhead> acts_ahead(const TaskNetwork& network, const Order& order,
                                                const Paths& paths);
/// Only those in which one of these nodes acts, which are in program order.
[[nodiscard]] std::vector<ActsAhead> acts_ahead(const TaskNetwork& network, const Order& order,
                                                const Paths& paths, std::span<const NodeId> nodes);

/// All pairs that the order permits, by `senses`, then `acts`: of sensing nodes and irreversible ones, which
/// do not lie in parallel. Takes time like acts_ahead().
[[nodiscard]] std::vector<SensesAhead> senses_ahead(const TaskNetwork& network, const Order& order,
                                                    const Paths& paths);

/// Each pair of names once, in the order of the first nodes that act.
[[nodiscard]] std::vector<NamedActsAhead> by_name(const TaskNetwork& network,
                                                  const std::vector<ActsAhead>& pairs);
[[nodiscard]] std::vector<NamedSensesAhead> by_name(const TaskNetwork& network,
                                                    const std::vector<SensesAhead>& pairs);

}  // namespace segue::task_network
