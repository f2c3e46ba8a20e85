// SPDX-License-Identifier: Apache-2.0
//
// Troubles of a robot: since when there is one, why, and what repairs it.
#include <segue/runtime/health_view.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/test_support.hpp>
#include <segue/task/component.hpp>

#include <support/eventually.hpp>
#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <map>
#include <string>
#include <vector>

namespace runtime_health_test {

/// Breaks at its next update while the test wishes it to.
class Motor final : public segue::task::Component {
 public:
  Motor() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}
  static std::atomic<bool> hot;

 protected:
  void on_update() override {
    if (hot) exception("is too hot");
  }
};
std::atomic<bool> Motor::hot{false};

}  // namespace runtime_health_test

SEGUE_COMPONENT(runtime_health_test::Motor)

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using runtime_health_test::Motor;
using segue::testing::eventually;
using ::testing::HasSubstr;
using testing::network_of;
using ::testing::SizeIs;
using State = Health::State;

/// All that health_of() refers to.
struct Everything {
  std::vector<detail::DetectedFault> faults{};
  std::map<std::string, detail::Handling> handled{};
  std::map<model::DeploymentKey, std::string> ended{};
  std::vector<task_host::TaskReport> tasks{};
  std::vector<task_host::ComputerReport> computers{};
  std::vector<PoolReport> pools{};

  [[nodiscard]] detail::HealthView view() const {
    return {.faults = faults,
            .handled = handled,
            .ended = ended,
            .tasks = tasks,
            .computers = computers,
            .pools = pools};
  }
  [[nodiscard]] Trouble only() const {
    const Health health = detail::health_of(view());
    EXPECT_EQ(health.state, State::InTrouble);
    EXPECT_THAT(health.troubles, SizeIs(1));
    return health.troubles.empty() ? Trouble{} : health.troubles.front();
  }
};

const model::DeploymentKey kProcess{model::kLocalHost, model::ProcessName("nav")};

detail::DetectedFault task_fault(model::FailurePolicy policy) {
  return {model::TaskId("slam"), policy, "is exception"};
}

TEST(HealthOf, ARobotThatHasAllItNeedsIsHealthy) {
  EXPECT_EQ(detail::health_of(Everything().view()).state, State::Healthy);
}

TEST(HealthOf, AProcessThatCrashedIsNamedWithHowItEnded) {
  Everything all;
  all.faults.push_back({kProcess, model::FailurePolicy::Restart, "is gone", true});
  all.ended.emplace(kProcess, "was killed by signal 9; its log ends with:\n  its last line");
  const Trouble trouble = all.only();
  EXPECT_EQ(trouble.kind, Trouble::Kind::Process);
  EXPECT_EQ(trouble.why, "was killed by signal 9");
  EXPECT_EQ(trouble.repair, "the runtime repairs it by itself");
  EXPECT_FALSE(trouble.on_request);
}

TEST(HealthOf, AProcessThatDoesNotAnswerIsNotExplainedByItself) {
  Everything all;
  all.faults.push_back({kProcess, model::FailurePolicy::Restart, "does not answer", true});
  task_host::TaskReport report;
  report.process = kProcess;
  report.error = "process 'localhost/nav' (pid 7) does not answer; a transition replaces it";
  all.tasks.push_back(report);
  EXPECT_EQ(all.only().why, "");
}

TEST(HealthOf, WhatWasGivenUpSaysWhatTriesAgain) {
  Everything all;
  all.faults.push_back(task_fault(model::FailurePolicy::Recover));
  all.handled.emplace("task 'slam'", detail::Handling{3, true});
  const Trouble trouble = all.only();
  EXPECT_EQ(trouble.repair, "`segue repair` tries again; 3 attempts have not helped");
  EXPECT_TRUE(trouble.on_request);
}

TEST(HealthOf, WhatIsLeftSoSaysWhatRepairsIt) {
  Everything all;
  all.faults.push_back(task_fault(model::FailurePolicy::Report));
  EXPECT_THAT(all.only().repair, HasSubstr("`segue repair` repairs it"));
  EXPECT_TRUE(all.only().on_request);
}

TEST(HealthOf, ALostConnectionIsOne) {
  Everything all;
  auto fault = task_fault(model::FailurePolicy::Report);
  fault.lacks_connection = true;
  all.faults.push_back(fault);
  EXPECT_EQ(all.only().kind, Trouble::Kind::Connection);
}

