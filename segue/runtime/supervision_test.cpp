// SPDX-License-Identifier: Apache-2.0
//
// Repairs, look-ahead and removal of leftovers, which the runtime does without a request.
#include <segue/runtime/supervision.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using detail::AfterLimit;
using detail::DetectedFault;
using detail::RepairScheduler;
using model::FailurePolicy;
using segue::testing::eventually;
using testing::network_of;

DetectedFault fault(const char* task, FailurePolicy policy, bool needs_process = false) {
  return {model::TaskId(task), policy, "is faulty", needs_process};
}

TEST(RepairSchedulerTest, WaitsLongerEachTimeAndGivesUp) {
  RepairScheduler repairs({.max = 3, .backoff = 100ms}, AfterLimit::GiveUp);
  const TimePoint start = RealClock::instance().now();
  const std::vector faults{fault("a", FailurePolicy::Restart)};
  EXPECT_TRUE(repairs.decide(faults, start).empty()) << "the first attempt waits as well";
  EXPECT_EQ(repairs.next(), start + 100ms);
  for (const auto at : {100ms, 300ms, 700ms}) {
    EXPECT_TRUE(repairs.decide(faults, start + at - 1ms).empty());
    EXPECT_EQ(repairs.decide(faults, start + at).repair.size(), 1U);
  }
  const auto last = repairs.decide(faults, start + 1500ms);
  EXPECT_EQ(last.given_up.size(), 1U);
  EXPECT_EQ(repairs.attempts(faults.front()), 3);
  for (TimePoint now = start + 2s; now < start + 1h; now += 5s) {
    ASSERT_TRUE(repairs.decide(faults, now).empty()) << "for as long as the fault lasts";
  }
  EXPECT_EQ(repairs.next(), std::nullopt);
}

TEST(RepairSchedulerTest, ForgetsAttemptsAfterALongTimeWithoutFault) {
  RepairScheduler repairs({.max = 1, .backoff = 1ms}, AfterLimit::GiveUp);
  const TimePoint start = RealClock::instance().now();
  const std::vector faults{fault("a", FailurePolicy::Restart)};
  repairs.decide(faults, start);
  EXPECT_EQ(repairs.decide(faults, start + 1s).repair.size(), 1U);
  EXPECT_EQ(repairs.decide(faults, start + 2s).given_up.size(), 1U);
  EXPECT_TRUE(repairs.decide({}, start + 3s).empty());
  EXPECT_TRUE(repairs.decide(faults, start + 4s).empty()) << "still given up";
  EXPECT_TRUE(repairs.decide({}, start + 30s).empty());
  repairs.decide(faults, start + 31s);
  EXPECT_EQ(repairs.decide(faults, start + 32s).repair.size(), 1U);
}

TEST(RepairSchedulerTest, MayGoOnForEver) {
  RepairScheduler repairs({.max = 2, .backoff = 1s}, AfterLimit::GoOn);
  const std::vector faults{fault("a", FailurePolicy::Restart)};
  TimePoint now = RealClock::instance().now();
  int tried = 0;
  int reported = 0;
  for (int i = 0; i < 100'000; ++i, now += 1s) {
    const auto decision = repairs.decide(faults, now);
    tried += static_cast<int>(decision.repair.size());
    reported += static_cast<int>(decision.given_up.size());
  }
  EXPECT_GT(tried, 300) << "every five minutes at last";
  EXPECT_LT(tried, 360);
  EXPECT_EQ(reported, 1);
  EXPECT_EQ(repairs.exhausted(faults).size(), 1U);
  EXPECT_THAT(repairs.exhausted({}), ::testing::IsEmpty());
}

TEST(RepairSchedulerTest, FollowsTheFailurePolicy) {
  RepairScheduler repairs({.max = 3, .backoff = 0ms}, AfterLimit::GiveUp);
  const TimePoint start = RealClock::instance().now();
  EXPECT_TRUE(repairs.decide({fault("a", FailurePolicy::Report)}, start).empty());
  EXPECT_TRUE(repairs.decide({fault("b", FailurePolicy::Fallback)}, start).fallback);
  EXPECT_EQ(repairs.decide({fault("c", FailurePolicy::Recover)}, start).repair.size(), 1U);
  EXPECT_EQ(repairs.decide({fault("d", FailurePolicy::Recover, true)}, start).given_up.size(), 1U);
  EXPECT_EQ(repairs.decide({fault("e", FailurePolicy::Restart, true)}, start).repair.size(), 1U);
}

