// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/runtime/runtime.hpp>

#include <segue/runtime/belief.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/test_support.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task/component.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>

namespace runtime_test {

/// Its configure hook blocks until the test lets it return.
class Hanging final : public segue::task::Component {
 public:
  static std::shared_future<void> gate;

 private:
  segue::Result<void> on_configure() override {
    gate.wait();
    return {};
  }
};
std::shared_future<void> Hanging::gate;

}  // namespace runtime_test

SEGUE_COMPONENT(runtime_test::Hanging)

namespace segue::runtime {
namespace {

using segue::testing::eventually;
using ::testing::HasSubstr;
using testing::network_of;

constexpr const char* kFirst = R"(
network: first
tasks:
  kept: {component: a::Kept}
  changed: {component: a::Changed, properties: {gain: 1}}
  gone: {component: a::Gone}
deployments:
  d1: {host: localhost, process: old, tasks: [gone]}
  d2: {host: localhost, process: shared, tasks: [changed]}
connections:
  - kept.out -> changed.in
  - changed.out -> gone.in
)";

constexpr const char* kSecond = R"(
network: second
tasks:
  kept: {component: a::Kept}
  changed: {component: a::Changed, properties: {gain: 2}}
  added: {component: a::Added}
deployments:
  d1: {host: localhost, process: new, tasks: [added]}
  d2: {host: localhost, process: shared, tasks: [changed]}
connections:
  - kept.out -> changed.in
  - {from: changed.out, to: added.in, policy: buffer, size: 5}
)";

class RuntimeTest : public ::testing::Test {
 protected:
  RuntimeTest() {
    EXPECT_FALSE(runtime_.add_controller(first_).has_errors());
    EXPECT_FALSE(runtime_.add_controller(second_).has_errors());
  }
  SwitchResult switch_to(const char* name) { return runtime_.switch_to(model::NetworkName(name)); }
  void expect_truth(const model::Network& expected) {
    EXPECT_THAT(differences(expected, runtime_.belief()), ::testing::IsEmpty());
    EXPECT_THAT(runtime_.observed_differences(), ::testing::IsEmpty());
  }

  const model::Network first_ = network_of(kFirst);
  const model::Network second_ = network_of(kSecond);
  testing::StandInRobot robot_;
  Runtime& runtime_ = robot_.runtime;
};

TEST_F(RuntimeTest, SwitchesBetweenControllersAndToNothing) {
  for (const auto* target : {&first_, &second_, &first_}) {
    const auto result = runtime_.switch_to(target->name);
    ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
    EXPECT_EQ(result.to, target->name);
    EXPECT_FALSE(result.actions.empty());
    EXPECT_GE(result.duration, result.commit);
    expect_truth(*target);
  }
  const auto same = switch_to("first");
  EXPECT_EQ(same.outcome, Outcome::Done);
  EXPECT_TRUE(same.actions.empty()) << "nothing to do";
  const auto nothing = runtime_.switch_to(model::Network{});
  ASSERT_EQ(nothing.outcome, Outcome::Done) << nothing.why();
  EXPECT_TRUE(robot_.host.observe().empty());
  EXPECT_EQ(runtime_.state(), RuntimeState::Idle);
  EXPECT_EQ(runtime_.history().size(), 5U);
}

TEST_F(RuntimeTest, KeepsTasksThatTheTransitionDoesNotNameRunning) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  const auto result = switch_to("second");
  for (const auto& record : result.actions) {
    const auto* task = record.action.task();
    EXPECT_FALSE(task != nullptr && task->str() == "kept") << record.action.label();
  }
}

TEST_F(RuntimeTest, LetsTheHostGetReadyBetweenPrepareAndCommit) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  Mutex mutex;
  std::vector<model::Phase> phases;
  std::vector<model::Phase> before;
  robot_.asking.ask([&](const model::Action& action) -> Result<void> {
    const Lock lock(mutex);
    phases.push_back(action.phase);
    return {};
  });
  robot_.asking.when_getting_ready([&](const model::Network& target) {
    const Lock lock(mutex);
    EXPECT_EQ(target.name.str(), "second");
    before = phases;
  });
  const auto result = switch_to("second");
  ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_THAT(before, ::testing::Not(::testing::Contains(::testing::Ne(model::Phase::Prepare))));
  EXPECT_EQ(before.size(), static_cast<std::size_t>(std::ranges::count(phases, model::Phase::Prepare)));
  EXPECT_THAT(phases, ::testing::Contains(model::Phase::Commit));
}