TEST(HealthOf, OnlyHostsThatAreRequiredCount) {
  Everything all;
  all.computers = {{.name = model::HostName("arm"),
                    .reachable = false,
                    .state = "timed out",
                    .since = 3s,
                    .address = {},
                    .software = {}},
                   {.name = model::HostName("tablet"),
                    .reachable = false,
                    .optional = true,
                    .state = {},
                    .address = {},
                    .software = {}}};
  const auto begin = std::chrono::system_clock::now();
  const Trouble trouble = all.only();
  EXPECT_EQ(trouble.name, "arm");
  EXPECT_EQ(trouble.why, "timed out");
  EXPECT_GE(trouble.since, begin - 3s);
}

TEST(HealthOf, APoolThatIsShortSaysByHowMuch) {
  Everything all;
  all.pools = {{"planner",
                {{.task = model::TaskId("planner_1"), .ready = true, .reason = {}},
                 {.task = model::TaskId("planner_2"), .given_up = true, .reason = "does not run"}}}};
  const Trouble trouble = all.only();
  EXPECT_EQ(trouble.what, "pool 'planner' is short: 1 of 2 ready");
  EXPECT_EQ(trouble.why, "planner_2: does not run");
  EXPECT_TRUE(trouble.on_request);
}

TEST(HealthOf, WhatIsMissingDuringATransitionMayBeAboutToCome) {
  Everything all;
  all.faults.push_back(task_fault(model::FailurePolicy::Report));
  auto view = all.view();
  view.in_transition = true;
  EXPECT_EQ(detail::health_of(view).state, State::InTransition);
}

TEST(TroubleTimesTest, RememberTheFirstTimeForAsLongAsItLasts) {
  detail::TroubleTimes times;
  const std::chrono::system_clock::time_point begin{1h};
  std::vector<Trouble> troubles{{.kind = Trouble::Kind::Task, .name = "slam", .what = {}}};
  times.note(troubles, begin);
  times.note(troubles, begin + 5s);
  EXPECT_EQ(troubles.front().since, begin);
  std::vector<Trouble> none;
  times.note(none, begin + 6s);
  times.note(troubles, begin + 7s);
  EXPECT_EQ(troubles.front().since, begin + 7s) << "it had been well";
}

RuntimeOptions often(int attempts, model::FailurePolicy policy) {
  RuntimeOptions options;
  options.policies.on_failure = policy;
  options.policies.restart = {.max = attempts, .backoff = 1ms};
  options.policies.watch = 5ms;
  return options;
}

class HealthTest : public ::testing::Test {
 protected:
  HealthTest() { Motor::hot = false; }
  ~HealthTest() override { Motor::hot = false; }

  static model::Network drive() {
    return network_of("network: drive\ntasks: {motor: {component: \"runtime_health_test::Motor\"}}\n");
  }
  static bool is(const Runtime& runtime, State state) { return runtime.snapshot().health.state == state; }
};

TEST_F(HealthTest, ABrokenTaskIsTroubleUntilItIsRepairedOnRequest) {
  testing::StandInRobot robot(often(3, model::FailurePolicy::Report));
  ASSERT_EQ(robot.runtime.switch_to(drive()).outcome, Outcome::Done);
  EXPECT_TRUE(is(robot.runtime, State::Healthy));
  const auto begin = std::chrono::system_clock::now();
  Motor::hot = true;
  ASSERT_TRUE(eventually([&] { return is(robot.runtime, State::InTrouble); }));
  const Health health = robot.runtime.snapshot().health;
  ASSERT_THAT(health.troubles, SizeIs(1));
  EXPECT_EQ(health.troubles[0].name, "motor");
  EXPECT_THAT(health.troubles[0].why, HasSubstr("is too hot"));
  EXPECT_GE(health.troubles[0].since, begin);
  EXPECT_EQ(robot.runtime.snapshot().health.troubles[0].since, health.troubles[0].since);
  Motor::hot = false;
  EXPECT_EQ(robot.runtime.repair().result.get().outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return is(robot.runtime, State::Healthy); }));
}

TEST_F(HealthTest, WhatWasGivenUpIsTriedAgainOnRequest) {
  testing::StandInRobot robot(often(2, model::FailurePolicy::Recover));
  ASSERT_EQ(robot.runtime.switch_to(drive()).outcome, Outcome::Done);
  Motor::hot = true;
  ASSERT_TRUE(eventually([&] {
    const Health health = robot.runtime.snapshot().health;
    return health.state == State::InTrouble && health.troubles.at(0).on_request;
  }));
  EXPECT_THAT(robot.runtime.snapshot().health.troubles.at(0).repair, HasSubstr("2 attempts have not helped"));
  Motor::hot = false;
  EXPECT_EQ(robot.runtime.repair().result.get().outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return is(robot.runtime, State::Healthy); }));
}

