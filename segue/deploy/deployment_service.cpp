// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/deployment_service.hpp>

#include <utility>

namespace segue::deploy {

std::vector<Result<void>> DeploymentService::perform(std::span<const model::Action> actions,
                                                     TimePoint deadline) {
  return host::wait_for_outcomes(actions.size(), [&](host::Completion completed) {
    begin_all({actions.begin(), actions.end()}, deadline, std::move(completed));
  });
}

}  // namespace segue::deploy
