// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime.hpp>

#include <support/eventually.hpp>
#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <stop_token>
#include <string>
#include <thread>

#include "test_support.hpp"

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using segue::testing::eventually;
using testing::AskingHost;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::network_of;
using ::testing::Not;
using testing::StandInRobot;

const char* const kWithA = "network: with_a\ntasks: {a: {component: \"x::A\"}}\n";
const char* const kWithB = "network: with_b\ntasks: {b: {component: \"x::A\"}}\n";

model::Pool pool_of(int size, const std::string& properties = "{}") {
  Diagnostics diagnostics;
  const auto robot = model::read_robot("robot: r\npools: {planner: {component: \"x::Planner\", size: " +
                                           std::to_string(size) + ", properties: " + properties + "}}\n",
                                       "robot.yaml", diagnostics);
  EXPECT_TRUE(robot) << to_string(diagnostics);
  return robot ? robot->pools.at(0) : model::Pool{};
}

RuntimeOptions with_pool(model::Pool pool) {
  RuntimeOptions options;
  options.policies.restart = {.max = 2, .backoff = 1ms};
  options.policies.watch = 5ms;
  options.pools.push_back(std::move(pool));
  return options;
}

bool all_ready(const Runtime& runtime) {
  const auto pools = runtime.pools();
  return !pools.empty() && std::ranges::all_of(pools[0].instances, &PoolInstance::ready);
}

std::vector<std::string> labels(const SwitchResult& result) {
  std::vector<std::string> all;
  for (const auto& record : result.actions)
    all.push_back(record.action.label());
  return all;
}

TEST(RobotPools, RunBesideEveryController) {
  StandInRobot robot(with_pool(pool_of(2)));
  ASSERT_TRUE(eventually([&] { return all_ready(robot.runtime); }));
  EXPECT_TRUE(robot.runtime.belief().empty()) << "they are part of no controller";
  for (const char* text : {kWithA, kWithB, kWithA}) {
    const auto result = robot.runtime.switch_to(network_of(text));
    ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
    EXPECT_THAT(labels(result), Each(Not(HasSubstr("planner"))));
    EXPECT_TRUE(all_ready(robot.runtime));
  }
  EXPECT_EQ(robot.runtime.switch_to(model::NetworkName("")).outcome, Outcome::Done);
  EXPECT_TRUE(all_ready(robot.runtime));
  EXPECT_THAT(robot.runtime.observed_differences(), ::testing::IsEmpty());
  EXPECT_EQ(robot.host.tasks().size(), 2U);
}

TEST(RobotPools, LeaveAnInstanceThatFailsAsSoonAsItRunsToItsPolicy) {
  model::Pool pool = pool_of(1);
  pool.task.on_failure = model::FailurePolicy::Report;
  RuntimeOptions options = with_pool(pool);
  StandInRobot robot;  // whose runtime does nothing
  std::atomic<int> starts = 0;
  AskingHost asking(robot.host);
  asking.ask_after([&](const model::Action& action) -> Result<void> {
    if (action.label() != "start planner_1") return {};
    ++starts;
    model::Action stop = action;
    stop.kind = model::ActionKind::Stop;
    return robot.host.perform(stop, RealClock::instance().now() + 60s);
  });
  Runtime runtime("robot", asking, robot.catalog, std::move(options));
  EXPECT_TRUE(eventually([&] { return runtime.pools().at(0).instances.at(0).given_up; }));
  EXPECT_EQ(starts, 1);
}

TEST(RobotPools, EndWithARequestThatSaysSo) {
  StandInRobot robot(with_pool(pool_of(2)));
  ASSERT_EQ(robot.runtime.switch_to(network_of(kWithA)).outcome, Outcome::Done);
  ASSERT_TRUE(eventually([&] { return all_ready(robot.runtime); }));
  ASSERT_EQ(robot.runtime.take_down().get().outcome, Outcome::Done);
  EXPECT_TRUE(robot.host.tasks().empty());
  ASSERT_EQ(robot.runtime.switch_to(network_of(kWithA)).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return all_ready(robot.runtime); })) << "the next request has them again";
}

