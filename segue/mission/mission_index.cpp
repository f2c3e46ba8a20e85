// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission_index.hpp>

#include <algorithm>

namespace segue::mission {

namespace {

std::uint64_t hash(StateIndex parent, std::string_view id) {
  const std::uint64_t mixed =
      std::hash<std::string_view>{}(id) ^ (std::uint64_t{parent} * 0x9e3779b97f4a7c15ULL);
  return mixed ^ (mixed >> 32);
}

}  // namespace

MissionIndex::MissionIndex(const Mission& mission) : mission_(mission) {
  actions_.reserve(mission.actions.size());
  for (const Action& action : mission.actions)
    actions_.try_emplace(action.name.str(), &action);
  for (const Library& library : mission.libraries)
    libraries_.try_emplace(library.name, &library);
  enter_children();
  resolve();
}

/// The position at which a child is, or would be inserted.
std::size_t MissionIndex::place_of(StateIndex parent, std::string_view id, std::uint32_t tag,
                                   std::size_t place) const {
  const std::size_t mask = children_.size() - 1;
  for (place &= mask; children_[place].state != kNoState; place = (place + 1) & mask) {
    if (children_[place].tag != tag) continue;
    const State& state = mission_.states[children_[place].state];
    if (state.parent == parent && state.id.str() == id) break;
  }
  return place;
}

void MissionIndex::enter_children() {
  std::size_t capacity = 16;
  while (capacity < 2 * mission_.states.size())
    capacity *= 2;
  children_.resize(capacity);
  positions_.resize(mission_.states.size());
  for (StateIndex parent = 0; parent < mission_.states.size(); ++parent) {
    std::uint32_t position = 0;
    for (const StateIndex child : mission_.states[parent].children) {
      positions_[child] = position++;
      const std::string& id = mission_.states[child].id.str();
      const std::uint64_t key = hash(parent, id);
      const auto tag = static_cast<std::uint32_t>(key >> 32);
      Slot& slot = children_[place_of(parent, id, tag, key)];
      if (slot.state == kNoState)
        slot = {tag, child};
      else
        duplicates_.push_back(child);
    }
  }
}

void MissionIndex::resolve() {
  const std::size_t count = mission_.states.size();
  actions_of_.reserve(count);
  first_target_.reserve(count);
  first_flow_.reserve(count);
  targets_.reserve(count);
  for (StateIndex i = 0; i < count; ++i) {
    const State& state = mission_.states[i];
    actions_of_.push_back(is_leaf(state.kind) ? action(state.action) : nullptr);
    first_target_.push_back(static_cast<std::uint32_t>(targets_.size()));
    for (const StateTransition& transition : state.transitions)
      targets_.push_back(transition.to.leaves() ? kNoState : child(state.parent, transition.to.state));
    first_flow_.push_back(static_cast<std::uint32_t>(flows_.size()));
    const auto touched = [&](const FlowPort& ref) {
      return ref.owner == Owner::Child ? child(i, ref.state) : kNoState;
    };
    for (const DataFlow& flow : state.flows)
      flows_.push_back({touched(flow.from), touched(flow.to)});
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
  const std::uint64_t key = hash(parent, id.str());
  return children_[place_of(parent, id.str(), static_cast<std::uint32_t>(key >> 32), key)].state;
}

std::optional<Interface> MissionIndex::interface(StateIndex index) const {
  // A library may consist of the use of another one. No chain without a cycle has more steps than there are
  // libraries.
  for (std::size_t steps = 0; steps <= mission_.libraries.size(); ++steps) {
    const State& state = mission_.states[index];
    if (is_container(state.kind)) return Interface{&state.inputs, &state.outputs, &state.outcomes};
    if (state.kind != StateKind::Library) {
      const Action* found = actions_of_[index];
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