constexpr const char* kWatched = R"(
network: watched
tasks:
  a: {component: x::A, on_failure: restart}
  b: {component: x::B}
  c: {component: x::C}
deployments:
  d: {host: localhost, process: p, tasks: [b], on_failure: recover}
connections:
  - a.out -> b.in
  - b.out -> c.in
)";

TEST(Faults, AreTasksProcessesAndLostConnections) {
  const auto wanted = network_of(kWatched);
  EXPECT_THAT(detail::find_faults(wanted, wanted, FailurePolicy::Report), ::testing::IsEmpty());
  auto ill = wanted;
  ill.find_task(model::TaskId("a"))->state = TaskState::Fatal;
  ill.connections.pop_back();
  auto found = detail::find_faults(wanted, ill, FailurePolicy::Fallback);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name(), "task 'a'");
  EXPECT_TRUE(found[0].needs_process);
  EXPECT_EQ(found[0].policy, FailurePolicy::Restart);
  EXPECT_EQ(found[1].name(), "task 'c'") << "the reader of the lost connection";
  EXPECT_EQ(found[1].policy, FailurePolicy::Fallback);
  auto gone = wanted;
  gone.deployments.clear();
  std::erase_if(gone.tasks, [](const auto& task) { return task.id == model::TaskId("b"); });
  gone.connections.clear();
  found = detail::find_faults(wanted, gone, FailurePolicy::Report);
  ASSERT_EQ(found.size(), 1U) << "the process instead of its tasks";
  EXPECT_EQ(found[0].name(), "process 'localhost/p'");
  EXPECT_EQ(found[0].policy, FailurePolicy::Recover);
}

TEST(Faults, OfAProcessFollowTheStrongestPolicyOfItsTasks) {
  const auto wanted = network_of(
      "network: watched\n"
      "tasks: {a: {component: \"x::A\", on_failure: restart}, b: {component: \"x::B\"}}\n"
      "deployments: {p: {tasks: [a, b]}, q: {tasks: []}}\n");
  auto gone = wanted;
  gone.deployments.clear();
  gone.tasks.clear();
  const auto found = detail::find_faults(wanted, gone, FailurePolicy::Report);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].policy, FailurePolicy::Restart);
  EXPECT_EQ(found[1].policy, FailurePolicy::Report);
}

std::size_t count(const Runtime& runtime, EventKind kind) {
  const auto events = runtime.events();
  return static_cast<std::size_t>(
      std::count_if(events.begin(), events.end(), [&](const Event& event) { return event.kind == kind; }));
}

RuntimeOptions quick(int attempts) {
  RuntimeOptions options;
  options.policies.restart = {.max = attempts, .backoff = 1ms};
  options.policies.watch = 5ms;
  options.fallback = model::NetworkName("safe");
  return options;
}

model::Network failing(const char* policy) {
  return network_of(std::string("network: failing\ntasks:\n"
                                "  a: {component: x::A, on_failure: ") +
                    policy + ", properties: {stand_in: {rate: 1000, fail: [update]}}}\n");
}

TEST(Supervision, RepairsATaskAsOftenAsItsPolicyPermits) {
  testing::StandInRobot robot(quick(3));
  ASSERT_EQ(robot.runtime.switch_to(failing("recover")).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return count(robot.runtime, EventKind::GivenUp) == 1; }));
  EXPECT_EQ(count(robot.runtime, EventKind::Repair), 3U);
  EXPECT_EQ(robot.runtime.history().size(), 4U);
  EXPECT_EQ(robot.runtime.history().back().cause, Cause::Repair);
  EXPECT_FALSE(robot.runtime.observed_differences().empty()) << "and the drift is reported";
}

TEST(Supervision, SaysWhatItMendsForAsLongAsItMayTryAgain) {
  RuntimeOptions slow = quick(3);
  slow.policies.restart.backoff = 1h;
  testing::StandInRobot waits(std::move(slow));
  ASSERT_EQ(waits.runtime.switch_to(failing("recover")).outcome, Outcome::Done);
  ASSERT_TRUE(eventually([&] { return !waits.runtime.in_repair().empty(); }));
  EXPECT_EQ(waits.runtime.in_repair().front().task, model::TaskId("a"));
  EXPECT_THAT(waits.runtime.in_repair().front().controllers,
              ::testing::ElementsAre(model::NetworkName("failing")));
  EXPECT_THAT(waits.runtime.unresolved(), ::testing::IsEmpty());

  testing::StandInRobot gives_up(quick(1));
  ASSERT_EQ(gives_up.runtime.switch_to(failing("recover")).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return !gives_up.runtime.unresolved().empty(); }));
  EXPECT_THAT(gives_up.runtime.in_repair(), ::testing::IsEmpty());
}

