// SPDX-License-Identifier: Apache-2.0
#include "../look/look.hpp"
#include "../participant/participant.hpp"
#include "../topics/topics_test_support.hpp"

#include <segue/task/realtime_log.hpp>
#include <segue/type/yaml.hpp>

#include <support/logged_lines.hpp>
#include <support/paths.hpp>
#include <support/ros2_installation.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <set>
#include <string>
#include <thread>
#include <utility>

namespace ros2::testing {
namespace {

using segue::TaskState;
using segue::testing::TemporaryFiles;
using segue::type::Value;

class StartedNodes : public ::testing::Test {
 protected:
  static ValueMap node(const std::string& executable, const std::string& name = "/planner") {
    ValueMap map;
    map.append("name", name);
    map.append("domain", std::int64_t{own_domain()});
    map.append("discovery", "localhost");
    map.append("timeout", "60s");
    map.append("process", Value::map({{"package", "test_nodes"}, {"executable", executable}}));
    return map;
  }
  static ValueMap component(const std::string& name, const std::string& plugin = "test::Managed") {
    ValueMap map = node("", name);
    map["process"] = Value::map({{"package", "test_nodes"},
                                 {"component", plugin},
                                 {"container", "/container"},
                                 {"remappings", Value::list({"scan:=/front"})}});
    return map;
  }
  static std::string error_of(const segue::Result<void>& done) {
    return done ? std::string() : segue::to_string(done.error());
  }
  [[nodiscard]] std::string noted(const std::string& name) const { return ros.noted(name); }
  [[nodiscard]] pid_t pid_of(const std::string& name) const { return ros.pid_of(name); }
  static bool is_gone(pid_t pid) {
    return pid > 0 && eventually([&] { return ::kill(pid, 0) != 0; });
  }

