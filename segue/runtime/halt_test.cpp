// SPDX-License-Identifier: Apache-2.0
//
// Robots that are brought to rest: by whoever stops them, by the end of a lease, by a condition; at every
// action of a transition.
#include <segue/model/network_sets.hpp>
#include <segue/runtime/condition_watch.hpp>
#include <segue/runtime/halting_robot.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <set>
#include <string>
#include <vector>

namespace segue::runtime {
namespace {

using model::HaltCondition;
using model::NetworkName;
using model::TaskReaches;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::hold;
using ::testing::IsEmpty;
using testing::network_of;
using testing::with;
using Robot = testing::HaltingRobot;

TEST(Halt, IsPreparedBesideWhateverRunsWithoutARequest) {
  Robot robot;
  EXPECT_TRUE(segue::testing::eventually([&] {
    const auto observed = robot.host.observe();
    const auto* brake = observed.find_task(model::TaskId("brake"));
    return brake != nullptr && brake->state == TaskState::Stopped;
  }));
  EXPECT_THAT(robot.runtime.readiness(), IsEmpty()) << "nobody has asked for it";
}

TEST(Halt, BringsTheRobotToRestAndKeepsItThereUntilItIsReleased) {
  Robot robot;
  const auto rest = robot.runtime.halt({.who = "ann", .latch = true}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, IsEmpty());
  EXPECT_EQ(robot.running(), "hold");
  EXPECT_TRUE(robot.runtime.halted()->result->at_rest);
  EXPECT_EQ(robot.runtime.halted()->stopped_by, "ann");
  const auto refused = robot.switch_to("drive");
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_THAT(refused.why(), HasSubstr("stopped by ann; 'segue stop --release' lets it be commanded again"));
  EXPECT_EQ(robot.runtime.served().take_lease("bob").error().code, ErrorCode::InvalidState);
  RequestOptions forced;
  forced.take_over = true;
  EXPECT_EQ(robot.switch_to("drive", forced).outcome, Outcome::Refused) << "nor is it taken over";
  EXPECT_EQ(robot.running(), "hold");
  ASSERT_TRUE(robot.runtime.release("bob"));
  EXPECT_EQ(robot.runtime.release("bob").error().code, ErrorCode::InvalidState);
  EXPECT_EQ(robot.switch_to("drive").outcome, Outcome::Done);
  EXPECT_FALSE(robot.runtime.halted()) << "it has been commanded since";
}

TEST(Halt, FollowsALeaseThatEndsUnlessWhatRunsShallBeKept) {
  Robot robot;
  const auto kept = robot.runtime.served().take_lease("mission a").value();
  EXPECT_FALSE(robot.runtime.served().end_lease(kept, true).valid());
  EXPECT_EQ(robot.running(), "drive");
  const auto lost = robot.runtime.served().take_lease("mission b").value();
  const auto rest = robot.runtime.served().end_lease(lost);
  ASSERT_TRUE(rest.valid());
  EXPECT_TRUE(rest.get().at_rest);
  EXPECT_EQ(robot.running(), "hold");
  EXPECT_EQ(robot.runtime.halted()->request.who, "mission b");
  EXPECT_EQ(robot.switch_to("work").outcome, Outcome::Done) << "nothing holds the robot afterwards";
}

type::Value doing(const char* state, const char* at_stop) {
  return type::Value::map({{"mission", "patrol"}, {"state", state}, {"at_stop", at_stop}});
}

TEST(Halt, FollowsAtOnceWhereAMissionIsStoppedThatThenCommandsNothingAnyMore) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  ASSERT_TRUE(robot.runtime.served().report(lease, doing("running", "halt")));
  ASSERT_TRUE(robot.runtime.served().send_command("stop"));
  EXPECT_TRUE(robot.runtime.served().halt_on_its_way().get().at_rest)
      << "although the mission has heard nothing yet";
  EXPECT_EQ(robot.running(), "hold");
  EXPECT_EQ(robot.runtime.halted()->request.why, "its mission is stopped");
  EXPECT_EQ(robot.runtime.served().lease_standing(lease), (control::LeaseStanding{std::nullopt, true}));
  RequestOptions theirs;
  theirs.lease = lease;
  EXPECT_THAT(robot.switch_to("drive", theirs).why(), HasSubstr("the mission is being stopped"));
  EXPECT_EQ(robot.runtime.served().allow({.who = "mission a", .lease = lease}, "sets 'x.y'").error().code,
            ErrorCode::Cancelled);
  EXPECT_EQ(robot.runtime.served().lease_refusal(lease)->code, ErrorCode::Cancelled);
  EXPECT_EQ(robot.runtime.served().take_commands(lease).at(0).what, "stop");
  EXPECT_TRUE(robot.runtime.served().report(lease, doing("stopping", "halt"))) << "it says how it ends";
  EXPECT_TRUE(robot.runtime.served().end_lease(lease).get().at_rest) << "of the same halt";
  EXPECT_EQ(robot.switch_to("drive").outcome, Outcome::Done) << "nothing holds the robot afterwards";
}

TEST(Halt, FollowsAtOnceWhereAMissionSaysThatItIsStopping) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  ASSERT_TRUE(robot.runtime.served().report(lease, doing("stopping", "halt")));
  EXPECT_TRUE(robot.runtime.served().halt_on_its_way().get().at_rest);
  EXPECT_EQ(robot.running(), "hold");
}

