// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::mission {

/// What a state shows to its surroundings, wherever that is declared. Points into the mission.
struct Interface {
  const std::vector<Port>* inputs = nullptr;
  const std::vector<Port>* outputs = nullptr;
  const std::vector<std::string>* outcomes = nullptr;
};

/// The states whose ports a data flow touches; kNoState where it is the container itself, or there is none.
struct FlowStates {
  StateIndex from = kNoState;
  StateIndex to = kNoState;
};

/// Finds by name, each reference between states once for all who ask. Valid as long as the mission lives
/// unchanged; reading from several threads is fine.
class MissionIndex {
 public:
  explicit MissionIndex(const Mission& mission);

  [[nodiscard]] const Mission& mission() const { return mission_; }
  /// nullptr or kNoState where there is none; of two with the same name the first.
  [[nodiscard]] const Action* action(const ActionName& name) const;
  [[nodiscard]] const Library* library(std::string_view name) const;
  [[nodiscard]] StateIndex child(StateIndex parent, const StateId& id) const;
  /// The action of a leaf; nullptr where there is none.
  [[nodiscard]] const Action* action_of(StateIndex leaf) const { return actions_of_[leaf]; }
  /// Its place among the children of its parent.
  [[nodiscard]] std::uint32_t position(StateIndex state) const { return positions_[state]; }
  /// The sibling that a transition leads to; kNoState where it leaves, or there is none.
  [[nodiscard]] StateIndex target(StateIndex state, std::size_t transition) const {
    return targets_[first_target_[state] + transition];
  }
  [[nodiscard]] FlowStates flow(StateIndex container, std::size_t flow) const {
    return flows_[first_flow_[container] + flow];
  }
  /// States that are called as one before them beside them.
  [[nodiscard]] const std::vector<StateIndex>& duplicates() const { return duplicates_; }
  /// Nothing where the state's action or library is not there, or libraries only use each other in a circle.
  [[nodiscard]] std::optional<Interface> interface(StateIndex state) const;

 private:
  /// A place of an open hash table, whose key is in the mission.
  struct Slot {
    std::uint32_t tag = 0;
    StateIndex state = kNoState;
  };
  /// Where a child is, or would be entered, looking from `place` on.
  [[nodiscard]] std::size_t place_of(StateIndex parent, std::string_view id, std::uint32_t tag,
                                     std::size_t place) const;
  void enter_children();
  void resolve();

  const Mission& mission_;
  std::unordered_map<std::string_view, const Action*> actions_;
  std::unordered_map<std::string_view, const Library*> libraries_;
  std::vector<Slot> children_;
  std::vector<const Action*> actions_of_;
  std::vector<std::uint32_t> positions_;
  std::vector<std::uint32_t> first_target_;
  std::vector<StateIndex> targets_;
  std::vector<std::uint32_t> first_flow_;
  std::vector<FlowStates> flows_;
  std::vector<StateIndex> duplicates_;
};

/// The position of the port of that name; nothing where there is none.
std::optional<std::size_t> position(const std::vector<Port>& ports, std::string_view name);

}  // namespace segue::mission
