// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/path_conditions.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace segue::convert {

/// The replacement of a null: a constant, or the output "value" of a node that reads a global variable.
struct Default {
  type::Value value;
  task_network::NodeId reader{task_network::kNone};
};
/// Tried in their order until one is not null. Null pointer: there are none.
using Defaults = std::shared_ptr<const std::vector<Default>>;
/// `defaults` with one more at the end, unless an earlier constant can never be null.
Defaults with(const Defaults& defaults, Default more);

/// An output of a node that may be the value, with the defaults for a null.
struct Candidate {
  task_network::NodeId node{};
  std::uint32_t output = 0;  ///< of TaskNetwork::names
  BranchEdge when;
  Defaults defaults;
  std::uint64_t turn = 0;  ///< of the write, by which those to several slots are ordered
};

/// A value that is known when the plan runs: that of the last candidate in program order that has run, or
/// else `rest`.
struct Symbol {
  std::vector<Candidate> candidates;
  Defaults rest;
  std::uint64_t rest_turn = 0;
  /// Whether nothing may have been written.
  [[nodiscard]] bool empty() const { return candidates.empty() && !rest; }
};

/// The ports and variables of a container at a point of the plan: for each slot, the nodes that may have
/// written it last.
class Slots {
 public:
  explicit Slots(std::size_t count) : slots_(count) {}

  /// Writes to the slot: from here on it holds `value` if `when` is on the path. All candidates of `value`
  /// lie on `when`.
  void write(std::uint32_t slot, BranchEdge when, Symbol value, PathConditions& paths);
  /// The value that was written last to the slot, seen from `at`. If nothing may have been written, `rest` is
  /// null.
  [[nodiscard]] Symbol read(std::uint32_t slot, BranchEdge at, PathConditions& paths) const;

 private:
  struct Write {
    std::uint64_t turn = 0;
    BranchEdge when;
    Symbol value;
  };
  struct Reader {
    BranchEdge at;
    PathConditions& paths;
    Symbol result;  ///< the newest candidate first
    bool take(const Write& write);
  };
  std::vector<std::vector<Write>> slots_;
  std::uint64_t turn_ = 0;
};

}  // namespace segue::convert
