// SPDX-License-Identifier: Apache-2.0
#include <segue/model/seats.hpp>

namespace segue::model {

std::map<TaskId, DeploymentKey> seats_of(const Network& network) {
  std::map<TaskId, DeploymentKey> seats;
  for (const auto& deployment : network.deployments) {
    for (const auto& seat : deployment.tasks) {
      seats.emplace(seat.task, deployment.key());
    }
  }
  return seats;
}

}  // namespace segue::model
