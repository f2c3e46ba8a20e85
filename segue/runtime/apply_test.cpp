// SPDX-License-Identifier: Apache-2.0
//
// Files that are applied to a running runtime, beside other requests.
#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/test_support.hpp>
#include <segue/task/component.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <string>

namespace runtime_apply_test {

class Motor final : public segue::task::Component {
  segue::task::Property<double> speed_{*this, "speed", 1};
};

}  // namespace runtime_apply_test

SEGUE_COMPONENT(runtime_apply_test::Motor)

namespace segue::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::network_of;

const model::NetworkName kWork{"work"};
const model::NetworkName kRest{"rest"};

model::Network work(int gain, const std::string& more = "") {
  return network_of(
      "network: work\ntasks:\n  arm: {component: a::Arm, properties: {gain: " + std::to_string(gain) + more +
          "}}\n  eye: {component: a::Eye}\nconnections: [eye.out -> arm.in]\n",
      "work.yaml");
}

model::Network rest() {
  return network_of("network: rest\ntasks:\n  eye: {component: a::Eye}\n", "rest.yaml");
}

ControllerSet set_of(std::vector<model::Network> networks) {
  return {std::move(networks), {}, {}};
}

class ApplyTest : public ::testing::Test {
 protected:
  ApplyTest() { EXPECT_FALSE(runtime_.load(set_of({work(1), rest()})).has_errors()); }

  ApplyResult apply(std::vector<model::Network> networks) {
    return runtime_.apply(set_of(std::move(networks))).get();
  }
  void expect_runs(const model::Network& network) {
    EXPECT_THAT(differences(network, runtime_.belief()), IsEmpty());
    EXPECT_EQ(runtime_.belief().name, network.name);
    EXPECT_EQ(runtime_.version(), network.version);
    EXPECT_THAT(runtime_.observed_differences(), IsEmpty());
  }

  /// The next action waits for `go_`; see wait_until_held().
  void hold() {
    robot_.asking.ask([this, gate = go_.get_future().share()](const model::Action&) -> Result<void> {
      if (!held_.exchange(true)) {
        entered_.set_value();
        gate.wait();
      }
      return {};
    });
  }
  void wait_until_held() {
    ASSERT_EQ(entered_.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
  }

  std::promise<void> entered_;
  std::promise<void> go_;
  std::atomic<bool> held_{false};
  testing::StandInRobot robot_;
  Runtime& runtime_ = robot_.runtime;
};

TEST_F(ApplyTest, TheRunningControllerGoesToItsNewVersion) {
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  expect_runs(work(1));
  const auto result = apply({work(2), rest()});
  ASSERT_EQ(result.outcome, Outcome::Done);
  ASSERT_EQ(result.changes.size(), 1U);
  EXPECT_EQ(result.changes[0].controller, kWork);
  EXPECT_TRUE(result.changes[0].runs);
  EXPECT_THAT(result.changes[0].edits, ElementsAre("task 'arm': property 'gain': 1 -> 2"));
  ASSERT_TRUE(result.transition);
  EXPECT_EQ(result.transition->cause, Cause::Apply);
  EXPECT_EQ(result.transition->from_version, work(1).version);
  EXPECT_EQ(result.transition->runs_version, work(2).version);
  for (const auto& record : result.transition->actions)
    EXPECT_TRUE(!record.action.task() || *record.action.task() == model::TaskId("arm"))
        << record.action.label();
  expect_runs(work(2));
  EXPECT_EQ(runtime_.history().back().cause, Cause::Apply);
}

TEST_F(ApplyTest, WhatDoesNotRunIsReplacedWithoutAnAction) {
  ASSERT_EQ(runtime_.switch_to(kRest).outcome, Outcome::Done);
  const auto extra = network_of("network: extra\ntasks: {eye: {component: a::Eye}}\n");
  const auto result = apply({extra, rest()});
  ASSERT_EQ(result.outcome, Outcome::Done);
  EXPECT_FALSE(result.transition);
  EXPECT_THAT(runtime_.controllers(), ElementsAre(extra.name, kRest));
  EXPECT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Refused) << "its file has vanished";
  expect_runs(rest());
}

TEST_F(ApplyTest, ANetworkThatCannotRunHereLeavesEverythingAsItWas) {
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  const auto broken =
      network_of("network: rest\ntasks: {eye: {component: a::Eye}}\nconnections: [eye.out -> ear.in]\n");
  const auto result = apply({work(2), broken});
  EXPECT_EQ(result.outcome, Outcome::Refused);
  EXPECT_TRUE(result.error->diagnostics);
  EXPECT_EQ(runtime_.controller(kWork)->version, work(1).version);
  expect_runs(work(1));
}

