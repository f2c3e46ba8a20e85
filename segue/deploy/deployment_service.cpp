// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/deployment_service.hpp>
#include <segue/host/batch_outcomes.hpp>

#include <memory>
#include <utility>

namespace segue::deploy {

std::vector<Result<void>> DeploymentService::perform(std::span<const model::Action> actions,
                                                     TimePoint deadline) {
  std::vector<Result<void>> outcomes(actions.size());
  // Shared, since the waiter may be gone before the last call of it has returned.
  const auto told =
      std::make_shared<host::BatchOutcomes>(actions.size(), [&outcomes](std::vector<host::Completed> ended) {
        for (auto& one : ended) {
          outcomes[one.index] = std::move(one.outcome);
        }
      });
  if (!actions.empty()) {
    begin_all({actions.begin(), actions.end()}, deadline,
              [told](std::vector<host::Completed> ended) { told->add(std::move(ended)); });
  }
  told->wait();
  return outcomes;
}

}  // namespace segue::deploy
