// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/program.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission {

/// The states that use units whose number changes: those of resources of which some action creates, consumes
/// or deletes units, or which some container blocks. States of a barrier take these in program order, in
/// sequential runs and concurrently, so that no race decides which of them gets too few. For one thread.
class SharedUnits {
 public:
  /// `program` must outlive this.
  explicit SharedUnits(const Program& program);

  /// Whether the leaf or container may use such units itself.
  [[nodiscard]] bool takes_in_order(StateIndex user) const { return !used_by(user).empty(); }
  /// Whether something in the state may use such units of a resource that the user may use as well. Names
  /// that contain inputs may stand for any resource that fits. The first call for two is linear in the states
  /// within.
  [[nodiscard]] bool shared(StateIndex state, StateIndex user);
  /// Whether a state that can follow this one in its hierarchy may use such units of a resource that the user
  /// may use as well.
  [[nodiscard]] bool shared_after(StateIndex state, StateIndex user);

 private:
  using Patterns = std::vector<std::string>;
  [[nodiscard]] const Patterns& used_by(StateIndex state) const;
  [[nodiscard]] StateIndex alike(StateIndex user) const;
  [[nodiscard]] bool has_user(StateIndex state, const Patterns& resources) const;

  const Program& program_;
  std::vector<Patterns> by_action_;              ///< of the resources that it uses
  std::map<StateIndex, Patterns> by_container_;  ///< of the resources that it uses
  std::vector<StateIndex> first_user_;           ///< by action: the first state that has it
  using Known = std::map<std::pair<StateIndex, StateIndex>, bool>;
  Known known_;
  Known known_after_;
};

}  // namespace segue::mission
