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

/// The ports and outcomes of a state, wherever they are declared. Points into the mission.
struct Interface {
  const std::vector<Port>* inputs = nullptr;
  const std::vector<Port>* outputs = nullptr;
  const std::vector<std::string>* outcomes = nullptr;
};

/// The states whose ports a data flow connects; kNoState for the container itself, or if there is none.
struct FlowStates {
  StateIndex from = kNoState;
  StateIndex to = kNoState;
};

/// Looks up what names refer to; references between states are resolved once, by the constructor. Valid as
/// long as the mission exists and is not changed. May be read by several threads.
class MissionIndex {
 public:
  explicit MissionIndex(const Mission& mission);

  [[nodiscard]] const Mission& mission() const { return mission_; }
  /// nullptr or kNoState if there is none; the first of several with one name.
  [[nodiscard]] const Action* action(const ActionName& name) const;
  [[nodiscard]] const Library* library(std::string_view name) const;
  [[nodiscard]] StateIndex child(StateIndex parent, const StateId& id) const;
  /// The action of a leaf; nullptr if there is none.
  [[nodiscard]] const Action* action_of(StateIndex leaf) const { return actions_of_[leaf]; }
  /// Its position among the children of its parent.
  [[nodiscard]] std::uint32_t position(StateIndex state) const { return positions_[state]; }
  /// The sibling that a transition leads to; kNoState if it leaves the parent, or there is no such sibling.
  [[nodiscard]] StateIndex target(StateIndex state, std::size_t transition) const {
    return targets_[first_target_[state] + transition];
  }
  [[nodiscard]] FlowStates flow(StateIndex container, std::size_t flow) const {
    return flows_[first_flow_[container] + flow];
  }
  /// States whose id an earlier sibling has already.
  [[nodiscard]] const std::vector<StateIndex>& duplicates() const { return duplicates_; }
  /// Nothing if the state's action or library is missing, or if its libraries only use each other in a cycle.
  [[nodiscard]] std::optional<Interface> interface(StateIndex state) const;

 private:
  /// An entry of an open hash table; its key is in the mission.
  struct Slot {
    std::uint32_t tag = 0;
    StateIndex state = kNoState;
  };
  /// The position at which a child is, or would be inserted; the search begins at `place`.
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

/// The position of the port of that name; nothing if there is none.
std::optional<std::size_t> position(const std::vector<Port>& ports, std::string_view name);

}  // namespace segue::mission
