// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/world_flow.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

void WorldFlow::Values::make(const Change& change, PathConditions& paths) {
  values.write(change.slot, change.when, change.value, paths);
  Symbol by;
  by.candidates.push_back(change.by);
  changed_by.write(change.slot, change.when, std::move(by), paths);
}

WorldFlow::WorldFlow(const mission::Mission& mission)
    : now_{Slots(mission.world_data.size()), Slots(mission.world_data.size())} {
  for (auto& [name, value] : mission::initial_values(mission)) {
    slots_.emplace(name, static_cast<std::uint32_t>(initial_.size()));
    initial_.push_back(with({}, {value}));
  }
}

Symbol WorldFlow::value(std::string_view name, BranchEdge at, PathConditions& paths) const {
  const auto slot = slots_.find(name);
  if (slot == slots_.end()) return {};
  Symbol value = now_.values.read(slot->second, at, paths);
  if (!value.rest) value.rest = initial_[slot->second];
  return value;
}

Symbol WorldFlow::changed_by(std::string_view name, BranchEdge at, PathConditions& paths) const {
  const auto slot = slots_.find(name);
  return slot == slots_.end() ? Symbol() : now_.changed_by.read(slot->second, at, paths);
}

void WorldFlow::change(std::string_view name, BranchEdge when, Symbol value, task_network::NodeId by,
                       std::uint32_t end, PathConditions& paths) {
  const auto slot = slots_.find(name);
  if (slot == slots_.end()) return;
  Change change{slot->second, when, std::move(value), {by, end, when, {}}};
  now_.make(change, paths);
  if (before_) changes_.push_back(std::move(change));
}

void WorldFlow::may_forget() {
  if (!before_ && !slots_.empty()) before_ = now_;
}

void WorldFlow::forget(const std::vector<task_network::NodeId>& lost, PathConditions& paths) {
  const auto is_lost = [&](const Change& change) {
    return std::ranges::find(lost, change.by.node) != lost.end();
  };
  if (std::erase_if(changes_, is_lost) == 0) return;
  now_ = *before_;
  for (const Change& change : changes_)
    now_.make(change, paths);
}

void WorldFlow::keep() {
  before_.reset();
  changes_.clear();
}

}  // namespace segue::convert