TEST(Halt, DoesNotFollowBeforeAMissionHasDoneWhatItDoesWhenItIsStopped) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  ASSERT_TRUE(robot.runtime.served().report(lease, doing("running", "go_on")));
  ASSERT_TRUE(robot.runtime.served().send_command("stop"));
  ASSERT_TRUE(robot.runtime.served().report(lease, doing("stopping", "go_on")));
  RequestOptions theirs;
  theirs.lease = lease;
  EXPECT_EQ(robot.switch_to("work", theirs).outcome, Outcome::Done);
  EXPECT_FALSE(robot.runtime.halted());
  EXPECT_TRUE(robot.runtime.served().end_lease(lease).get().at_rest);
  EXPECT_EQ(robot.running(), "hold");
}

TEST(Halt, TakesTheRobotFromAMissionThatIsStoppedAndDoesNotEnd) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  ASSERT_TRUE(robot.runtime.served().report(lease, doing("running", "halt")));
  ASSERT_TRUE(robot.runtime.served().send_command("stop"));
  EXPECT_THAT(robot.switch_to("drive").error->message,
              ::testing::AnyOf(HasSubstr("halted by mission a"), HasSubstr("commanded by mission a")));
  EXPECT_TRUE(robot.runtime.halt({.who = "ann"}).get().at_rest);
  EXPECT_THAT(robot.runtime.served().lease_standing(lease).lost_to, ::testing::Optional(HasSubstr("ann")));
  EXPECT_FALSE(robot.runtime.served().end_lease(lease).valid());
  EXPECT_EQ(robot.switch_to("drive").outcome, Outcome::Done);
}

TEST(Halt, DoesNotFollowALeaseThatWasTakenOver) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  RequestOptions options;
  options.take_over = true;
  EXPECT_EQ(robot.switch_to("work", options).outcome, Outcome::Done);
  EXPECT_FALSE(robot.runtime.served().end_lease(lease).valid());
  EXPECT_EQ(robot.running(), "work");
}

TEST(Halt, TakesTheRobotFromWhoeverCommandsIt) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  EXPECT_TRUE(robot.runtime.halt({.who = "ann"}).get().at_rest);
  EXPECT_THAT(robot.runtime.served().lease_standing(lease).lost_to, ::testing::Optional(HasSubstr("ann")));
  RequestOptions theirs;
  theirs.lease = lease;
  EXPECT_EQ(robot.switch_to("work", theirs).outcome, Outcome::Refused);
  EXPECT_EQ(robot.running(), "hold");
}

TEST(Halt, ThatIsUnderWayWhenSomebodyStopsTheRobotLeavesItStopped) {
  Robot robot;
  std::atomic<bool> stopped = false;
  robot.asking.ask([&](const model::Action&) -> Result<void> {
    if (!stopped.exchange(true)) robot.runtime.halt({.who = "ann", .latch = true});
    return {};
  });
  EXPECT_TRUE(robot.runtime.halt({.who = "a mission"}).get().at_rest);
  robot.asking.ask({});
  ASSERT_TRUE(stopped) << "the halt takes actions";
  EXPECT_EQ(robot.switch_to("work").outcome, Outcome::Refused);
  EXPECT_TRUE(robot.runtime.release("ann"));
}

