// SPDX-License-Identifier: Apache-2.0
#include <segue/base/time_after.hpp>
#include <segue/base/varied_duration.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/base/wait.hpp>

#include <support/eventually.hpp>
#include <support/waiting_call.hpp>

#include <gtest/gtest.h>

#include <list>

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
  testing::WaitingCall sleeper([&] { clock.sleep_until(TimePoint{} + std::chrono::hours(1)); });
  EXPECT_TRUE(sleeper.waits());
  clock.advance(std::chrono::minutes(59));
  EXPECT_FALSE(sleeper.returned());
  clock.advance(std::chrono::minutes(1));
  sleeper.join();
  EXPECT_TRUE(sleeper.returned());
}

TEST(VirtualClock, WakesAllWhoWait) {
  VirtualClock clock;
  std::list<testing::WaitingCall> sleepers;
  for (int i = 0; i < 3; ++i) {
    sleepers.emplace_back([&] { clock.sleep_until(TimePoint{} + std::chrono::hours(1)); });
    ASSERT_TRUE(sleepers.back().waits());
  }
  clock.advance(std::chrono::hours(1));
  for (const testing::WaitingCall& sleeper : sleepers)
    EXPECT_TRUE(testing::eventually([&] { return sleeper.returned(); }));
  for (std::size_t i = 0; i < sleepers.size(); ++i)
    clock.advance({});  // so that the test ends even if some were forgotten
}

TEST(TimeAfter, IsAnErrorWhereNoTimeIsSoLate) {
  constexpr Duration kAll = Duration::max();
  EXPECT_EQ(time_after(TimePoint(Duration(3)), Duration(4)).value(), TimePoint(Duration(7)));
  EXPECT_EQ(time_after(TimePoint{}, kAll).value(), TimePoint::max());
  EXPECT_EQ(time_after(TimePoint(Duration(1)), kAll).error().code, ErrorCode::InvalidArgument);
}

TEST(TimeAfter, SumsOfDurationsEndAtTheLongest) {
  EXPECT_EQ(sum_of_durations(Duration(3), Duration(4)), Duration(7));
  EXPECT_EQ(sum_of_durations(Duration(1), Duration::max()), Duration::max());
  EXPECT_EQ(sum_of_durations(Duration(-1), Duration::min()), Duration::min());
}

TEST(TimeAfter, VariedDurationsEndAtTheLongest) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    EXPECT_GT(varied(Duration::max(), seed, 0, 0), Duration::zero());
}

TEST(DeadlineTest, IsADurationFromNowOnOrATime) {
  const TimePoint before = monotonic_now();
  const TimePoint in_an_hour = Deadline(std::chrono::hours(1));
  EXPECT_GE(in_an_hour, before + std::chrono::hours(1));
  EXPECT_LE(in_an_hour, monotonic_now() + std::chrono::hours(1));
  EXPECT_EQ(TimePoint(Deadline(before)), before);
  EXPECT_GE(Wait(std::chrono::hours(1)).deadline, in_an_hour);
}

TEST(DeadlineTest, NeverComesAfterTheLongestDuration) {
  EXPECT_EQ(TimePoint(Deadline(Duration::max())), TimePoint::max());
  EXPECT_LT(TimePoint(Deadline(Duration::min())), monotonic_now());
}

TEST(RealClock, SleepingIntoThePastReturnsAtOnce) {
  RealClock& clock = RealClock::instance();
  const TimePoint before = clock.now();
  clock.sleep_until(before - std::chrono::hours(1));
  EXPECT_LT(clock.now() - before, std::chrono::minutes(1));
}

}  // namespace
}  // namespace segue
