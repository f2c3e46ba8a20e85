// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/symbol.hpp>
#include <segue/mission/program.hpp>
#include <segue/task_network/task_network.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::convert {

/// The names of values that actions in a state see or change, and of those that they change, sorted.
struct TouchedValues {
  std::vector<std::string> all;
  std::vector<std::string> changed;
};
[[nodiscard]] TouchedValues values_within(const mission::Program& program, mission::StateIndex state);

/// The values of the world (mission/world_values.hpp) at the point up to which a mission is planned, in
/// program order: what they are made of, and which nodes have to happen before they are real. So actions that
/// predict the world begin once the values are known, all others once they are real.
class WorldFlow {
 public:
  explicit WorldFlow(const mission::Mission& mission);

  /// The value seen from `at`, real or predicted.
  [[nodiscard]] Symbol value(std::string_view name, BranchEdge at, PathConditions& paths) const;
  /// The nodes that may have changed it last: once they have ended, it is real.
  [[nodiscard]] Symbol changed_by(std::string_view name, BranchEdge at, PathConditions& paths) const;
  /// From here on it is `value` if `when` is on the path, since `by` changes it, whose output `end` comes
  /// with its end.
  void change(std::string_view name, BranchEdge when, Symbol value, task_network::NodeId by,
              std::uint32_t end, PathConditions& paths);

  /// From here on, nodes may be forgotten: a preemptive container has been entered.
  void may_forget();
  /// The changes of these nodes have not happened, since they have lost a race.
  void forget(const std::vector<task_network::NodeId>& lost, PathConditions& paths);
  /// All races are decided.
  void keep();

 private:
  struct Change {
    std::uint32_t slot = 0;
    BranchEdge when;
    Symbol value;
    Candidate by;
  };
  struct Values {
    Slots values;
    Slots changed_by;
    void make(const Change& change, PathConditions& paths);
  };

  std::map<std::string, std::uint32_t, std::less<>> slots_;
  std::vector<Defaults> initial_;
  Values now_;
  std::optional<Values> before_;  ///< the changes that may be forgotten
  std::vector<Change> changes_;
};

}  // namespace segue::convert