TEST(Halt, OfARobotThatDoesNotSayWhatRestIsStopsItsDevices) {
  Robot robot{RuntimeOptions{}};
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, ElementsAre(model::TaskId("wheels")));
  EXPECT_EQ(robot.host.observe().find_task(model::TaskId("wheels"))->state, TaskState::Stopped);
  EXPECT_EQ(robot.host.observe().find_task(model::TaskId("planner"))->state, TaskState::Running);
}

TEST(Halt, ThatDoesNotLeadToRestInTimeStopsDevicesAndSaysWhatIsMissing) {
  auto halt = hold({{TaskReaches{"wheels", "idle"}, {}}});
  halt.within = std::chrono::milliseconds(300);
  Robot robot(with(std::move(halt)));
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_FALSE(rest.at_rest);
  EXPECT_THAT(rest.trouble, HasSubstr("it does not hold that task 'wheels' is idle"));
  EXPECT_THAT(rest.stopped, ElementsAre(model::TaskId("wheels")));
  EXPECT_EQ(robot.host.observe().find_task(model::TaskId("wheels"))->state, TaskState::Stopped);
}

TEST(Halt, NamesNoDeviceAsStoppedThatCouldNotBe) {
  auto halt = hold({{TaskReaches{"wheels", "idle"}, {}}});
  halt.within = std::chrono::milliseconds(300);
  Robot robot(with(std::move(halt)));
  robot.asking.ask([](const model::Action& action) -> Result<void> {
    if (action.kind != model::ActionKind::Stop) return {};
    return fail(ErrorCode::HookFailed, "the wheels turn on");
  });
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_FALSE(rest.at_rest);
  EXPECT_THAT(rest.trouble, HasSubstr("its devices could not be stopped: "));
  EXPECT_THAT(rest.trouble, HasSubstr("the wheels turn on"));
  EXPECT_THAT(rest.stopped, IsEmpty());
  robot.asking.ask({});
}

TEST(Halt, ComesWhenItsConditionHoldsAndHoldsTheRobotAsLong) {
  auto halt = hold();
  halt.when = {{TaskReaches{"planner", "stopped"}, {}}};
  Robot robot(with(std::move(halt)));
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  model::Action stop{
      1, model::ActionKind::Stop, model::TaskAction{model::TaskId("planner")}, model::Phase::Commit, {}};
  ASSERT_TRUE(robot.host.perform(stop, RealClock::instance().now() + std::chrono::seconds(60)));
  ASSERT_TRUE(segue::testing::eventually([&] { return robot.running() == "hold"; }));
  EXPECT_THAT(robot.runtime.served().lease_standing(lease).lost_to, ::testing::Optional(HasSubstr("halt")));
  EXPECT_TRUE(segue::testing::eventually([&] {
    const auto halted = robot.runtime.halted();
    return halted && halted->result && halted->request.why == "task 'planner' is stopped";
  }));
  EXPECT_TRUE(segue::testing::eventually([&] { return robot.switch_to("work").outcome == Outcome::Done; }))
      << "the task is gone, and nothing holds the robot any more";
}

/// The steps at which the tool is stopped last until a watch has seen that.
TEST(Halt, DoesNotComeForATaskThatIsOnlyPreparedOrIsStoppedByATransition) {
  const TaskReaches is_stopped{"tool", "stopped"};
  auto halt = hold();
  halt.when = {{is_stopped, {}}};
  Robot robot(with(std::move(halt)));
  const auto wait_until_seen = [&] {
    const detail::ConditionWatch watch(robot.host, is_stopped, detail::ConditionWatch::From::Now, [] {});
    EXPECT_TRUE(segue::testing::eventually([&] { return watch.holds(); }));
  };
  robot.runtime.prepare({NetworkName("work")}).get();
  wait_until_seen();
  robot.asking.ask_after([&](const model::Action& action) -> Result<void> {
    if (action.label() == "configure tool" || action.label() == "stop tool") wait_until_seen();
    return {};
  });
  for (const char* next : {"work", "drive", "work"}) {
    const auto switched = robot.switch_to(next);
    EXPECT_EQ(switched.outcome, Outcome::Done) << switched.why();
  }
  robot.asking.ask_after({});
  EXPECT_FALSE(robot.runtime.halted()) << robot.runtime.halted()->request.why;
}

