// SPDX-License-Identifier: Apache-2.0
//
// Requests that are cancelled: before each action, behind the point of commit, while they are undone.
#include <segue/model/network_sets.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/eventually.hpp>
#include <support/faulty_host.hpp>

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::runtime {
namespace {

using testing::AskingHost;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::network_of;
using testing::StandInRobot;

const std::string kBefore =
    "network: before\n"
    "tasks: {a: {component: \"demo::A\"}, b: {component: \"demo::A\", properties: {gain: 1}}}\n"
    "connections: [a.out -> b.in]\n";
const std::string kTarget =
    "network: target\n"
    "tasks: {b: {component: \"demo::A\", properties: {gain: 2}}, c: {component: \"demo::B\"}}\n"
    "connections: [c.out -> b.in]\n";

TimePoint in_a_while() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

SwitchResult end_of(Result<std::future<SwitchResult>> cancelled) {
  EXPECT_TRUE(cancelled) << to_string(cancelled.error());
  if (!cancelled || cancelled->wait_until(in_a_while()) != std::future_status::ready) {
    ADD_FAILURE() << "it does not end";
    return {};
  }
  return cancelled->get();
}

/// A robot that runs `before`.
struct Robot : StandInRobot {
  explicit Robot(RuntimeOptions options = {}) : StandInRobot(std::move(options)) {
    EXPECT_EQ(runtime.switch_to(before).outcome, Outcome::Done);
  }
  std::vector<model::Action> planned() {
    const auto transition = runtime.plan(target);
    EXPECT_TRUE(transition);
    return transition ? transition->actions : std::vector<model::Action>{};
  }
  void expect_restored() {
    EXPECT_EQ(runtime.state(), RuntimeState::Idle);
    EXPECT_EQ(runtime.belief().name, before.name);
    EXPECT_THAT(differences(before, host.observe()), IsEmpty());
    EXPECT_THAT(runtime.open_requests(), IsEmpty());
  }

  const model::Network before = network_of(kBefore);
  const model::Network target = network_of(kTarget);
};

bool is_same(const model::Action& one, const model::Action& other) {
  return one.phase == other.phase && one.label() == other.label();
}

TEST(Cancel, BeforeEachActionUntilThePointOfCommitUndoesAllOfIt) {
  Robot robot;
  int undone = 0;
  for (const auto& at : robot.planned()) {
    SCOPED_TRACE(at.label());
    std::atomic<bool> done = false;
    std::promise<Result<std::future<SwitchResult>>> cancelled;
    robot.asking.ask([&](const model::Action& action) -> Result<void> {
      if (is_same(action, at) && !done.exchange(true)) {
        cancelled.set_value(robot.runtime.cancel(0, "ann"));
      }
      return {};
    });
    const auto result = robot.runtime.switch_to(robot.target);
    robot.asking.ask({});
    ASSERT_TRUE(done);
    auto answer = cancelled.get_future().get();
    if (at.phase == model::Phase::Retire) {
      ASSERT_FALSE(answer);
      EXPECT_EQ(answer.error().code, ErrorCode::InvalidState);
      EXPECT_THAT(answer.error().message, HasSubstr("past its point of commit"));
      EXPECT_EQ(result.outcome, Outcome::Done);
      ASSERT_EQ(robot.runtime.switch_to(robot.before).outcome, Outcome::Done);
      continue;
    }
    ++undone;
    EXPECT_EQ(end_of(std::move(answer)).outcome, Outcome::Cancelled);
    ASSERT_EQ(result.outcome, Outcome::Cancelled) << result.why();
    EXPECT_EQ(result.cancelled_by, "ann");
    EXPECT_THAT(result.why(), HasSubstr("was cancelled by ann; it was undone: the robot runs 'before'"));
    ASSERT_TRUE(result.undo && result.undo->restored);
    robot.expect_restored();
  }
  EXPECT_GT(undone, 4);
}

TEST(Cancel, AfterEachActionLeavesTheOldNetworkOrTheNewOne) {
  Robot robot;
  for (const auto& at : robot.planned()) {
    SCOPED_TRACE(at.label());
    std::atomic<bool> done = false;
    std::atomic<bool> accepted = false;
    robot.asking.ask_after([&](const model::Action& action) -> Result<void> {
      if (is_same(action, at) && !done.exchange(true)) {
        accepted = robot.runtime.cancel(0, "ann").has_value();
      }
      return {};
    });
    const auto result = robot.runtime.switch_to(robot.target);
    robot.asking.ask_after({});
    EXPECT_EQ(result.outcome, accepted ? Outcome::Cancelled : Outcome::Done) << result.why();
    EXPECT_EQ(accepted, at.phase != model::Phase::Retire);
    EXPECT_THAT(differences(accepted ? robot.before : robot.target, robot.host.observe()), IsEmpty());
    ASSERT_EQ(robot.runtime.switch_to(robot.before).outcome, Outcome::Done);
  }
}

TEST(Cancel, OfNothingAndOfOtherRequestsIsRefused) {
  Robot robot;
  const auto nothing = robot.runtime.cancel(0, "ann");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::NotFound);
  EXPECT_THAT(nothing.error().message, HasSubstr("nothing to cancel"));
  const auto ended = robot.runtime.cancel(1, "ann");
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, ErrorCode::NotFound);
}

