// SPDX-License-Identifier: Apache-2.0
#include <segue/task/duration_histogram.hpp>

#include <gtest/gtest.h>

namespace segue::task {
namespace {

using namespace std::chrono_literals;

TEST(DurationHistogramTest, EachBinHasWhatLiesBetweenItsEnds) {
  EXPECT_EQ(DurationHistogram::from(0), 0ns);
  EXPECT_EQ(DurationHistogram::from(1), 128ns);
  EXPECT_EQ(DurationHistogram::from(2), 192ns);
  EXPECT_EQ(DurationHistogram::from(3), 256ns);
  for (std::size_t bin = 0; bin + 1 < DurationHistogram::kBins; ++bin) {
    EXPECT_EQ(DurationHistogram::bin_of(DurationHistogram::from(bin)), bin);
    EXPECT_EQ(DurationHistogram::bin_of(DurationHistogram::below(bin) - 1ns), bin);
    EXPECT_EQ(DurationHistogram::below(bin), DurationHistogram::from(bin + 1));
  }
}

TEST(DurationHistogramTest, NoDurationIsOutside) {
  EXPECT_EQ(DurationHistogram::bin_of(-1ns), 0U);
  EXPECT_EQ(DurationHistogram::bin_of(Duration::min()), 0U);
  EXPECT_EQ(DurationHistogram::bin_of(1h), DurationHistogram::kBins - 1);
  EXPECT_EQ(DurationHistogram::bin_of(Duration::max()), DurationHistogram::kBins - 1);
  EXPECT_EQ(DurationHistogram::below(DurationHistogram::kBins - 1), Duration::max());
}

TEST(DurationHistogramTest, QuantilesAreEndsOfBins) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0ns);
  histogram.counts[1] = 98;
  histogram.counts[3] = 1;
  histogram.counts[5] = 1;
  EXPECT_EQ(histogram.total(), 100U);
  EXPECT_EQ(histogram.quantile(0), DurationHistogram::below(1));
  EXPECT_EQ(histogram.quantile(0.5), DurationHistogram::below(1));
  EXPECT_EQ(histogram.quantile(0.99), DurationHistogram::below(3));
  EXPECT_EQ(histogram.quantile(1), DurationHistogram::below(5));
}

TEST(DurationHistogramTest, WhatIsCountedIsRead) {
  detail::HistogramRecorder recorder;
  for (const Duration duration : {100ns, 130ns, 131ns})
    recorder.add(duration);
  DurationHistogram expected;
  expected.counts[0] = 1;
  expected.counts[1] = 2;
  EXPECT_EQ(recorder.read(), expected);
  recorder.reset();
  EXPECT_EQ(recorder.read(), DurationHistogram{});
}

}  // namespace
}  // namespace segue::task
