// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission.hpp>
#include <segue/mission/state_path.hpp>

#include <algorithm>
#include <variant>

namespace segue::mission {

std::string to_string(const FlowPort& ref) {
  switch (ref.owner) {
    case Owner::Child:
      return ref.state.str() + "." + ref.port;
    case Owner::Inputs:
      return "inputs." + ref.port;
    case Owner::Outputs:
      return "outputs." + ref.port;
    case Owner::Variables:
      break;
  }
  return "variables." + ref.port;
}

StateIndex Mission::add(StateIndex parent, State state) {
  const auto index = static_cast<StateIndex>(states.size());
  state.parent = parent;
  states.push_back(std::move(state));
  if (parent != kNoState) states[parent].children.push_back(index);
  return index;
}

std::string state_path(const std::vector<const std::string*>& ids, std::string around) {
  for (auto id = ids.rbegin(); id != ids.rend(); ++id)
    around += (around.empty() ? "" : "/") + **id;
  return around;
}

std::optional<Action> declared_by(const State& container) {
  if (container.preconditions.empty() && container.resources.empty()) return std::nullopt;
  Action made;
  made.name = ActionName(container.id.str());
  made.inputs = container.inputs;
  made.preconditions = container.preconditions;
  made.resources = container.resources;
  made.where = container.where;
  return made;
}

std::string Mission::path(StateIndex state) const {
  std::vector<const std::string*> ids;
  for (; state != kNoState && states[state].parent != kNoState; state = states[state].parent)
    ids.push_back(&states[state].id.str());
  return state_path(ids);
}

bool has_scripts(const Mission& mission) {
  return !mission.world_data.empty() || std::ranges::any_of(mission.actions, [](const Action& action) {
    return std::holds_alternative<Script>(action.run);
  });
}

}  // namespace segue::mission
