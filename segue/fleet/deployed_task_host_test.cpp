// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/fleet/deployed_task_host.hpp>

#include <segue/fleet/process_record.hpp>
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/full_id.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <support/eventually.hpp>
#include <support/fake_world.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <latch>
#include <thread>

namespace segue::fleet {
namespace {

namespace testing = deploy::testing;
using namespace std::chrono_literals;
using deploy::testing::FakePtr;
using deploy::testing::FakeWorld;
using deploy::testing::Fault;
using deploy::testing::FaultKind;
using model::ActionKind;
using segue::testing::eventually;

TimePoint soon() {
  return RealClock::instance().now() + 60s;
}

model::Network network_of(std::string_view text) {
  Diagnostics diagnostics;
  auto network = model::read_network(text, "test.yaml", diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  return network.value_or(model::Network{});
}

const char* const kOne = R"(network: one
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, tasks: [a, b]}
  p2: {process: p2, tasks: [c]}
connections:
  - a.out -> b.in
  - {from: b.out, to: c.in, policy: buffer, size: 10}
  - c.out -> d.in
  - d.out -> a.in
)";

const char* const kTwo = R"(network: two
tasks:
  a: {component: test::A}
  c: {component: test::C, state: stopped}
  d: {component: test::D}
  e: {component: test::E}
deployments:
  p1: {process: p1, tasks: [a, e]}
  p3: {process: p3, tasks: [c]}
connections:
  - a.out -> c.in
  - c.out -> e.in
  - d.out -> a.in
)";

/// Records the events of the host and waits for them.
class EventRecorder {
 public:
  void add(const task_host::HostEvent& event) {
    {
      const Lock lock(mutex_);
      events_.push_back(event);
    }
    changed_.notify_all();
  }
  bool wait(const std::function<bool(const task_host::HostEvent&)>& fits) {
    Lock lock(mutex_);
    return changed_.wait_until(mutex_, soon(),
                               [&] { return std::any_of(events_.begin(), events_.end(), fits); });
  }
  bool process(const std::string& name, const std::string& part, bool gone) {
    return wait([&](const task_host::HostEvent& event) {
      const auto* what = std::get_if<task_host::ProcessEvent>(&event);
      return what != nullptr && what->process.process.str() == name && what->gone == gone &&
             what->message.find(part) != std::string::npos;
    });
  }
  bool task(const std::string& id, TaskState state) {
    return wait([&](const task_host::HostEvent& event) { return says(event, id, state); });
  }
  bool has_seen(const std::string& id, TaskState state) {
    const Lock lock(mutex_);
    return std::any_of(events_.begin(), events_.end(),
                       [&](const task_host::HostEvent& event) { return says(event, id, state); });
  }

 private:
  static bool says(const task_host::HostEvent& event, const std::string& id, TaskState state) {
    const auto* what = std::get_if<task_host::TaskEvent>(&event);
    return what != nullptr && what->task.str() == id && what->state == state;
  }

  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<task_host::HostEvent> events_;
};

/// A host over simulated processes. They are only polled when a test requests it, so that calls can be
/// counted.
struct Robot {
  explicit Robot(FakeWorld& fakes, DeployedOptions options = {60s, 1h})
      : world(fakes), host(own, processes, deploy::testing::connector(world), launch(), local, options) {
    host.set_listener([this](const task_host::HostEvent& event) { recorded.add(event); });
  }

  static process_server::Launch launch() {
    process_server::Launch launch;
    launch.robot = "robot";
    launch.stand_in = true;
    return launch;
  }

  Result<void> switch_to(const char* text, Duration action_deadline = 60s) {
    return switch_to(network_of(text), action_deadline);
  }
  /// Switches as the runtime does, but one action after the other: observes, solves, and carries out the
  /// actions.
  Result<void> switch_to(const model::Network& target, Duration action_deadline = 60s) {
    const model::Network observed = host.observe();
    const auto transition = solve::diff(observed, target, catalog, {order});
    if (!transition) {
      return transition.error();
    }
    host.begin_transition(observed, target);
    auto done = perform(*transition, model::Phase::Prepare, action_deadline);
    if (done) {
      done = host.arm_commit(*transition, RealClock::instance().now() + action_deadline);
    }
    if (done) {
      done = perform(*transition, model::Phase::Commit, action_deadline);
    }
    if (!done) {
      host.withdraw();
      return done;
    }
    if (auto stored = host.commit(); !stored) return stored;
    done = perform(*transition, model::Phase::Retire, action_deadline);
    host.conclude(*transition);
    return done;
  }
  Result<void> perform(const model::Transition& transition, model::Phase phase, Duration action_deadline) {
    for (const auto& action : transition.actions) {
      if (action.phase != phase) {
        continue;
      }
      if (auto done = host.perform(action, RealClock::instance().now() + action_deadline); !done) {
        return done;
      }
    }
    return {};
  }

  [[nodiscard]] std::vector<std::string> wrong() const {
    return model::differences(world.truth(), host.observe());
  }

  FakeWorld& world;
  model::Order order = model::Order::Paper;
  EventRecorder recorded;
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost local{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeProcesses processes{world};
  deploy::testing::FakeService own{world, world.own()};
  DeployedTaskHost host;
};

std::string text(const Result<void>& result) {
  return result ? "done" : to_string(result.error());
}

std::string text(const std::vector<std::string>& sentences) {
  std::string all;
  for (const auto& sentence : sentences) {
    all += sentence + '\n';
  }
  return all;
}

model::Action action(ActionKind kind, decltype(model::Action::what) what) {
  return {1, kind, std::move(what), model::Phase::Commit, {}};
}

model::Action on_process(ActionKind kind, const std::string& name) {
  model::Deployment deployment;
  deployment.process = model::ProcessName(name);
  return action(kind, model::DeploymentAction{deployment});
}

TEST(DeployedTaskHost, SpreadsANetworkOverProcessesAndTakesItBack) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
  EXPECT_EQ(text(robot.wrong()), "");
  EXPECT_EQ(world.find("p1")->tasks.size(), 2U);
  EXPECT_EQ(world.own()->tasks.size(), 1U);
  ASSERT_EQ(text(robot.switch_to(kTwo)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kTwo)));
  ASSERT_EQ(text(robot.switch_to(model::Network{})), "done");
  EXPECT_TRUE(robot.host.observe().empty());
  EXPECT_TRUE(world.running().empty());
  EXPECT_EQ(world.orphaned_endpoints(), 0U);
}

