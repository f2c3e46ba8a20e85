// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace segue {
namespace {

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

TEST(RealClock, SleepingIntoThePastReturnsAtOnce) {
  RealClock& clock = RealClock::instance();
  const TimePoint before = clock.now();
  clock.sleep_until(before - std::chrono::hours(1));
  EXPECT_LT(clock.now() - before, std::chrono::minutes(1));
}

}  // namespace
}  // namespace segue
