// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/test_support.hpp>

namespace segue::fleet {
namespace {

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
