// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/state_path.hpp>
#include <segue/mission_engine/history.hpp>

#include <vector>

namespace segue::mission {

std::string History::path(const Program& program, std::uint32_t item) const {
  std::vector<const std::string*> ids;
  for (; item != kNone; item = items_[item].parent) {
    // The root of a library has no path element of its own.
    const StateIndex state = items_[item].state;
    if (program.node(state).parent != kNoState) ids.push_back(&program.state(state).id.str());
  }
  return state_path(ids);
}

}  // namespace segue::mission