/// Holds the transition to `target` at its first action.
struct Held : Robot {
  explicit Held(const std::string& holder = "") {
    if (!holder.empty()) {
      lease = runtime.served().take_lease(holder).value();
    }
    asking.ask([held = gate](const model::Action&) -> Result<void> {
      if (!held->entered.exchange(true)) {
        held->reached.set_value();
        held->released.get_future().wait_until(in_a_while());
      }
      return {};
    });
    result = runtime.request(target, {.who = "bob", .lease = lease});
    EXPECT_EQ(gate->reached.get_future().wait_until(in_a_while()), std::future_status::ready);
  }
  struct Gate {
    std::atomic<bool> entered = false;
    std::promise<void> reached;
    std::promise<void> released;
  };
  const std::shared_ptr<Gate> gate = std::make_shared<Gate>();  ///< outlives the runtime
  std::uint64_t lease = 0;
  std::future<SwitchResult> result;
};

TEST(Cancel, IsAnsweredWhenTheActionThatHangsHasReturned) {
  Held robot;
  const auto open = robot.runtime.open_requests();
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(open[0].who, "bob");
  EXPECT_EQ(open[0].state, "prepare");
  auto first = robot.runtime.cancel(open[0].request, "ann");
  auto second = robot.runtime.cancel(open[0].request, "eve");
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->wait_for(std::chrono::milliseconds(1)), std::future_status::timeout);
  EXPECT_EQ(robot.runtime.open_requests()[0].cancelled_by, "ann");
  robot.gate->released.set_value();
  EXPECT_EQ(end_of(std::move(first)).cancelled_by, "ann");
  EXPECT_EQ(end_of(std::move(second)).cancelled_by, "ann") << "who came first";
  robot.expect_restored();
}

TEST(Cancel, ComesWithTheEndOfTheLeaseOfWhoeverRequested) {
  Held robot("ann");
  robot.runtime.served().end_lease(robot.lease);
  robot.gate->released.set_value();
  const auto result = robot.result.get();
  EXPECT_EQ(result.outcome, Outcome::Cancelled);
  EXPECT_EQ(result.cancelled_by, "the end of the lease of ann");
  robot.expect_restored();
}

TEST(Cancel, DoesNotComeWithTheEndOfTheLeaseOfSomebodyElse) {
  Held robot;
  robot.runtime.served().end_lease(robot.runtime.served().take_lease("ann").value());
  robot.gate->released.set_value();
  EXPECT_EQ(robot.result.get().outcome, Outcome::Done);
}

TEST(Cancel, FollowsWhoeverWaitsForARequestNoLonger) {
  Held robot;
  EXPECT_FALSE(robot.runtime.add_controller(robot.before).has_errors());
  RuntimeService service(robot.runtime, nullptr, [] {});
  std::stop_source stop;
  auto waits = std::async(std::launch::async, [&] {
    return service.switch_to("before", {.who = "eve"}, {in_a_while(), stop.get_token()});
  });
  EXPECT_TRUE(segue::testing::eventually([&] { return robot.runtime.open_requests().size() == 2; }));
  stop.request_stop();
  EXPECT_EQ(waits.get().error().code, ErrorCode::Cancelled) << "while the other one is still held";
  EXPECT_TRUE(segue::testing::eventually([&] { return robot.runtime.open_requests().size() == 1; }));
  robot.gate->released.set_value();
  EXPECT_EQ(robot.result.get().outcome, Outcome::Superseded) << "as it was when the newer one came";
}

