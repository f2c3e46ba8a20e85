// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/symbol.hpp>
#include <segue/mission/program.hpp>
#include <segue/task_network/name_table.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::convert {

/// Something that an execution of a state passes on to the next one, beside the data flows: how often the
/// state has begun, or the number of the persistent variables that it has left. It is an output of the node,
/// so that executions that run ahead see it too, and are repeated where it was another one.
enum class PassedOn : std::uint8_t { Nothing, Count, Memory };

inline constexpr std::string_view kCountOutput = "#executions";
inline constexpr std::string_view kMemoryOutput = "#persistent variables";
/// The output with it, after which the input of the next execution is named, too.
[[nodiscard]] constexpr std::string_view output_of(PassedOn what) {
  return what == PassedOn::Count ? kCountOutput : kMemoryOutput;
}

/// The nodes that may have passed it on last, at a point of the plan. For one thread.
class PassedOnFlow {
 public:
  explicit PassedOnFlow(std::shared_ptr<const mission::Program> program);
  /// By the state, which is a leaf: of simulated actions with several outcomes, and of scripts that use
  /// persistent variables. Reads the files of scripts.
  [[nodiscard]] PassedOn kind(mission::StateIndex state);
  /// As seen from `at`.
  [[nodiscard]] Symbol last(mission::StateIndex state, BranchEdge at, PathConditions& paths);
  /// The node `by` of that state passes it on, if the state does.
  void write(mission::StateIndex state, BranchEdge when, task_network::NodeId by,
             task_network::NameTable& names, PathConditions& paths);

 private:
  const std::shared_ptr<const mission::Program> program_;
  std::vector<std::optional<PassedOn>> kinds_;  ///< by action
  std::unordered_map<mission::StateIndex, Slots> written_;
};

}  // namespace segue::convert