/// A leftover that cannot be removed is an event, stands in the status, and is removed as soon as that works.
TEST(Supervision, PursuesLeftoversForEver) {
  testing::StandInRobot robot(quick(2));
  std::atomic<bool> stuck{true};
  std::atomic<int> attempts{0};
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    const bool removal = action.kind == model::ActionKind::Cleanup && action.label() == "cleanup b";
    attempts += removal ? 1 : 0;
    return removal && stuck ? Result<void>(fail(ErrorCode::HookFailed, "is stuck")) : Result<void>();
  });
  const char* const kBoth = "network: both\ntasks: {a: {component: \"x::A\"}, b: {component: \"x::B\"}}\n";
  const char* const kOne = "network: one\ntasks: {a: {component: \"x::A\"}}\n";
  ASSERT_EQ(robot.runtime.switch_to(network_of(kBoth)).outcome, Outcome::Done);
  const auto result = robot.runtime.switch_to(network_of(kOne));
  ASSERT_EQ(result.outcome, Outcome::Done);
  EXPECT_TRUE(result.leftover);
  EXPECT_TRUE(eventually([&] { return !robot.runtime.unresolved().empty(); }));
  EXPECT_EQ(count(robot.runtime, EventKind::GivenUp), 1U);
  const int so_far = attempts;
  EXPECT_TRUE(eventually([&] { return attempts > so_far + 2; })) << "it goes on";
  EXPECT_EQ(count(robot.runtime, EventKind::GivenUp), 1U) << "reported once";
  EXPECT_THAT(robot.runtime.unresolved().front().sentence, ::testing::HasSubstr("task 'b' was left over"));
  stuck = false;
  EXPECT_TRUE(eventually([&] { return robot.host.observe().tasks.size() == 1; }));
  EXPECT_TRUE(eventually([&] { return robot.runtime.unresolved().empty(); }));
}

TEST(Supervision, KnowsWhichOfSeveralControllersAFaultConcerns) {
  testing::StandInRobot robot(quick(1));
  const auto add = [&](const char* name, const char* task, const char* rest) {
    const std::string text = std::string("network: ") + name +
                             "\ntasks:\n  shared: {component: \"x::S\"}\n  " + task +
                             ": {component: \"x::C\", on_failure: recover" + rest + "}\n";
    ASSERT_FALSE(robot.runtime.add_controller(network_of(text)).has_errors());
  };
  add("arm", "a", ", properties: {stand_in: {rate: 1000, fail: [update]}}");
  add("drive", "d", "");
  ASSERT_EQ(robot.runtime.switch_to(model::NetworkName("arm+drive")).outcome, Outcome::Done);
  ASSERT_TRUE(eventually([&] { return !robot.runtime.unresolved().empty(); }));
  EXPECT_THAT(robot.runtime.unresolved().front().controllers,
              ::testing::ElementsAre(model::NetworkName("arm")));
}

/// A task that was created but never configured leaves without any action.
TEST(Supervision, RemovesLeftoversThatNeedNoAction) {
  testing::StandInRobot robot(quick(2));
  const auto one = network_of("network: one\ntasks: {a: {component: \"x::A\"}}\n");
  ASSERT_EQ(robot.runtime.switch_to(one).outcome, Outcome::Done);
  model::ConfigAction create;
  create.definition.id = model::TaskId("b");
  create.definition.component = model::ComponentName("x::B");
  const model::Action action{1, model::ActionKind::ApplyConfig, create, model::Phase::Prepare, {}};
  ASSERT_TRUE(robot.host.perform(action, RealClock::instance().now() + 10s));
  ASSERT_EQ(robot.host.observe().tasks.size(), 2U);
  EXPECT_TRUE(eventually([&] { return robot.host.observe().tasks.size() == 1; }));
  EXPECT_TRUE(eventually([&] { return robot.runtime.unresolved().empty(); }));
}

TEST(Supervision, OnlyReportsWithPolicyReport) {
  testing::StandInRobot robot(quick(3));
  ASSERT_EQ(robot.runtime.switch_to(failing("report")).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return count(robot.runtime, EventKind::Difference) > 0; }));
  EXPECT_EQ(count(robot.runtime, EventKind::Difference), 1U) << "reported once for as long as it lasts";
  EXPECT_EQ(robot.runtime.history().size(), 1U);
  EXPECT_TRUE(eventually([&] { return robot.runtime.unresolved().size() == 1; }));
  EXPECT_THAT(robot.runtime.unresolved().front().sentence,
              ::testing::HasSubstr("is left so, as its 'on_failure' says"));
  EXPECT_TRUE(robot.runtime.unresolved().front().task);
}