TEST_F(HealthTest, ACrashIsTroubleAmongTheEvents) {
  testing::StandInRobot robot(often(3, model::FailurePolicy::Report));
  ASSERT_EQ(robot.runtime.switch_to(drive()).outcome, Outcome::Done);
  Motor::hot = true;
  EXPECT_TRUE(eventually([&] {
    const auto events = robot.runtime.events();
    return std::ranges::any_of(events, [](const Event& event) {
      return event.kind == EventKind::TaskState && event.subject == "motor" && event.trouble;
    });
  }));
}

TEST_F(HealthTest, APoolThatIsShortBeginsAgainOnRequest) {
  Diagnostics diagnostics;
  const auto file = model::read_robot(
      "robot: r\npools: {pump: {component: \"runtime_health_test::Motor\", on_failure: report}}\n",
      "robot.yaml", diagnostics);
  ASSERT_TRUE(file) << to_string(diagnostics);
  auto options = often(2, model::FailurePolicy::Report);
  options.pools = file->pools;
  testing::StandInRobot robot(std::move(options));
  ASSERT_TRUE(eventually([&] { return is(robot.runtime, State::Healthy); }));
  Motor::hot = true;
  ASSERT_TRUE(eventually([&] {
    const Health health = robot.runtime.snapshot().health;
    return health.state == State::InTrouble && health.troubles.at(0).on_request;
  }));
  EXPECT_EQ(robot.runtime.snapshot().health.troubles.at(0).kind, Trouble::Kind::Pool);
  Motor::hot = false;
  EXPECT_EQ(robot.runtime.repair().result.get().outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return is(robot.runtime, State::Healthy); }));
}

TEST_F(HealthTest, DuringATransitionARobotIsInTransition) {
  testing::StandInRobot robot;
  std::promise<void> entered;
  std::promise<void> go;
  std::atomic<bool> first{true};
  robot.asking.ask([&, gate = go.get_future().share()](const model::Action&) -> Result<void> {
    if (first.exchange(false)) {
      entered.set_value();
      gate.wait();
    }
    return {};
  });
  auto done = robot.runtime.request(drive());
  entered.get_future().wait();
  EXPECT_TRUE(is(robot.runtime, State::InTransition));
  go.set_value();
  EXPECT_EQ(done.get().outcome, Outcome::Done);
}

TEST_F(HealthTest, WhatWasNeverRequestedIsNotRepaired) {
  testing::StandInRobot robot;
  ASSERT_EQ(robot.runtime.switch_to(network_of("tasks: {a: {component: x::A}}", "")).outcome, Outcome::Done);
  robot.runtime.reset_belief();
  EXPECT_EQ(robot.runtime.repair().result.get().outcome, Outcome::Refused);
  EXPECT_THAT(robot.host.observe().tasks, SizeIs(1));
}

/// Counts how often it is asked for each part of a status.
class CountingHost final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  [[nodiscard]] View snapshot() const override {
    ++looks;
    return inner_.snapshot();
  }
  [[nodiscard]] std::vector<task_host::TaskReport> tasks() const override {
    ++others;
    return inner_.tasks();
  }
  [[nodiscard]] std::vector<task_host::ConnectionReport> connections() const override {
    ++others;
    return inner_.connections();
  }
  mutable std::atomic<int> looks{0};
  mutable std::atomic<int> others{0};
};

TEST_F(HealthTest, AStatusAsksEachProcessOnce) {
  testing::StandInRobot robot;
  CountingHost host(robot.host);
  RuntimeOptions options;
  options.policies.watch = 1h;
  Runtime runtime("counted", host, robot.catalog, options);
  RuntimeService service(runtime, nullptr, [] {});
  ASSERT_EQ(runtime.switch_to(drive()).outcome, Outcome::Done);
  host.looks = 0;
  host.others = 0;
  const auto status = service.status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->find("health")->find("state")->as_string(), "healthy");
  EXPECT_EQ(host.looks, 1);
  EXPECT_EQ(host.others, 0);
}

}  // namespace
}  // namespace segue::runtime
