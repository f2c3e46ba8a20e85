// SPDX-License-Identifier: Apache-2.0
// `segue chain` of a running robot.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using type::Value;

class Chain : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    start({"--controller", "explore"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("explore"));
  }
  /// The only chain, once all its steps have been measured.
  Value measured(const std::vector<std::string>& arguments) {
    Value chain;
    EXPECT_TRUE(eventually([&] {
      const Value answer = json(arguments);
      const auto& chains = answer.find("chains")->as_list();
      if (chains.size() != 1) return false;
      chain = chains.front();
      return chain.find("unmeasured")->as_list().empty();
    }));
    return chain;
  }
};

TEST_F(Chain, AddsUpWhatIsMeasuredOfWhatRuns) {
  const Value chain = measured({"chain", "laser", "drive"});
  const auto& steps = chain.find("steps")->as_list();
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps.front().find("step")->as_string(), "laser.scan -> wanderer.scan");
  EXPECT_EQ(steps.back().find("step")->as_string(), "drive");
  double mean = 0;
  for (const Value& step : steps)
    mean += step.find("mean_us")->as_double();
  EXPECT_NEAR(chain.find("mean_us")->as_double(), mean, 1e-3);
  EXPECT_LE(chain.find("mean_us")->as_double(), chain.find("worst_us")->as_double());
  EXPECT_LE(chain.find("p99_us")->as_double(), chain.find("worst_us")->as_double());
  EXPECT_THAT(segue({"chain", "laser", "drive"}).output, HasSubstr("laser -> drive, observed"));
}

TEST_F(Chain, IsPredictedBeforeASwitch) {
  static_cast<void>(measured({"chain", "laser", "drive"}));
  const Value answer = json({"chain", "laser", "drive", "--controller", "manual"});
  const auto& steps = answer.find("chains")->as_list().front().find("steps")->as_list();
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[0].find("step")->as_string(), "laser.scan -> guard.scan");
  EXPECT_EQ(steps[0].find("like")->as_string(), "connections in a process");
  EXPECT_EQ(*steps[1].find("mean_us"), Value()) << "no task of the component of guard runs";
  EXPECT_EQ(steps[2].find("like")->as_string(), "connections to demo::Drive.command");
  EXPECT_EQ(*steps[3].find("like"), Value()) << "the drive runs on";
  const auto text = segue({"chain", "laser", "drive", "--controller", "manual"});
  EXPECT_THAT(text.output, HasSubstr("never measured"));
  EXPECT_EQ(controller(), "explore");
}

TEST_F(Chain, ThatIsNotThereIsAnError) {
  const auto back = segue({"chain", "odometry.pose", "odometry.pose"});
  EXPECT_EQ(back.status, 1);
  EXPECT_THAT(back.errors, HasSubstr("no connections lead from 'odometry.pose' to 'odometry.pose'"));
  EXPECT_THAT(segue({"chain", "lasre", "drive"}).errors, HasSubstr("did you mean 'laser'?"));
}

}  // namespace
}  // namespace segue::testing
