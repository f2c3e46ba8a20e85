// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/robot_changes.hpp>

#include <algorithm>

namespace segue::model {

namespace {

Pool* pool_of(Robot& robot, const std::string& name) {
  const auto found = std::ranges::find(robot.pools, name, &Pool::name);
  return found == robot.pools.end() ? nullptr : &*found;
}

Result<void> set_pool_size(Robot& robot, const std::string& name, int size) {
  Pool* pool = pool_of(robot, name);
  if (pool == nullptr) {
    std::vector<std::string> names;
    for (const Pool& other : robot.pools)
      names.push_back(other.name);
    return fail(ErrorCode::NotFound,
                "robot " + quote(robot.name) + " has no pool " + quote(name) + did_you_mean(name, names));
  }
  if (size < 1 || size > kLargestPool)
    return fail(ErrorCode::InvalidArgument, "a pool has between 1 and " + std::to_string(kLargestPool) +
                                                " instances, not " + std::to_string(size));
  pool->least = pool->most = size;
  return {};
}

Result<void> set_property(Robot& robot, std::vector<Network>& controllers, const std::string& name,
                          const type::Value& value) {
  const auto dot = name.find('.');
  if (dot == std::string::npos)
    return fail(ErrorCode::InvalidArgument, "expected TASK.PROPERTY, got " + quote(name));
  const std::string task = name.substr(0, dot);
  const std::string property = name.substr(dot + 1);
  bool found = false;
  const auto set = [&](Task* in) {
    if (in == nullptr) return;
    in->properties.as_map().set(property, value);
    found = true;
  };
  for (Network& controller : controllers)
    set(controller.find_task(TaskId(task)));
  if (Pool* pool = pool_of(robot, task)) set(&pool->task);
  if (found) return {};
  return fail(ErrorCode::NotFound,
              "no controller of robot " + quote(robot.name) + " has a task " + quote(task));
}

}  // namespace

Result<void> apply(const RobotChanges& changes, Robot& robot, std::vector<Network>& controllers) {
  for (const auto& [pool, size] : changes.pool_sizes) {
    if (auto set = set_pool_size(robot, pool, size); !set) return set;
  }
  for (const auto& [name, value] : changes.properties) {
    if (auto set = set_property(robot, controllers, name, value); !set) return set;
  }
  return {};
}

}  // namespace segue::model
