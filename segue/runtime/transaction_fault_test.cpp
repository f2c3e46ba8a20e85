// SPDX-License-Identifier: Apache-2.0
//
// A fault at every action of many transitions: the robot then runs what it did, or what was wanted, or the
// runtime says truthfully what it runs.
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/random_networks.hpp>

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <cstdlib>

namespace segue::runtime {
namespace {

using testing::runnable;
using testing::why;

constexpr const char* kArtemis = SEGUE_SOURCE_DIR "/examples/04_artemis/robot.yaml";

enum class Fault {
  Refused,    ///< the action is not done, once
  Doubted,    ///< it is done and reported as failed, once
  Persistent  ///< whatever is tried with it fails, on the way back too
};
constexpr std::array kFaults = {Fault::Refused, Fault::Doubted, Fault::Persistent};

Result<void> broken() {
  return fail(ErrorCode::IoError, "a fault");
}

/// Does to the host what a fault does.
void inject(testing::AskingHost& host, Fault fault, const std::string& label, std::atomic<bool>& struck) {
  const auto strikes = [&struck, fault, label](const model::Action& action) -> Result<void> {
    if (action.label() != label || (fault != Fault::Persistent && struck.exchange(true))) {
      return {};
    }
    struck = true;
    return broken();
  };
  if (fault == Fault::Doubted) {
    host.ask_after(strikes);
  } else {
    host.ask(strikes);
  }
}

void let_be(testing::AskingHost& host) {
  host.ask(nullptr);
  host.ask_after(nullptr);
}

/// How often each of the three allowed ends was seen.
struct Ends {
  int target = 0;
  int before = 0;
  int told = 0;
  [[nodiscard]] int all() const { return target + before + told; }
};

void judge(Runtime& runtime, const host::TaskHost& host, const SwitchResult& result,
           const model::Network& before, const model::Network& target, Ends& ends) {
  const model::Network observed = host.observe();
  if (result.outcome == Outcome::Done) {
    ++ends.target;
    if (!result.leftover) {
      EXPECT_THAT(differences(target, observed), ::testing::IsEmpty());
    }
    EXPECT_EQ(runtime.belief().name, target.name);
  } else if (result.undo && result.undo->restored) {
    ++ends.before;
    EXPECT_EQ(runtime.belief().name, before.name);
    for (const auto& task : before.tasks) {
      const auto* now = observed.find_task(task.id);
      ASSERT_NE(now, nullptr) << task.id.str();
      EXPECT_EQ(*now, task) << task.id.str();
    }
  } else {
    ++ends.told;
    EXPECT_EQ(runtime.state(), RuntimeState::Failed);
    EXPECT_THAT(why(result), ::testing::HasSubstr("the robot now runs"));
    EXPECT_THAT(differences(runtime.belief(), observed), ::testing::IsEmpty());
  }
}

/// The transition with that fault at that action; afterwards the robot runs `before` again.
void try_fault(testing::StandInRobot& robot, const model::Network& before, const model::Network& target,
               const model::Action& action, Fault fault, Ends& ends) {
  SCOPED_TRACE(before.name.str() + " to " + target.name.str() + ": " + action.label() + ", fault " +
               std::to_string(static_cast<int>(fault)));
  std::atomic<bool> struck{false};
  inject(robot.asking, fault, action.label(), struck);
  const auto result = robot.runtime.switch_to(target);
  let_be(robot.asking);
  EXPECT_TRUE(struck);
  judge(robot.runtime, robot.host, result, before, target, ends);
  const auto back = robot.runtime.switch_to(before);
  ASSERT_EQ(back.outcome, Outcome::Done) << why(back);
  ASSERT_THAT(differences(before, robot.host.observe()), ::testing::IsEmpty());
}

/// All of them with every fault only where somebody has the time.
bool thorough() {
  return std::getenv("SEGUE_ALL_FAULTS") != nullptr;
}

TEST(TransactionFaults, at_every_action_of_the_artemis_transitions) {
  Diagnostics diagnostics;
  const auto example = EmbeddedRobot::open(
      kArtemis, diagnostics, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}, .journal = {}});
  ASSERT_TRUE(example) << to_string(diagnostics);
  Ends ends;
  std::size_t turn = 0;
  for (const auto& from : example->runtime().controllers()) {
    for (const auto& to : example->runtime().controllers()) {
      if (from == to) {
        continue;
      }
      testing::StandInRobot robot;
      const auto before = *example->runtime().controller(from);
      const auto target = *example->runtime().controller(to);
      ASSERT_EQ(robot.runtime.switch_to(before).outcome, Outcome::Done);
      const auto plan = robot.runtime.plan(target);
      ASSERT_TRUE(plan);
      for (const auto& action : plan->actions) {
        ++turn;
        for (const Fault fault : kFaults) {
          // Every action is struck in some way, one in three of them here.
          const bool its_turn = turn % 9 == static_cast<std::size_t>(fault) * 3;
          if (its_turn || thorough()) {
            ASSERT_NO_FATAL_FAILURE(try_fault(robot, before, target, action, fault, ends));
          }
        }
      }
    }
  }
  EXPECT_GT(ends.target, 20);
  EXPECT_GT(ends.before, 50);
  RecordProperty("cases", ends.all());
}

TEST(TransactionFaults, at_every_action_of_random_transitions) {
  segue::testing::NetworkShape shape;
  shape.attributes = false;
  segue::testing::Random random(20261122);
  Ends ends;
  for (int pair = 0; ends.all() < (thorough() ? 100'000 : 1500); ++pair) {
    auto before = runnable(segue::testing::random_network(random, shape));
    auto target = runnable(segue::testing::random_variation(random, before, shape));
    before.name = model::NetworkName("before" + std::to_string(pair));
    target.name = model::NetworkName("target" + std::to_string(pair));
    testing::StandInRobot robot;
    ASSERT_EQ(robot.runtime.switch_to(before).outcome, Outcome::Done);
    const auto plan = robot.runtime.plan(target);
    ASSERT_TRUE(plan);
    for (const auto& action : plan->actions) {
      for (const Fault fault : kFaults) {
        ASSERT_NO_FATAL_FAILURE(try_fault(robot, before, target, action, fault, ends));
      }
    }
  }
  EXPECT_GT(ends.target, 100);
  EXPECT_GT(ends.before, 100);
  EXPECT_GT(ends.told, 10);
}

}  // namespace
}  // namespace segue::runtime
