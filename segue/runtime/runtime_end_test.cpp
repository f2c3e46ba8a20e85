// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime.hpp>

#include <segue/runtime/test_support.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <thread>

namespace segue::runtime {
namespace {

using testing::network_of;

constexpr const char* kOneTask = "network: first\ntasks:\n  kept: {component: a::Kept}\n";
constexpr const char* kTwoTasks =
    "network: second\ntasks:\n  kept: {component: a::Kept}\n  added: {component: a::Added}\n";

/// The first action sets `entered` and waits for `go`, both of which outlive the robot.
void hold_first_action(testing::StandInRobot& robot, std::promise<void>& entered, std::promise<void>& go) {
  robot.asking.ask([&entered, gate = go.get_future().share(),
                    first = std::make_shared<std::atomic<bool>>(true)](const model::Action&) -> Result<void> {
    if (first->exchange(false)) {
      entered.set_value();
      gate.wait();
    }
    return {};
  });
}

TEST(RuntimeEnd, APreparationThatWaitsIsAnswered) {
  std::future<std::vector<Readiness>> prepared;
  std::promise<void> entered;
  std::promise<void> go;
  std::thread release;
  {
    testing::StandInRobot robot;
    hold_first_action(robot, entered, go);
    const auto running = robot.runtime.request(network_of(kOneTask));
    entered.get_future().wait();
    prepared = robot.runtime.prepare({model::NetworkName("second")});
    release = std::thread([&] { go.set_value(); });
  }
  release.join();
  const auto answer = prepared.get();
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_FALSE(answer.front().ready);
}

TEST(RuntimeEnd, RequestsThatWaitAreAnswered) {
  std::future<SwitchResult> running;
  std::future<SwitchResult> waiting;
  std::promise<void> entered;
  std::promise<void> go;
  std::thread release;
  {
    testing::StandInRobot robot;
    hold_first_action(robot, entered, go);
    running = robot.runtime.request(network_of(kOneTask));
    entered.get_future().wait();
    waiting = robot.runtime.request(network_of(kTwoTasks));
    // The destructor answers the waiting request before it waits for the action.
    release = std::thread([&] {
      waiting.wait();
      go.set_value();
    });
  }
  release.join();
  EXPECT_EQ(waiting.get().error->code, ErrorCode::Cancelled);
  EXPECT_EQ(running.get().outcome, Outcome::Failed);
}

}  // namespace
}  // namespace segue::runtime
