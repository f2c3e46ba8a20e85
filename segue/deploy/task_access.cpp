// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/task_access.hpp>

#include <utility>

namespace segue::deploy {

std::vector<Result<void>> TaskAccess::perform(std::span<const model::Action> actions, TimePoint deadline) {
  return task_host::wait_for_outcomes(actions.size(), [&](task_host::Completion completed) {
    begin_all({actions.begin(), actions.end()}, deadline, std::move(completed));
  });
}

}  // namespace segue::deploy
