// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/passed_on.hpp>
#include <segue/mission_script/persistent_variables.hpp>

#include <utility>

namespace segue::convert {

using mission::StateIndex;

PassedOnFlow::PassedOnFlow(std::shared_ptr<const mission::Program> program)
    : program_(std::move(program)), kinds_(program_->mission().actions.size()) {}

PassedOn PassedOnFlow::kind(StateIndex state) {
  const std::size_t number = program_->node(state).action;
  auto& known = kinds_[number];
  if (known) return *known;
  const mission::Action& action = program_->mission().actions[number];
  known = PassedOn::Nothing;
  if (const auto* simulated = std::get_if<mission::Simulated>(&action.run)) {
    if (simulated->outcomes.size() > 1) known = PassedOn::Count;
  } else if (mission::uses_persistent_variables(program_->mission(), action)) {
    known = PassedOn::Memory;
  }
  return *known;
}

Symbol PassedOnFlow::last(StateIndex state, BranchEdge at, PathConditions& paths) {
  const auto found = written_.find(state);
  return found == written_.end() ? Symbol{} : found->second.read(0, at, paths);
}

void PassedOnFlow::write(StateIndex state, BranchEdge when, task_network::NodeId by,
                         task_network::NameTable& names, PathConditions& paths) {
  const PassedOn what = kind(state);
  if (what == PassedOn::Nothing) return;
  Symbol value;
  value.candidates.push_back({by, names.intern(output_of(what)), when, {}});
  written_.try_emplace(state, 1).first->second.write(0, when, std::move(value), paths);
}

}  // namespace segue::convert