TEST(DeployedTaskHost, AsksEachTaskWhereItLives) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_EQ(robot.host.describe(model::TaskId("a"))->doc, "p1/a");
  EXPECT_EQ(robot.host.describe(model::TaskId("c"))->doc, "p2/c");
  EXPECT_EQ(robot.host.describe(model::TaskId("d"))->doc, "/d");
  EXPECT_EQ(robot.host.details(model::TaskId("c"))->timing.updates.total(), 1U);
  const auto missing = robot.host.properties(model::TaskId("x"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::NotFound);
}

model::Action on_task(ActionKind kind, const char* task) {
  return action(kind, model::TaskAction{model::TaskId(task)});
}

model::Action on_wire(ActionKind kind, const model::Connection& connection) {
  return action(kind, model::ConnectionAction{connection});
}

model::Connection wire(const char* from, const char* to, Policy policy = {}) {
  model::Connection connection;
  connection.from = {model::TaskId(from), "out"};
  connection.to = {model::TaskId(to), "in"};
  connection.policy = policy;
  return connection;
}

/// a -> b -> c with b in p1; b is about to move to p3.
class Move : public ::testing::Test {
 protected:
  Move() {
    EXPECT_EQ(text(robot_.switch_to(kOne)), "done");
    perform(on_process(ActionKind::Deploy, "p3"));
    perform(apply("b", "p3"));
  }

  static model::Action apply(const char* task, const char* process) {
    model::ConfigAction what;
    what.definition = *network_of(kOne).find_task(model::TaskId("b"));
    what.definition.id = model::TaskId(task);
    what.process = {model::kLocalHost, model::ProcessName(process)};
    what.name = task;
    return action(ActionKind::ApplyConfig, what);
  }
  Result<void> try_to(const model::Action& what) { return robot_.host.perform(what, soon()); }
  void perform(const model::Action& what) { EXPECT_EQ(text(try_to(what)), "done") << what.label(); }
  TaskState state_of(const char* task) {
    const auto network = robot_.host.observe();
    const auto* found = network.find_task(model::TaskId(task));
    EXPECT_NE(found, nullptr) << task;
    return found == nullptr ? TaskState::Fatal : found->state;
  }
  bool has(const model::Connection& connection) {
    const auto network = robot_.host.observe();
    return std::find(network.connections.begin(), network.connections.end(), connection) !=
           network.connections.end();
  }
  std::vector<model::TaskId> tasks_of(const char* process) {
    std::vector<model::TaskId> tasks;
    for (const auto& deployment : robot_.host.observe().deployments) {
      for (const auto& placement : deployment.tasks) {
        if (deployment.process.str() == process) tasks.push_back(placement.task);
      }
    }
    return tasks;
  }
  void prepare() {
    perform(on_task(ActionKind::Configure, "b"));
    perform(on_wire(ActionKind::Connect, wire("a", "b")));
    perform(on_wire(ActionKind::Connect, to_c_));
  }
  void commit() {
    perform(on_task(ActionKind::Stop, "b"));
    perform(on_wire(ActionKind::Disconnect, wire("a", "b")));
    perform(on_wire(ActionKind::Disconnect, to_c_));
    perform(on_task(ActionKind::Start, "b"));
    perform(on_task(ActionKind::Cleanup, "b"));
  }

  const model::Connection to_c_ = wire("b", "c", {BufferKind::Buffer, 10, Transport::Automatic, false});
  static constexpr const char* kNew = "b@localhost/p3";
  FakeWorld world_;
  Robot robot_{world_};
};

TEST_F(Move, MakesANewIncarnationBesideTheOneThatRuns) {
  EXPECT_TRUE(robot_.host.side_by_side());
  prepare();
  EXPECT_EQ(state_of("b"), TaskState::Running);
  EXPECT_EQ(state_of(kNew), TaskState::Stopped);
  EXPECT_EQ(tasks_of("p1"), (std::vector<model::TaskId>{model::TaskId("a"), model::TaskId("b")}));
  EXPECT_EQ(tasks_of("p3"), std::vector<model::TaskId>{model::TaskId(kNew)});
  EXPECT_TRUE(has(wire("a", "b")));
  EXPECT_TRUE(has(wire("a", kNew)));
  EXPECT_TRUE(has(to_c_));
  EXPECT_EQ(robot_.host.describe(model::TaskId("b"))->doc, "p1/b");
  EXPECT_EQ(robot_.host.describe(model::TaskId(kNew))->doc, "p3/b");
  commit();
  EXPECT_EQ(state_of("b"), TaskState::PreOperational);
  EXPECT_EQ(state_of(kNew), TaskState::Running);
  EXPECT_FALSE(has(wire("a", "b")));
  EXPECT_TRUE(has(wire("a", kNew)));
  robot_.host.conclude({});
  EXPECT_EQ(state_of("b"), TaskState::Running);
  EXPECT_EQ(tasks_of("p1"), std::vector<model::TaskId>{model::TaskId("a")});
  EXPECT_EQ(tasks_of("p3"), std::vector<model::TaskId>{model::TaskId("b")});
  EXPECT_TRUE(has(wire("a", "b")));
  EXPECT_EQ(robot_.host.observe().tasks.size(), 4U);
  EXPECT_EQ(world_.find("p1")->tasks.size(), 1U);
  EXPECT_EQ(world_.orphaned_endpoints(), 0U);
  EXPECT_EQ(text(robot_.wrong()), "");
}

TEST_F(Move, GivenUpLeavesTheOldOneRunningAndTheNewOneToBeRemoved) {
  prepare();
  robot_.host.withdraw();
  EXPECT_EQ(state_of("b"), TaskState::Running);
  EXPECT_EQ(state_of(kNew), TaskState::Stopped);
  EXPECT_FALSE(try_to(on_task(ActionKind::Start, "b"))) << "it runs";
  EXPECT_EQ(try_to(apply("b", "p3")).error().code, ErrorCode::InvalidState);
  ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot_.host.observe(), network_of(kOne)));
  EXPECT_EQ(world_.find("p3"), nullptr);
  EXPECT_EQ(world_.orphaned_endpoints(), 0U);
  EXPECT_EQ(text(robot_.wrong()), "");
}

