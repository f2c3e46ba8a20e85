// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>

#include <gtest/gtest.h>
#include <unistd.h>
#include <support/eventually.hpp>

#include <atomic>
#include <fstream>
#include <future>
#include <string>
#include <thread>
#include <vector>

namespace segue {
namespace {

/// Whether a thread of this process is blocked.
bool is_blocked(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end_of_name = text.rfind(") ");
  return end_of_name != std::string::npos && text[end_of_name + 2] == 'S';
}

TEST(VirtualClock, MovesOnlyWhenTold) {
  VirtualClock clock;
  const TimePoint begin = clock.now();
  EXPECT_EQ(clock.now(), begin);
  clock.advance(std::chrono::seconds(3));
  EXPECT_EQ(clock.now() - begin, std::chrono::seconds(3));
}

TEST(VirtualClock, WakesWhoeverWaitsForAPointInTimeThatCame) {
  VirtualClock clock;
  std::atomic<bool> woke{false};
  std::thread sleeper([&] {
    clock.sleep_until(TimePoint{} + std::chrono::hours(1));
    woke = true;
  });
  clock.advance(std::chrono::minutes(59));
  EXPECT_FALSE(woke);
  clock.advance(std::chrono::minutes(1));
  sleeper.join();
  EXPECT_TRUE(woke);
}

TEST(VirtualClock, WakesAllWhoWait) {
  VirtualClock clock;
  std::vector<std::future<void>> sleepers;
  for (int i = 0; i < 3; ++i) {
    std::promise<pid_t> thread;
    std::future<pid_t> started = thread.get_future();
    sleepers.push_back(std::async(std::launch::async, [&clock, thread = std::move(thread)]() mutable {
      thread.set_value(::gettid());
      clock.sleep_until(TimePoint{} + std::chrono::hours(1));
    }));
    const pid_t number = started.get();
    ASSERT_TRUE(testing::eventually([&] { return is_blocked(number); }));
  }
  clock.advance(std::chrono::hours(1));
  const auto deadline = std::chrono::steady_clock::now() + testing::kPatience;
  for (std::future<void>& sleeper : sleepers)
    EXPECT_EQ(sleeper.wait_until(deadline), std::future_status::ready);
  for (std::size_t i = 0; i < sleepers.size(); ++i)
    clock.advance({});  // so that the test ends even if some were forgotten
}

TEST(RealClock, SleepingIntoThePastReturnsAtOnce) {
  RealClock& clock = RealClock::instance();
  const TimePoint before = clock.now();
  clock.sleep_until(before - std::chrono::hours(1));
  EXPECT_LT(clock.now() - before, std::chrono::minutes(1));
}

}  // namespace
}  // namespace segue
