// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

/// Random networks for property tests, structurally valid and with every feature of files. All functions
/// depend only on the given generator, so a seed reproduces a case: `RC_GTEST_PROP(..., (std::uint64_t seed))
/// { std::mt19937_64 random(seed); auto n = random_network(random);
/// }`
namespace segue::testing {

using Random = std::mt19937_64;

/// Limits and features of a random network.
struct NetworkShape {
  int tasks = 8;              ///< how many tasks, at most
  int processes = 3;          ///< how many deployments, at most; some tasks stay in the runtime's process
  int connections = 12;       ///< how many connections, at most
  int components = 4;         ///< names of components: demo::C0 ...
  int ports = 3;              ///< out0 ..., in0 ...
  bool target_states = true;  ///< also PreOperational and Stopped
  bool error_states = false;  ///< also RunTimeError, Exception and Fatal (beliefs)
  bool properties = true;     ///< properties and sections
  bool awkward_text = false;  ///< texts that are hard to quote, extreme numbers
  bool attributes = true;     ///< activities, devices, takes_over, attributes of processes
  bool policies = true;       ///< other than plain data
  bool foreign_placements = false;  ///< deployments may name tasks that the network lacks
};

/// From 0 to `most`.
inline int up_to(Random& random, int most) {
  return most <= 0 ? 0 : static_cast<int>(random() % (static_cast<std::uint64_t>(most) + 1));
}
inline bool one_in(Random& random, int chances) {
  return up_to(random, chances - 1) == 0;
}
template <class Items>
const auto& any_of(Random& random, const Items& items) {
  return items[static_cast<std::size_t>(up_to(random, static_cast<int>(std::size(items)) - 1))];
}

inline std::string random_text(Random& random, bool awkward) {
  static constexpr std::array<std::string_view, 5> kPlain = {"left", "right", "map", "/dev/ttyS0",
                                                             "odometry"};
  static constexpr std::array<std::string_view, 24> kAwkward = {"",
                                                                " lead",
                                                                "trail ",
                                                                "true",
                                                                "null",
                                                                "~",
                                                                "1.10",
                                                                "0x1F",
                                                                "- a",
                                                                "a: b",
                                                                "#no",
                                                                "x #y",
                                                                "'",
                                                                "\"",
                                                                "two\nlines",
                                                                "tab\there",
                                                                "{a: b",
                                                                "[",
                                                                "\xc3\xa4\xe2\x82\xac",
                                                                "\\n\\",
                                                                "100ms",
                                                                "%percent",
                                                                "@at",
                                                                "&anchor *alias !tag"};
  return std::string(awkward ? any_of(random, kAwkward) : any_of(random, kPlain));
}

inline type::Value random_value(Random& random, bool awkward, int depth = 2) {
  static constexpr std::array<double, 8> kNumbers = {
      0.1, -0.0, 1e300, 5e-324, 123456.789, std::numeric_limits<double>::infinity(), 3.0, -2.5};
  switch (up_to(random, depth > 0 ? 7 : 5)) {
    case 0:
      return one_in(random, 2);
    case 1:
      return up_to(random, 1000) - 500;
    case 2:
      return awkward ? type::Value(any_of(random, kNumbers)) : type::Value(up_to(random, 100) / 8.0);
    case 3:
      return awkward ? type::Value(random()) : type::Value(up_to(random, 9));
    case 4:
      return random_text(random, awkward);
    case 5:
      return awkward ? type::Value() : type::Value("default");
    case 6: {
      type::Value::List list;
      for (int i = up_to(random, 3); i > 0; --i)
        list.push_back(random_value(random, awkward, depth - 1));
      return list;
    }
    default: {
      type::ValueMap map;
      for (int i = up_to(random, 3); i > 0; --i)
        map.set("k" + std::to_string(i), random_value(random, awkward, depth - 1));
      if (awkward && one_in(random, 3)) map.set(random_text(random, true), 1);
      return map;
    }
  }
}

inline std::vector<int> random_cpus(Random& random) {
  std::vector<int> cpus;
  for (int i = up_to(random, 2); i > 0; --i)
    cpus.push_back(up_to(random, 7));
  return cpus;
}

inline Activity random_activity(Random& random) {
  Activity activity;
  activity.trigger = static_cast<Trigger>(up_to(random, 2));
  if (activity.trigger == Trigger::Periodic) activity.period = Duration(1 + up_to(random, 2'000'000'000));
  if (activity.trigger != Trigger::Periodic && one_in(random, 3))
    activity.triggers = {"in", "in" + std::to_string(up_to(random, 2))};
  activity.scheduler = static_cast<Scheduler>(up_to(random, 2));
  if (activity.scheduler != Scheduler::Normal) activity.priority = 1 + up_to(random, 98);
  activity.cpus = random_cpus(random);
  if (one_in(random, 3)) activity.thread = "group" + std::to_string(up_to(random, 2));
  activity.optional = one_in(random, 4);
  if (one_in(random, 4)) activity.update_deadline = Duration(1 + up_to(random, 2'000'000'000));
  const bool is_periodic = activity.trigger == Trigger::Periodic;
  const Duration spin = Duration(1 + up_to(random, 9'999'999));
  if (one_in(random, 4) && !(is_periodic && spin >= activity.period)) activity.spin = spin;
  return activity;
}

inline TaskState random_state(Random& random, const NetworkShape& shape) {
  if (shape.error_states && one_in(random, 4)) return static_cast<TaskState>(3 + up_to(random, 2));
  if (shape.target_states && one_in(random, 3)) return static_cast<TaskState>(up_to(random, 2));
  return TaskState::Running;
}

inline model::Task random_task(Random& random, const NetworkShape& shape, std::string id) {
  model::Task task;
  task.id = model::TaskId(std::move(id));
  task.component = model::ComponentName("demo::C" + std::to_string(up_to(random, shape.components - 1)));
  task.state = random_state(random, shape);
  if (shape.properties) {
    for (int i = up_to(random, 2); i > 0; --i)
      task.properties.as_map().set("p" + std::to_string(i), random_value(random, shape.awkward_text));
    if (one_in(random, 4)) task.config_names = {"default", "fast"};
  }
  if (!shape.attributes) return task;
  if (one_in(random, 3)) task.activity = random_activity(random);
  if (one_in(random, 4)) task.exclusive = {"/dev/" + task.id.str()};
  if (one_in(random, 6)) task.takes_over = model::TaskId("old_" + task.id.str());
  if (one_in(random, 5)) task.on_failure = static_cast<model::FailurePolicy>(up_to(random, 3));
  return task;
}

inline model::ResourceLimits random_limits(Random& random) {
  model::ResourceLimits limits;
  const auto size = [&random] {
    const auto number = static_cast<std::uint64_t>(up_to(random, 999));
    return one_in(random, 2) ? number * 1'000'000 : number * 4096 + 1;
  };
  if (one_in(random, 2)) limits.memory = (std::uint64_t{16} << 20) + size();
  if (one_in(random, 3)) limits.open_files = 64 + static_cast<std::uint64_t>(up_to(random, 4000));
  if (one_in(random, 3)) limits.cpu_time = std::chrono::seconds(1 + up_to(random, 9999));
  if (one_in(random, 3)) limits.core = one_in(random, 2) ? 0 : size();
  return limits;
}

inline model::Deployment random_deployment(Random& random, const NetworkShape& shape, int number) {
  model::Deployment deployment;
  // Few names, so that the same process occurs in related networks and on several hosts.
  deployment.process = model::ProcessName("process" + std::to_string(number));
  if (!shape.attributes) return deployment;
  if (one_in(random, 3)) deployment.host = model::HostName("base");
  if (one_in(random, 4)) deployment.deployer = "orogen";
  if (one_in(random, 4)) {
    deployment.scheduler = Scheduler::Fifo;
    deployment.priority = 1 + up_to(random, 98);
  }
  deployment.cpus = random_cpus(random);
  deployment.optional = one_in(random, 5);
  if (one_in(random, 4)) deployment.limits = random_limits(random);
  if (one_in(random, 5)) deployment.on_failure = static_cast<model::FailurePolicy>(up_to(random, 3));
  if (one_in(random, 4)) deployment.environment.emplace_back("KEY", random_text(random, shape.awkward_text));
  return deployment;
}

inline Policy random_policy(Random& random) {
  Policy policy;
  policy.kind = static_cast<BufferKind>(up_to(random, 2));
  if (policy.kind != BufferKind::Data) policy.size = static_cast<std::size_t>(1 + up_to(random, 99));
  policy.init = policy.kind == BufferKind::Data && one_in(random, 3);
  policy.transport = static_cast<Transport>(up_to(random, 3));
  return policy;
}

/// Puts most tasks into the deployments, each at most once.
inline void place_tasks(Random& random, const NetworkShape& shape, model::Network& network) {
  for (model::Deployment& deployment : network.deployments)
    deployment.tasks.clear();
  if (network.deployments.empty()) return;
  for (const model::Task& task : network.tasks) {
    if (one_in(random, 5)) continue;
    auto& placements = network
                           .deployments[static_cast<std::size_t>(
                               up_to(random, static_cast<int>(network.deployments.size()) - 1))]
                           .tasks;
    placements.push_back({task.id, one_in(random, 6) ? "name_of_" + task.id.str() : task.id.str()});
  }
  if (shape.foreign_placements && one_in(random, 2)) {
    network.deployments.front().tasks.push_back({model::TaskId("absent"), "absent"});
  }
}

/// Connections between tasks of the network, no two of the same ports.
inline void add_connections(Random& random, const NetworkShape& shape, model::Network& network) {
  if (network.tasks.empty()) return;
  std::unordered_set<std::string> taken;
  for (const model::Connection& connection : network.connections)
    taken.insert(to_string(connection.from) + to_string(connection.to));
  while (static_cast<int>(network.connections.size()) < shape.connections) {
    model::Connection connection;
    connection.from = {any_of(random, network.tasks).id,
                       "out" + std::to_string(up_to(random, shape.ports - 1))};
    connection.to = {any_of(random, network.tasks).id, "in" + std::to_string(up_to(random, shape.ports - 1))};
    if (shape.policies && one_in(random, 2)) connection.policy = random_policy(random);
    if (taken.insert(to_string(connection.from) + to_string(connection.to)).second) {
      network.connections.push_back(std::move(connection));
    }
    if (one_in(random, shape.connections)) return;
  }
}

inline model::Network random_network(Random& random, const NetworkShape& shape = {}) {
  model::Network network;
  network.name = model::NetworkName("n" + std::to_string(up_to(random, 9)));
  for (int i = up_to(random, shape.tasks); i > 0; --i)
    network.tasks.push_back(random_task(random, shape, "t" + std::to_string(i)));
  for (int i = up_to(random, shape.processes); i > 0; --i)
    network.deployments.push_back(random_deployment(random, shape, i));
  place_tasks(random, shape, network);
  add_connections(random, shape, network);
  return network;
}

/// A variation of `network`: some tasks removed, added, changed or moved, some connections and processes
/// different.
inline model::Network random_variation(Random& random, model::Network network,
                                       const NetworkShape& shape = {}) {
  network.name = model::NetworkName(network.name.str() + "_varied");
  std::erase_if(network.tasks, [&](const auto&) { return one_in(random, 5); });
  for (model::Task& task : network.tasks) {
    if (one_in(random, 4)) task = random_task(random, shape, task.id.str());
  }
  for (int i = up_to(random, 2); i > 0; --i)
    network.tasks.push_back(random_task(random, shape, "new" + std::to_string(i)));
  for (model::Deployment& deployment : network.deployments) {
    const std::string process = deployment.process.str();
    if (one_in(random, 5)) {
      deployment = random_deployment(random, shape, 0);
      deployment.process = model::ProcessName(process);
    }
  }
  std::erase_if(network.deployments, [&](const auto&) { return one_in(random, 5); });
  std::unordered_set<model::TaskId> left;
  for (const model::Task& task : network.tasks)
    left.insert(task.id);
  for (model::Deployment& deployment : network.deployments)
    std::erase_if(deployment.tasks, [&](const auto& placement) { return !left.contains(placement.task); });
  if (one_in(random, 3)) place_tasks(random, shape, network);
  std::erase_if(network.connections, [&](const model::Connection& connection) {
    return !left.contains(connection.from.task) || !left.contains(connection.to.task) || one_in(random, 4);
  });
  add_connections(random, shape, network);
  return network;
}

}  // namespace segue::testing