TEST(Supervision, FallsBack) {
  testing::StandInRobot robot(quick(3));
  const auto safe = network_of("network: safe\ntasks: {brake: {component: a::Brake}}\n");
  ASSERT_FALSE(robot.runtime.add_controller(safe).has_errors());
  ASSERT_EQ(robot.runtime.switch_to(failing("fallback")).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return robot.runtime.belief().name == safe.name; }));
  EXPECT_TRUE(eventually([&] { return robot.runtime.history().back().cause == Cause::Fallback; }));
}

constexpr const char* kDrive = R"(
network: drive
tasks:
  base: {component: x::Base}
  joystick: {component: x::Joystick}
connections:
  - joystick.command -> base.command
)";
constexpr const char* kDock = R"(
network: dock
tasks:
  base: {component: x::Base}
  camera: {component: x::Camera}
  servo: {component: x::Servo}
deployments:
  d: {host: localhost, process: vision, tasks: [camera, servo]}
connections:
  - camera.image -> servo.image
  - servo.command -> base.command
)";

class LookAheadTest : public ::testing::Test {
 protected:
  LookAheadTest() {
    EXPECT_FALSE(runtime_.add_controller(drive_).has_errors());
    EXPECT_FALSE(runtime_.add_controller(dock_).has_errors());
  }
  std::vector<Readiness> prepare(std::vector<model::NetworkName> names) {
    return runtime_.prepare(std::move(names)).get();
  }
  /// Nothing was made or taken apart, only started, stopped and connected.
  static bool only_switches(const SwitchResult& result) {
    using enum model::ActionKind;
    return std::all_of(result.actions.begin(), result.actions.end(), [](const auto& record) {
      const model::ActionKind kind = record.action.kind;
      return kind == Start || kind == Stop || kind == Connect || kind == Disconnect;
    });
  }

  const model::Network drive_ = network_of(kDrive);
  const model::Network dock_ = network_of(kDock);
  testing::StandInRobot robot_;
  Runtime& runtime_ = robot_.runtime;
};

TEST_F(LookAheadTest, APreparedControllerBeginsAtItsCommitAndTheOldOneStaysReady) {
  ASSERT_EQ(runtime_.switch_to(drive_.name).outcome, Outcome::Done);
  const auto ready = prepare({dock_.name, drive_.name});
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_TRUE(ready[0].ready) << ready[0].reason;
  EXPECT_EQ(ready[0].prepared, 3U);
  EXPECT_EQ(runtime_.belief().name, drive_.name);
  EXPECT_THAT(differences(drive_, runtime_.belief()), ::testing::IsEmpty());
  EXPECT_THAT(runtime_.observed_differences(), ::testing::IsEmpty()) << "standby tasks are not drift";
  EXPECT_EQ(robot_.host.observe().tasks.size(), 4U);

  const auto docked = runtime_.switch_to(dock_.name);
  ASSERT_EQ(docked.outcome, Outcome::Done) << docked.why();
  EXPECT_TRUE(only_switches(docked));
  const auto back = runtime_.switch_to(drive_.name);
  ASSERT_EQ(back.outcome, Outcome::Done) << back.why();
  EXPECT_TRUE(only_switches(back));
  EXPECT_THAT(differences(drive_, runtime_.belief()), ::testing::IsEmpty());

  prepare({});
  EXPECT_TRUE(eventually([&] { return differences(drive_, robot_.host.observe()).empty(); }))
      << "standby has ended";
}

TEST_F(LookAheadTest, APropertyThatWasSetByHandNeitherHindersItNorIsUndone) {
  model::Network slow = drive_;
  slow.name = model::NetworkName("slow");
  slow.tasks.front().properties = type::Value::map({{"gain", 1}});
  ASSERT_EQ(runtime_.switch_to(slow).outcome, Outcome::Done);
  const auto deadline = RealClock::instance().now() + std::chrono::seconds(30);
  const auto set = robot_.host.set_property(model::TaskId("base"), "gain", 7, deadline);
  ASSERT_TRUE(set) << to_string(set.error());
  const auto ready = prepare({dock_.name});
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_TRUE(ready[0].ready) << ready[0].reason;
  EXPECT_THAT(runtime_.observed_differences(),
              ::testing::ElementsAre("task 'base': property 'gain' is 7, expected 1"));
}