TEST_F(RuntimeTest, RefusesUnknownNamesBeforeAnyAction) {
  const auto unknown = switch_to("frist");
  EXPECT_EQ(unknown.outcome, Outcome::Refused);
  EXPECT_THAT(unknown.why(), HasSubstr("did you mean 'first'"));
  model::Network broken = first_;
  broken.connections.front().to.task = model::TaskId("nobody");
  broken.tasks.push_back(broken.tasks.front());
  const auto refused = runtime_.switch_to(broken);
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_GE(refused.error->diagnostics->error_count(), 2U) << "all problems at once";
  EXPECT_TRUE(runtime_.add_controller(broken).has_errors());
  RequestOptions hasty;
  hasty.action_deadline = Duration(0);
  EXPECT_EQ(runtime_.switch_to(first_, hasty).outcome, Outcome::Refused);
  EXPECT_TRUE(robot_.host.observe().empty());
  EXPECT_EQ(runtime_.state(), RuntimeState::Idle);
}

TEST_F(RuntimeTest, ExecutesAGivenTransitionAndRefusesOneThatDoesNotFit) {
  auto there = runtime_.plan(model::NetworkName("first"));
  ASSERT_TRUE(there) << to_string(there.error());
  const auto done = runtime_.switch_to(*there);
  ASSERT_EQ(done.outcome, Outcome::Done) << done.why();
  expect_truth(first_);
  const auto again = runtime_.switch_to(*there);
  EXPECT_EQ(again.outcome, Outcome::Refused);
  EXPECT_TRUE(again.actions.empty());
  expect_truth(first_);
}

TEST_F(RuntimeTest, APreviewSaysWhatChangesAndChangesNothing) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  const auto planned = runtime_.preview(model::NetworkName("second"));
  ASSERT_TRUE(planned) << to_string(planned.error());
  EXPECT_THAT(planned->changes, ::testing::IsSupersetOf({"task 'changed': property 'gain': 1 -> 2",
                                                         "task 'gone' is removed", "task 'added' is added"}));
  EXPECT_FALSE(planned->expected) << "there is no journal";
  EXPECT_EQ(planned->transition, *runtime_.plan(model::NetworkName("second")));
  expect_truth(first_);
}

bool takes_down(const model::Action& action) {
  using enum model::ActionKind;
  const bool down = action.kind == Recover || action.kind == Stop || action.kind == Disconnect ||
                    action.kind == Cleanup || action.kind == Undeploy;
  return down && action.phase != model::Phase::Prepare;
}

/// Executes the transition from `from` to `to` once for each of its actions, which fails then.
void fail_each_action(const model::Network& from, const model::Network& to, model::Order order) {
  testing::StandInRobot robot;
  Runtime& runtime = robot.runtime;
  const RequestOptions options{.order = order, .who = {}};
  ASSERT_EQ(runtime.switch_to(from).outcome, Outcome::Done);
  const auto plan = runtime.plan(to, options);
  ASSERT_TRUE(plan);
  for (const auto& action : plan->actions) {
    std::atomic<bool> failed_once{false};
    robot.asking.ask([&](const model::Action& asked) -> Result<void> {
      const bool fails = asked.label() == action.label() && !failed_once.exchange(true);
      return fails ? Result<void>(fail(ErrorCode::IoError, "a fault")) : Result<void>();
    });
    const auto result = runtime.switch_to(to, options);
    robot.asking.ask(nullptr);
    // The runtime may still be removing leftovers.
    EXPECT_NE(runtime.state(), RuntimeState::Failed) << action.label();
    EXPECT_THAT(runtime.observed_differences(), ::testing::IsEmpty()) << action.label();
    if (takes_down(action)) {
      ASSERT_EQ(result.outcome, Outcome::Done) << action.label() << ": " << result.why();
      EXPECT_EQ(runtime.belief().name, to.name);
    } else {
      ASSERT_EQ(result.outcome, Outcome::Failed) << action.label();
      EXPECT_EQ(result.error->code, ErrorCode::IoError);
      EXPECT_EQ(result.error->subject, action.label());
      ASSERT_TRUE(result.undo);
      EXPECT_TRUE(result.undo->restored) << action.label() << ": " << result.why();
      EXPECT_THAT(differences(from, robot.host.observe()), ::testing::IsEmpty()) << action.label();
      EXPECT_EQ(runtime.belief().name, from.name);
    }
    const auto retried = runtime.switch_to(to);
    ASSERT_EQ(retried.outcome, Outcome::Done) << action.label() << ": " << retried.why();
    EXPECT_THAT(differences(to, robot.host.observe()), ::testing::IsEmpty());
    ASSERT_EQ(runtime.switch_to(from).outcome, Outcome::Done);
  }
}

