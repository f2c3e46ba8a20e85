// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/model/host_config.hpp>

#include <support/paths.hpp>
#include <support/shared_data.hpp>

#include <gmock/gmock.h>

#include <filesystem>

namespace segue::model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using type::Value;
namespace fs = std::filesystem;

struct Read {
  std::optional<Network> network;
  Diagnostics diagnostics;
};

Read read(std::string_view text, const std::string& file = "net.yaml") {
  Read result;
  result.network = read_network(text, file, result.diagnostics);
  return result;
}

TEST(NetworkFileTest, TheExampleOfTheManual) {
  const Read result = read(R"(network: goal_navigation
tasks:
  velodyne:
    component: velodyne_lidar::LaserScanner
    state: stopped
    properties: {range: {max: 30.0}, rate: 10}
    activity: {periodic: 100ms, scheduler: fifo, priority: 40, cpu: [1], thread: lidar}
    exclusive: [/dev/velodyne]
    takes_over: old_velodyne
  filter: {component: demo::Filter, activity: port_driven}
deployments:
  drivers: {host: onboard, process: rover_drivers, tasks: [velodyne]}
connections:
  - velodyne.scans -> filter.input
  - {from: velodyne.cloud, to: filter.cloud, policy: buffer, size: 10, link: shm}
)");
  ASSERT_TRUE(result.network) << to_string(result.diagnostics);
  EXPECT_THAT(result.diagnostics.items(), IsEmpty());
  const Network& network = *result.network;
  EXPECT_EQ(network.name, NetworkName("goal_navigation"));
  const Task& task = network.tasks[0];
  EXPECT_EQ(task.component, ComponentName("velodyne_lidar::LaserScanner"));
  EXPECT_EQ(task.state, TaskState::Stopped);
  EXPECT_EQ(task.properties, Value::map({{"range", Value::map({{"max", 30.0}})}, {"rate", 10}}));
  const Activity expected{
      Trigger::Periodic, std::chrono::milliseconds(100), Scheduler::Fifo, 40, {1}, "lidar", false};
  EXPECT_EQ(task.activity, expected);
  EXPECT_THAT(task.exclusive, ElementsAre("/dev/velodyne"));
  EXPECT_EQ(task.takes_over, TaskId("old_velodyne"));
  EXPECT_EQ(task.where.line, 4);
  EXPECT_EQ(network.tasks[1].state, TaskState::Running);
  EXPECT_EQ(network.deployments[0].key(), (DeploymentKey{HostName("onboard"), ProcessName("rover_drivers")}));
  EXPECT_THAT(network.deployments[0].tasks, ElementsAre(Placement{TaskId("velodyne"), "velodyne"}));
  EXPECT_EQ(network.connections[0].to, (PortRef{TaskId("filter"), "input"}));
  EXPECT_EQ(network.connections[1].policy, (Policy{BufferKind::Buffer, 10, Transport::SharedMemory, false}));
}

TEST(NetworkFileTest, ANetworkWithoutANameIsNamedAfterItsFile) {
  EXPECT_EQ(read("tasks: {}", "controllers/safe_stop.yaml").network->name, NetworkName("safe_stop"));
  EXPECT_EQ(read("tasks:\n", "shutdown.cnd.yml").network->name, NetworkName("shutdown"));
}

TEST(NetworkFileTest, EmptyMapsAndNullsAreTheEmptyNetwork) {
  for (const char* text : {"tasks:\ndeployments:\nconnections:\n",
                           "{tasks: {}, deployments: {}, connections: {}}", "network: empty"}) {
    const Read result = read(text);
    ASSERT_TRUE(result.network) << text << to_string(result.diagnostics);
    EXPECT_TRUE(result.network->empty());
  }
}