TEST_F(Move, TheNewOneIsNotTakenForAnOldOneThatDied) {
  prepare();
  world_.kill(world_.find("p1"));
  EXPECT_TRUE(robot_.recorded.process("p1", "", true));
  EXPECT_EQ(try_to(on_task(ActionKind::Stop, "b")).error().code, ErrorCode::NotFound);
  perform(on_task(ActionKind::Start, "b"));
  EXPECT_EQ(state_of(kNew), TaskState::Running);
  robot_.host.withdraw();
  EXPECT_EQ(state_of("b"), TaskState::Running);
  ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot_.host.observe(), network_of(kOne)));
}

TEST_F(Move, BothEndsOfAConnectionMayMove) {
  perform(apply("a", "p3"));
  for (const char* task : {"a", "b"}) {
    perform(on_task(ActionKind::Configure, task));
  }
  perform(on_wire(ActionKind::Connect, wire("a", "b")));
  EXPECT_TRUE(has(wire("a", "b")));
  EXPECT_TRUE(has(wire("a@localhost/p3", kNew)));
  EXPECT_EQ(world_.find("p3")->connections.size(), 1U) << "within the process";
  perform(on_wire(ActionKind::Disconnect, wire("a", "b")));
  EXPECT_FALSE(has(wire("a", "b")));
  EXPECT_TRUE(has(wire("a@localhost/p3", kNew)));
  perform(on_wire(ActionKind::Disconnect, wire("a@localhost/p3", kNew)));
  EXPECT_FALSE(has(wire("a@localhost/p3", kNew)));
}

TEST_F(Move, HandsItsStateOver) {
  const task::SavedState state{"/test/State", 2, type::Value("what b knows")};
  world_.change([&, p1 = world_.find("p1")] { p1->states[model::TaskId("b")] = state; });
  perform(on_task(ActionKind::Configure, "b"));
  perform(action(ActionKind::HandOver, model::HandOverAction{model::TaskId("b"), model::TaskId("b")}));
  EXPECT_EQ(world_.find("p3")->states.at(model::TaskId("b")), state);
  // c in p2 has no state, and d lives in the runtime's own process.
  perform(action(ActionKind::HandOver, model::HandOverAction{model::TaskId("c"), model::TaskId("d")}));
  EXPECT_TRUE(world_.own()->states.empty());
  const auto alone =
      try_to(action(ActionKind::HandOver, model::HandOverAction{model::TaskId("c"), model::TaskId("c")}));
  EXPECT_EQ(alone.error().code, ErrorCode::InvalidState);
  const auto nobody =
      try_to(action(ActionKind::HandOver, model::HandOverAction{model::TaskId("x"), model::TaskId("b")}));
  EXPECT_EQ(nobody.error().code, ErrorCode::NotFound);
}

TEST_F(Move, EventsTellWhichIncarnationTheyAreOf) {
  world_.tell(world_.find("p3"), {model::TaskId("b"), TaskState::Exception, "new"});
  EXPECT_TRUE(robot_.recorded.task(kNew, TaskState::Exception));
  world_.tell(world_.find("p1"), {model::TaskId("b"), TaskState::Exception, "old"});
  EXPECT_TRUE(robot_.recorded.task("b", TaskState::Exception));
}

TEST(DeployedTaskHost, KillsAProcessWithoutAskingWhatItHolds) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  auto kill = on_process(ActionKind::Undeploy, "p1");
  EXPECT_FALSE(robot.host.perform(kill, soon())) << "its tasks run";
  std::get<model::DeploymentAction>(kill.what).kill = true;
  ASSERT_EQ(text(robot.host.perform(kill, soon())), "done");
  EXPECT_EQ(world.calls("kill"), 1);
  EXPECT_EQ(world.calls("stop"), 0);
  EXPECT_EQ(world.find("p1"), nullptr);
  EXPECT_EQ(world.orphaned_endpoints(), 0U);
  EXPECT_EQ(text(robot.wrong()), "");
}

/// The process crashes just before it was to end, as where a transition is undone since a task could not be
/// configured.
TEST(DeployedTaskHost, SaysWhyAProcessEndedThatEndedJustBeforeItWasToEnd) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  world.find("p2")->crashed_by = SIGABRT;
  ASSERT_EQ(text(robot.switch_to(kTwo)), "done");
  EXPECT_TRUE(robot.recorded.process("p2", "SIGABRT", true));
  EXPECT_EQ(text(robot.wrong()), "");
}

/// Whatever fault happens in whichever call, the host shows the actual state, and the robot can go on
/// switching.
class EveryCall : public ::testing::TestWithParam<FaultKind> {};

TEST_P(EveryCall, MayFailAndTheStateShownIsTrueAndCanBeLeft) {
  bool happened = true;
  int at = 0;
  for (at = 1; happened; ++at) {
    FakeWorld world;
    Robot robot(world);
    world.set_fault({at, GetParam()});
    const Duration deadline = GetParam() == FaultKind::Hang ? Duration(100ms) : Duration(60s);
    (void)robot.switch_to(kOne, deadline);
    (void)robot.switch_to(kTwo, deadline);
    happened = world.fault_happened();
    world.clear_fault();
    ASSERT_EQ(text(robot.wrong()), "") << "after a fault at call " << at;
    ASSERT_EQ(text(robot.switch_to(kTwo)), "done") << "after a fault at call " << at;
    ASSERT_TRUE(equivalent(robot.host.observe(), network_of(kTwo))) << "after a fault at call " << at;
    ASSERT_EQ(text(robot.wrong()), "") << "after a fault at call " << at;
  }
  EXPECT_GT(at, 50);
}

INSTANTIATE_TEST_SUITE_P(DeployedTaskHost, EveryCall,
                         ::testing::Values(FaultKind::Fail, FaultKind::LoseAnswer, FaultKind::Hang,
                                           FaultKind::Die, FaultKind::DieAfterwards));

