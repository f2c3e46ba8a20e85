// SPDX-License-Identifier: Apache-2.0
//
// Motions of the rover's arm at the table, without tasks.
#include "box_estimate.hpp"
#include "motion_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace planning {
namespace {

using ::testing::HasSubstr;

const Positions kHome(rover::kArmHome.begin(), rover::kArmHome.end());
constexpr double kBaseX = 0.85;

/// In front of the table, with three boxes on it.
Situation at_table() {
  Situation situation{.base = {kBaseX, 0, 0}, .positions = kHome, .boxes = {}, .held = -1, .grasp = {}};
  for (std::int32_t id = 0; id < 3; ++id) {
    const Eigen::Vector3d place(0.77, 0.2 * (id - 1), rover::kTableHeight + rover::kBoxSide / 2);
    situation.boxes.push_back({id, {place, Eigen::Quaterniond::Identity()}});
  }
  return situation;
}

/// From above, the fingers on both sides of the box.
Goal grasp(std::int32_t box) {
  Goal goal;
  goal.relative_to = box;
  goal.pose.position = {0, 0, 0.01};
  goal.pose.orientation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
  goal.quarter_turns = true;
  return goal;
}

PlanRequest take(const Situation& from, std::int32_t box) {
  PlanRequest request;
  request.from = from;
  request.goals = {grasp(box)};
  if (from.positions != kHome) request.leave = {0, 0, 0.1};
  request.approach = {0, 0, 0.1};
  request.take = box;
  return request;
}

PlanRequest put(const Situation& from, const Eigen::Vector3d& place) {
  PlanRequest request;
  request.from = from;
  Goal goal;
  goal.of_held = true;
  goal.quarter_turns = true;
  goal.pose.position = place;
  request.goals = {goal};
  request.leave = {0, 0, 0.1};
  request.approach = {0, 0, 0.1};
  request.release = true;
  return request;
}

PlanRequest move(const Positions& from, const Positions& to) {
  PlanRequest request;
  request.from = at_table();
  request.from.positions = from;
  Goal goal;
  goal.positions = to;
  request.goals = {goal};
  return request;
}

/// A check that shares nothing with that of the planner: frames from the constants of the joints, the arm as
/// points on its middle lines, everything else as blocks.
class Blocks {
 public:
  explicit Blocks(const Situation& situation, const std::vector<std::int32_t>& without = {}) {
    constexpr double kInfinite = 10;
    add({rover::kTableEdge - kBaseX, -0.5, -1}, {rover::kTableEdge + 0.5 - kBaseX, 0.5, rover::kTableHeight});
    add({-0.43, -0.36, -1}, {0.43, 0.36, rover::kDeckHeight});
    add({0.03, 0.15, 0}, {0.07, 0.19, 0.98});  // the mast
    add({-kInfinite, -kInfinite, -1}, {kInfinite, kInfinite, 0});
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(rover::kBoxSide / 2);
    for (const BoxPose& box : situation.boxes) {
      if (std::ranges::find(without, box.id) == without.end())
        add(box.pose.position - half, box.pose.position + half);
    }
  }

  /// Of the arm's middle lines from the elbow on to anything, m. Zero inside of something.
  [[nodiscard]] double distance(const Positions& positions) const {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t joint = 0; joint < rover::kArmJoints; ++joint) {
      frame.translate(Eigen::Vector3d(rover::kArm.at(joint).place.data()));
      frame.rotate(Eigen::AngleAxisd(positions[joint], Eigen::Vector3d(rover::kArm.at(joint).axis.data())));
      if (joint >= 1) corners.emplace_back(frame.translation());
    }
    corners.emplace_back(frame * Eigen::Vector3d(rover::kTool.data()));
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t corner = 0; corner + 1 < corners.size(); ++corner) {
      for (int part = 0; part <= 10; ++part)
        least =
            std::min(least, distance(corners[corner] + (corners[corner + 1] - corners[corner]) * part / 10));
    }
    return least;
  }

 private:
  void add(const Eigen::Vector3d& lowest, const Eigen::Vector3d& highest) {
    blocks_.emplace_back(lowest, highest);
  }
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [lowest, highest] : blocks_) {
      const Eigen::Vector3d nearest = point.cwiseMax(lowest).cwiseMin(highest);
      least = std::min(least, (point - nearest).norm());
    }
    return least;
  }
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> blocks_;
};

double least_distance(const Blocks& blocks, const std::vector<Positions>& path) {
  constexpr int kParts = 200;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t point = 0; point + 1 < path.size(); ++point) {
    for (int part = 0; part <= kParts; ++part) {
      Positions between = path[point];
      for (std::size_t joint = 0; joint < between.size(); ++joint)
        between[joint] += (path[point + 1][joint] - path[point][joint]) * part / kParts;
      least = std::min(least, blocks.distance(between));
    }
  }
  return least;
}

class MotionPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = ArmScene::create();
    ASSERT_TRUE(made) << to_string(made.error());
    scene_ = std::move(*made);
  }
  PlanResult planned(const PlanRequest& request) {
    auto result = plan_motion(*scene_, request);
    EXPECT_TRUE(result) << to_string(result.error());
    return result ? *result : PlanResult{};
  }
  void expect_refused(const PlanRequest& request, const char* why) {
    const auto result = plan_motion(*scene_, request);
    ASSERT_FALSE(result) << why;
    EXPECT_EQ(result.error().code, segue::ErrorCode::InvalidArgument);
    EXPECT_THAT(result.error().message, HasSubstr(why));
  }

  std::unique_ptr<ArmScene> scene_;
};

/// The hand low above the table, to the left or to the right of the boxes.
PlanRequest across_the_table(ArmScene& scene) {
  scene.set(at_table());
  const auto above = [&](double y) {
    Eigen::Isometry3d tool(Eigen::Translation3d(0.72, y, 0.35));
    tool.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
    return scene.reach(tool, {y, -0.6, 1.0, 0, 1.2, 0}).value_or(kHome);
  };
  return move(above(-0.33), above(0.33));
}

TEST_F(MotionPlan, GoesStraightWhereNothingIsInTheWay) {
  const Positions up = {0.5, -1.2, 1.2, 0, 0.5, 0};
  const auto result = planned(move(kHome, up));
  EXPECT_EQ(result.path.points, (std::vector<Positions>{kHome, up}));
  EXPECT_NEAR(result.cost, 1.3, 1e-9) << "that of the joint that turns most";
  EXPECT_EQ(result.after.positions, up);
  EXPECT_EQ(result.goal, 0);
}

TEST_F(MotionPlan, GoesAroundWhatIsInTheWay) {
  const Blocks blocks(at_table());
  auto request = across_the_table(*scene_);
  request.budget = 300;
  const auto& begin = request.from.positions;
  const auto& end = request.goals[0].positions;
  ASSERT_EQ(least_distance(blocks, {begin, end}), 0) << "the straight way leads through the boxes";
  const auto result = planned(request);
  ASSERT_GT(result.path.points.size(), 2U);
  EXPECT_EQ(result.path.points.front(), begin);
  EXPECT_EQ(result.path.points.back(), end);
  EXPECT_GT(least_distance(blocks, result.path.points), 0.01);
  EXPECT_NEAR(result.cost, cost_of(result.path.points), 1e-9);
}

TEST_F(MotionPlan, NeverTouchesAnythingBetweenRandomConfigurations) {
  const Blocks blocks(at_table());
  std::mt19937_64 random(7);
  const auto limits = ArmScene::limits();
  Positions at = kHome;
  int paths = 0;
  for (int trial = 0; trial < 30; ++trial) {
    Positions to = at;
    for (std::size_t joint = 0; joint < to.size(); ++joint)
      to[joint] = std::uniform_real_distribution(limits[joint].first, limits[joint].second)(random);
    PlanRequest request = move(at, to);
    request.budget = 200;
    const auto result = plan_motion(*scene_, request);
    if (!result) {
      EXPECT_EQ(result.error().code, segue::ErrorCode::NotFound) << to_string(result.error());
      continue;
    }
    ++paths;
    EXPECT_EQ(result->path.points.front(), at);
    EXPECT_EQ(result->path.points.back(), to);
    EXPECT_GT(least_distance(blocks, result->path.points), 0.005);
    at = to;
  }
  EXPECT_GT(paths, 5) << "others end inside of something";
}

TEST_F(MotionPlan, BringsAllBoxesToTheDeckOnePlanAfterTheOther) {
  const std::vector<Eigen::Vector3d> places = {
      {0.05, -0.27, 0.34}, {-0.1, -0.27, 0.34}, {-0.02, -0.12, 0.34}};
  Situation situation = at_table();
  for (std::int32_t box = 0; box < 3; ++box) {
    const auto& place = places[static_cast<std::size_t>(box)];
    const auto taken = planned(take(situation, box));
    EXPECT_EQ(taken.after.held, box);
    EXPECT_GT(least_distance(Blocks(situation, {box, box - 1}), taken.path.points), 0.005);
    const auto brought = planned(put(taken.after, place));
    EXPECT_EQ(brought.path.points.front(), taken.path.points.back());
    EXPECT_EQ(brought.after.held, -1);
    EXPECT_GT(least_distance(Blocks(situation, {box}), brought.path.points), 0.005);
    situation = brought.after;
    EXPECT_LT((situation.boxes[static_cast<std::size_t>(box)].pose.position - place).norm(), 1e-3);
  }
}

