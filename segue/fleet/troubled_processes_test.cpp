// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/test_support.hpp>

namespace segue::fleet {
namespace {

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

}  // namespace
}  // namespace segue::fleet