TEST(DeployedTaskHost, ShowsNewConnectionsFromTheCommitOn) {
  FakeWorld world;
  Robot robot(world);
  robot.order = model::Order::Seamless;
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const model::Network one = robot.host.observe();
  const auto way = solve::diff(one, network_of(kTwo), robot.catalog, {robot.order});
  ASSERT_TRUE(way);
  robot.host.begin_transition(one, network_of(kTwo));
  ASSERT_EQ(text(robot.perform(*way, model::Phase::Prepare, 60s)), "done");
  ASSERT_EQ(text(robot.host.arm_commit(*way, soon())), "done");
  ASSERT_EQ(text(robot.perform(*way, model::Phase::Commit, 60s)), "done");
  const auto has = [](const model::Network& network, const char* from, const char* to) {
    return std::any_of(network.connections.begin(), network.connections.end(), [&](const auto& connection) {
      return connection.from.task.str() == from && task_host::plain_id(connection.to.task).str() == to;
    });
  };
  EXPECT_FALSE(has(robot.host.observe(), "a", "c")) << "dormant";
  ASSERT_TRUE(robot.host.commit());
  EXPECT_TRUE(has(robot.host.observe(), "a", "c"));
}

/// A connection between two processes that a transition is about to end.
class EndingConnection : public ::testing::Test {
 protected:
  EndingConnection() {
    const std::string tasks =
        "network: pair\ntasks: {a: {component: \"t::A\"}, b: {component: \"t::B\"}}\n"
        "deployments: {one: {process: p1, tasks: [a]}, two: {process: p2, tasks: [b]}}\n";
    robot_.order = model::Order::Seamless;
    EXPECT_EQ(text(robot_.switch_to((tasks + "connections: [a.out -> b.in]\n").c_str())), "done");
    const model::Network before = robot_.host.observe();
    const auto without = network_of(tasks);
    way_ = solve::diff(before, without, robot_.catalog, {robot_.order}).value();
    robot_.host.begin_transition(before, without);
  }
  FakeWorld world_;
  Robot robot_{world_};
  model::Transition way_;
};

TEST_F(EndingConnection, CannotEndWhereAProcessWasNotToldOfIt) {
  world_.set_fault({1, FaultKind::Fail});
  EXPECT_THAT(text(robot_.host.arm_commit(way_, soon())), ::testing::HasSubstr("injected"));
}

TEST_F(EndingConnection, NeedsNoAnswerOfAProcessThatEnds) {
  world_.set_fault({1, FaultKind::Die});
  EXPECT_EQ(text(robot_.host.arm_commit(way_, soon())), "done");
  EXPECT_TRUE(world_.fault_happened());
}

/// The transition commits, but is not completed: what it ended is still there, and in the way.
TEST(DeployedTaskHost, MakesConnectionsAgainThatEndedWithACommit) {
  const std::string tasks =
      "network: pair\ntasks: {a: {component: \"t::A\"}, b: {component: \"t::B\"}}\n"
      "deployments: {one: {process: p1, tasks: [a]}, two: {process: p2, tasks: [b]}}\n";
  const auto with = network_of((tasks + "connections: [a.out -> b.in]\n").c_str());
  const auto without = network_of(tasks.c_str());
  FakeWorld world;
  Robot robot(world);
  robot.order = model::Order::Seamless;
  ASSERT_EQ(text(robot.switch_to(with)), "done");
  const model::Network before = robot.host.observe();
  const auto way = solve::diff(before, without, robot.catalog, {robot.order});
  ASSERT_TRUE(way);
  robot.host.begin_transition(before, without);
  ASSERT_EQ(text(robot.host.arm_commit(*way, soon())), "done");
  ASSERT_TRUE(robot.host.commit());
  robot.host.withdraw();
  ASSERT_TRUE(robot.host.observe().connections.empty());
  ASSERT_EQ(text(robot.switch_to(with)), "done");
  EXPECT_EQ(robot.host.observe().connections.size(), 1U);
  EXPECT_EQ(world.orphaned_endpoints(), 0U);
}

TEST(DeployedTaskHost, ReportsAProcessThatEndsByItselfAndItsTasks) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  world.kill(world.find("p1"), 11);
  EXPECT_TRUE(robot.recorded.process("p1", "SIGSEGV", true));
  EXPECT_TRUE(robot.recorded.task("a", TaskState::Fatal));
  EXPECT_TRUE(robot.recorded.task("b", TaskState::Fatal));
  EXPECT_EQ(text(robot.wrong()), "");
  EXPECT_EQ(robot.host.tasks().size(), 2U);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne)));
}

TEST(DeployedTaskHost, ShowsAHungProcessAsFatalAndReplacesIt) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto hung = world.find("p2");
  world.change([&] { hung->hangs = true; });
  EXPECT_EQ(text(robot.wrong()), "");
  EXPECT_TRUE(robot.recorded.process("p2", "does not answer", false));
  EXPECT_TRUE(robot.recorded.task("c", TaskState::Fatal));
  const auto reports = robot.host.tasks();
  const auto c = std::find_if(reports.begin(), reports.end(),
                              [](const auto& report) { return report.id == model::TaskId("c"); });
  ASSERT_NE(c, reports.end());
  EXPECT_EQ(c->state, TaskState::Fatal);
  EXPECT_EQ(c->state_name, "fatal");
  EXPECT_NE(c->error.find("does not answer"), std::string::npos);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_NE(world.find("p2"), hung);
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

TEST(DeployedTaskHost, AsksAProcessThatDoesNotAnswerForNothingAboutItsTasks) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto hung = world.find("p2");
  world.change([&] { hung->hangs = true; });
  EXPECT_EQ(text(robot.wrong()), "");
  std::atomic<int> asked{0};
  world.on_call([&](const std::string& what, const FakePtr& process) {
    if (process == hung && what != "snapshot") ++asked;
  });
  const model::TaskId c("c");
  const auto expect_refused = [](const auto& answer) {
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, ErrorCode::Unavailable);
    EXPECT_THAT(answer.error().message,
                ::testing::HasSubstr("process 'localhost/p2' (pid 102) does not answer"));
  };
  expect_refused(robot.host.properties(c));
  expect_refused(robot.host.describe(c));
  expect_refused(robot.host.details(c));
  expect_refused(robot.host.set_property(c, "gain", 1, soon()));
  expect_refused(robot.host.call(c, "reset", {}, soon()));
  expect_refused(robot.host.write({c, "in"}, 1, soon()));
  expect_refused(robot.host.open_reader({c, "out"}, 1));
  world.on_call(nullptr);
  EXPECT_EQ(asked, 0);
}