/// The rover's boxes on its deck, displaced by up to 1 cm and turned by up to 0.3 rad.
Situation on_deck(std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-1, 1);
  Situation situation = at_table();
  for (BoxPose& box : situation.boxes) {
    const auto& place = rover::kDeckPlaces.at(static_cast<std::size_t>(box.id));
    box.pose.position = {place.x + 0.01 * part(random), place.y + 0.01 * part(random),
                         rover::kDeckHeight + rover::kBoxSide / 2};
    box.pose.orientation = Eigen::AngleAxisd(0.3 * part(random), Eigen::Vector3d::UnitZ());
  }
  return situation;
}

TEST_F(MotionPlan, FindsAGraspOfEachBoxOnTheDeckHoweverItLies) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Situation situation = on_deck(random);
    for (std::int32_t box = 0; box < 3; ++box) {
      PlanRequest request = take(situation, box);
      request.goals.clear();
      for (const double tilt : {67.1, 90.0, 112.9}) {  // degrees, as bring_boxes.yaml of example 08 has them
        request.goals.push_back(grasp(box));
        request.goals.back().pose.orientation =
            Eigen::AngleAxisd(tilt * M_PI / 180, Eigen::Vector3d::UnitY());
      }
      request.first = true;
      request.seed = static_cast<std::uint64_t>(trial);
      const auto result = plan_motion(*scene_, request);
      EXPECT_TRUE(result) << "box " << box << " of " << trial << ": " << to_string(result.error());
    }
  }
}

TEST_F(MotionPlan, SaysWhyThereIsNoPath) {
  PlanRequest request = move(kHome, kHome);
  request.goals[0].positions.clear();
  request.goals[0].pose.position = {0.9, 0, 0.15};  // inside of the table
  request.goals[0].pose.orientation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
  const auto inside = plan_motion(*scene_, request);
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error().code, segue::ErrorCode::NotFound);
  EXPECT_THAT(inside.error().message, HasSubstr("there is no path: goal 1: "));
  request.goals[0].pose.position = {3, 0, 0.5};
  const auto far = plan_motion(*scene_, request);
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().message, HasSubstr("no configuration of the arm has that pose"));
  request = move({0, 0.6, 0.3, 0, 0, 0}, kHome);
  const auto touching = plan_motion(*scene_, request);
  ASSERT_FALSE(touching);
  EXPECT_THAT(touching.error().message, HasSubstr("at its beginning there is contact between"));
}

TEST_F(MotionPlan, GivesUpWhenItsBudgetIsUsedUp) {
  PlanRequest request = across_the_table(*scene_);
  request.budget = 1;
  const auto result = plan_motion(*scene_, request);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("within 1 steps"));
}

TEST_F(MotionPlan, OfTheSameRequestIsTheSame) {
  PlanRequest request = across_the_table(*scene_);
  request.budget = 150;
  const auto first = planned(request);
  EXPECT_EQ(planned(request).path.points, first.path.points);
  auto other = ArmScene::create();
  ASSERT_TRUE(other);
  const auto again = plan_motion(**other, request);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->path.points, first.path.points) << "whatever was planned before";
  request.seed = 2;
  EXPECT_NE(planned(request).path.points, first.path.points);
}

TEST_F(MotionPlan, LeadsToTheBestOfSeveralGoalsOrToTheFirstThatItFinds) {
  PlanRequest request = move(kHome, {2.5, -1.2, 1.2, 0, 0.5, 0});
  request.goals.push_back({});
  request.goals[1].positions = {0.5, -1.2, 1.2, 0, 0.5, 0};
  EXPECT_EQ(planned(request).goal, 1);
  request.first = true;
  EXPECT_EQ(planned(request).goal, 1) << "the nearest is tried first";
}