TEST(NetworkFileTest, AFileThatSaysNothingOfANetworkIsNone) {
  for (const char* text : {"", "\n", "# network: go\n", "---\n", "null", "~", "{}", "speed: 3\n"}) {
    for (const char* file : {"go.yaml", "go.cnd"}) {
      const Read result = read(text, file);
      EXPECT_FALSE(result.network) << text;
      EXPECT_EQ(result.diagnostics.items().front().code, "no-network") << to_string(result.diagnostics);
    }
  }
}

TEST(NetworkFileTest, ThePortFollowsTheLastDot) {
  const Read result = read("network: n\nconnections: [arm.left.out -> b-1.in_2]\n");
  ASSERT_TRUE(result.network) << to_string(result.diagnostics);
  EXPECT_EQ(result.network->connections[0].from, (PortRef{TaskId("arm.left"), "out"}));
  EXPECT_EQ(result.network->connections[0].to, (PortRef{TaskId("b-1"), "in_2"}));
}

TEST(NetworkFileTest, APortWithADotIsWrittenAsAMap) {
  const Read result =
      read("network: n\nconnections: [{from: camera.frame, to: {task: logger, port: camera.frame}}]\n");
  ASSERT_TRUE(result.network) << to_string(result.diagnostics);
  EXPECT_EQ(result.network->connections[0].to, (PortRef{TaskId("logger"), "camera.frame"}));
  const Read again = read(write_network(*result.network));
  EXPECT_EQ(again.network, result.network);
}

TEST(NetworkFileTest, ReportsEveryProblemAtOnce) {
  const Read result =
      read("network: n\ntasks:\n  a: {component: x, state: flying}\n  b: {activity: often}\n");
  EXPECT_FALSE(result.network);
  EXPECT_EQ(result.diagnostics.error_count(), 3U) << to_string(result.diagnostics);
}

TEST(NetworkFileTest, AMissingFileIsADiagnostic) {
  Diagnostics diagnostics;
  EXPECT_FALSE(load_network("/does/not/exist.yaml", diagnostics));
  EXPECT_TRUE(diagnostics.has_errors());
}

TEST(CndTest, ConfigurationSectionsAreKeptAndReportedAsNotRead) {
  for (const auto& [text, file] : {std::pair("tasks:\n  a: {type: x::T, config_names: [default, outdoor]}\n  "
                                             "b: {type: x::T, config_names: c}\n",
                                             "x.cnd"),
                                   std::pair("network: n\ntasks:\n  a: {component: x::T, config_names: "
                                             "[default, outdoor]}\n  b: {component: x::T, config_names: c}\n",
                                             "x.yaml")}) {
    const Read result = read(text, file);
    ASSERT_TRUE(result.network) << to_string(result.diagnostics);
    EXPECT_THAT(result.network->tasks[0].config_names, ElementsAre("default", "outdoor"));
    ASSERT_EQ(result.diagnostics.items().size(), 1U) << to_string(result.diagnostics);
    const Diagnostic& warning = result.diagnostics.items()[0];
    EXPECT_EQ(warning.severity, Severity::Warning);
    EXPECT_EQ(warning.code, "sections-not-read");
    EXPECT_THAT(warning.message, HasSubstr("task 'a' and 1 more: "));
    EXPECT_GT(warning.where.line, 0);
  }
}

TEST(CndTest, ANetworkThatIncludesOthersIsRefusedWhereTheyAreNotAtHand) {
  for (const auto& [text, file] : {std::pair("include: [b.cnd]\ntasks:\n  a: {type: x::T}\n", "x.cnd"),
                                   std::pair("network: n\ninclude: b.yaml\n", "x.yaml")}) {
    const Read result = read(text, file);
    EXPECT_FALSE(result.network);
    ASSERT_EQ(result.diagnostics.items().size(), 1U) << to_string(result.diagnostics);
    EXPECT_EQ(result.diagnostics.items()[0].code, "no-include");
  }
}