TEST_F(LookAheadTest, ReportsAnExceededBudgetAndUnknownNames) {
  testing::StandInRobot robot(
      RuntimeOptions{.fallback = {}, .policies = {}, .look_ahead = {.processes = 0}, .journal = {}});
  for (const auto& network : {drive_, dock_}) {
    ASSERT_FALSE(robot.runtime.add_controller(network).has_errors());
  }
  ASSERT_EQ(robot.runtime.switch_to(drive_.name).outcome, Outcome::Done);
  const auto ready = robot.runtime.prepare({dock_.name, model::NetworkName("fly")}).get();
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_FALSE(ready[0].ready);
  EXPECT_THAT(ready[0].reason, ::testing::HasSubstr("budget of 0 processes"));
  EXPECT_FALSE(ready[1].ready);
  EXPECT_EQ(robot.host.observe().tasks.size(), 2U);
}

TEST_F(LookAheadTest, AsManyProcessesOfAControllerArePreparedAsTheBudgetPermits) {
  testing::StandInRobot robot(
      RuntimeOptions{.fallback = {}, .policies = {}, .look_ahead = {.processes = 1}, .journal = {}});
  model::Network wide = dock_;
  model::Deployment& vision = wide.deployments.front();
  model::Deployment control = vision;
  control.process = model::ProcessName("control");
  control.tasks = {vision.tasks.back()};
  vision.tasks.pop_back();
  wide.deployments.push_back(control);
  for (const auto& network : {drive_, wide}) {
    ASSERT_FALSE(robot.runtime.add_controller(network).has_errors());
  }
  ASSERT_EQ(robot.runtime.switch_to(drive_.name).outcome, Outcome::Done);
  const auto ready = robot.runtime.prepare({wide.name}).get();
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].ready);
  EXPECT_EQ(ready[0].prepared, 2U) << "base, which runs, and camera";
  EXPECT_THAT(ready[0].reason, ::testing::HasSubstr("1 of its 2 processes exceed the budget"));
  EXPECT_NE(robot.host.observe().find_task(model::TaskId("camera")), nullptr);
  EXPECT_EQ(robot.host.observe().find_task(model::TaskId("servo")), nullptr);
  const auto docked = robot.runtime.switch_to(wide.name);
  ASSERT_EQ(docked.outcome, Outcome::Done) << docked.why();
  for (const auto& record : docked.actions) {
    const bool created_again =
        record.action.kind == model::ActionKind::Configure && record.action.task()->str() == "camera";
    EXPECT_FALSE(created_again) << "it was ready";
  }
}

TEST_F(LookAheadTest, AFailedPreparationLeavesTheRunningControllerAlone) {
  ASSERT_EQ(runtime_.switch_to(drive_.name).outcome, Outcome::Done);
  robot_.asking.ask([](const model::Action& action) -> Result<void> {
    const bool fails = action.kind == model::ActionKind::Configure;
    return fails ? Result<void>(fail(ErrorCode::IoError, "a fault")) : Result<void>();
  });
  const auto ready = prepare({dock_.name});
  robot_.asking.ask(nullptr);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].ready);
  EXPECT_THAT(ready[0].reason, ::testing::HasSubstr("a fault"));
  EXPECT_NE(runtime_.state(), RuntimeState::Failed);
  EXPECT_THAT(differences(drive_, robot_.host.observe()), ::testing::IsEmpty());
  EXPECT_EQ(runtime_.switch_to(dock_.name).outcome, Outcome::Done);
}

TEST_F(LookAheadTest, RemovesTheLeftoversOfASupersededRequest) {
  ASSERT_EQ(runtime_.switch_to(drive_.name).outcome, Outcome::Done);
  std::promise<void> entered;
  std::promise<void> go;
  std::atomic<bool> first{true};
  robot_.asking.ask([&, gate = go.get_future().share()](const model::Action& action) -> Result<void> {
    if (action.kind == model::ActionKind::Configure && first.exchange(false)) {
      entered.set_value();
      gate.wait();
    }
    return {};
  });
  auto superseded = runtime_.request(dock_.name);
  entered.get_future().wait();
  auto refused = runtime_.request(model::NetworkName("fly"));
  go.set_value();
  EXPECT_EQ(superseded.get().outcome, Outcome::Superseded);
  EXPECT_EQ(refused.get().outcome, Outcome::Refused);
  EXPECT_TRUE(eventually([&] { return differences(drive_, robot_.host.observe()).empty(); }));
  EXPECT_EQ(runtime_.belief().name, drive_.name);
}

}  // namespace
}  // namespace segue::runtime
