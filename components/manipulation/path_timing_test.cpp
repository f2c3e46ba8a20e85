// SPDX-License-Identifier: Apache-2.0
#include "path_timing.hpp"

#include <Eigen/Core>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace manipulation {
namespace {

using Points = std::vector<std::vector<double>>;

constexpr double kStep = 0.01;

std::vector<JointLimits> three_joints() {
  return {{-3, 3, {1.0, 3.0, 30.0}}, {-3, 3, {0.5, 2.0, 20.0}}, {-3, 3, {2.0, 6.0, 90.0}}};
}

PathTiming timed(const Points& points) {
  auto made = PathTiming::make(points, three_joints(), {});
  EXPECT_TRUE(made) << to_string(made.error());
  return *made;
}

std::vector<std::vector<double>> set_points(const PathTiming& timing) {
  std::vector<std::vector<double>> all;
  for (int i = -4; i * kStep <= timing.duration() + 4 * kStep; ++i) {
    all.emplace_back(3);
    timing.at(i * kStep, all.back());
  }
  return all;
}

void expect_limits_kept(const PathTiming& timing) {
  const auto limits = three_joints();
  auto values = set_points(timing);
  constexpr std::array<const char*, 3> kNames = {"velocity", "acceleration", "jerk"};
  for (std::size_t order = 0; order < kNames.size(); ++order) {
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      for (std::size_t joint = 0; joint < 3; ++joint) {
        values[i][joint] = (values[i + 1][joint] - values[i][joint]) / kStep;
        const auto& motion = limits[joint].motion;
        const std::array<double, 3> most = {motion.velocity, motion.acceleration, motion.jerk};
        ASSERT_LE(std::abs(values[i][joint]), 1.001 * most.at(order) + 1e-6)
            << kNames.at(order) << " of joint " << joint << " at set point " << i;
      }
    }
    values.pop_back();
  }
}

double distance_from(const Points& path, const std::vector<double>& point) {
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::Vector3d(values[0], values[1], values[2]);
  };
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector3d begin = vector(path[i]);
    const Eigen::Vector3d way = vector(path[i + 1]) - begin;
    const double squared = way.squaredNorm();
    const double along = squared > 0 ? std::clamp((vector(point) - begin).dot(way) / squared, 0.0, 1.0) : 0;
    closest = std::min(closest, (vector(point) - begin - along * way).norm());
  }
  return closest;
}

TEST(PathTiming, MovesFromTheFirstPointToTheLast) {
  const Points path = {{0, 0, 0}, {1, 0.2, -0.5}};
  const auto timing = timed(path);
  std::vector<double> at(3);
  timing.at(-1, at);
  EXPECT_EQ(at, path.front());
  timing.at(timing.duration(), at);
  EXPECT_EQ(at, path.back());
  timing.at(1e9, at);
  EXPECT_EQ(at, path.back());
  EXPECT_NEAR(timing.duration(), 1.0 + 1.0 / 2.7 + 0.21, 0.05) << "cruising, acceleration, and the average";
}

TEST(PathTiming, APathOfOnePointIsNoMotion) {
  const auto timing = timed({{0.5, 0, 1}, {0.5, 0, 1}});
  std::vector<double> at(3);
  timing.at(0.1, at);
  EXPECT_THAT(at, ::testing::ElementsAre(0.5, 0, 1));
}

TEST(PathTiming, RefusesWhatIsNoPath) {
  const double no_number = std::nan("");
  for (const Points& points : {Points{}, Points{{0, 0}}, Points{{0, 0, 0}, {0, 0, 0, 0}}, Points{{0, 0, 4}},
                               Points{{0, 0, 0}, {0, no_number, 0}}, Points{{0, 0, -INFINITY}}}) {
    EXPECT_FALSE(PathTiming::make(points, three_joints(), {}));
  }
}

TEST(PathTiming, RefusesAMotionThatNeverEnds) {
  Points to_and_fro;
  for (int i = 0; i < 400; ++i)
    to_and_fro.push_back({i % 2 == 0 ? -3.0 : 3.0, 0, 0});
  const auto made = PathTiming::make(to_and_fro, three_joints(), {});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, ::testing::HasSubstr("ten minutes"));
}

RC_GTEST_PROP(PathTimingProperty, KeepsAllLimitsAndStaysOnThePath, ()) {
  const auto position = rc::gen::map(rc::gen::inRange(-3000, 3001), [](int value) { return value / 1000.0; });
  const auto point = rc::gen::container<std::vector<double>>(3, position);
  auto path = *rc::gen::nonEmpty(rc::gen::container<Points>(point));
  path.push_back({0, 0, 0});
  const auto timing = timed(path);
  expect_limits_kept(timing);
  for (const auto& one : set_points(timing))
    ASSERT_LE(distance_from(path, one), 0.02 + 0.012) << "the corner and the average";
}

}  // namespace
}  // namespace manipulation
