// SPDX-License-Identifier: Apache-2.0
#include <segue/model/pools.hpp>

#include <segue/base/text.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/network_index.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

namespace segue::model {

using type::Value;

TaskId instance_of(const Pool& pool, int number) {
  return TaskId(pool.name + "_" + std::to_string(number));
}

Network pool_network(const std::vector<Pool>& pools) {
  Network network;
  for (const Pool& pool : pools) {
    for (int number = 1; number <= pool.most; ++number) {
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

/// "3"; -1 where it is no such number.
int number_in(std::string_view text) {
  int number = -1;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status == std::errc{} && end == text.data() + text.size() ? number : -1;
}

/// A number, or a range: "1..3".
void read_size(Fields& fields, Pool& pool, const Source& source) {
  constexpr std::string_view kDots = "..";
  if (const Value* size = fields.find("size")) {
    const std::string text = scalar_text(*size).value_or("");
    const auto dots = text.find(kDots);
    pool.least = number_in(text.substr(0, dots));
    pool.most = dots == std::string::npos ? pool.least : number_in(text.substr(dots + kDots.size()));
    if (pool.least < 0 || pool.most < std::max(pool.least, 1) || pool.most > kLargestPool) {
      source.error("bad-size",
                   fields.what() + ": 'size' must be a number from 1 to " + std::to_string(kLargestPool) +
                       ", or a range of numbers such as 1..3 or 0..2",
                   *size);
      pool.least = pool.most = 1;
    }
  }
  pool.idle_after = fields.duration("idle_after").value_or(pool.idle_after);
  if (pool.idle_after <= Duration::zero()) {
    source.error("bad-duration", fields.what() + ": 'idle_after' must be longer than nothing",
                 *fields.find("idle_after"));
  }
}

Pool read_pool(const std::string& name, const Value& value, const Source& source) {
  Fields fields(value, "pool " + quote(name), source);
  check_name(name, fields.what(), value, source);
  Pool pool;
  pool.name = name;
  pool.where = pool.task.where = pool.process.where = source.at(value);
  read_size(fields, pool, source);
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
  if (pool.most > 1 && !pool.task.exclusive.empty()) {
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

PoolBudget read_pool_budget(Fields& robot, const Source& source) {
  PoolBudget budget;
  const Value* map = robot.find("pool_budget", Value::Kind::Map);
  if (map == nullptr) return budget;
  Fields fields(*map, "the budget of the pools", source);
  budget.processes =
      static_cast<int>(fields.integer("processes", 0, 10'000, "bad-value").value_or(budget.processes));
  budget.memory = fields.size("memory", "bad-value").value_or(budget.memory);
  fields.finish();
  return budget;
}

void check_pools(const std::vector<Pool>& pools, const Network& controller, Diagnostics& diagnostics) {
  std::map<std::string, const Pool*> taken;
  for (const Pool& pool : pools) {
    for (int number = 1; number <= pool.most; ++number)
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