TEST_F(RuntimeTest, AFaultAtAnyActionLeavesTheOldControllerOrTheNewOne) {
  for (const auto order : {model::Order::Seamless, model::Order::Paper}) {
    fail_each_action(first_, second_, order);
    fail_each_action(model::Network{}, first_, order);
    fail_each_action(second_, model::Network{}, order);
  }
}

TEST_F(RuntimeTest, HooksThatFailLeaveTheOldControllerRunning) {
  for (const char* what : {"configure", "start", "connect"}) {
    auto broken = second_;
    broken.find_task(model::TaskId("added"))
        ->properties.as_map()
        .set("stand_in", type::Value::map({{"fail", what}}));
    ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
    const auto failed = runtime_.switch_to(broken);
    ASSERT_EQ(failed.outcome, Outcome::Failed) << what;
    EXPECT_THAT(failed.error->subject, HasSubstr("added")) << what;
    EXPECT_THAT(failed.why(), HasSubstr("the robot runs 'first' as before")) << what;
    expect_truth(first_);
    const auto result = switch_to("second");
    ASSERT_EQ(result.outcome, Outcome::Done) << what << ": " << result.why();
    expect_truth(second_);
  }
}

TEST_F(RuntimeTest, ATaskThatFailsToStopDoesNotBlockTheSwitch) {
  auto stubborn = first_;
  stubborn.find_task(model::TaskId("gone"))
      ->properties.as_map()
      .set("stand_in", type::Value::map({{"fail", "stop"}}));
  ASSERT_EQ(runtime_.switch_to(stubborn).outcome, Outcome::Done);
  const auto result = switch_to("second");
  ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
  expect_truth(second_);
}

TEST_F(RuntimeTest, AFailureThatCannotBeUndoneIsReportedAndTheFallbackRuns) {
  testing::StandInRobot robot{
      {.fallback = model::NetworkName("safe"), .policies = {}, .look_ahead = {}, .journal = {}}};
  Runtime& runtime = robot.runtime;
  const auto safe = network_of("network: safe\ntasks: {brake: {component: a::Brake}}\n");
  ASSERT_FALSE(runtime.add_controller(safe).has_errors());
  ASSERT_EQ(runtime.switch_to(first_).outcome, Outcome::Done);
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    const bool fails = action.kind == model::ActionKind::Start && *action.task() != model::TaskId("brake");
    return fails ? Result<void>(fail(ErrorCode::IoError, "a fault")) : Result<void>();
  });
  const auto result = runtime.switch_to(second_);
  ASSERT_EQ(result.outcome, Outcome::Failed);
  ASSERT_TRUE(result.undo);
  EXPECT_FALSE(result.undo->restored);
  EXPECT_TRUE(result.undo->fell_back) << result.why();
  EXPECT_THAT(result.why(), HasSubstr("runs its fallback 'safe'"));
  EXPECT_EQ(runtime.belief().name, model::NetworkName("safe"));
  EXPECT_THAT(differences(safe, robot.host.observe()), ::testing::IsEmpty());
}

TEST_F(RuntimeTest, WithoutAFallbackItReportsWhatRuns) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  robot_.asking.ask([&](const model::Action& action) -> Result<void> {
    const bool fails = action.kind == model::ActionKind::Start;
    return fails ? Result<void>(fail(ErrorCode::IoError, "a fault")) : Result<void>();
  });
  const auto result = switch_to("second");
  robot_.asking.ask(nullptr);
  ASSERT_EQ(result.outcome, Outcome::Failed);
  EXPECT_THAT(result.why(), HasSubstr("the robot now runs 4 tasks"));
  EXPECT_EQ(runtime_.state(), RuntimeState::Failed);
  EXPECT_THAT(runtime_.observed_differences(), ::testing::IsEmpty());
  EXPECT_THAT(differences(runtime_.belief(), robot_.host.observe()), ::testing::IsEmpty());
  ASSERT_EQ(switch_to("second").outcome, Outcome::Done);
  expect_truth(second_);
}