/// Actions that a process does not end: what it was asked for is held up, and then it stops answering.
// It is only busy, and nothing could replace it.
TEST(DeployedTaskHost, LeavesTasksAsTheyWereWhereTheRuntimesOwnProcessDoesNotAnswer) {
  FakeWorld world;
  Robot robot(world, {20ms, 1h});
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
  std::promise<void> answers;
  const auto answered = answers.get_future().share();
  world.on_call([&](const std::string& what, const FakePtr& process) {
    if (what == "snapshot" && process == world.own()) answered.wait();
  });
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
  EXPECT_TRUE(robot.recorded.process("", "too busy to answer", false));
  answers.set_value();
  EXPECT_TRUE(robot.recorded.process("", "answers again", false));
  EXPECT_FALSE(robot.recorded.has_seen("d", TaskState::Fatal));
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

class SilentDuringActions : public ::testing::Test {
 protected:
  SilentDuringActions() { EXPECT_EQ(text(robot_.switch_to(kOne)), "done"); }
  /// How the action ends, although p2 never answers to `call`.
  Result<void> outcome_of(const model::Action& what, const std::string& call) {
    std::latch asked(1);
    const auto p2 = world_.find("p2");
    world_.on_call([&asked, call, p2, this](const std::string& made, const FakePtr& process) {
      if (made == call && process == p2 && !held_.exchange(true)) {
        asked.count_down();
        over_.wait();
      }
    });
    std::promise<Result<void>> ended;
    auto outcome = ended.get_future();
    std::thread begin([&] {
      robot_.host.begin_all({what}, soon(), [&](std::vector<task_host::Completed> all) {
        ended.set_value(std::move(all.front().outcome));
      });
    });
    asked.wait();
    world_.change([&] { p2->hangs = true; });
    EXPECT_EQ(text(robot_.wrong()), "");
    const bool in_time = outcome.wait_for(30s) == std::future_status::ready;
    EXPECT_TRUE(in_time) << "before the process was heard of again";
    over_.count_down();
    begin.join();
    return outcome.get();
  }

  std::atomic<bool> held_{false};
  std::latch over_{1};  ///< the call goes on after its action has been reported
  FakeWorld world_;
  Robot robot_{world_};
};

TEST_F(SilentDuringActions, FailsWhatAProcessDoesThatStopsAnswering) {
  EXPECT_THAT(text(outcome_of(on_task(ActionKind::Stop, "c"), "perform")),
              ::testing::HasSubstr("process 'localhost/p2' (pid 102) does not answer"));
}

TEST_F(SilentDuringActions, FailsConnectionsOfAProcessThatStopsAnswering) {
  const auto to_c = network_of(kOne).connections.at(1);
  EXPECT_THAT(text(outcome_of(on_wire(ActionKind::Disconnect, to_c), "close_endpoints")),
              ::testing::HasSubstr("does not answer"));
}

TEST(DeployedTaskHost, TakesAProcessBackThatAnswersAgain) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto hung = world.find("p2");
  world.change([&] { hung->hangs = true; });
  EXPECT_EQ(text(robot.wrong()), "");
  world.change([&] { hung->hangs = false; });
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
  EXPECT_TRUE(robot.recorded.process("p2", "answers again", false));
  EXPECT_TRUE(robot.recorded.task("c", TaskState::Running));
}

TEST(DeployedTaskHost, ReplacesTheProcessOfATaskWhoseHookHangs) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto before = world.find("p1");
  world.change([&] { before->hanging.insert(model::TaskId("a")); });
  EXPECT_EQ(text(robot.wrong()), "");
  EXPECT_TRUE(robot.recorded.task("a", TaskState::Fatal));
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_NE(world.find("p1"), before);
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

TEST(DeployedTaskHost, DoesNotWaitForAProcessBeyondItsPatience) {
  FakeWorld world;
  Robot robot(world, {100ms, 1h});
  ASSERT_EQ(text(robot.host.perform(on_process(ActionKind::Deploy, "p1"), soon())), "done");
  std::promise<void> released;
  const auto held = released.get_future().share();
  world.on_call([&](const std::string& what, const FakePtr& process) {
    if (what == "snapshot" && process == world.find("p1")) {
      held.wait();
    }
  });
  const model::Network seen = robot.host.observe();
  ASSERT_EQ(seen.deployments.size(), 1U);
  EXPECT_EQ(seen.deployments[0].deployer, "unknown");
  released.set_value();
  EXPECT_TRUE(robot.recorded.process("p1", "answers again", false));
  EXPECT_EQ(robot.host.observe().deployments.at(0).deployer, "segue");
}

TEST(DeployedTaskHost, ReconnectsToAProcessWhoseConnectionBroke) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const int connected = world.calls("connect_deployment");
  const auto process = world.find("p1");
  // Its service answers as without a connection until there is a new one.
  world.change([&] { process->alive = false; });
  world.on_call([&](const std::string& what, const FakePtr&) {
    if (what == "connect_deployment") {
      world.change([&] { process->alive = true; });
    }
  });
  world.cut(process);
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne)));
  EXPECT_GT(world.calls("connect_deployment"), connected);
  EXPECT_EQ(world.find("p1"), process);
}

TEST(DeployedTaskHost, PassesOnEventsOfTasks) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  world.tell(world.find("p2"), {model::TaskId("c"), TaskState::Exception, "out of scans"});
  EXPECT_TRUE(robot.recorded.task("c", TaskState::Exception));
}

