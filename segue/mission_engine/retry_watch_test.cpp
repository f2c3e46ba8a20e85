// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/mission_engine/retry_watch.hpp>

#include <gtest/gtest.h>

namespace segue::mission {
namespace {

constexpr StateIndex kGrasp = 3;
constexpr StateIndex kDrive = 4;

/// Both states abort in turn, so many times, with so much time between.
int warnings(RetryWatch& watch, VirtualClock& clock, std::uint32_t times, Duration between) {
  int count = 0;
  for (std::uint32_t i = 0; i < times; ++i) {
    clock.advance(between);
    count += watch.ended(kGrasp, kAborted, clock.now()) ? 1 : 0;
    count += watch.ended(kDrive, kAborted, clock.now()) ? 1 : 0;
  }
  return count;
}

TEST(RetryWatch, WarnsOnceOfEachStateThatAbortsAgainAndAgainAtOnce) {
  VirtualClock clock;
  RetryWatch watch;
  EXPECT_EQ(warnings(watch, clock, RetryWatch::kAborts - 1, Duration(1)), 0);
  EXPECT_EQ(warnings(watch, clock, 1, Duration(1)), 2);
  EXPECT_EQ(warnings(watch, clock, 5 * RetryWatch::kAborts, Duration(1)), 0);
}

TEST(RetryWatch, IsContentWithPausesAndWithWhatSucceedsNowAndThen) {
  VirtualClock clock;
  RetryWatch watch;
  const Duration pause = 2 * RetryWatch::kWithin / RetryWatch::kAborts;
  EXPECT_EQ(warnings(watch, clock, 3 * RetryWatch::kAborts, pause), 0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(watch.ended(kGrasp, 0, clock.now()));
    EXPECT_FALSE(watch.ended(kDrive, kPreempted, clock.now()));
    EXPECT_EQ(warnings(watch, clock, RetryWatch::kAborts - 1, Duration(1)), 0);
  }
}

}  // namespace
}  // namespace segue::mission
