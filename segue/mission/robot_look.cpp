// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/robot_look.hpp>

namespace segue::mission {

Result<PortFeed> PortFeed::open(CommandedRobot& robot, const Member& port) {
  auto samples = robot.open(port);
  if (!samples) return samples.error();
  return PortFeed{port, std::move(*samples)};
}

Result<void> PortFeed::look() {
  auto came = samples->take();
  if (!came) return came.error();
  fresh = std::move(*came);
  if (!fresh.empty()) last = fresh.back();
  return {};
}

bool is_in(const TaskView& task, const TaskReaches& state) {
  return task.state == state.state || task.state_name == state.state;
}

Result<bool> holds(CommandedRobot& robot, const OperationAnswers& when, TimePoint deadline) {
  const auto answer = robot.call(when.operation, type::ValueMap{}, deadline);
  if (!answer) return answer.error();
  return *answer == when.is;
}

}  // namespace segue::mission