TEST_F(ApplyTest, AmongStandInsAWrongValueOfAnInstalledComponentIsRefusedBeforeAnyAction) {
  auto models = robot_.libraries.export_models("", robot_.catalog.types());
  ASSERT_TRUE(models);
  for (auto& model : *models)
    robot_.catalog.add(std::move(model));
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  const auto refused = [&](const std::string& text) {
    const auto result = apply({network_of("network: work\n" + text)});
    EXPECT_EQ(result.outcome, Outcome::Refused) << text;
    EXPECT_FALSE(result.transition) << text;
    expect_runs(work(1));
    return result.why();
  };
  const std::string motor = "tasks: {motor: {component: \"runtime_apply_test::Motor\"";
  EXPECT_THAT(refused(motor + ", properties: {speed: fast}}}\n"), HasSubstr("motor.speed"));
  EXPECT_THAT(refused(motor + ", properties: {sped: 1}}}\n"), HasSubstr("no property 'sped'"));
  EXPECT_THAT(refused(motor + "}, arm: {component: a::Arm}}\nconnections: [motor.turns -> arm.in]\n"),
              HasSubstr("no output port 'turns'"));
  EXPECT_THAT(refused("tasks: {arm: {component: a::Arm, properties: {stand_in: {configure: soon}}}}\n"),
              HasSubstr("stand_in"));
  EXPECT_EQ(apply({network_of("network: work\n" + motor + ", properties: {speed: 2.5}}}\n")}).outcome,
            Outcome::Done);
}

TEST_F(ApplyTest, AmongStandInsAValueThatTheModelExcludesIsRefusedBeforeAnyAction) {
  Diagnostics diagnostics;
  model::read_components(
      "components: {a::Arm: {ports: [{name: in, direction: input, type: /double}], "
      "properties: [{name: gain, type: /double}]}}\n",
      "arm.yaml", robot_.catalog, diagnostics);
  ASSERT_TRUE(diagnostics.empty()) << to_string(diagnostics);
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  const auto result =
      apply({network_of("network: work\ntasks: {arm: {component: a::Arm, properties: {gain: high}}}\n")});
  EXPECT_EQ(result.outcome, Outcome::Refused);
  EXPECT_THAT(result.why(), HasSubstr("arm.gain"));
  expect_runs(work(1));
}

TEST_F(ApplyTest, AControllerThatRunsOutlivesItsFile) {
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  const auto result = apply({rest()});
  EXPECT_EQ(result.outcome, Outcome::Done);
  ASSERT_EQ(result.changes.size(), 1U);
  EXPECT_EQ(result.changes[0].kind, ControllerChange::Kind::Removed);
  EXPECT_TRUE(result.changes[0].runs);
  expect_runs(work(1));
  EXPECT_FALSE(runtime_.controller(kWork));
}

TEST_F(ApplyTest, AControllerThatTheProgramAddedStays) {
  const auto own = network_of("network: own\ntasks: {eye: {component: a::Eye}}\n");
  ASSERT_FALSE(runtime_.add_controller(own).has_errors());
  ASSERT_EQ(apply({rest()}).outcome, Outcome::Done);
  EXPECT_THAT(runtime_.controllers(), ElementsAre(own.name, kRest));
}

TEST_F(ApplyTest, ATransitionThatFailsBringsTheOldControllersBack) {
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  const auto broken = work(2, ", stand_in: {fail: configure}");
  const auto result = apply({broken});
  ASSERT_EQ(result.outcome, Outcome::Failed);
  ASSERT_TRUE(result.transition && result.transition->undo);
  EXPECT_TRUE(result.transition->undo->restored);
  EXPECT_EQ(result.transition->runs_version, work(1).version);
  EXPECT_THAT(to_string(*result.error), HasSubstr("the robot runs 'work' as before"));
  expect_runs(work(1));
  EXPECT_EQ(runtime_.controller(kWork)->version, work(1).version);
  EXPECT_THAT(runtime_.controllers(), ElementsAre(kRest, kWork));
  EXPECT_EQ(apply({work(3)}).outcome, Outcome::Done);
  expect_runs(work(3));
}

TEST_F(ApplyTest, ATransitionThatFailsBringsTheOldHaltBack) {
  auto before = set_of({work(1), rest()});
  before.halt = model::Halt();
  before.halt->controller = kRest;
  before.halt->at_rest = {{model::TaskReaches{"eye", "running"}, {}}};
  before.halt->within = std::chrono::seconds(60);
  ASSERT_EQ(runtime_.apply(before).get().outcome, Outcome::Done);
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  ASSERT_EQ(apply({work(2, ", stand_in: {fail: configure}"), rest()}).outcome, Outcome::Failed);
  EXPECT_TRUE(runtime_.halt({.who = "ann"}).get().at_rest);
  expect_runs(rest());
}