TEST_F(MotionPlan, RefusesRequestsThatMakeNoSense) {
  const double no_number = std::nan("");
  const auto with = [](auto change) {
    PlanRequest request = take(at_table(), 1);
    change(request);
    return request;
  };
  expect_refused(with([](auto& r) { r.from.positions.pop_back(); }), "the arm has 6 joints");
  expect_refused(with([&](auto& r) { r.from.positions[2] = no_number; }), "joint 3 is not finite");
  expect_refused(with([&](auto& r) { r.from.base.theta = no_number; }), "from.base");
  expect_refused(with([](auto& r) { r.from.boxes[0].id = 7; }), "boxes 0 to 2, not 7");
  expect_refused(with([](auto& r) { r.from.boxes[0].id = 1; }), "box 1 is there twice");
  expect_refused(with([&](auto& r) { r.from.boxes[0].pose.position[1] = no_number; }), "pose of box 0");
  expect_refused(with([](auto& r) { r.from.held = 5; }), "box 5 is held");
  expect_refused(with([](auto& r) { r.goals.clear(); }), "1 to 64 goals");
  expect_refused(with([](auto& r) { r.goals.resize(100); }), "1 to 64 goals");
  expect_refused(with([](auto& r) {
                   r.goals[0].positions = {1, 2};
                 }),
                 "entry 1: the arm has 6 joints, not 2");
  expect_refused(with([](auto& r) { r.goals[0].positions = {0, 0, 9, 0, 0, 0}; }), "joint 3 does not reach");
  expect_refused(with([&](auto& r) { r.goals[0].positions = {0, 0, no_number, 0, 0, 0}; }), "joint 3");
  expect_refused(with([&](auto& r) { r.goals[0].pose.position[0] = no_number; }), "finite numbers");
  expect_refused(with([](auto& r) { r.goals[0].pose.orientation.coeffs().setZero(); }), "finite numbers");
  expect_refused(with([](auto& r) { r.goals[0].of_held = true; }), "no box is held");
  expect_refused(with([](auto& r) { r.goals[0].relative_to = 9; }), "box 9 is not among");
  expect_refused(with([&](auto& r) { r.approach[2] = no_number; }), "leave and approach");
  expect_refused(with([](auto& r) { r.leave[2] = 4; }), "leave and approach");
  expect_refused(with([](auto& r) { r.budget = 0; }), "budget");
  expect_refused(with([](auto& r) { r.take = 9; }), "box 9 can be taken only");
  expect_refused(with([](auto& r) { r.release = true; }), "no box is held that could be released");
}

/// A plane with a wall around the goal, but for a gap where `open`.
SearchSpace room(bool open, int& checks) {
  SearchSpace space;
  space.limits = {{-1, 1}, {-1, 1}};
  space.is_free = [open, &checks](const Positions& at) {
    ++checks;
    const double distance = std::hypot(at[0] - 0.5, at[1]);
    return distance < 0.2 || distance > 0.3 || (open && at[0] > 0.5 && std::abs(at[1]) < 0.1);
  };
  return space;
}

TEST(PathSearch, FindsTheGapAndGivesUpWhereThereIsNone) {
  int checks = 0;
  const auto path = find_path(room(true, checks), {-0.5, 0}, {0.5, 0}, {.steps = 3000});
  ASSERT_TRUE(path);
  EXPECT_GT(cost_of(*path), 1.2) << "round to the other side";
  EXPECT_FALSE(find_path(room(false, checks), {-0.5, 0}, {0.5, 0}, {.steps = 3000}));
  EXPECT_FALSE(find_path(room(true, checks), {-0.5, 0}, {0.25, 0}, {})) << "into the wall";
}

TEST(PathSearch, KeepsToItsBudget) {
  int few = 0;
  EXPECT_FALSE(find_path(room(false, few), {-0.5, 0}, {0.5, 0}, {.steps = 50}));
  int many = 0;
  EXPECT_FALSE(find_path(room(false, many), {-0.5, 0}, {0.5, 0}, {.steps = 5000}));
  EXPECT_LT(few * 20, many);
}

TEST(BoxEstimate, StandsUprightWhicheverSideWasSeen) {
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  for (int axis = 0; axis < 3; ++axis) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Eigen::Quaterniond side(Eigen::AngleAxisd(quarter * M_PI / 2, Eigen::Vector3d::Unit(axis)));
      const auto cube = upright({{1, 2, 3}, yaw * side});
      EXPECT_LT(cube.orientation.angularDistance(yaw), 1e-9);
    }
  }
}

TEST(BoxEstimate, NeedsEnoughImagesAndLeavesOutWhatIsWrong) {
  BoxEstimate estimate(5);
  const auto seen_at = [](double x, double turn) {
    return messages::Pose{{x, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()))};
  };
  estimate.add(3, seen_at(std::nan(""), 0));
  for (const double x : {0.51, 0.50, 9.0, 0.49})
    estimate.add(3, seen_at(x, M_PI / 4 - 0.01));
  EXPECT_FALSE(estimate.pose(3));
  EXPECT_FALSE(estimate.pose(4));
  estimate.add(3, seen_at(0.50, M_PI / 4 + 0.01));  // a quarter turn away from the others, nearly
  ASSERT_TRUE(estimate.pose(3));
  EXPECT_NEAR(estimate.pose(3)->position.x(), 0.5, 0.011);
  const double turn = Eigen::AngleAxisd(estimate.pose(3)->orientation).angle();
  EXPECT_NEAR(turn, M_PI / 4, 0.03);
  for (int image = 0; image < 20; ++image)
    estimate.next_image();
  EXPECT_FALSE(estimate.pose(3)) << "it has not been seen lately";
}

}  // namespace
}  // namespace planning