bool is_same(const model::Action& one, const model::Action& other) {
  return one.phase == other.phase && one.label() == other.label();
}

/// Whatever a transition is doing when the robot is halted: what waits for the action that is just begun is
/// not begun any more, unless the commit needs it, and the robot comes to rest.
TEST(Halt, AtEachActionOfATransitionGivesWayToNothingButItsCommit) {
  const auto actions_to_work = [](Robot& robot) {
    const auto transition = robot.runtime.plan(NetworkName("work"));
    EXPECT_TRUE(transition);
    return transition ? transition->actions : std::vector<model::Action>{};
  };
  Robot planned;
  const auto all = actions_to_work(planned);
  for (const auto& at : all) {
    SCOPED_TRACE(at.label());
    std::set<std::string> waits_for_it;
    for (const auto& other : all) {
      const bool waits = std::ranges::find(other.after, at.id) != other.after.end();
      if (waits && other.phase == model::Phase::Prepare) waits_for_it.insert(other.label());
    }
    Robot robot;
    std::atomic<bool> halted = false;
    std::atomic<int> begun_after = 0;
    std::promise<std::shared_future<HaltResult>> rest;
    robot.asking.ask([&](const model::Action& action) -> Result<void> {
      if (halted && waits_for_it.contains(action.label())) ++begun_after;
      if (is_same(action, at) && !halted.exchange(true)) rest.set_value(robot.runtime.halt({.who = "ann"}));
      return {};
    });
    const auto result = robot.switch_to("work");
    ASSERT_TRUE(halted);
    const auto ended = rest.get_future().get().get();
    robot.asking.ask({});
    EXPECT_TRUE(ended.at_rest) << ended.trouble;
    EXPECT_EQ(result.outcome, at.phase == model::Phase::Prepare ? Outcome::Superseded : Outcome::Done)
        << result.why();
    EXPECT_EQ(begun_after, 0);
    EXPECT_EQ(robot.running(), "hold");
  }
}

/// An action of a task that neither runs nor is needed at rest may take as long as it likes, and ends late.
TEST(Halt, WaitsForNoActionThatConcernsNothingOfWhatRunsOrBringsItToRest) {
  Robot planned;
  const auto transition = planned.runtime.plan(NetworkName("work")).value();
  int tried = 0;
  for (const auto& at : transition.actions) {
    const auto* what = std::get_if<model::TaskAction>(&at.what);
    if (what == nullptr || what->task.str() == "wheels" || at.phase == model::Phase::Commit) continue;
    SCOPED_TRACE(at.label());
    ++tried;
    std::atomic<bool> halted = false;
    bool came_to_rest = false;
    std::promise<void> ended;
    Robot robot;
    robot.asking.ask_after([&](const model::Action& action) -> Result<void> {
      if (!is_same(action, at) || halted.exchange(true)) return {};
      const auto rest = robot.runtime.halt({.who = "ann"});
      came_to_rest =
          rest.wait_for(std::chrono::seconds(30)) == std::future_status::ready && rest.get().at_rest;
      ended.set_value();
      return {};
    });
    const auto result = robot.switch_to("work");
    ended.get_future().wait();
    robot.asking.ask_after({});
    EXPECT_TRUE(came_to_rest) << "while the action was in progress";
    EXPECT_EQ(result.outcome, at.phase == model::Phase::Prepare ? Outcome::Superseded : Outcome::Done)
        << result.why();
    EXPECT_EQ(robot.running(), "hold");
    EXPECT_EQ(robot.switch_to("work").outcome, Outcome::Done) << "what ended late is in nobody's way";
    EXPECT_THAT(robot.runtime.observed_differences(), IsEmpty());
  }
  EXPECT_GE(tried, 2);
}

TEST(Halt, HasBroughtTheRobotToRestBeforeWhatRanIsRetired) {
  std::promise<std::shared_future<HaltResult>> begun;
  const auto halt = begun.get_future().share();
  std::atomic<int> retired = 0;
  std::atomic<bool> came_to_rest = true;
  Robot robot;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    if (action.phase != model::Phase::Retire) return {};
    ++retired;
    const bool in_time = halt.get().wait_for(std::chrono::seconds(30)) == std::future_status::ready;
    came_to_rest = came_to_rest && in_time;
    return {};
  });
  begun.set_value(robot.runtime.halt({.who = "ann"}));
  EXPECT_TRUE(halt.get().get().at_rest);
  EXPECT_EQ(robot.running(), "hold");
  EXPECT_EQ(robot.switch_to("drive").outcome, Outcome::Done);
  robot.asking.ask({});
  EXPECT_GT(retired, 0);
  EXPECT_TRUE(came_to_rest);
}