TEST(CndTest, ReadsTasksDeploymentsAndConnections) {
  const Read result = read(R"(tasks:
  camera-1:
    type: camera::Task
    state: PRE_OPERATIONAL
    config: {gain: {auto: true}}
    properties: [{Name: rate, Type: /double, Value: 2.5}]
    activity: {type: PERIODIC, period: 0.1, priority: 60, realtime: true}
  viewer: {type: viewer::Task, activity: {type: NONE}}
deployments:
  7: {deployer: orogen, hostID: local, process_name: io, taskList: {camera-1: cam}}
connections:
  42:
    from: {task_id: camera-1, port_name: frame}
    to: {task_id: viewer, port_name: image}
    type: BUFFER
    size: 5
    transport: CORBA
)",
                           "x.cnd");
  ASSERT_TRUE(result.network) << to_string(result.diagnostics);
  EXPECT_THAT(result.diagnostics.items(), IsEmpty()) << to_string(result.diagnostics);
  const Task& task = result.network->tasks[0];
  EXPECT_EQ(task.state, TaskState::PreOperational);
  EXPECT_EQ(task.properties, Value::map({{"gain", Value::map({{"auto", true}})}, {"rate", 2.5}}));
  EXPECT_EQ(task.activity->period, std::chrono::milliseconds(100));
  EXPECT_EQ(task.activity->scheduler, Scheduler::Fifo);
  EXPECT_FALSE(result.network->tasks[1].activity);
  const Deployment& deployment = result.network->deployments[0];
  EXPECT_EQ(deployment.host, kLocalHost);
  EXPECT_EQ(deployment.deployer, "orogen");
  EXPECT_THAT(deployment.tasks, ElementsAre(Placement{TaskId("camera-1"), "cam"}));
  EXPECT_EQ(result.network->connections[0].policy,
            (Policy{BufferKind::Buffer, 5, Transport::Automatic, false}));
}

TEST(TransitionFileTest, HandWrittenListsRead) {
  Diagnostics diagnostics;
  const auto transition = read_transition(R"(transition:
  from: search_explore
  to: goal_navigation
  actions:
    - {id: 10, kind: stop, task: area_explorer}
    - {id: 20, kind: disconnect, from: slam.mls, to: area_explorer.map, policy: data, after: [10]}
    - {kind: call_operation, task: slam, operation: reset, arguments: {}, after: [20]}
)",
                                          "t.yaml", diagnostics);
  ASSERT_TRUE(transition) << to_string(diagnostics);
  EXPECT_EQ(transition->actions[1].id, 2);
  EXPECT_THAT(transition->actions[1].after, ElementsAre(1));
  EXPECT_THAT(transition->actions[2].after, ElementsAre(2));
  EXPECT_EQ(transition->actions[0].label(), "stop area_explorer");
  EXPECT_EQ(transition->actions[1].label(), "disconnect slam.mls -> area_explorer.map");
  EXPECT_EQ(transition->counts().state_changes(), 1);
  EXPECT_EQ(transition->counts().total(), 3);
}

TEST(TransitionFileTest, BeginsAndEndsAtSeveralControllersOrNone) {
  const auto ends = [](const std::string& text) {
    Diagnostics diagnostics;
    const auto transition = read_transition(text, "t.yaml", diagnostics);
    return diagnostics.has_errors() ? to_string(diagnostics)
                                    : transition->from.str() + " to " + transition->to.str();
  };
  EXPECT_EQ(ends("transition: {from: drive+arm, to: '', actions: []}"), "arm+drive to ");
  EXPECT_THAT(ends("transition: {from: drive+a b, actions: []}"), HasSubstr("'a b' is not a name"));
  EXPECT_THAT(ends("transition: {to: drive++arm, actions: []}"), HasSubstr("'' is not a name"));
}

TEST(TransitionFileTest, ApplyConfigWithoutDefinitionSaysSo) {
  Diagnostics diagnostics;
  const auto transition =
      read_transition("transition: {actions: [{kind: apply_config, task: a}]}", "t.yaml", diagnostics);
  EXPECT_FALSE(transition);
  EXPECT_THAT(to_string(diagnostics), HasSubstr("'definition'"));
}

