// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/path_conditions.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace segue::convert {

/// What stands for a null: a constant, or the output "value" of a node that reads a global variable.
struct Default {
  type::Value value;
  cdtn::NodeId reader{cdtn::kNone};
};
/// One after the other, until one is not null. Null: none.
using Defaults = std::shared_ptr<const std::vector<Default>>;
/// With one more at the end, unless a constant before it can never be null.
Defaults with(const Defaults& defaults, Default more);

/// An output of a node that may be the value, and what stands for a null there.
struct Candidate {
  cdtn::NodeId node{};
  std::uint32_t output = 0;  ///< of TaskNetwork::names
  BranchEdge when;
  Defaults defaults;
};

/// A value that is known when the plan runs: of the last candidate that has run, in program order; where none
/// has, `rest`.
struct Symbol {
  std::vector<Candidate> candidates;
  Defaults rest;
};

/// Ports and variables that the states of a container exchange, as they are when the plan will have got
/// there: for each slot, who may have written it last.
class Slots {
 public:
  explicit Slots(std::size_t count) : slots_(count) {}

  /// From here on, where `when` is on the path, the slot holds `value`, all of whose candidates lie on
  /// `when`.
  void write(std::uint32_t slot, BranchEdge when, Symbol value, PathConditions& paths);
  /// What was written last to any of the slots, seen from `at`. Where nobody may have written, `rest` is
  /// null.
  [[nodiscard]] Symbol read(const std::vector<std::uint32_t>& slots, BranchEdge at,
                            PathConditions& paths) const;

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
