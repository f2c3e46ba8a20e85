// SPDX-License-Identifier: Apache-2.0
#include <segue/base/robot_name.hpp>

#include <segue/base/mutex.hpp>

#include <utility>

namespace segue {

namespace {

struct RobotName {
  Mutex mutex;
  std::string name SEGUE_GUARDED_BY(mutex);
};

RobotName& robot_name() {
  static RobotName name;
  return name;
}

}  // namespace

std::string robot_of_process() {
  RobotName& own = robot_name();
  const Lock lock(own.mutex);
  return own.name;
}

void set_robot_of_process(std::string name) {
  RobotName& own = robot_name();
  const Lock lock(own.mutex);
  own.name = std::move(name);
}

}  // namespace segue
