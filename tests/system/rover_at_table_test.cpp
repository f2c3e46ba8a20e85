// SPDX-License-Identifier: Apache-2.0
// The simulated rover clears and sets the table, as in example 08, judged by what the simulation knows.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <support/number_from.hpp>

#include <Eigen/Core>
#include <array>
#include <functional>
#include <iterator>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Eigen::Vector3d kRover(0.85, 0, 0);
const Eigen::Vector3d kPlace(0.05, -0.27, 0.34);  ///< of the first box on the deck, as the mission says
constexpr double kTolerance = 0.03;               ///< m

class RoverAtTable : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    const auto example = segue::paths::in_sources("/examples/08_rover");
    std::filesystem::copy(example, folder_ / "example", std::filesystem::copy_options::recursive);
  }
  /// Of each planner's answer.
  void limit_plans_to(const std::string& timeout) const {
    std::ifstream file(folder_ / "example/bring_boxes.yaml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string pool = "      pool: planner\n";
    const std::string limit = "      timeout: " + timeout + "\n";
    for (auto at = text.find(pool); at != std::string::npos; at = text.find(pool, at + limit.size() + 1))
      text.insert(at, limit);
    write("example/bring_boxes.yaml", text);
  }
  void start_robot(const std::string& file) {
    robot_ = std::make_unique<Process>(command({"run", "example/" + file}), folder_);
    ASSERT_TRUE(robot_->wait_for("runs (pid"));
  }
  /// In the frame of the room.
  Eigen::Vector3d box(std::size_t number) {
    const auto sample = json({"read", "rover.boxes"});
    const auto* const markers = sample.find("markers");
    if (markers == nullptr) return Eigen::Vector3d::Zero();
    const auto& position = markers->as_list().at(number).find("pose")->find("position")->as_list();
    return {position.at(0).as_double(), position.at(1).as_double(), position.at(2).as_double()};
  }
  std::string state_of(const std::string& task) {
    const auto status = json({"status"});
    for (const auto& entry : status.find("tasks")->as_list()) {
      if (entry.find("id")->as_string() != task) continue;
      const auto* const name = entry.find("state_name");
      return name == nullptr || name->is_null() ? "" : name->as_string();
    }
    return "";
  }
  void wait_until(const std::string& what, const std::function<bool()>& holds) {
    ASSERT_TRUE(eventually(holds)) << what;
  }
  std::vector<double> arm() {
    std::vector<double> positions;
    const auto sample = json({"read", "arm.joints"});
    for (const auto& position : sample.find("positions")->as_list())
      positions.push_back(position.as_double());
    return positions;
  }
  /// Clears the table, and interrupts it while the arm moves: how the mission ends.
  Finished interrupted(const std::string& mode, const std::vector<std::string>& trouble) {
    Process mission(command({"mission", "run", "example/clear_table.yaml", "--mode", mode}), folder_);
    EXPECT_TRUE(eventually([&] { return state_of("follower") == "moving"; })) << "the arm follows a path";
    EXPECT_EQ(segue(trouble).status, 0);
    return mission.wait();
  }
  void expect_rest() {
    EXPECT_EQ(controller(), "guard+hold");
    EXPECT_EQ(state_of("arm"), "holding");
    EXPECT_EQ(state_of("wheels"), "idle");
    const auto rest = arm();
    const auto time = json({"read", "rover.time"}).as_double();
    ASSERT_NO_FATAL_FAILURE(wait_until("time goes on", [&] {
      return json({"read", "rover.time"}).as_double() > time + 0.3;
    }));
    const auto later = arm();
    ASSERT_EQ(rest.size(), later.size());
    for (std::size_t joint = 0; joint < rest.size(); ++joint)
      EXPECT_NEAR(rest[joint], later[joint], 0.005) << "joint " << joint + 1 << " stands still";
  }
};

TEST_F(RoverAtTable, BringsABoxToItsPlaceOnTheDeck) {
  ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
  const auto run =
      json({"mission", "run", "example/clear_table.yaml", "--input", "boxes=1", "--mode", "concurrent"});
  EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
  EXPECT_LT((box(0) - kRover - kPlace).norm(), kTolerance) << box(0).transpose();
  EXPECT_GT(box(1).x(), 1.5) << "the others are still on the table";
  EXPECT_GT(box(2).x(), 1.5);

  const auto nowhere =
      segue({"call", "planner_1.plan", "request={goals: [{positions: [0, 0, 9, 0, 0, 0]}]}"});
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_THAT(nowhere.errors, HasSubstr("the arm has 6 joints; from.positions has 0"));
  EXPECT_EQ(stop().status, 0);
}

/// Of the box that is fetched, while the hand is on its way to it: how far a person moves it, m.
struct Hand {
  const char* what;
  Eigen::Vector3d by;
};