TEST(Halt, TakesThePlaceOfWhatIsUndone) {
  Robot robot;
  std::atomic<bool> failed = false;
  std::atomic<bool> halted = false;
  std::promise<std::shared_future<HaltResult>> rest;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    if (action.label() == "start tool" && !failed.exchange(true))
      return fail(ErrorCode::HookFailed, "as the test wants");
    if (failed && !halted.exchange(true)) rest.set_value(robot.runtime.halt({.who = "ann"}));
    return {};
  });
  const auto result = robot.switch_to("work");
  EXPECT_EQ(result.outcome, Outcome::Failed) << result.why();
  ASSERT_TRUE(halted) << "something is undone";
  ASSERT_TRUE(result.undo && result.undo->error);
  EXPECT_THAT(to_string(*result.undo->error), HasSubstr("the robot was halted"));
  const auto ended = rest.get_future().get().get();
  robot.asking.ask({});
  EXPECT_TRUE(ended.at_rest) << ended.trouble;
  EXPECT_EQ(robot.running(), "hold");
}

/// Look-ahead configures the tool of "work", which takes until end() is called. Outlives the robot.
class ToolBeingConfigured {
 public:
  std::future<std::vector<Readiness>> begin(Robot& robot) {
    robot.asking.ask_after([this](const model::Action& action) -> Result<void> {
      if (action.label() != "configure tool" || has_begun_.exchange(true)) return {};
      begun_.set_value();
      may_end_.wait_for(std::chrono::seconds(30));
      return {};
    });
    auto prepared = robot.runtime.prepare({NetworkName("work")});
    begun_.get_future().wait();
    return prepared;
  }
  void end() { end_.set_value(); }

 private:
  std::atomic<bool> has_begun_ = false;
  std::promise<void> begun_;
  std::promise<void> end_;
  const std::shared_future<void> may_end_ = end_.get_future().share();
};

TEST(Request, WaitsForNoActionInProgressButOfTasksThatItNeeds) {
  ToolBeingConfigured tool;
  Robot robot(RuntimeOptions{});
  const auto prepared = tool.begin(robot);
  EXPECT_EQ(robot.switch_to("hold").outcome, Outcome::Done) << "while the tool is being configured";
  auto work = robot.runtime.request(NetworkName("work"));
  EXPECT_EQ(work.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  EXPECT_EQ(robot.runtime.open_requests().at(0).state, "waiting");
  tool.end();
  const auto result = work.get();
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  robot.asking.ask_after({});
  EXPECT_THAT(robot.runtime.observed_differences(), IsEmpty());
}

TEST(Request, ThatWaitsForAnActionInProgressCanBeCancelledAndSuperseded) {
  ToolBeingConfigured tool;
  Robot robot(RuntimeOptions{});
  const auto prepared = tool.begin(robot);
  EXPECT_EQ(robot.switch_to("hold").outcome, Outcome::Done);
  auto first = robot.runtime.accept(NetworkName("work"));
  EXPECT_TRUE(robot.runtime.cancel(first.number, "ann"));
  EXPECT_EQ(first.result.get().outcome, Outcome::Cancelled);
  auto second = robot.runtime.request(NetworkName("work"));
  EXPECT_EQ(robot.switch_to("drive").outcome, Outcome::Done);
  EXPECT_EQ(second.get().outcome, Outcome::Superseded);
  tool.end();
  robot.asking.ask_after({});
}

TEST(Halt, DoesNotWaitForWhatARequestWaitsFor) {
  ToolBeingConfigured tool;
  Robot robot;
  const auto prepared = tool.begin(robot);
  auto work = robot.runtime.request(NetworkName("work"));
  EXPECT_TRUE(robot.runtime.halt({.who = "ann"}).get().at_rest);
  EXPECT_EQ(work.get().outcome, Outcome::Cancelled);
  EXPECT_EQ(robot.running(), "hold");
  tool.end();
  robot.asking.ask_after({});
}

}  // namespace
}  // namespace segue::runtime