TEST_F(ApplyTest, ItWaitsForASwitchInProgressAndSupersedesNothing) {
  ASSERT_EQ(runtime_.switch_to(kRest).outcome, Outcome::Done);
  hold();
  auto switched = runtime_.request(kWork);
  wait_until_held();
  auto applied = runtime_.apply(set_of({work(2), rest()}));
  go_.set_value();
  const auto first = switched.get();
  EXPECT_EQ(first.outcome, Outcome::Done) << first.why();
  EXPECT_EQ(first.runs_version, work(1).version) << "it was requested before the files were applied";
  const auto second = applied.get();
  EXPECT_EQ(second.outcome, Outcome::Done);
  EXPECT_EQ(second.transition->to_version, work(2).version);
  expect_runs(work(2));
}

TEST_F(ApplyTest, ASwitchOvertakesItsTransitionAndTheFilesStayApplied) {
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  hold();
  auto added = network_of("network: work\ntasks: {arm: {component: a::Arm}, ear: {component: a::Ear}}\n");
  auto applied = runtime_.apply(set_of({added, rest()}));
  wait_until_held();
  auto switched = runtime_.request(kRest);
  go_.set_value();
  const auto result = switched.get();
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_EQ(applied.get().outcome, Outcome::Done);
  expect_runs(rest());
  EXPECT_EQ(runtime_.controller(kWork)->version, added.version);
}

TEST_F(ApplyTest, ControllersOnStandbyArePreparedAnew) {
  ASSERT_EQ(runtime_.switch_to(kRest).outcome, Outcome::Done);
  ASSERT_TRUE(runtime_.prepare({kWork}).get().at(0).ready);
  const std::uint64_t before = runtime_.events().back().number;
  ASSERT_EQ(apply({work(2), rest()}).outcome, Outcome::Done);
  const auto deadline = RealClock::instance().now() + std::chrono::seconds(60);
  const auto is_prepared = [](const Event& event) { return event.kind == EventKind::Prepared; };
  while (std::ranges::none_of(runtime_.events(before), is_prepared) && RealClock::instance().now() < deadline)
    (void)runtime_.events(runtime_.events().back().number, std::chrono::seconds(1));
  EXPECT_TRUE(runtime_.readiness().at(0).ready) << runtime_.readiness().at(0).reason;
  const auto result = runtime_.switch_to(kWork);
  ASSERT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_TRUE(std::ranges::none_of(result.actions, [](const ActionRecord& record) {
    return record.action.kind == model::ActionKind::ApplyConfig ||
           record.action.kind == model::ActionKind::Configure;
  })) << "the new version was configured ahead";
  expect_runs(work(2));
}

TEST_F(ApplyTest, APreparationInProgressMakesWay) {
  ASSERT_EQ(runtime_.switch_to(kRest).outcome, Outcome::Done);
  hold();
  auto prepared = runtime_.prepare({kWork});
  wait_until_held();
  auto applied = runtime_.apply(set_of({work(2), rest()}));
  go_.set_value();
  EXPECT_EQ(applied.get().outcome, Outcome::Done);
  (void)prepared.get();
  const auto history = runtime_.history();
  EXPECT_TRUE(std::ranges::any_of(history, [](const SwitchResult& result) {
    return result.cause == Cause::LookAhead && result.outcome == Outcome::Superseded;
  }));
  ASSERT_EQ(runtime_.switch_to(kWork).outcome, Outcome::Done);
  expect_runs(work(2));
}

TEST_F(ApplyTest, NewerFilesTakeThePlaceOfThoseThatWait) {
  ASSERT_EQ(runtime_.switch_to(kRest).outcome, Outcome::Done);
  hold();
  auto switched = runtime_.request(kWork);
  wait_until_held();
  auto first = runtime_.apply(set_of({work(2), rest()}));
  auto broken = runtime_.apply(set_of({work(3, ", stand_in: {fail: configure}"), rest()}));
  EXPECT_EQ(first.get().outcome, Outcome::Superseded);
  go_.set_value();
  EXPECT_EQ(switched.get().outcome, Outcome::Done);
  EXPECT_EQ(broken.get().outcome, Outcome::Failed);
  expect_runs(work(1));
  EXPECT_EQ(runtime_.controller(kWork)->version, work(1).version)
      << "the controllers are those before the first of the two";
}

TEST_F(ApplyTest, ARuntimeThatEndsAnswersFilesThatWait) {
  auto robot = std::make_unique<testing::StandInRobot>();
  ASSERT_FALSE(robot->runtime.load(set_of({work(1)})).has_errors());
  std::future<ApplyResult> applied;
  robot->asking.ask([&](const model::Action&) -> Result<void> {
    if (!held_.exchange(true)) applied = robot->runtime.apply(set_of({work(2)}));
    return {};
  });
  const auto first = robot->runtime.switch_to(kWork);
  EXPECT_EQ(first.outcome, Outcome::Done) << first.why();
  robot.reset();
  EXPECT_EQ(applied.wait_for(std::chrono::seconds(0)), std::future_status::ready);
}

}  // namespace
}  // namespace segue::runtime