TEST(DeployedTaskHost, AdoptsWhatRuns) {
  FakeWorld world;
  {
    Robot robot(world);
    ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  }
  ASSERT_EQ(world.running().size(), 2U);
  // The tasks of the former runtime's own process, and its incarnation, are gone.
  world.change([&] {
    *world.own() = deploy::testing::FakeProcess{};
    world.own()->incarnation = 2000;
  });
  const auto p1 = world.find("p1");
  Robot robot(world);
  EXPECT_TRUE(robot.recorded.process("p1", "taken over", false));
  EXPECT_EQ(text(robot.wrong()), "");
  EXPECT_EQ(world.orphaned_endpoints(), 0U) << "endpoints with the dead runtime are forgotten";
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_EQ(world.find("p1"), p1) << "nothing was restarted";
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

TEST(DeployedTaskHost, AdoptsAProcessThatDoesNotAnswerAsOneToBeReplaced) {
  FakeWorld world;
  const auto hung = world.add_running("p1");
  world.change([&] { hung->hangs = true; });
  Robot robot(world);
  ASSERT_EQ(robot.host.observe().deployments.size(), 1U);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_NE(world.find("p1"), hung);
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

TEST(DeployedTaskHost, ReportsProcessesOfAnotherVersionAndTakesTheirNames) {
  FakeWorld world;
  world.change([other = world.add_running("p1")] { other->other_version = true; });
  Robot robot(world);
  EXPECT_TRUE(robot.recorded.process("p1", "version 0.0.9", false));
  EXPECT_TRUE(robot.host.observe().deployments.empty());
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne))) << text(robot.wrong());
}

TEST(DeployedTaskHost, SaysWhyAProcessEndedWhileItStarted) {
  FakeWorld world;
  Robot robot(world);
  world.next_dies_at_once();
  const auto deployed = robot.host.perform(on_process(ActionKind::Deploy, "p1"), soon());
  ASSERT_FALSE(deployed);
  EXPECT_NE(deployed.error().message.find("SIGSEGV"), std::string::npos) << to_string(deployed.error());
  EXPECT_TRUE(robot.host.observe().deployments.empty());
  EXPECT_EQ(text(robot.host.perform(on_process(ActionKind::Deploy, "p1"), soon())), "done");
}

TEST(DeployedTaskHost, RefusesToUndeployWhatHoldsConfiguredTasks) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto refused = robot.host.perform(on_process(ActionKind::Undeploy, "p2"), soon());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_NE(refused.error().message.find("'c'"), std::string::npos);
  EXPECT_NE(world.find("p2"), nullptr);
}

TEST(DeployedTaskHost, RefusesLinksThatCannotCarryAConnectionBetweenProcesses) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  model::Connection connection;
  connection.from = {model::TaskId("a"), "other"};
  connection.to = {model::TaskId("c"), "other"};
  connection.policy.transport = Transport::Local;
  const auto local =
      robot.host.perform(action(ActionKind::Connect, model::ConnectionAction{connection}), soon());
  ASSERT_FALSE(local);
  EXPECT_NE(local.error().message.find("needs both tasks in one process"), std::string::npos);
  connection.policy.transport = Transport::Dds;
  const auto dds =
      robot.host.perform(action(ActionKind::Connect, model::ConnectionAction{connection}), soon());
  ASSERT_FALSE(dds);
  EXPECT_EQ(dds.error().code, ErrorCode::Unsupported);
  EXPECT_EQ(text(robot.wrong()), "");
}

TEST(DeployedTaskHost, FindsBeforehandWhatCannotRunHere) {
  FakeWorld world;
  const Robot robot(world);
  EXPECT_TRUE(robot.host.check(network_of(kOne)).empty());
  const auto findings = robot.host.check(network_of(R"(network: elsewhere
tasks: {a: {component: test::A}, b: {component: test::B}, c: {component: test::C}}
deployments:
  p1: {process: p1, tasks: [a]}
  p2: {process: p2, host: base, tasks: [b]}
connections:
  - {from: a.out, to: c.in, link: local}
)"));
  ASSERT_EQ(findings.items().size(), 2U) << to_string(findings);
  EXPECT_EQ(findings.items()[0].code, "other-host");
  EXPECT_EQ(findings.items()[1].code, "link");
  EXPECT_NE(findings.items()[1].message.find("'c' lives in the runtime's own process"), std::string::npos);
}

TEST(DeployedTaskHost, NeedsOneMessageForEachProcessAndThreeForAllConnections) {
  FakeWorld world;
  Robot robot(world);
  for (const char* name : {"p1", "p2"}) {
    ASSERT_EQ(text(robot.host.perform(on_process(ActionKind::Deploy, name), soon())), "done");
  }
  std::vector<model::Action> tasks;
  std::vector<model::Action> wires;
  for (int i = 0; i < 20; ++i) {
    model::ConfigAction config;
    config.definition.id = model::TaskId("t" + std::to_string(i));
    config.name = config.definition.id.str();
    config.process = {model::kLocalHost, model::ProcessName(i % 2 == 0 ? "p1" : "p2")};
    tasks.push_back(action(ActionKind::ApplyConfig, config));
    model::Connection connection;
    connection.from = {config.definition.id, "out"};
    connection.to = {model::TaskId("t" + std::to_string((i + 1) % 20)), "in"};
    wires.push_back(action(ActionKind::Connect, model::ConnectionAction{connection}));
  }
  for (const auto& outcome : robot.host.perform_all(tasks, soon())) {
    EXPECT_EQ(text(outcome), "done");
  }
  EXPECT_EQ(world.calls("perform"), 2);
  for (const auto& outcome : robot.host.perform_all(wires, soon())) {
    EXPECT_EQ(text(outcome), "done");
  }
  for (const char* round : {"memory", "admit", "describe_outputs", "open_inputs", "attach_outputs"}) {
    EXPECT_EQ(world.calls(round), 2) << round;
  }
  EXPECT_EQ(robot.host.observe().connections.size(), 20U);
}

/// Counts the calls that are in a process at the same time: holds them until there are more than `most`, or
/// for a moment.
class Crowd {
 public:
  explicit Crowd(std::size_t most) : most_(most) {}
  void enter() {
    Lock lock(mutex_);
    ++inside_;
    changed_.notify_all();
    changed_.wait_for(mutex_, 300ms, [this] { return inside_ > most_ || over_; });
    over_ = true;  // one moment is enough
    crowded_ = crowded_ || inside_ > most_;
    changed_.notify_all();
    --inside_;
  }
  [[nodiscard]] bool crowded() {
    const Lock lock(mutex_);
    return crowded_;
  }

 private:
  const std::size_t most_;
  Mutex mutex_;
  ConditionVariable changed_;
  std::size_t inside_ = 0;
  bool over_ = false;
  bool crowded_ = false;
};

TEST(DeployedTaskHost, AsksAProcessAboutFewOfItsManyConnectionsAtATime) {
  constexpr int kReaders = 40;
  std::string text = "network: star\ntasks:\n  hub: {component: test::A}\n";
  std::string processes = "deployments:\n  hub: {tasks: [hub]}\n";
  for (int i = 0; i < kReaders; ++i) {
    const std::string reader = "r" + std::to_string(i);
    text += "  " + reader + ": {component: test::B}\n";
    processes += "  " + reader + ": {tasks: [" + reader + "]}\n";
  }
  FakeWorld world;
  Robot robot(world);
  ASSERT_TRUE(robot.switch_to(network_of(text + processes)));
  Crowd crowd(detail::ConnectionTurn::kMost);
  world.on_call([&](const std::string& what, const FakePtr& process) {
    const bool about_connections = what == "admit" || what == "describe_outputs" || what == "attach_outputs";
    if (about_connections && process->info.key.process.str() == "hub") crowd.enter();
  });
  std::latch connected(kReaders);
  for (int i = 0; i < kReaders; ++i) {
    model::Action connect;
    connect.kind = ActionKind::Connect;
    connect.what = model::ConnectionAction{
        {{model::TaskId("hub"), "out"}, {model::TaskId("r" + std::to_string(i)), "in"}, {}, {}}};
    robot.host.begin_all({connect}, soon(), [&](const std::vector<task_host::Completed>& completed) {
      for (const auto& one : completed) {
        EXPECT_TRUE(one.outcome) << to_string(one.outcome.error());
        connected.count_down();
      }
    });
  }
  connected.wait();
  EXPECT_FALSE(crowd.crowded());
  world.on_call({});
}

TEST(DeployedTaskHost, OpensAnInputAgainWhereTheOutputHasNoType) {
  FakeWorld world;
  Robot robot(world);
  model::Network target = network_of(kOne);
  target.connections.at(1).from.port = deploy::testing::kPortWithoutType;
  ASSERT_EQ(text(robot.switch_to(target)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), target)) << text(robot.wrong());
  const int opened = world.calls("open_inputs");
  EXPECT_EQ(opened, world.calls("describe_outputs") + 1);
  EXPECT_EQ(world.calls("close_endpoints"), 1);
}