TEST(TransitionFileTest, AfterMustNameEarlierActions) {
  Diagnostics diagnostics;
  const auto transition = read_transition(
      "transition: {actions: [{id: 1, kind: stop, task: a, after: [2]}, {id: 2, kind: stop, task: b}]}",
      "t.yaml", diagnostics);
  EXPECT_FALSE(transition);
  EXPECT_THAT(to_string(diagnostics), HasSubstr("earlier"));
}

TEST(HostConfigTest, IsReadWithPathsRelativeToTheFile) {
  Diagnostics diagnostics;
  const auto config = read_host_config(
      "name: arm\nlisten: 0.0.0.0:7447\ncredentials: keys\nstate: /var/lib/segue\n"
      "zygote: [segue_components_demo]\n",
      "/etc/segue/host.yaml", diagnostics);
  ASSERT_TRUE(config) << to_string(diagnostics);
  EXPECT_EQ(
      *config,
      (HostConfig{"arm", "0.0.0.0:7447", "/etc/segue/keys", "/var/lib/segue", {"segue_components_demo"}}));
}

TEST(HostConfigTest, LibrariesAreNamesAndKeysAreKnown) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_host_config("zygote: [../evil]\nlissen: x\n", "host.yaml", diagnostics));
  EXPECT_THAT(to_string(diagnostics), HasSubstr("../evil"));
  EXPECT_THAT(to_string(diagnostics), HasSubstr("did you mean 'listen'"));
}

