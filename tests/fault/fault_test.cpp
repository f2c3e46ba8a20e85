// SPDX-License-Identifier: Apache-2.0
#include <support/paths.hpp>

#include "fault_test.hpp"

namespace segue::testing {

namespace {

using type::Value;

}  // namespace

void FaultTest::SetUp() {
  SystemTest::SetUp();
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kTestLibraries, 1);
  write("robot/robot.yaml", "robot: patient\nlibraries: [segue_test_faults]\ncontrollers: [\"*.net\"]\n");
}

void FaultTest::TearDown() {
  if (robot_) stop();
  expect_nothing_left(folder_ / "runtime");
  SystemTest::TearDown();
}

void FaultTest::write_network(const std::string& name, const std::string& tasks,
                              const std::string& deployments, const std::string& connections) {
  write("robot/" + name + ".net", "network: " + name + "\ntasks:\n" + kChainTasks + tasks + "deployments:\n" +
                                      kChainDeployments + deployments + "connections:\n" + kChainConnections +
                                      connections);
}

void FaultTest::start(const std::string& controller) {
  std::vector<std::string> arguments = {"run", "robot/robot.yaml"};
  arguments.insert(arguments.end(), run_options_.begin(), run_options_.end());
  robot_ = std::make_unique<Process>(command(std::move(arguments)), folder_);
  if (!robot_->wait_for("robot patient runs")) {
    const auto finished = robot_->wait();
    FAIL() << finished.output << finished.errors;
  }
  if (!controller.empty()) {
    switch_to(controller);
  }
}

void FaultTest::kill_runtime() {
  robot_->signal(SIGKILL);
  EXPECT_EQ(robot_->wait().status, 128 + SIGKILL);
  robot_.reset();
}

std::map<std::string, pid_t> FaultTest::deployments() const {
  return deployments_of(folder_ / "runtime");
}

void FaultTest::expect_deployments(const std::vector<std::string>& names) {
  std::vector<std::string> found;
  const bool as_expected = eventually([&] {
    found.clear();
    for (const auto& [name, pid] : deployments())
      found.push_back(name);
    return found == names;
  });
  EXPECT_TRUE(as_expected);
  if (!as_expected) {
    EXPECT_EQ(found, names);
  }
}

Value FaultTest::switch_to(const std::string& controller, const std::string& outcome) {
  const auto result = json({"switch", controller}, outcome == "done" ? 0 : 1);
  const Value* found = result.find("outcome");
  EXPECT_TRUE(found != nullptr && *found == Value(outcome)) << type::to_json(result);
  return result;
}

bool FaultTest::recover_to(const std::string& controller) {
  return eventually([&] {
    static_cast<void>(segue({"switch", controller}));
    return what_is_wrong(controller).empty();
  });
}

std::string FaultTest::what_is_wrong(const std::string& controller) {
  const auto finished = segue({"status", "--format", "json"});
  const auto status = type::parse_json(finished.output);
  if (finished.status != 0 || !status) {
    return finished.errors;
  }
  if (*status->find("controller") != Value(controller) || !status->find("differences")->as_list().empty()) {
    return type::to_json(*status->find("controller")) + type::to_json(*status->find("differences"));
  }
  for (const Value& task : status->find("tasks")->as_list()) {
    if (*task.find("state") != Value("running")) {
      return type::to_json(task);
    }
  }
  return {};
}

Sight FaultTest::sight(const std::string& watcher) {
  return Sight::of(json({"call", watcher + ".report"}));
}

void FaultTest::expect_undisturbed(const std::string& watcher) {
  testing::expect_undisturbed(watcher, [&] { return sight(watcher); });
}

std::string FaultTest::expect_event(const std::string& kind, const std::string& words) {
  std::string found;
  const bool came = eventually([&] {
    const auto events = json({"events"});
    for (const Value& event : events.as_list()) {
      const std::string text = event.find("subject")->as_string() + ": " + event.find("message")->as_string();
      if (*event.find("kind") == Value(kind) && text.find(words) != std::string::npos) {
        found = text;
        return true;
      }
    }
    return false;
  });
  EXPECT_TRUE(came) << "no event '" << kind << "' with '" << words << "'\n" << segue({"events"}).output;
  return found;
}

}  // namespace segue::testing
