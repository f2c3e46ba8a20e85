// SPDX-License-Identifier: Apache-2.0
#include <segue/web/robot_link.hpp>

#include <utility>

namespace segue::web {

RobotLink::RobotLink(Connect connect, Duration pause) : connect_(std::move(connect)), pause_(pause) {}

Result<RobotLink::Connected> RobotLink::get() {
  const Lock lock(mutex_);
  if (connected_.robot) return connected_;
  const TimePoint now = monotonic_now();
  if (now < next_try_) return last_error_;
  auto robot = connect_();
  if (!robot) {
    last_error_ = robot.error();
    next_try_ = monotonic_now() + pause_;
    return last_error_;
  }
  connected_ = {std::move(*robot), ++generations_};
  return connected_;
}

void RobotLink::failed(std::uint64_t generation, const Error& error) {
  if (error.code != ErrorCode::Unavailable) return;
  const Lock lock(mutex_);
  if (connected_.generation == generation) connected_ = {};
}

}  // namespace segue::web