/// Requests `name` and blocks it at its first action of a phase, until go() is called.
class HeldUp {
 public:
  HeldUp(testing::StandInRobot& robot, const char* name, model::Phase phase) {
    robot.asking.ask(
        [this, phase, gate = go_.get_future().share()](const model::Action& action) -> Result<void> {
          if (action.phase == phase && !entered_.exchange(true)) {
            in_.set_value();
            gate.wait();
          }
          return {};
        });
    result_ = robot.runtime.request(model::NetworkName(name));
    in_.get_future().wait();
  }
  SwitchResult go() {
    go_.set_value();
    return result_.get();
  }

 private:
  std::promise<void> in_;
  std::promise<void> go_;
  std::atomic<bool> entered_{false};
  std::future<SwitchResult> result_;
};

TEST_F(RuntimeTest, AWaitingRequestIsSupersededByANewerOne) {
  HeldUp held(robot_, "first", model::Phase::Commit);
  EXPECT_EQ(runtime_.state(), RuntimeState::Executing);
  auto superseded = runtime_.request(model::NetworkName("first"));
  auto second = runtime_.request(model::NetworkName("second"));
  EXPECT_EQ(superseded.get().outcome, Outcome::Superseded);
  runtime_.reset_belief();
  EXPECT_EQ(held.go().outcome, Outcome::Done);
  const auto result = second.get();
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_EQ(result.from, model::NetworkName("first"));
  expect_truth(second_);
}

TEST_F(RuntimeTest, ARequestSupersedesOneThatIsBeingPrepared) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  HeldUp held(robot_, "second", model::Phase::Prepare);
  auto back = runtime_.request(model::NetworkName("first"));
  EXPECT_EQ(held.go().outcome, Outcome::Superseded);
  const auto result = back.get();
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  expect_truth(first_);
}

TEST_F(RuntimeTest, ARequestWaitsForTheEndOfACommit) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  HeldUp held(robot_, "second", model::Phase::Commit);
  auto back = runtime_.request(model::NetworkName("first"));
  const auto first_result = held.go();
  EXPECT_EQ(first_result.outcome, Outcome::Done) << first_result.why();
  const auto result = back.get();
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_EQ(result.from, model::NetworkName("second"));
  expect_truth(first_);
}

TEST_F(RuntimeTest, QueriesAreAnsweredWhileAComponentHangs) {
  std::promise<void> go;
  runtime_test::Hanging::gate = go.get_future().share();
  const auto network = network_of("network: hanging\ntasks: {stuck: {component: runtime_test::Hanging}}\n");
  RequestOptions hasty;
  hasty.action_deadline = std::chrono::milliseconds(20);
  const auto result = runtime_.switch_to(network, hasty);
  EXPECT_EQ(result.outcome, Outcome::Failed);
  EXPECT_EQ(result.error->code, ErrorCode::DeadlineExceeded);
  ASSERT_TRUE(result.undo);
  EXPECT_TRUE(result.undo->restored) << result.why();
  EXPECT_TRUE(robot_.host.observe().empty());
  const auto again = runtime_.request(network, hasty);
  EXPECT_TRUE(eventually([&] { return !robot_.host.tasks().empty(); }));
  EXPECT_TRUE(robot_.host.observe().tasks.size() <= 1U);
  EXPECT_EQ(runtime_.belief().name, model::NetworkName()) << "the runtime answers all the same";
  again.wait();
  go.set_value();
  const auto done = runtime_.switch_to(network);
  EXPECT_EQ(done.outcome, Outcome::Done) << done.why();
  expect_truth(network);
}

TEST_F(RuntimeTest, ATaskThatFailsCausesAnEventAndChangesTheBelief) {
  auto failing = first_;
  failing.find_task(model::TaskId("kept"))
      ->properties.as_map()
      .set("stand_in", type::Value::map({{"fail", "update"}, {"rate", 1000}}));
  ASSERT_EQ(runtime_.switch_to(failing).outcome, Outcome::Done);
  const auto is_failed = [&] {
    return runtime_.belief().find_task(model::TaskId("kept"))->state == TaskState::Exception;
  };
  const auto deadline = RealClock::instance().now() + std::chrono::seconds(30);
  std::uint64_t last = 0;
  while (!is_failed() && RealClock::instance().now() < deadline) {
    for (const auto& event : runtime_.events(last, std::chrono::seconds(1))) {
      last = event.number;
    }
  }
  ASSERT_TRUE(is_failed());
  const auto result = switch_to("first");
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  expect_truth(first_);
}