TEST(Cancel, OfARequestThatWaitsLeavesTheOneInProgress) {
  Robot robot;
  std::promise<void> reached;
  std::promise<void> release;
  std::atomic<bool> entered = false;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    if (action.phase == model::Phase::Commit && !entered.exchange(true)) {
      reached.set_value();
      release.get_future().wait_until(in_a_while());
    }
    return {};
  });
  auto result = robot.runtime.request(robot.target);
  reached.get_future().wait_until(in_a_while());
  auto waits = robot.runtime.request(robot.before);
  ASSERT_EQ(robot.runtime.open_requests().size(), 2U);
  EXPECT_EQ(robot.runtime.open_requests()[1].state, "waiting");
  EXPECT_EQ(end_of(robot.runtime.cancel(0, "ann")).outcome, Outcome::Cancelled);
  const auto withdrawn = waits.get();
  EXPECT_EQ(withdrawn.outcome, Outcome::Cancelled);
  EXPECT_FALSE(withdrawn.undo);
  release.set_value();
  EXPECT_EQ(result.get().outcome, Outcome::Done);
}

TEST(Cancel, WhileAFailureIsUndoneIsRefused) {
  Robot robot;
  std::optional<Error> refusal;
  std::atomic<int> commits = 0;
  bool failed = false;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    if (failed && !refusal) {
      const auto answer = robot.runtime.cancel(0, "ann");
      if (!answer) refusal = answer.error();
    }
    if (action.phase == model::Phase::Commit && ++commits == 2) {
      failed = true;
      return fail(ErrorCode::HookFailed, "broken");
    }
    return {};
  });
  const auto result = robot.runtime.switch_to(robot.target);
  robot.asking.ask({});
  EXPECT_EQ(result.outcome, Outcome::Failed);
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->message, HasSubstr("is being undone already"));
  robot.expect_restored();
}

TEST(Cancel, WhileItIsUndoneAfterACancelIsAnsweredWithTheSameResult) {
  Robot robot;
  std::vector<Result<std::future<SwitchResult>>> answers;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    const bool undoes = !answers.empty() && answers.size() < 2;
    if (undoes || (answers.empty() && action.phase == model::Phase::Commit)) {
      answers.push_back(robot.runtime.cancel(0, answers.empty() ? "ann" : "eve"));
    }
    return {};
  });
  const auto result = robot.runtime.switch_to(robot.target);
  robot.asking.ask({});
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(result.outcome, Outcome::Cancelled);
  for (auto& answer : answers) {
    EXPECT_EQ(end_of(std::move(answer)).cancelled_by, "ann");
  }
  robot.expect_restored();
}

TEST(Cancel, LetsANewerRequestFollowTheUndoing) {
  Held robot;
  auto cancelled = robot.runtime.cancel(0, "ann");
  auto newer = robot.runtime.request(robot.target);
  robot.gate->released.set_value();
  EXPECT_EQ(end_of(std::move(cancelled)).outcome, Outcome::Cancelled);
  EXPECT_EQ(newer.get().outcome, Outcome::Done);
  EXPECT_EQ(robot.runtime.belief().name, robot.target.name);
}

TEST(Cancel, OfASupersededRequestIsRefused) {
  Held robot;
  const auto number = robot.runtime.open_requests()[0].request;
  auto newer = robot.runtime.request(robot.target);
  const auto refused = robot.runtime.cancel(number, "ann");
  robot.gate->released.set_value();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("a newer request has taken its place"));
  EXPECT_EQ(robot.result.get().outcome, Outcome::Superseded);
  EXPECT_EQ(newer.get().outcome, Outcome::Done);
}

/// The next transition takes the rest away.
TEST(Retire, EndsWithTheActionInProgressWhenSomethingNewerIsRequested) {
  Robot robot;
  std::promise<std::future<SwitchResult>> newer;
  std::atomic<bool> done = false;
  robot.asking.ask([&](const model::Action& action) -> Result<void> {
    if (action.phase == model::Phase::Retire && !done.exchange(true))
      newer.set_value(robot.runtime.request(robot.before));
    return {};
  });
  const auto result = robot.runtime.switch_to(robot.target);
  ASSERT_TRUE(done);
  EXPECT_EQ(result.outcome, Outcome::Done) << result.why();
  EXPECT_FALSE(result.actions.back().executed) << result.actions.back().action.label();
  EXPECT_EQ(newer.get_future().get().get().outcome, Outcome::Done);
  robot.expect_restored();
}

TEST(Cancel, EndsWithTheRuntime) {
  auto robot = std::make_unique<Held>();
  auto cancelled = robot->runtime.cancel(0, "ann");
  ASSERT_TRUE(cancelled);
  robot->gate->released.set_value();
  robot.reset();
  EXPECT_EQ(cancelled->wait_until(in_a_while()), std::future_status::ready);
}

