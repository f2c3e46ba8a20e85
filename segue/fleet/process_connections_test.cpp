// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/test_support.hpp>

namespace segue::fleet {
namespace {

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

}  // namespace
}  // namespace segue::fleet