TEST_F(RoverAtTable, BringsABoxThatIsMovedByHandOrSaysThatItHasNot) {
  const std::array kHands = {Hand{"pushed a little", {0.0, 0.015, 0.0}}, Hand{"taken away", {0.0, 2.0, 0.0}},
                             Hand{"pushed aside", {0.05, -0.1, 0.0}}, Hand{"turned over", {0.0, 0.0, 0.1}}};
  const int rounds = number_from("SEGUE_MOVED_BOXES", 2);
  for (int round = 0; round < rounds; ++round) {
    const Hand& hand = kHands.at(static_cast<std::size_t>(round / 2) % kHands.size());
    const std::string mode = round % 2 == 0 ? "concurrent" : "sequential";
    SCOPED_TRACE(std::string(hand.what) + ", " + mode + ", seed " + std::to_string(round + 1));
    ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
    Process mission(command({"mission", "run", "example/clear_table.yaml", "--mode", mode, "--input",
                             "boxes=1", "--input", "seed=" + std::to_string(round + 1)}),
                    folder_);
    ASSERT_NO_FATAL_FAILURE(
        wait_until("the arm follows a path", [&] { return state_of("follower") == "moving"; }));
    const Eigen::Vector3d to = box(0) + hand.by;
    EXPECT_EQ(segue({"call", "rover.place_box", "box=0",
                     fmt::format("pose={{position: [{}, {}, {}], orientation: {{w: 1, x: 0, y: 0, z: 0}}}}",
                                 to.x(), to.y(), to.z()),
                     "--beside-mission"})
                  .status,
              0);
    const auto ended = mission.wait();
    const bool is_there = (box(0) - kRover - kPlace).norm() < kTolerance;
    const bool says_done = ended.status == 0 && ended.output.find("clear_table: done") != std::string::npos;
    EXPECT_EQ(says_done, is_there) << ended.output << ended.errors;
    if (!says_done) {
      EXPECT_NE(ended.errors.find("aborted"), std::string::npos) << "it says why: " << ended.errors;
    }
    EXPECT_EQ(stop().status, 0);
  }
}

TEST_F(RoverAtTable, SaysWhyNoPlanHasBeenFound) {
  limit_plans_to("1ms");
  ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
  for (const std::string mode : {"sequential", "concurrent"}) {
    const auto ended = segue({"mission", "run", "example/clear_table.yaml", "--mode", mode});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("no plan has been found"), HasSubstr("'timeout' of 1ms")));
  }
  EXPECT_EQ(stop().status, 0);
}

TEST_F(RoverAtTable, SetsATableForTwo) {
  ASSERT_NO_FATAL_FAILURE(start_robot("loaded_robot.yaml"));
  const auto run =
      json({"mission", "run", "example/set_table.yaml", "--input", "persons=2", "--mode", "concurrent"});
  EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
  const Eigen::Vector3d rover(0.85, 0, 0);
  EXPECT_LT((box(0) - rover - Eigen::Vector3d(0.77, -0.2, 0.33)).norm(), 0.03) << box(0).transpose();
  EXPECT_LT((box(1) - rover - Eigen::Vector3d(0.77, 0, 0.33)).norm(), 0.03) << box(1).transpose();
  EXPECT_LT(box(2).x(), 1.2) << "the third is still on the deck";
  EXPECT_EQ(stop().status, 0);
}

TEST_F(RoverAtTable, AStopButtonHaltsTheRobotAndEndsItsMission) {
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
    const auto ended = interrupted(mode, {"call", "stop_button.press", "--beside-mission"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, HasSubstr("its halt condition, who halted it")) << ended.output;
    ASSERT_NO_FATAL_FAILURE(wait_until("the robot is at rest", [&] {
      return segue({"status"}).output.find("at rest") != std::string::npos;
    }));
    ASSERT_NO_FATAL_FAILURE(expect_rest());
    EXPECT_THAT(segue({"switch", "carry+guard"}).errors, HasSubstr("while task 'stop_button' is pressed"));
    EXPECT_EQ(segue({"call", "stop_button.release"}).status, 0);
    ASSERT_NO_FATAL_FAILURE(wait_until("it can be commanded again", [&] {
      return segue({"switch", "carry+guard"}).status == 0;
    }));
    EXPECT_EQ(stop().status, 0);
  }
}

TEST_F(RoverAtTable, AStopButtonHaltsTheRobotWithoutAMission) {
  ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
  EXPECT_EQ(segue({"switch", "carry+guard"}).status, 0);
  EXPECT_EQ(segue({"call", "stop_button.press"}).status, 0);
  ASSERT_NO_FATAL_FAILURE(wait_until(
      "the robot is at rest", [&] { return segue({"status"}).output.find("at rest") != std::string::npos; }));
  ASSERT_NO_FATAL_FAILURE(expect_rest());
  EXPECT_EQ(stop().status, 0);
}

TEST_F(RoverAtTable, ALowBatteryEndsAMissionWithTheRobotAtRest) {
  for (const std::string mode : {"sequential", "concurrent"}) {
    ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
    SCOPED_TRACE(mode);
    const auto ended = interrupted(mode, {"call", "battery.recharge", "charge=0.1", "--beside-mission"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output, HasSubstr("clear_table: battery_low")) << ended.errors;
    ASSERT_NO_FATAL_FAILURE(expect_rest());
    EXPECT_EQ(stop().status, 0);
  }
}

}  // namespace
}  // namespace segue::testing