TEST(DeployedTaskHost, MapsPeersBeforeTheyAreConnected) {
  FakeWorld world;
  Robot robot(world);
  const model::Network target = network_of(kOne);
  robot.host.get_ready(target);
  EXPECT_EQ(world.calls("memory"), 0) << "none of them is there";
  for (const char* name : {"p1", "p2"}) {
    ASSERT_EQ(text(robot.host.perform(on_process(ActionKind::Deploy, name), soon())), "done");
  }
  robot.host.get_ready(target);
  const int offers = world.calls("memory");
  const int admissions = world.calls("admit");
  EXPECT_GE(offers, 2);
  EXPECT_EQ(world.calls("open_inputs"), 0) << "what runs is not changed";
  ASSERT_EQ(text(robot.switch_to(target)), "done");
  EXPECT_EQ(world.calls("memory"), offers);
  EXPECT_EQ(world.calls("admit"), admissions);
}

TEST(DeployedTaskHost, CarriesOutTheOthersWhereOneFails) {
  FakeWorld world;
  Robot robot(world);
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const auto on = [](ActionKind kind, const char* task) {
    return action(kind, model::TaskAction{model::TaskId(task)});
  };
  const std::vector<model::Action> actions = {on(ActionKind::Start, "a"), on(ActionKind::Stop, "b"),
                                              on(ActionKind::Stop, "nobody"), on(ActionKind::Stop, "c")};
  const auto outcomes = robot.host.perform_all(actions, soon());
  EXPECT_FALSE(outcomes[0]);
  EXPECT_EQ(text(outcomes[1]), "done");
  EXPECT_FALSE(outcomes[2]);
  EXPECT_EQ(text(outcomes[3]), "done");
  EXPECT_EQ(text(robot.wrong()), "");
}

TEST(DeployedTaskHost, RemovesEndpointsThatADeadProcessLeft) {
  FakeWorld world;
  Robot robot(world, {60s, 10ms});
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  // The writer's endpoint of b.out -> c.in is gone, the reader's is still there.
  const auto p1 = world.find("p1");
  world.change([&] {
    std::erase_if(p1->endpoints, [](const deploy::EndpointReport& endpoint) {
      return endpoint.side == deploy::Side::Output;
    });
  });
  EXPECT_TRUE(eventually([&] { return world.orphaned_endpoints() == 0; }));
  EXPECT_EQ(text(robot.wrong()), "");
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kOne)));
}

TEST(DeployedTaskHost, MakesADamagedConnectionAgain) {
  FakeWorld world;
  for (const char* process : {"p1", "p2"}) {
    Robot robot(world);
    ASSERT_EQ(text(robot.switch_to(kOne)), "done");
    const model::Network whole = network_of(kOne);
    const auto damage = world.find(process);
    const auto between = [&](const deploy::EndpointReport& endpoint) {
      return endpoint.connection == whole.connections[1];  // b in p1 to c in p2
    };
    world.change([&] {
      const auto found = std::find_if(damage->endpoints.begin(), damage->endpoints.end(), between);
      ASSERT_NE(found, damage->endpoints.end());
      found->damage = sample_link::Damage::Ring;
      found->corrupt = 3;
    });
    auto broken = whole;
    broken.connections.erase(broken.connections.begin() + 1);
    EXPECT_TRUE(equivalent(robot.host.observe(), broken)) << "with an endpoint damaged in " << process;
    EXPECT_EQ(text(robot.switch_to(kOne)), "done");
    EXPECT_TRUE(equivalent(robot.host.observe(), whole)) << "with an endpoint damaged in " << process;
    EXPECT_EQ(world.orphaned_endpoints(), 0U);
  }
}