TEST(RobotFileTest, TheExampleOfTheManual) {
  Diagnostics diagnostics;
  const auto robot = read_robot(R"(robot: artemis
hosts:
  onboard: local
  base: {address: "tcp://10.0.0.2:7447", credentials: certs}
libraries: [segue_components_demo]
models: ["models/*.yaml"]
controllers: [controllers/*.yaml]
missions: [missions/*.yaml]
fallback: safe_stop
policies: {on_failure: restart, restart: {max: 5, backoff: 200ms}, watch: 500ms}
look_ahead: {processes: 3, memory: 512MB}
)",
                                "/robots/artemis/robot.yaml", diagnostics);
  ASSERT_TRUE(robot) << to_string(diagnostics);
  EXPECT_THAT(diagnostics.items(), IsEmpty());
  EXPECT_THAT(robot->hosts, ElementsAre(Host{HostName("onboard"), "local", ""},
                                        Host{HostName("base"), "tcp://10.0.0.2:7447", "certs"}));
  EXPECT_EQ(robot->policies, (Policies{FailurePolicy::Restart,
                                       {5, std::chrono::milliseconds(200)},
                                       std::chrono::milliseconds(500)}));
  EXPECT_EQ(robot->look_ahead, (LookAhead{3, 512'000'000}));
  EXPECT_EQ(robot->folder, "/robots/artemis");
  EXPECT_EQ(robot->fallback, NetworkName("safe_stop"));
}

TEST(RobotFileTest, DefaultsAreModest) {
  Diagnostics diagnostics;
  const auto robot = read_robot("robot: r\npolicies: {}\nlook_ahead: {}\n", "r.yaml", diagnostics);
  ASSERT_TRUE(robot) << to_string(diagnostics);
  EXPECT_EQ(robot->policies, Policies{});
  EXPECT_EQ(robot->policies.on_failure, FailurePolicy::Report);
  EXPECT_EQ(robot->look_ahead, LookAhead{});
}

TEST(RobotFileTest, NamesThePlannerOfItsMissions) {
  Diagnostics diagnostics;
  const auto robot =
      read_robot("robot: r\nplanner: {command: [lama, \"{domain}\"], timeout: 5s, memory: 1MB}\n", "r.yaml",
                 diagnostics);
  ASSERT_TRUE(robot) << to_string(diagnostics);
  ASSERT_TRUE(robot->planner);
  EXPECT_EQ(robot->planner->command, (std::vector<std::string>{"lama", "{domain}"}));
  EXPECT_EQ(robot->planner->timeout, std::chrono::seconds(5));
  EXPECT_EQ(robot->planner->memory, 1'000'000U);
  EXPECT_FALSE(read_robot("robot: r\nplanner: {timeout: 0s}\n", "r.yaml", diagnostics));
  EXPECT_EQ(
      to_string(diagnostics),
      "r.yaml:2:10: error: the planner needs a 'command', such as [my-planner, \"{domain}\", \"{problem}\"] "
      "[no-command]\n"
      "r.yaml:2:20: error: the planner: 'timeout' must be longer than nothing [bad-duration]\n");
}

TEST(RobotFileTest, DeclaresUnitsThatOutliveMissions) {
  Diagnostics diagnostics;
  const auto robot = read_robot("robot: r\nunits: {deck_place: 3, screws: {count: 40}, \"process:map\": 0}\n",
                                "r.yaml", diagnostics);
  ASSERT_TRUE(robot) << to_string(diagnostics);
  EXPECT_EQ(robot->units, (std::vector<UnitStock>{{"deck_place", 3}, {"screws", 40}, {"process:map", 0}}));
  const auto problem = [](const std::string& units) {
    Diagnostics found;
    EXPECT_FALSE(read_robot("robot: r\nunits: " + units + "\n", "r.yaml", found));
    return to_string(found);
  };
  EXPECT_THAT(problem("{screws: -1}"),
              HasSubstr("r.yaml:2:17: error: the units 'screws': expected how many"));
  EXPECT_THAT(problem("{screws: many}"), HasSubstr("[bad-count]"));
  EXPECT_THAT(problem("{screws: {count: 1.5}}"), HasSubstr("[bad-count]"));
  EXPECT_THAT(problem("{screws: {}}"), HasSubstr("'count'"));
  EXPECT_THAT(problem("{screws: {count: 1, of: robot}}"), HasSubstr("'of'"));
  EXPECT_THAT(problem("{\"cup_{n}\": 1}"), HasSubstr("expected the name of a resource"));
  EXPECT_THAT(problem("[screws]"), HasSubstr("units"));
}

TEST(RobotFileTest, LibrariesAreNamesNeverPaths) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_robot("robot: r\nlibraries: [../evil.so]\n", "r.yaml", diagnostics));
  EXPECT_THAT(to_string(diagnostics), HasSubstr("never paths"));
}

TEST(KindOfFileTest, ByContentThenByName) {
  EXPECT_EQ(kind_of_file("a.yaml", "network: n"), FileKind::Network);
  EXPECT_EQ(kind_of_file("a.yaml", "tasks: {a: {component: x}}"), FileKind::Network);
  EXPECT_EQ(kind_of_file("a.yaml", "tasks: {a: {type: x}}"), FileKind::Cnd);
  EXPECT_EQ(kind_of_file("shutdown.cnd", "tasks:\ndeployments:\nconnections:\n"), FileKind::Cnd);
  EXPECT_EQ(kind_of_file("a.yaml", "robot: r"), FileKind::Robot);
  EXPECT_EQ(kind_of_file("a.yaml", "mission: m\nstates: {}"), FileKind::Mission);
  EXPECT_EQ(kind_of_file("a.yaml", "mission: m\nstates: [\n"), FileKind::Mission);
  EXPECT_EQ(kind_of_file("a.yaml", "transition: {}"), FileKind::Transition);
  EXPECT_EQ(kind_of_file("a.json", R"({"from": "a", "to": "b", "actions": []})"), FileKind::Transition);
  EXPECT_EQ(kind_of_file("a.yaml", "components: {}"), FileKind::Components);
  EXPECT_EQ(kind_of_file("a.yaml", "tasks: {a::T: {input_ports: []}}"), FileKind::Components);
  EXPECT_EQ(kind_of_file("a.yaml", "gps: {Task: {inputPorts: []}}"), FileKind::Components);
  EXPECT_EQ(kind_of_file("a.xml", "<?xml version='1.0'?>\n<typelib/>"), FileKind::Typelib);
  EXPECT_EQ(kind_of_file("a.yaml", "name: x\nnodes: []\n"), FileKind::Unknown);
  EXPECT_EQ(kind_of_file("a.yaml", "network: n\ntasks: [\n"), FileKind::Network);
  EXPECT_EQ(kind_of_file("a.json", R"({"name": "x", "nodes": []})"), FileKind::TaskNetwork);
  EXPECT_EQ(kind_of_file("a.yaml", "stand_ins: {default: {rate: 1}}"), FileKind::StandIns);
  EXPECT_EQ(kind_of_file("a.yaml", "stand_ins: [\n"), FileKind::StandIns);
  EXPECT_EQ(kind_of_file("a.yaml", "plan_mapping: rover\nactions: {}"), FileKind::PlanMapping);
  EXPECT_EQ(kind_of_file("a.yaml", "plan_mapping: [\n"), FileKind::PlanMapping);
  EXPECT_EQ(kind_of_file("plan", "; cost 2\n(move a b)\n"), FileKind::Pddl);
  for (const char* plan :
       {"\xef\xbb\xbf(define (domain d))", "0.000: (move a b) [1]\n", "STEP 0: move(a,b)\n",
        "SequentialPlan:\n    move(a, b)\n", "ff: found legal plan as follows\n\nstep 0: MOVE A B\n"})
    EXPECT_EQ(kind_of_file("plan", plan), FileKind::Pddl) << plan;
  EXPECT_EQ(kind_of_file("empty.cnd", " \n"), FileKind::Cnd);
  EXPECT_EQ(kind_of_file("a.txt", "; nothing"), FileKind::Unknown);
}

const fs::path kArtemis = segue::paths::in_sources("/examples/04_artemis/controllers");

void expect_cnd_files_to_read(const fs::path& folder, int expected) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().string().find(".cnd") == std::string::npos) continue;
    Diagnostics diagnostics;
    const auto network = load_network(entry.path(), diagnostics);
    ASSERT_TRUE(network) << to_string(diagnostics);
    for (const Diagnostic& item : diagnostics.items())
      EXPECT_EQ(item.code, "sections-not-read") << item.message;
    EXPECT_FALSE(network->tasks.empty());
    Diagnostics again;
    EXPECT_EQ(read_network(write_network(*network), "x.yaml", again), network) << to_string(again);
    ++files;
  }
  EXPECT_EQ(files, expected);
}

TEST(RealFilesSharedData, EveryCndFileReads) {
  if (const auto missing = missing_shared_data("rock/cnd"); !missing.empty()) GTEST_SKIP() << missing;
  expect_cnd_files_to_read(shared_data("rock/cnd"), 3);
}

TEST(RealFilesTest, EveryArtemisControllerReads) {
  expect_cnd_files_to_read(kArtemis, 4);
}

TEST(RealFilesTest, TheArtemisControllersHaveThePapersSizes) {
  Diagnostics diagnostics;
  const auto network = load_network(kArtemis / "goal_navigation.cnd", diagnostics);
  ASSERT_TRUE(network) << to_string(diagnostics);
  EXPECT_EQ(network->name, NetworkName("goal_navigation"));
  EXPECT_EQ(network->tasks.size(), 41U);
  EXPECT_EQ(network->deployments.size(), 17U);
  EXPECT_EQ(network->connections.size(), 58U);
}

TEST(TransitionFileTest, ATransitionWithoutNamesIsReadBack) {
  Diagnostics diagnostics;
  const auto transition =
      read_transition("transition: {actions: [{id: 1, kind: stop, task: a}]}", "t.yaml", diagnostics);
  ASSERT_TRUE(transition) << to_string(diagnostics);
  const auto again = read_transition(write_transition(*transition), "t.yaml", diagnostics);
  ASSERT_TRUE(again) << to_string(diagnostics);
  EXPECT_EQ(*again, *transition);
}

}  // namespace
}  // namespace segue::model