TEST(BeliefTest, AnEventDuringASnapshotIsNotLost) {
  const model::ComponentCatalog catalog;
  const task_host::LibrarySet libraries;
  task_host::LocalTaskHost tasks(libraries, catalog,
                                 {.stand_in = true, .only_stand_ins = false, .stand_ins = {}});
  testing::AskingHost host(tasks);
  const auto network = network_of("network: n\ntasks: {kept: {component: a::Kept}}\n");
  const auto way = solve::diff({}, network, catalog);
  ASSERT_TRUE(way);
  for (const auto& action : way->actions) {
    ASSERT_TRUE(host.perform(action, RealClock::instance().now() + std::chrono::seconds(30)));
  }
  detail::Belief belief(host);
  host.set_listener(
      [&](const task_host::HostEvent& event) { belief.on_event(std::get<task_host::TaskEvent>(event)); });
  const model::TaskId kept("kept");
  const auto look_and_adopt = [&] {
    const auto seen = belief.observe();
    belief.adopt(detail::split_observation(seen.network, network, network), seen.task_events);
    return belief.controller().find_task(kept)->state;
  };
  host.tell_after_look({kept, TaskState::Exception, "broke"});
  EXPECT_EQ(look_and_adopt(), TaskState::Exception);
  EXPECT_EQ(look_and_adopt(), TaskState::Running) << "a later snapshot overrides the event";

  const auto before = belief.observe();
  belief.adopt_assumed({});
  EXPECT_FALSE(belief.refresh(detail::split_observation(before.network, network, network), before));
  EXPECT_TRUE(belief.is_assumed()) << "a belief given meanwhile is kept";
  host.set_listener({});
}

TEST_F(RuntimeTest, BeliefCanBeGivenAndReset) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  runtime_.reset_belief(second_);
  EXPECT_FALSE(runtime_.observed_differences().empty());
  EXPECT_TRUE(runtime_.plan(model::NetworkName("second"))->actions.empty())
      << "the plan starts from the given belief";
  runtime_.reset_belief();
  EXPECT_EQ(runtime_.belief().name, model::NetworkName("first"));
  expect_truth(first_);
}

TEST_F(RuntimeTest, APropertyChangedFromOutsideIsDriftAndUndoneByTheNextRequest) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  const auto deadline = RealClock::instance().now() + std::chrono::seconds(30);
  ASSERT_TRUE(robot_.host.set_property(model::TaskId("changed"), "gain", 7, deadline));
  EXPECT_EQ(runtime_.observed_differences().size(), 1U);
  const auto result = switch_to("first");
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_FALSE(result.actions.empty());
  expect_truth(first_);
}

TEST_F(RuntimeTest, NothingDiffersAfterAResetHoweverMuchOfItWasNoticedBefore) {
  for (const bool noticed : {false, true}) {
    ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
    const auto deadline = RealClock::instance().now() + std::chrono::seconds(30);
    ASSERT_TRUE(robot_.host.set_property(model::TaskId("changed"), "gain", 7, deadline));
    if (noticed) {
      EXPECT_TRUE(eventually([&] { return differences(runtime_.belief(), robot_.host.observe()).empty(); }));
    }
    runtime_.reset_belief();
    EXPECT_THAT(runtime_.observed_differences(), ::testing::IsEmpty()) << noticed;
    EXPECT_EQ(runtime_.belief().name, model::NetworkName("first")) << "with a property that was set";
  }
}

TEST_F(RuntimeTest, EventsAreNumberedWithoutGaps) {
  ASSERT_EQ(switch_to("first").outcome, Outcome::Done);
  const auto events = runtime_.events();
  ASSERT_FALSE(events.empty());
  for (std::size_t index = 0; index < events.size(); ++index) {
    EXPECT_EQ(events[index].number, index + 1);
  }
  EXPECT_TRUE(runtime_.events(events.back().number).empty());
  EXPECT_EQ(runtime_.events(events.back().number - 1).size(), 1U);
}

}  // namespace
}  // namespace segue::runtime
