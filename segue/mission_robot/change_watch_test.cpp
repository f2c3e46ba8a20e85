// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/change_watch.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>

#include <memory>

namespace segue::mission {
namespace {

class ChangeWatchTest : public ::testing::Test {
 protected:
  FakeCommandedRobot robot_;
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  ChangeWatch changes_{robot_, bell_};

  /// Asks, once it is time.
  void ask() {
    const TimePoint next = changes_.next_question();
    while (RealClock::instance().now() < next)
      bell_->wait(next);
    changes_.ask();
  }
};

TEST_F(ChangeWatchTest, HasNewsAtFirstAndAfterEachChange) {
  EXPECT_FALSE(changes_.take());
  ask();
  EXPECT_TRUE(changes_.take());
  for (int i = 0; i < 2; ++i) {
    ask();
    EXPECT_FALSE(changes_.take()) << "nothing has changed";
    robot_.lose("it is broken");
    EXPECT_TRUE(changes_.take());
  }
}

TEST_F(ChangeWatchTest, MissesNoChangeThatComesWhileNothingIsAsked) {
  ask();
  EXPECT_TRUE(changes_.take());
  robot_.lose("it is broken");
  EXPECT_FALSE(changes_.take());
  ask();
  EXPECT_TRUE(changes_.take());
}

TEST_F(ChangeWatchTest, AsksOneQuestionAtATime) {
  ask();
  EXPECT_TRUE(changes_.take());
  changes_.ask();
  EXPECT_LT(changes_.next_question(), TimePoint::max()) << "it is not yet time";
  ask();
  EXPECT_EQ(changes_.next_question(), TimePoint::max());
  changes_.ask();
  robot_.lose("it is broken");
  EXPECT_TRUE(changes_.take());
  EXPECT_FALSE(changes_.take());
}

/// Cannot be asked.
class LostRobot final : public FakeCommandedRobot {
  void changes(std::uint64_t /*seen*/, const Wait& /*wait*/, ChangesAnswer answered) override {
    answered(fail(ErrorCode::Unavailable, "it is lost"));
  }
};

TEST(ChangeWatch, CountsAnErrorAsNewsAndTriesAgainLater) {
  LostRobot robot;
  ChangeWatch changes(robot, std::make_shared<Bell>());
  const TimePoint begin = RealClock::instance().now();
  changes.ask();
  EXPECT_TRUE(changes.take());
  EXPECT_GE(changes.next_question(), begin + ChangeWatch::kBetweenTries);
}

}  // namespace
}  // namespace segue::mission
