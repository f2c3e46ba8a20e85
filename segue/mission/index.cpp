// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/index.hpp>

#include <algorithm>

namespace segue::mission {

MissionIndex::MissionIndex(const Mission& mission) : mission_(mission) {
  actions_.reserve(mission.actions.size());
  for (const Action& action : mission.actions)
    actions_.try_emplace(action.name.str(), &action);
  for (const Library& library : mission.libraries)
    libraries_.try_emplace(library.name, &library);
  children_.reserve(mission.states.size());
  for (StateIndex parent = 0; parent < mission.states.size(); ++parent) {
    for (const StateIndex child : mission.states[parent].children)
      children_.try_emplace(Child{parent, mission.states[child].id.str()}, child);
  }
}

const Action* MissionIndex::action(const ActionName& name) const {
  const auto found = actions_.find(name.str());
  return found == actions_.end() ? nullptr : found->second;
}

const Library* MissionIndex::library(std::string_view name) const {
  const auto found = libraries_.find(name);
  return found == libraries_.end() ? nullptr : found->second;
}

StateIndex MissionIndex::child(StateIndex parent, const StateId& id) const {
  const auto found = children_.find(Child{parent, id.str()});
  return found == children_.end() ? kNoState : found->second;
}

std::optional<Interface> MissionIndex::interface(StateIndex index) const {
  // A library may be nothing but a use of another one; as many steps as there are libraries end every chain.
  for (std::size_t steps = 0; steps <= mission_.libraries.size(); ++steps) {
    const State& state = mission_.states[index];
    if (is_container(state.kind)) return Interface{&state.inputs, &state.outputs, &state.outcomes};
    if (state.kind != StateKind::Library) {
      const Action* found = action(state.action);
      if (found == nullptr) return std::nullopt;
      return Interface{&found->inputs, &found->outputs, &found->outcomes};
    }
    const Library* used = library(state.library);
    if (used == nullptr) return std::nullopt;
    index = used->root;
  }
  return std::nullopt;
}

std::optional<std::size_t> position(const std::vector<Port>& ports, std::string_view name) {
  const auto found = std::ranges::find(ports, name, &Port::name);
  if (found == ports.end()) return std::nullopt;
  return static_cast<std::size_t>(found - ports.begin());
}

}  // namespace segue::mission
