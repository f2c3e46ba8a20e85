// SPDX-License-Identifier: Apache-2.0
// Tasks request controllers of a running robot, from whatever process they live in.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using type::Value;

class RequestsOfTasks : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("rover/robot.yaml",
          "robot: rover\nlibraries: [segue_components_demo, segue_components_requests]\n"
          "controllers: [controllers/*.yaml]\n");
    write("rover/controllers/wait.yaml",
          "tasks: {runtime: {component: 'runtime::Requests'}}\ndeployments: {other: {tasks: [runtime]}}\n");
    write("rover/controllers/drive.yaml", "tasks: {drive: {component: 'demo::Drive'}}\n");
    start({"--controller", "wait"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("wait"));
  }
};

TEST_F(RequestsOfTasks, AreCarriedOutAndJournalled) {
  EXPECT_EQ(segue({"write", "runtime.request=drive"}).status, 0);
  ASSERT_NO_FATAL_FAILURE(wait_for_controller("drive"));
  EXPECT_TRUE(eventually([&] {
    const Value history = json({"history"});
    return history.as_list().back().find("who")->as_string() == "task runtime";
  })) << "the journal follows what runs";
}

TEST_F(RequestsOfTasks, ThatAreRefusedAreShownAsEvents) {
  EXPECT_EQ(segue({"write", "runtime.request=fly"}).status, 0);
  EXPECT_TRUE(
      eventually([&] { return segue({"events"}).output.find("no controller 'fly'") != std::string::npos; }));
  EXPECT_EQ(controller(), "wait");
}

}  // namespace
}  // namespace segue::testing
