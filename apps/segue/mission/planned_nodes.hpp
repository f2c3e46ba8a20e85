// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/diagram.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace segue::cli {

/// The nodes of a plan, which of them have begun and ended, and hence which wait for which. One thread at a
/// time.
class PlannedNodes {
 public:
  /// An empty diagram where nothing is known in advance.
  explicit PlannedNodes(draw::Diagram plan);

  /// `name` is the node's name, with its iteration where that is not the first ("dig#2").
  void began(const std::string& name);
  void ended(const std::string& name, const std::string& outcome);

  struct Waiting {
    std::string node;
    std::vector<std::string> waits_for;  ///< the first few nodes that have not ended
  };
  /// Nodes that have not begun, in program order, the first `most`: those that wait for others. Nodes on ways
  /// that are not taken, as far as that is known by now, are left out. Linear in the plan.
  [[nodiscard]] std::vector<Waiting> waiting(std::size_t most) const;
  /// Nodes on ways that are not taken, so that their runs that began ahead of time are discarded. Linear in
  /// the plan.
  [[nodiscard]] std::vector<std::string> off_path() const;

 private:
  enum class State : std::uint8_t { Planned, Running, Ended };
  struct View {
    bool off = false;
    std::vector<std::uint32_t> blockers;  ///< nodes, few
  };
  [[nodiscard]] std::vector<View> views() const;
  void consider(const draw::Diagram::Dependency& dependency, std::vector<View>& views, View& own,
                bool any_way) const;
  [[nodiscard]] static bool is_action(draw::Diagram::Role role);

  draw::Diagram plan_;
  std::unordered_map<std::string, std::uint32_t> by_name_;
  std::vector<State> states_;
  std::vector<std::string> outcomes_;
};

}  // namespace segue::cli
