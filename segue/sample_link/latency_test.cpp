// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/latency.hpp>

#include <segue/task/sample_stamps.hpp>

#include <gtest/gtest.h>

namespace segue::sample_link {
namespace {

using namespace std::chrono_literals;
using task::detail::SampleStamps;

constexpr TimePoint at(Duration time) {
  return TimePoint(1h + time);
}

TEST(LatencyTest, HasTheMeanAndTheWorst) {
  LatencyRecorder recorder;
  EXPECT_EQ(recorder.read(), Latency{});
  recorder.add(at(0us), at(2us));
  recorder.add(at(10us), at(16us));
  EXPECT_EQ(recorder.read(), (Latency{2, 4us, 6us, 6us}));
}

TEST(LatencyTest, OneOfAHundredMayTakeLongerThanThe99thPercentile) {
  LatencyRecorder recorder;
  recorder.add(at(0us), at(1ms));
  for (int i = 1; i < 100; ++i)
    recorder.add(at(0us), at(2us));
  EXPECT_EQ(recorder.read().worst, 1ms);
  EXPECT_EQ(recorder.read().p99, 2048ns) << "the end of its bin";
  recorder.add(at(0us), at(1ms));
  EXPECT_EQ(recorder.read().p99, 1ms);
}

TEST(LatencyTest, WhatIsNotToBeMeasuredDoesNotCount) {
  LatencyRecorder recorder;
  recorder.add(TimePoint());
  recorder.begin_at(at(5us));
  recorder.add(at(4us), at(20us));
  EXPECT_EQ(recorder.read(), Latency{}) << "written before the connection";
  recorder.add(at(5us), at(7us));
  EXPECT_EQ(recorder.read(), (Latency{1, 2us, 2us, 2us}));
}

TEST(LatencyTest, TimesThatCannotBeDoNotCount) {
  LatencyRecorder recorder;
  recorder.add(at(1us), at(0us));
  recorder.add(TimePoint::max(), at(0us));
  recorder.add(TimePoint::min(), at(0us));
  recorder.add(TimePoint(-1ns), at(0us));
  EXPECT_EQ(recorder.read(), Latency{});
}

TEST(LatencyTest, OfTwoConnectionsInARowIsTheirSum) {
  const Latency first{10, 2us, 9us, 8us};
  EXPECT_EQ(in_series(first, {4, 1us, 2us, 2us}), (Latency{4, 3us, 11us, 10us}));
  EXPECT_EQ(in_series(first, {}), Latency{});
  EXPECT_EQ(in_series({}, first), Latency{});
}

/// How many of `samples` that are written every `period` carry a time.
int stamped(SampleStamps& stamps, int samples, Duration period, TimePoint& now) {
  int count = 0;
  for (int i = 0; i < samples; ++i, now += period) {
    const TimePoint stamp = stamps.next([&] { return now; });
    if (stamp == TimePoint()) continue;
    EXPECT_EQ(stamp, now);
    ++count;
  }
  return count;
}

TEST(SampleStampsTest, ASlowWriterHasATimeInEachSample) {
  SampleStamps stamps;
  TimePoint now = at(0s);
  EXPECT_EQ(stamped(stamps, 1000, 20ms, now), 1000);
}

TEST(SampleStampsTest, AFastWriterHasAsManyASecondAndNeverTooFew) {
  SampleStamps stamps;
  TimePoint now = at(0s);
  const int at_1_kHz = stamped(stamps, 10'000, 1ms, now);
  EXPECT_GE(at_1_kHz, 500);
  EXPECT_LE(at_1_kHz, 1500);
  const int at_1_MHz = stamped(stamps, 640'000, 1us, now);
  EXPECT_GE(at_1_MHz, 10'000);
  EXPECT_LE(at_1_MHz, 10'100);
}

TEST(SampleStampsTest, AWriterThatBecomesSlowSoonHasATimeInEachSampleAgain) {
  SampleStamps stamps;
  TimePoint now = at(0s);
  (void)stamped(stamps, 10'000, 1us, now);
  (void)stamped(stamps, 200, 1s, now);
  EXPECT_EQ(stamped(stamps, 100, 1s, now), 100);
}

}  // namespace
}  // namespace segue::sample_link
