// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/program.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission {

/// Who uses units that come and go: those of resources of which some action creates, consumes or deletes
/// units. States of a barrier take these in program order, in runs as written and concurrently, so that no
/// race decides who goes short. For one thread.
class SharedUnits {
 public:
  /// `program` must outlive this.
  explicit SharedUnits(const Program& program);

  /// Whether the action (by its position) may use such units.
  [[nodiscard]] bool takes_in_order(std::uint32_t action) const { return !varying_[action].empty(); }
  /// Whether an action in the state may use such units of a resource that the action may use as well. Names
  /// that contain inputs may stand for any resource that fits. The first call for two is linear in the states
  /// within.
  [[nodiscard]] bool shared(StateIndex state, std::uint32_t action);
  /// Likewise, whether a state may that can follow this one in its hierarchy.
  [[nodiscard]] bool shared_after(StateIndex state, std::uint32_t action);

 private:
  [[nodiscard]] bool has_user(StateIndex state, const std::vector<std::string>& resources) const;

  const Program& program_;
  std::vector<std::vector<std::string>> varying_;  ///< by action: patterns of the resources that it uses
  using Known = std::map<std::pair<StateIndex, std::uint32_t>, bool>;
  Known known_;
  Known known_after_;
};

}  // namespace segue::mission