/// Each fault at each action, where somebody cancels as that action begins: the old network runs, or what
/// runs is known.
TEST(Cancel, TogetherWithAFaultEndsInTheOldNetworkOrSaysWhatRuns) {
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost tasks{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  segue::testing::FaultyHost faulty{tasks};
  AskingHost host{faulty};
  Runtime runtime{"robot", host, catalog};
  const auto before = network_of(kBefore + "deployments: {one: {tasks: [a]}, two: {tasks: [b]}}\n");
  const auto target = network_of(kTarget + "deployments: {two: {tasks: [b]}, three: {tasks: [c]}}\n");
  ASSERT_EQ(runtime.switch_to(before).outcome, Outcome::Done);
  const auto plan = runtime.plan(target);
  ASSERT_TRUE(plan);
  int restored = 0;
  for (const auto& at : plan->actions) {
    for (const auto fault : segue::testing::kFaults) {
      SCOPED_TRACE(at.label() + ", " +
                   std::string(segue::testing::kFaultNames.at(static_cast<std::size_t>(fault))));
      std::atomic<bool> done = false;
      std::atomic<bool> accepted = false;
      faulty.arm(fault, at.label());
      host.ask([&](const model::Action& action) -> Result<void> {
        if (is_same(action, at) && !done.exchange(true)) accepted = runtime.cancel(0, "ann").has_value();
        return {};
      });
      const auto result = runtime.switch_to(target);
      host.ask({});
      const auto observed = host.observe();
      EXPECT_EQ(result.outcome == Outcome::Cancelled, accepted) << result.why();
      if (accepted && result.undo->restored) {
        ++restored;
        EXPECT_EQ(runtime.belief().name, before.name);
        EXPECT_TRUE(model::includes(observed, before));
      } else if (accepted) {
        EXPECT_EQ(runtime.state(), RuntimeState::Failed);
        EXPECT_THAT(differences(runtime.belief(), observed), IsEmpty());
      }
      faulty.heal();
      const auto back = runtime.switch_to(before);
      ASSERT_EQ(back.outcome, Outcome::Done) << back.why();
    }
  }
  EXPECT_GT(restored, 20);
}

/// Many at once, for the thread sanitizer.
TEST(Cancel, FromSeveralThreadsEndsEachRequestInOneNetwork) {
  Robot robot;
  std::atomic<int> round = 0;
  std::atomic<bool> ends = false;
  std::array<std::vector<Result<std::future<SwitchResult>>>, 3> accepted;
  std::vector<std::thread> threads;
  for (auto& mine : accepted) {
    threads.emplace_back([&] {
      while (!ends) {
        (void)robot.runtime.open_requests();
        if (round % 2 != 0) {
          if (auto answer = robot.runtime.cancel(0, "ann")) mine.push_back(std::move(answer));
        }
        std::this_thread::yield();
      }
    });
  }
  std::set<std::uint64_t> done;
  std::set<std::uint64_t> cancelled;
  const model::Network* runs = &robot.before;
  const TimePoint limit = in_a_while();
  for (; round < 40 || ((done.empty() || cancelled.empty()) && RealClock::instance().now() < limit);
       ++round) {
    const auto* wanted = runs == &robot.before ? &robot.target : &robot.before;
    const auto result = robot.runtime.switch_to(*wanted);
    if (result.outcome == Outcome::Done) {
      done.insert(result.request);
      runs = wanted;
    } else {
      ASSERT_EQ(result.outcome, Outcome::Cancelled) << result.why();
      cancelled.insert(result.request);
    }
    EXPECT_NE(robot.runtime.state(), RuntimeState::Failed);
    EXPECT_EQ(robot.runtime.belief().name, runs->name);
    EXPECT_THAT(differences(*runs, robot.host.observe()), IsEmpty());
  }
  ends = true;
  for (auto& thread : threads) {
    thread.join();
  }
  EXPECT_FALSE(done.empty());
  EXPECT_FALSE(cancelled.empty());
  std::set<std::uint64_t> answered;
  for (auto& mine : accepted) {
    for (auto& answer : mine) {
      answered.insert(end_of(std::move(answer)).request);
    }
  }
  EXPECT_EQ(answered, cancelled) << "whose cancelling was accepted, and nobody else";
}

}  // namespace
}  // namespace segue::runtime
