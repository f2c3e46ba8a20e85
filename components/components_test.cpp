// SPDX-License-Identifier: Apache-2.0
//
// The shipped components, in the networks of the examples.
#include <segue/runtime/embedded_robot.hpp>
#include <segue/task_host/task_host.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <thread>
#include <utility>
#include <vector>

#include "bench/gap_counter.hpp"

namespace segue {
namespace {

const std::string kExamples = segue::paths::in_sources("/examples/");

Result<runtime::EmbeddedRobot> open(const std::string& example) {
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
  auto robot = runtime::EmbeddedRobot::open(kExamples + example + "/robot.yaml");
  EXPECT_TRUE(robot) << to_string(diagnostics_of(robot.error()));
  return robot;
}

/// Reads a port until a sample satisfies `enough`; returns that sample, or null after half a minute.
template <class Enough>
type::Value wait_for(runtime::EmbeddedRobot& robot, const char* port, Enough enough) {
  auto samples = robot.port(port);
  const auto deadline = RealClock::instance().now() + std::chrono::seconds(30);
  while (RealClock::instance().now() < deadline) {
    auto sample = samples.next(deadline - RealClock::instance().now());
    EXPECT_TRUE(sample) << to_string(sample.error());
    if (!sample) break;
    if (enough(*sample)) return std::move(*sample);
  }
  return {};
}

double number(const type::Value& sample, const char* field) {
  return sample.find(field)->as_double();
}

/// The counts of a counter that has noted these numbers: lost and late.
std::pair<std::uint64_t, std::uint64_t> gaps_in(const std::vector<std::uint64_t>& numbers) {
  bench::GapCounter gaps;
  for (const std::uint64_t number : numbers)
    gaps.note(number);
  return {gaps.lost(), gaps.late()};
}

TEST(GapCounter, CountsWhatIsMissingAndWhatComesLate) {
  using Gaps = std::pair<std::uint64_t, std::uint64_t>;
  EXPECT_EQ(gaps_in({5, 6, 7}), (Gaps{0, 0})) << "the first may have any number";
  EXPECT_EQ(gaps_in({1, 2, 5, 6}), (Gaps{2, 0}));
  EXPECT_EQ(gaps_in({1, 2, 5, 3, 4, 6}), (Gaps{0, 2}));
  EXPECT_EQ(gaps_in({1, 2, 5, 4, 6}), (Gaps{1, 1}));
  EXPECT_EQ(gaps_in({1, 2, 3, 2, 4}), (Gaps{1, 0})) << "one that comes again is not taken for a late one";
  EXPECT_EQ(gaps_in({1, 2, 3, 1, 2, 3}), (Gaps{0, 0})) << "the producer was restarted";
  EXPECT_EQ(gaps_in({1, 100'000, 2, 3}), (Gaps{99'998, 0})) << "too old to be known";
  EXPECT_EQ(gaps_in({1, 20'000, 19'999, 20'001}), (Gaps{19'997, 1}));
}

TEST(BenchChain, CountsEverySampleAndNoneIsLost) {
  auto robot = open("03_chain");
  ASSERT_TRUE(robot);
  ASSERT_EQ(robot->switch_to("relay_a").outcome, runtime::Outcome::Done);
  const auto seen = wait_for(*robot, "consumer.statistics",
                             [](const type::Value& sample) { return number(sample, "count") >= 50; });
  ASSERT_TRUE(seen.is_map());
  EXPECT_EQ(number(seen, "lost"), 0);
  EXPECT_GT(number(seen, "latency_min"), 0);
  EXPECT_LE(number(seen, "latency_min"), number(seen, "latency_mean"));
  EXPECT_LE(number(seen, "latency_mean"), number(seen, "latency_max"));
  ASSERT_EQ(robot->switch_to("relay_b").outcome, runtime::Outcome::Done);
  EXPECT_TRUE(wait_for(*robot, "consumer.statistics",
                       [&](const type::Value& sample) {
                         return number(sample, "count") > number(seen, "count") + 20;
                       })
                  .is_map())
      << "samples flow through the other relay";
}

TEST(DemoRobot, GoesWhereItIsToldAndKeepsItsPoseAcrossASwitch) {
  auto robot = open("02_two_controllers");
  ASSERT_TRUE(robot);
  ASSERT_EQ(robot->switch_to("explore").outcome, runtime::Outcome::Done);
  const auto moved = wait_for(*robot, "odometry.pose", [](const type::Value& pose) {
    return std::hypot(number(pose, "x"), number(pose, "y")) > 0.05;
  });
  ASSERT_TRUE(moved.is_map()) << "it drives about";
  const auto result = robot->switch_to("go_to_goal");
  ASSERT_EQ(result.outcome, runtime::Outcome::Done);
  const auto first = wait_for(*robot, "seeker.distance", [](const type::Value&) { return true; });
  ASSERT_TRUE(first.is_number());
  EXPECT_TRUE(
      wait_for(*robot, "seeker.distance",
               [&](const type::Value& distance) { return distance.as_double() < first.as_double() - 0.1; })
          .is_number())
      << "it comes closer";
  const auto goal = type::Value::map({{"goal", type::Value::map({{"x", "far"}, {"y", 0}})}});
  EXPECT_FALSE(robot->host().call(model::TaskId("seeker"), "set_goal", goal,
                                  RealClock::instance().now() + std::chrono::seconds(10)));
  EXPECT_EQ(robot->shut_down().outcome, runtime::Outcome::Done);
}

}  // namespace
}  // namespace segue
