// SPDX-License-Identifier: Apache-2.0
// The simulated rover clears and sets the table, as in example 08, judged by what the simulation knows.
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <functional>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

class RoverAtTable : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    const auto example = segue::paths::in_sources("/examples/08_rover");
    std::filesystem::copy(example, folder_ / "example", std::filesystem::copy_options::recursive);
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
  /// Clears the table, and interrupts it while the arm moves: how that ends.
  void expect_halt(const std::string& mode, const std::vector<std::string>& trouble,
                   const std::string& outcome) {
    SCOPED_TRACE(mode + " " + trouble.at(1));
    Process mission(command({"mission", "run", "example/clear_table.yaml", "--mode", mode}), folder_);
    ASSERT_NO_FATAL_FAILURE(
        wait_until("the arm follows a path", [&] { return state_of("follower") == "moving"; }));
    ASSERT_EQ(segue(trouble).status, 0);
    const auto ended = mission.wait();
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output, HasSubstr("clear_table: " + outcome)) << ended.errors;
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
  const Eigen::Vector3d rover(0.85, 0, 0);
  const Eigen::Vector3d place(0.05, -0.27, 0.34);  // as the mission says
  EXPECT_LT((box(0) - rover - place).norm(), 0.03) << box(0).transpose();
  EXPECT_GT(box(1).x(), 1.5) << "the others are still on the table";
  EXPECT_GT(box(2).x(), 1.5);

  const auto nowhere =
      segue({"call", "planner_1.plan", "request={goals: [{positions: [0, 0, 9, 0, 0, 0]}]}"});
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_THAT(nowhere.errors, HasSubstr("the arm has 6 joints; from.positions has 0"));
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

TEST_F(RoverAtTable, AStopButtonEndsAMissionWithTheRobotAtRest) {
  for (const std::string mode : {"sequential", "concurrent"}) {
    ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
    ASSERT_NO_FATAL_FAILURE(expect_halt(mode, {"call", "stop_button.press", "--beside-mission"}, "stopped"));
    const auto refused = json({"mission", "run", "example/clear_table.yaml", "--mode", mode});
    EXPECT_EQ(refused.find("outcome")->as_string(), "stopped") << "the button is still pressed";
    const auto switched = segue({"switch", "carry"});
    EXPECT_EQ(switched.status, 0) << switched.errors;
    EXPECT_EQ(stop().status, 0);
  }
}

TEST_F(RoverAtTable, ALowBatteryEndsAMissionWithTheRobotAtRest) {
  for (const std::string mode : {"sequential", "concurrent"}) {
    ASSERT_NO_FATAL_FAILURE(start_robot("table_robot.yaml"));
    ASSERT_NO_FATAL_FAILURE(
        expect_halt(mode, {"call", "battery.recharge", "charge=0.1", "--beside-mission"}, "battery_low"));
    EXPECT_EQ(stop().status, 0);
  }
}

}  // namespace
}  // namespace segue::testing