/// An endpoint of process `process` on the way from p1 to p2 (b.out -> c.in) finds damage.
class Overwritten : public ::testing::Test {
 protected:
  Overwritten() { EXPECT_EQ(text(robot_.switch_to(kOne)), "done"); }
  void damage(const char* process, sample_link::Damage what) {
    const auto found = world_.find(process);
    world_.change([&] {
      for (auto& endpoint : found->endpoints) {
        if (endpoint.connection == to_c_) endpoint.damage = what;
      }
    });
  }
  std::string error() {
    for (const auto& report : robot_.host.connections()) {
      if (report.connection == to_c_) return report.error;
    }
    return "there is no such connection";
  }
  TaskState state_of(const char* task) { return robot_.host.observe().find_task(model::TaskId(task))->state; }

  const model::Connection to_c_ = network_of(kOne).connections.at(1);
  FakeWorld world_;
  Robot robot_{world_};
};

TEST_F(Overwritten, ASampleIsLaidToItsWriter) {
  damage("p2", sample_link::Damage::Payload);
  EXPECT_THAT(error(), ::testing::HasSubstr("was overwritten by process 'localhost/p1';"));
}

TEST_F(Overwritten, ARingIsLaidToAllThatSharedIt) {
  damage("p1", sample_link::Damage::Ring);
  EXPECT_THAT(error(), ::testing::HasSubstr("one of the processes 'localhost/p1', 'localhost/p2' and "
                                            "the runtime's own;"));
}

TEST_F(Overwritten, IsToldUntilTheConnectionIsMadeAgain) {
  damage("p1", sample_link::Damage::Ring);
  EXPECT_THAT(error(), ::testing::HasSubstr("was overwritten"));
  for (const char* process : {"p1", "p2"}) {
    const auto found = world_.find(process);
    world_.change([&] {
      std::erase_if(found->endpoints, [&](const auto& endpoint) { return endpoint.connection == to_c_; });
    });
  }
  EXPECT_THAT(error(), ::testing::HasSubstr("was overwritten"));
  ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
  EXPECT_EQ(error(), "");
}

TEST_F(Overwritten, AgainAndAgainByOneProcessHasThatReplaced) {
  const auto before = world_.find("p1");
  for (int time = 1; time <= 3; ++time) {
    EXPECT_EQ(state_of("b"), TaskState::Running) << time;
    damage("p2", sample_link::Damage::Payload);
    EXPECT_THAT(error(), ::testing::HasSubstr("was overwritten"));
    if (time < 3) {
      ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
    }
  }
  EXPECT_EQ(state_of("b"), TaskState::Fatal);
  EXPECT_TRUE(robot_.recorded.process("p1", "has overwritten shared memory of 3 connections", false));
  ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
  EXPECT_NE(world_.find("p1"), before);
  EXPECT_TRUE(equivalent(robot_.host.observe(), network_of(kOne))) << text(robot_.wrong());
}

TEST_F(Overwritten, AgainAndAgainByOneOfSeveralProcessesHasNoneReplaced) {
  for (int time = 1; time <= 4; ++time) {
    damage("p2", sample_link::Damage::Ring);
    EXPECT_THAT(error(), ::testing::HasSubstr("was overwritten"));
    ASSERT_EQ(text(robot_.switch_to(kOne)), "done");
  }
  EXPECT_EQ(state_of("b"), TaskState::Running);
  EXPECT_EQ(state_of("c"), TaskState::Running);
}

TEST(DeployedTaskHost, ConnectsOthersWhileAProcessDoesNotAnswer) {
  FakeWorld world;
  Robot robot(world, {60s, 10ms});  // orphaned endpoints are looked for all the time
  ASSERT_EQ(text(robot.switch_to(kOne)), "done");
  const model::Network one = network_of(kOne);
  const auto on = [&](ActionKind kind, std::size_t connection) {
    return action(kind, model::ConnectionAction{one.connections.at(connection)});
  };
  std::latch silent(1);
  std::latch answers(1);
  std::atomic<bool> held{false};
  world.on_call([&](const std::string& what, const FakePtr& process) {
    if (what == "describe_outputs" && process == world.find("p1") && !held.exchange(true)) {
      silent.count_down();
      answers.wait();
    }
  });
  ASSERT_EQ(text(robot.host.perform(on(ActionKind::Disconnect, 1), soon())), "done");
  std::thread slow([&] { EXPECT_EQ(text(robot.host.perform(on(ActionKind::Connect, 1), soon())), "done"); });
  silent.wait();
  EXPECT_EQ(text(robot.host.perform(on(ActionKind::Disconnect, 2), soon())), "done");
  EXPECT_EQ(text(robot.host.perform(on(ActionKind::Connect, 2), soon())), "done");
  const auto same = robot.host.perform(on(ActionKind::Connect, 1), RealClock::instance().now() + 10ms);
  EXPECT_THAT(text(same), ::testing::HasSubstr("the same connections are still being made or ended"));
  answers.count_down();
  slow.join();
  EXPECT_TRUE(equivalent(robot.host.observe(), one)) << text(robot.wrong());
}

TEST(DeployedTaskHost, CanBeObservedByManyThreadsWhileItSwitches) {
  FakeWorld world;
  Robot robot(world, {60s, 1ms});
  std::atomic<bool> done{false};
  std::vector<std::thread> lookers;
  for (int i = 0; i < 3; ++i) {
    lookers.emplace_back([&] {
      while (!done) {
        (void)robot.host.observe();
        (void)robot.host.tasks();
        (void)robot.host.connections();
      }
    });
  }
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(text(robot.switch_to(i % 2 == 0 ? kOne : kTwo)), "done");
  }
  done = true;
  for (auto& looker : lookers) {
    looker.join();
  }
  EXPECT_TRUE(equivalent(robot.host.observe(), network_of(kTwo)));
}

}  // namespace
}  // namespace segue::fleet
