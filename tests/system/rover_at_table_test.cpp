// SPDX-License-Identifier: Apache-2.0
// The simulated rover clears the table, as in example 08, judged by what the simulation knows.
#include <gmock/gmock.h>

#include <Eigen/Core>

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
    robot_ = std::make_unique<Process>(command({"run", "example/table_robot.yaml"}), folder_);
    ASSERT_TRUE(robot_->wait_for("robot rover_at_table runs"));
  }
  /// In the frame of the room.
  Eigen::Vector3d box(std::size_t number) {
    const auto sample = json({"read", "rover.boxes"});
    const auto* const markers = sample.find("markers");
    if (markers == nullptr) return Eigen::Vector3d::Zero();
    const auto& position = markers->as_list().at(number).find("pose")->find("position")->as_list();
    return {position.at(0).as_double(), position.at(1).as_double(), position.at(2).as_double()};
  }
};

TEST_F(RoverAtTable, BringsABoxToItsPlaceOnTheDeck) {
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

}  // namespace
}  // namespace segue::testing
