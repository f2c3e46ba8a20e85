// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/robot_loss.hpp>

namespace segue::distributed::detail {

void RobotLoss::note(const model::HostName& host, const Error& error) {
  if (error.code != ErrorCode::Superseded) {
    return;
  }
  const Error why =
      fail(ErrorCode::Superseded, "another runtime has got the robot", host.str()).because_of(error);
  {
    const Lock lock(mutex_);
    if (why_) {
      return;
    }
    why_ = why;
  }
  lost_(why);
}

std::optional<Error> RobotLoss::why() const {
  const Lock lock(mutex_);
  return why_;
}

}  // namespace segue::distributed::detail