  TemporaryFiles files;
  segue::testing::Ros2Installation ros{files.folder(), segue::paths::kNodeProgram};
};

TEST_F(StartedNodes, AreConfiguredStartedStoppedAndEnded) {
  RunningTask task("ros2::ManagedNode");
  auto values = node("managed");
  values["parameters"] = Value::map({{"rate", 10}, {"pid", Value::map({{"gain", 2.0}, {"on", "yes"}})}});
  values["process"].as_map().set("remappings", Value::list({"scan:=/front/scan"}));
  values["process"].as_map().set("arguments", Value::list({"--fast"}));
  ASSERT_EQ(error_of(task.configure(values)), "");
  EXPECT_EQ(noted("planner"),
            "--fast\n--ros-args\n-r\n__node:=planner\n-r\n__ns:=/\n-r\nscan:=/front/scan\n--ros-args\n"
            "--params-file\n/proc/self/fd/4\nrate: 10\npid: {gain: 2.0, 'on': 'yes'}\n");
  ASSERT_EQ(error_of(task.task().start(soon())), "");
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
  const pid_t pid = pid_of("planner");
  EXPECT_EQ(::kill(pid, 0), 0);
  ASSERT_EQ(error_of(task.task().cleanup(soon())), "");
  EXPECT_EQ(noted("planner.end"), "by SIGINT");
  EXPECT_TRUE(is_gone(pid));
}

TEST_F(StartedNodes, KeepParametersWithWhichTheyWereStarted) {
  segue::testing::LoggedLines lines;
  const segue::task::RealtimeLogDrain drain;
  RunningTask task("ros2::ManagedNode");
  auto values = node("managed");
  values["parameters"] = Value::map({{"rate", 10}});
  task.run(values);
  const auto set = [&](const Value& parameters) {
    return error_of(task.task().set_properties(Value::map({{"parameters", parameters}}), soon()));
  };
  EXPECT_EQ(set(Value::map({{"rate", 20}})), "");
  EXPECT_EQ(set(Value::map({})), "");
  EXPECT_TRUE(lines.has({"node /planner keeps parameter rate, which is not named any more"}));
}

/// Sets a variable as long as it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

TEST_F(StartedNodes, LookForOthersWhereTheirTaskDoesWhateverTheEnvironmentSays) {
  const Variable domain("ROS_DOMAIN_ID", std::to_string(own_domain() + 1));
  const Variable range("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF");
  const Variable peers("ROS_STATIC_PEERS", "127.0.0.9");
  RunningTask task("ros2::ManagedNode");
  auto values = node("managed");
  const std::string where = "ROS_DOMAIN_ID=" + std::to_string(own_domain()) + "\n";
  const auto looks = [&](const std::string& expected) {
    EXPECT_EQ(error_of(task.configure(values)), "");
    EXPECT_EQ(noted("planner.discovery"), where + expected);
    EXPECT_EQ(error_of(task.task().cleanup(soon())), "");
  };
  looks("ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST\nROS_LOCALHOST_ONLY=\nROS_STATIC_PEERS=127.0.0.9\n");
  values["static_peers"] = Value::list({"127.0.0.1", "127.0.0.2"});
  looks(
      "ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST\nROS_LOCALHOST_ONLY=\nROS_STATIC_PEERS=127.0.0.1;127.0.0.2\n");
}

TEST_F(StartedNodes, LookOnTheirComputerWhereTheirTaskDoes) {
  const Variable domain("ROS_DOMAIN_ID", std::to_string(own_domain() + 1));
  RunningTask task("ros2::ManagedNode");
  EXPECT_EQ(error_of(task.configure(node("managed"))), "");
  EXPECT_EQ(noted("planner.discovery"),
            "ROS_DOMAIN_ID=" + std::to_string(own_domain()) +
                "\nROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST\nROS_LOCALHOST_ONLY=1\nROS_STATIC_PEERS=\n");
}

TEST_F(StartedNodes, WithoutALifeCycleLiveFromStartToStop) {
  RunningTask task("ros2::Node");
  ASSERT_EQ(error_of(task.configure(node("talker"))), "");
  EXPECT_EQ(noted("planner"), "(not noted)")
      << "a node that acts as long as it lives must not be prepared ahead";
  ASSERT_EQ(error_of(task.task().start(soon())), "");
  const pid_t pid = pid_of("planner");
  EXPECT_EQ(::kill(pid, 0), 0);
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
  EXPECT_TRUE(is_gone(pid));
  ASSERT_EQ(error_of(task.task().start(soon())), "");
  EXPECT_TRUE(eventually([&] { return pid_of("planner") != pid; })) << "a new process";
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
}

TEST_F(StartedNodes, WithoutALifeCycleLiveFromConfigureOnWhereThatIsWanted) {
  RunningTask task("ros2::Node");
  auto values = node("talker");
  values.append("ahead", true);
  ASSERT_EQ(error_of(task.configure(values)), "");
  const pid_t pid = pid_of("planner");
  ASSERT_EQ(error_of(task.task().start(soon())), "");
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
  EXPECT_EQ(::kill(pid, 0), 0);
  ASSERT_EQ(error_of(task.task().cleanup(soon())), "");
  EXPECT_TRUE(is_gone(pid));
}

TEST_F(StartedNodes, HaveTheirTopicsAsPortsByTheNamesOfRemappings) {
  RunningTask counter("ros2::Node", "counter");
  auto values = node("counter", "/counter");
  values["process"].as_map().set("remappings", Value::list({"numbers:=/front/numbers"}));
  values.append("publishes", Value::map({{"numbers", "std_msgs/msg/String"}}));
  values.append("ready", Value::list({"numbers"}));
  ASSERT_EQ(error_of(counter.configure(values)), "");
  Reader reader(*counter.task().component().find_output("numbers"));
  ASSERT_EQ(error_of(counter.task().start(soon())), "");
  const Texts numbers = reader.read(3);
  ASSERT_GE(numbers.size(), 3U);
  EXPECT_EQ(std::stoi(numbers[2]), std::stoi(numbers[0]) + 2);
  ::kill(pid_of("counter"), SIGKILL);
  EXPECT_TRUE(eventually([&] { return counter.task().state() == TaskState::Exception; }));
}

TEST_F(StartedNodes, WhoseProcessEndsBeforeTheFirstSampleAreNotWaitedFor) {
  RunningTask task("ros2::Node", "talker");
  auto values = node("talker", "/talker");
  values.append("publishes", Value::map({{"words", "std_msgs/msg/String"}}));
  values.append("ready", Value::list({"words"}));
  ASSERT_EQ(error_of(task.configure(values)), "");
  std::string started;
  std::thread starter([&] { started = error_of(task.task().start(soon())); });
  EXPECT_TRUE(eventually([&] { return pid_of("talker") > 0; }));
  ::kill(pid_of("talker"), SIGKILL);
  starter.join();
  EXPECT_THAT(started, HasSubstr("the process of node /talker was killed by signal 9"));
}

TEST_F(StartedNodes, ThatEndAtOnceAreSaidWithTheirStatus) {
  RunningTask managed("ros2::ManagedNode");
  EXPECT_THAT(error_of(managed.configure(node("fails"))),
              HasSubstr("the process of node /planner ended with exit status 3"));
  RunningTask other("ros2::Node", "planner");
  ASSERT_EQ(error_of(other.configure(node("fails"))), "");
  EXPECT_THAT(error_of(other.task().start(soon())),
              HasSubstr("the process of node /planner ended with exit status 3"));
}

TEST_F(StartedNodes, ThatDieInConfigureAreSaidWithTheirSignal) {
  RunningTask task("ros2::ManagedNode");
  auto values = node("managed");
  values["parameters"] = Value::map({{"dies_in_configure", true}});
  EXPECT_THAT(error_of(task.configure(values)),
              HasSubstr("the process of node /planner was killed by signal 9 (Killed)"));
  EXPECT_EQ(task.task().state(), TaskState::PreOperational);
}

TEST_F(StartedNodes, WhoseProcessEndsBringAnException) {
  for (const auto& [kind, program] :
       {std::pair("ros2::ManagedNode", "managed"), std::pair("ros2::Node", "talker")}) {
    RunningTask task(kind);
    task.run(node(program));
    ASSERT_EQ(task.task().state(), TaskState::Running);
    ::kill(pid_of("planner"), SIGKILL);
    EXPECT_TRUE(eventually([&] { return task.task().state() == TaskState::Exception; }));
    EXPECT_THAT(task.task().error_message(), HasSubstr("was killed by signal 9"));
    ASSERT_EQ(error_of(task.task().recover(soon())), "");
    ASSERT_EQ(error_of(task.configure(node(program))), "") << "a new process";
    ASSERT_EQ(error_of(task.task().cleanup(soon())), "");
  }
}

std::set<segue::ros2::Gid> participants_with(const std::string& node, const Participant& participant) {
  std::set<segue::ros2::Gid> found;
  for (const auto& each : participant.graph().snapshot().participants) {
    const auto& nodes = each.entities.nodes;
    if (std::ranges::any_of(nodes, [&](const auto& one) { return full_name(one) == node; }))
      found.insert(each.entities.participant);
  }
  return found;
}

TEST_F(StartedNodes, AreNotTakenForThoseOfAProcessThatWasKilled) {
  const auto participant = Participant::join({own_domain(), Range::Localhost}).value();
  for (const auto& [name, values] :
       {std::pair("planner", node("talker")), std::pair("smoother", component("/smoother"))}) {
    RunningTask task("ros2::Node");
    task.run(values);
    const auto before = participants_with(std::string("/") + name, *participant);
    ASSERT_FALSE(before.empty());
    ASSERT_GT(pid_of(name), 0);
    ::kill(pid_of(name), SIGKILL);
    ASSERT_TRUE(eventually([&] { return task.task().state() == TaskState::Exception; }));
    ASSERT_EQ(error_of(task.task().recover(soon())), "");
    ASSERT_EQ(error_of(task.configure(values)), "");
    ASSERT_EQ(error_of(task.task().start(soon())), "");
    const auto now = participants_with(std::string("/") + name, *participant);
    EXPECT_FALSE(std::ranges::includes(before, now))
        << "the new process of " << name << " was not waited for";
  }
}

TEST_F(StartedNodes, ThatIgnoreSignalsAreKilledWithAllThatTheyHaveStarted) {
  RunningTask task("ros2::Node");
  task.run(node("stubborn"));
  ASSERT_EQ(task.task().state(), TaskState::Running);
  pid_t child = 0;
  ASSERT_TRUE(eventually([&] {
    child = static_cast<pid_t>(std::atoi(noted("planner.child").c_str()));
    return child > 0;
  })) << "it is seen before it has started what it starts";
  ASSERT_EQ(::kill(child, 0), 0);
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
  EXPECT_TRUE(is_gone(pid_of("planner")));
  EXPECT_TRUE(is_gone(child));
}

TEST_F(StartedNodes, OfAContainerShareItsProcess) {
  RunningTask first("ros2::ManagedNode", "first");
  RunningTask second("ros2::ManagedNode", "second");
  auto values = component("/robot/planner");
  values["parameters"] = Value::map({{"rate", 10}});
  ASSERT_EQ(error_of(first.configure(values)), "");
  ASSERT_EQ(error_of(second.configure(component("/smoother"))), "");
  EXPECT_EQ(noted("planner"), "scan:=/front\n{rate: 10}\n");
  EXPECT_EQ(pid_of("planner"), pid_of("container"));
  EXPECT_EQ(pid_of("smoother"), pid_of("container"));
  ASSERT_EQ(error_of(first.task().start(soon())), "");
  ASSERT_EQ(error_of(first.task().stop(soon())), "");
  ASSERT_EQ(error_of(first.task().cleanup(soon())), "");
  EXPECT_EQ(::kill(pid_of("container"), 0), 0) << "the other one is in it";
  ASSERT_EQ(error_of(second.task().cleanup(soon())), "");
  EXPECT_TRUE(is_gone(pid_of("container")));
  EXPECT_EQ(noted("container.end"), "by SIGINT");
}

TEST_F(StartedNodes, OfAContainerAreSeenAsItsComponentsWithTheirPlugin) {
  RunningTask first("ros2::ManagedNode", "first");
  RunningTask second("ros2::ManagedNode", "second");
  ASSERT_EQ(error_of(first.configure(component("/planner"))), "");
  ASSERT_EQ(error_of(second.configure(component("/smoother"))), "");
  Look request;
  request.domain = static_cast<std::int32_t>(own_domain());
  request.discovery = "localhost";
  request.wait = request.patience = std::chrono::seconds(120);
  request.nodes = {"/smoother"};
  const auto seen = look(request, {});
  ASSERT_TRUE(seen) << segue::to_string(seen.error());
  EXPECT_EQ(*seen->find("problems"), Value(Value::List()));
  const auto entry = [&](const std::string& name, const char* key) {
    for (const Value& node : seen->find("nodes")->as_list())
      if (*node.find("name") == Value(name) && node.find(key) != nullptr) return *node.find(key);
    return Value();
  };
  EXPECT_EQ(segue::type::to_yaml(entry("/smoother", "container")),
            "name: /container\nid: 2\nevidence: only_one\nplugins:\n"
            "- {package: test_nodes, name: 'test::Managed'}\ncomponents: 2\nunknown: []\n");
  const auto listed = entry("/container", "components");
  ASSERT_EQ(listed.as_list().size(), 2U);
  EXPECT_EQ(*listed.as_list().front().find("name"), Value("/planner"));
  EXPECT_EQ(entry("/container", "problems"), Value()) << "it was not asked for anything else";
  EXPECT_EQ(*entry("/smoother", "process").find("nodes"), Value(3));
}

TEST_F(StartedNodes, ThatAContainerDoesNotKnowAreSaid) {
  RunningTask task("ros2::ManagedNode");
  EXPECT_THAT(error_of(task.configure(component("/planner", "test::Other"))),
              HasSubstr("container /container does not load test::Other: there is no such plugin"));
  EXPECT_TRUE(is_gone(pid_of("container")));
}

TEST_F(StartedNodes, OfAContainerThatEndsAllBringAnException) {
  RunningTask first("ros2::ManagedNode", "first");
  RunningTask second("ros2::ManagedNode", "second");
  first.run(component("/planner"));
  second.run(component("/smoother"));
  ::kill(pid_of("container"), SIGKILL);
  for (RunningTask* task : {&first, &second})
    EXPECT_TRUE(eventually([&] { return task->task().state() == TaskState::Exception; }));
}

TEST_F(StartedNodes, ThatCannotBeFoundAreSaidWithWhatThereIs) {
  const auto error = [](const char* key, const char* value) {
    auto values = node("managed");
    values["process"].as_map().set(key, value);
    RunningTask task("ros2::ManagedNode");
    return error_of(task.configure(values));
  };
  EXPECT_THAT(error("installation", "humble"),
              HasSubstr("installation 'humble' is not known; there are jazzy"));
  EXPECT_THAT(error("package", "nav2_planner"),
              HasSubstr("installation jazzy has no programs of a package 'nav2_planner'"));
  EXPECT_THAT(error("executable", "talk"),
              HasSubstr("package test_nodes of installation jazzy has no program 'talk'; it has "));
  EXPECT_THAT(error("executable", "../../../bin/sh"),
              HasSubstr("'../../../bin/sh' is not a valid name of a package or a program"));
  EXPECT_THAT(error("component", "test::Managed"),
              HasSubstr("either an executable or a component of package test_nodes is expected"));
}

TEST_F(StartedNodes, AreNotStartedFromWhatIsNoInstallation) {
  const auto error = [&](const std::string& text) {
    ros.write("ros2.yaml", text);
    RunningTask task("ros2::ManagedNode");
    return error_of(task.configure(node("managed")));
  };
  EXPECT_THAT(error("installations: {other: {prefix: nowhere}}"), HasSubstr("nowhere' has no setup.sh"));
  ros.write("other/setup.sh", "true\n");
  EXPECT_THAT(error("installations: {other: {prefix: other}}"), HasSubstr("does not set AMENT_PREFIX_PATH"));
  EXPECT_THAT(error("installations: {other: {folder: other}}"), HasSubstr("'folder' is not a valid prefix"));
  EXPECT_THAT(error("installations: {a: {prefix: jazzy}, b: {prefix: jazzy}}"),
              HasSubstr("name one of the installations of ROS 2: a, b"));
}

}  // namespace
}  // namespace ros2::testing
