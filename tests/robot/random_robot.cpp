// SPDX-License-Identifier: Apache-2.0
#include "random_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace segue::testing {

namespace {

constexpr int kTasks = 6;

std::string task_name(int number) {
  return "t" + std::to_string(number);
}

model::Network random_controller(Random& random, std::size_t number) {
  model::Network network;
  network.name = model::NetworkName("c" + std::to_string(number));
  std::set<int> tasks;
  for (int count = 1 + up_to(random, 3); count > 0; --count)
    tasks.insert(up_to(random, kTasks - 1));
  for (const int one : tasks) {
    model::Task task;
    task.id = model::TaskId(task_name(one));
    task.component = model::ComponentName("test::Part");
    task.properties = type::Value::map({{"gain", one_in(random, 6) ? 2 : 1}});
    network.tasks.push_back(std::move(task));
  }
  for (const int from : tasks) {
    for (const int to : tasks) {
      if (from == to || !one_in(random, 3)) continue;
      model::Connection connection;
      connection.from = {model::TaskId(task_name(from)), "out"};
      connection.to = {model::TaskId(task_name(to)), "in"};
      const bool is_taken = std::ranges::any_of(
          network.connections, [&](const model::Connection& other) { return other.to == connection.to; });
      if (!is_taken) network.connections.push_back(std::move(connection));
    }
  }
  return network;
}

}  // namespace

std::vector<model::Network> random_controllers(Random& random) {
  std::vector<model::Network> controllers;
  for (std::size_t count = 2 + static_cast<std::size_t>(up_to(random, 3)); controllers.size() < count;)
    controllers.push_back(random_controller(random, controllers.size()));
  return controllers;
}

model::Network united(const std::vector<model::Network>& controllers, const std::set<std::string>& names) {
  model::Network all;
  for (const model::Network& one : controllers) {
    if (!names.contains(one.name.str())) continue;
    for (const model::Task& task : one.tasks) {
      if (all.find_task(task.id) == nullptr) all.tasks.push_back(task);
    }
    for (const model::Connection& connection : one.connections) {
      if (std::ranges::find(all.connections, connection) == all.connections.end())
        all.connections.push_back(connection);
    }
  }
  return all;
}

namespace {

/// Writes a mission state by state.
class MissionText {
 public:
  MissionText(Random& random, std::size_t controllers) : random_(random), controllers_(controllers) {}

  RobotMission write() {
    mission_.is_a_sequence = true;
    const int steps = 1 + up_to(random_, 3);
    std::string states;
    for (int i = 0; i < steps; ++i) {
      const std::string next = i + 1 < steps ? "step" + std::to_string(i + 1) : std::string("return done");
      states += one_in(random_, 3) ? side_by_side(i, next)
                                   : "  " + action("step" + std::to_string(i), next, next) + "\n";
    }
    mission_.text =
        "mission: random\nactions:\n" + actions_ +
        "  judge: {run: {decide: [{outcome: success}]}}\noutcomes: [done]\nstart: step0\nstates:\n" + states;
    return std::move(mission_);
  }

 private:
  /// A state with an action of its own.
  std::string action(const std::string& state, const std::string& done, const std::string& aborted) {
    const RobotMission::Action one{"c" + std::to_string(up_to(random_, static_cast<int>(controllers_) - 1)),
                                   one_in(random_, 3)};
    const std::string name = "a" + std::to_string(mission_.actions.size());
    actions_ += fmt::format(
        "  {}: {{outcomes: [done], run: {{controller: {}, afterwards: {}, until: [{{after: {}ms, outcome: "
        "done}}]}}}}\n",
        name, one.controller, one.stop ? "stop" : "keep", 1 + up_to(random_, 4));
    mission_.actions.push_back(one);
    return fmt::format("{}: {{action: {}, on: {{done: {}, aborted: {}}}}}", state, name, done, aborted);
  }

  std::string side_by_side(int number, const std::string& next) {
    mission_.is_a_sequence = false;
    std::string text =
        fmt::format("  step{}:\n    kind: barrier\n    on: {{success: {}}}\n    states:\n", number, next);
    for (int branch = 1 + up_to(random_, 2); branch >= 0; --branch) {
      text += fmt::format("      branch{}:\n        start: first\n        states:\n", branch);
      text += "          " + action("first", "second", "second") + "\n";
      text += "          " + action("second", "return success", "return success") + "\n";
    }
    return text + "      judge: {kind: decider, on: {success: return success}}\n";
  }

  Random& random_;
  const std::size_t controllers_;
  std::string actions_;
  RobotMission mission_;
};

}  // namespace

RobotMission random_robot_mission(Random& random, std::size_t controllers) {
  return MissionText(random, controllers).write();
}

}  // namespace segue::testing