TEST(RobotPools, SurviveATransitionThatIsUndone) {
  StandInRobot robot(with_pool(pool_of(2)));
  ASSERT_EQ(robot.runtime.switch_to(network_of(kWithA)).outcome, Outcome::Done);
  ASSERT_TRUE(eventually([&] { return all_ready(robot.runtime); }));
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    return action.label() == "start b" ? Result<void>(fail(ErrorCode::HookFailed, "refuses"))
                                       : Result<void>();
  });
  const auto result = robot.runtime.switch_to(network_of(kWithB));
  ASSERT_EQ(result.outcome, Outcome::Failed);
  ASSERT_TRUE(result.undo);
  EXPECT_TRUE(result.undo->restored);
  EXPECT_THAT(labels(result), Each(Not(HasSubstr("planner"))));
  EXPECT_TRUE(all_ready(robot.runtime));
}

TEST(RobotPools, FailWithoutTheControllers) {
  StandInRobot robot(with_pool(pool_of(1, "{stand_in: {rate: 1000, fail: [update]}}")));
  const auto given_up = [&] { return robot.runtime.pools().at(0).instances.at(0).given_up; };
  ASSERT_TRUE(eventually(given_up));
  for (const char* text : {kWithA, kWithB}) {
    const auto result = robot.runtime.switch_to(network_of(text));
    ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
    EXPECT_THAT(labels(result), Each(Not(HasSubstr("planner"))));
  }
  EXPECT_THAT(robot.runtime.unresolved(), ::testing::IsEmpty());
  EXPECT_TRUE(eventually(given_up));
}

TEST(RobotPools, WhoseInstancesCannotStartSayWhy) {
  StandInRobot robot(with_pool(pool_of(2, "{stand_in: {fail: [configure]}}")));
  ASSERT_TRUE(eventually([&] { return robot.runtime.pools().at(0).instances.at(1).given_up; }));
  const auto report = robot.runtime.pools().at(0);
  EXPECT_FALSE(report.instances[1].ready);
  EXPECT_THAT(report.instances[1].reason, HasSubstr("attempts to start it have not helped"));
  EXPECT_EQ(robot.runtime.switch_to(network_of(kWithA)).outcome, Outcome::Done);
}

/// Operations of its tasks end when the test says so.
class SlowOperations final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  Result<type::Value> call(const model::TaskId& /*task*/, std::string_view /*operation*/,
                           const type::Value& /*arguments*/, TimePoint /*deadline*/) override {
    end_.get_future().wait();
    return fail(ErrorCode::Unavailable, "its process has ended");
  }
  void end() { end_.set_value(); }

 private:
  std::promise<void> end_;
};

TEST(RobotPools, WhoseInstancesWorkForNobodyAreMadeAnew) {
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  SlowOperations slow(host);
  Runtime runtime("robot", slow, catalog, with_pool(pool_of(2)));
  ASSERT_TRUE(eventually([&] { return all_ready(runtime); }));
  const auto starts = runtime.history().size();
  std::stop_source stop;
  std::jthread caller([&] {
    (void)runtime.call(model::TaskId("planner_1"), "plan", {}, Wait(TimePoint::max(), stop.get_token()));
  });
  ASSERT_TRUE(eventually([&] { return runtime.pools().at(0).instances.at(0).busy; }));
  EXPECT_TRUE(runtime.pools().at(0).instances.at(0).ready);
  EXPECT_FALSE(runtime.pools().at(0).instances.at(1).busy);
  stop.request_stop();
  EXPECT_TRUE(eventually([&] { return runtime.history().size() > starts; }));
  EXPECT_EQ(runtime.history().back().cause, Cause::Pool);
  slow.end();
}

TEST(RobotPools, KeepTheirNames) {
  StandInRobot robot(with_pool(pool_of(2)));
  const auto result =
      robot.runtime.switch_to(network_of("network: x\ntasks: {planner_2: {component: \"x::A\"}}\n"));
  EXPECT_EQ(result.outcome, Outcome::Refused);
  EXPECT_THAT(result.why(), HasSubstr("task 'planner_2' belongs to the robot's pool 'planner'"));
}

}  // namespace
}  // namespace segue::runtime
