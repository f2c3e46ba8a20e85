// SPDX-License-Identifier: Apache-2.0
#include <segue/model/pools.hpp>

#include <segue/base/text.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/network_index.hpp>

#include <map>
#include <utility>

namespace segue::model {

using type::Value;

TaskId instance_of(const Pool& pool, int number) {
  return TaskId(pool.name + "_" + std::to_string(number));
}

Network pool_network(const std::vector<Pool>& pools) {
  Network network;
  for (const Pool& pool : pools) {
    for (int number = 1; number <= pool.size; ++number) {
      const TaskId id = instance_of(pool, number);
      Task& task = network.tasks.emplace_back(pool.task);
      task.id = id;
      Deployment& process = network.deployments.emplace_back(pool.process);
      process.process = ProcessName(id.str());
      process.tasks = {{id, id.str()}};
    }
  }
  return network;
}

namespace detail {

namespace {

Pool read_pool(const std::string& name, const Value& value, const Source& source) {
  Fields fields(value, "pool " + quote(name), source);
  check_name(name, fields.what(), value, source);
  Pool pool;
  pool.name = name;
  pool.where = pool.task.where = pool.process.where = source.at(value);
  pool.size = static_cast<int>(fields.integer("size", 1, kLargestPool, "bad-size").value_or(1));
  read_definition(fields, pool.task, source);
  if (const Value* process = fields.find("process", Value::Kind::Map)) {
    Fields attributes(*process, "'process' of " + fields.what(), source);
    read_process(attributes, pool.process, source);
    attributes.finish();
  }
  fields.finish();
  auto& policy = pool.task.on_failure;
  if (policy == FailurePolicy::Fallback || pool.process.on_failure == FailurePolicy::Fallback) {
    source.error("bad-on-failure",
                 fields.what() +
                     ": no controller depends on it, so the fallback would not help; say "
                     "report, recover or restart",
                 value);
  }
  if (!policy) policy = pool.process.on_failure.value_or(FailurePolicy::Restart);
  if (pool.size > 1 && !pool.task.exclusive.empty()) {
    source.error("exclusive-device",
                 fields.what() + ": its instances cannot all hold " + listed(pool.task.exclusive), value);
  }
  return pool;
}

}  // namespace

std::vector<Pool> read_pools(Fields& robot, const Source& source) {
  std::vector<Pool> pools;
  const Value* map = robot.find("pools", Value::Kind::Map);
  if (map == nullptr) return pools;
  for (const auto& [name, value] : map->as_map())
    pools.push_back(read_pool(name, value, source));
  return pools;
}

void check_pools(const std::vector<Pool>& pools, const Network& controller, Diagnostics& diagnostics) {
  std::map<std::string, const Pool*> taken;
  for (const Pool& pool : pools) {
    for (int number = 1; number <= pool.size; ++number)
      taken.emplace(instance_of(pool, number).str(), &pool);
  }
  const auto check = [&](const std::string& name, std::string_view what, const SourceLocation& where) {
    const auto found = taken.find(name);
    if (found == taken.end()) return;
    diagnostics.error("name-of-pool",
                      std::string(what) + " " + quote(name) + " belongs to the robot's pool " +
                          quote(found->second->name) + "; give it another name",
                      place(where, controller));
  };
  for (const Task& task : controller.tasks)
    check(task.id.str(), "task", task.where);
  for (const Deployment& deployment : controller.deployments)
    check(deployment.process.str(), "process", deployment.where);
}

}  // namespace detail
}  // namespace segue::model
