// SPDX-License-Identifier: Apache-2.0
#include "../test_network.hpp"
#include "conversions.hpp"
#include "transform_test_support.hpp"

#include <segue/task/component.hpp>
#include <segue/task/realtime_log.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>

namespace ros2_messages {
namespace {

using namespace std::chrono_literals;
using components_test::TestNetwork;
using segue::TaskState;
using segue::task::ReadStatus;
using segue::type::Value;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A task that tells the pose of base in map, with what it is connected to.
class PoseOfBase : public ::testing::Test {
 protected:
  struct Ends : segue::task::Component {
    segue::task::OutputPort<tf2_msgs::TFMessage> moving{*this, "moving"};
    segue::task::OutputPort<tf2_msgs::TFMessage> fixed{*this, "fixed"};
    segue::task::InputPort<messages::TimedPose> pose{*this, "pose"};
    segue::task::InputPort<messages::Odometry> odometry{*this, "odometry"};
  };

  PoseOfBase()
      : task_(
            network_.add("base", "from_ros2::Transform", Value::map({{"frame", "map"}, {"child", "base"}}))) {
    network_.connect(ends_.moving, network_.input("base", "in"));
    network_.connect(ends_.fixed, network_.input("base", "static"));
    network_.connect(network_.output("base", "out"), ends_.pose);
    network_.connect(network_.output("base", "odometry"), ends_.odometry);
    network_.start("base");
  }

  void send(const geometry_msgs::TransformStamped& transform) {
    ends_.moving.write({{transform}});
    network_.run_ready();
  }
  void send_static(const geometry_msgs::TransformStamped& transform) {
    ends_.fixed.write({{transform}});
    network_.run_ready();
  }
  void pass(segue::Duration time) {
    network_.advance(time);
    network_.run_ready();
  }

  Ends ends_;
  TestNetwork network_;
  segue::task::Task& task_;
  messages::TimedPose pose_;
  messages::Odometry odometry_;
};

TEST_F(PoseOfBase, ComesWithTheTransformThatCompletesIt) {
  send(made_transform("odom", "base", 1, 2));
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::NoData);
  send(made_transform("map", "odom", 1, 10));
  ASSERT_EQ(ends_.pose.read(pose_), ReadStatus::NewData);
  EXPECT_EQ(pose_.time, 1);
  EXPECT_EQ(pose_.pose.position.x(), 12);
  send(made_transform("odom", "base", 2, 3));
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::OldData) << "what is known for 1 s was told already";
  send(made_transform("map", "odom", 2, 10));
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::NewData);
  EXPECT_EQ(task_.state(), TaskState::Running);
}

TEST_F(PoseOfBase, HasTheVelocityInThePlaneThatFollows) {
  for (int i = 0; i <= 4; ++i) {
    auto turning = made_transform("map", "base", 1 + 0.05 * i, 0);
    const double angle = 3 + 0.1 * i;  // 2 rad/s, over the angle at which the sign changes
    turning.transform.translation = {std::sin(angle), -std::cos(angle), 7};  // on a circle of 1 m
    turning.transform.rotation = about_z(angle);
    send(turning);
  }
  ASSERT_EQ(ends_.odometry.read(odometry_), ReadStatus::NewData);
  EXPECT_NEAR(odometry_.pose.theta, std::remainder(3.4, 2 * M_PI), 1e-9);
  EXPECT_NEAR(odometry_.pose.y, -std::cos(3.4), 1e-9);
  EXPECT_NEAR(odometry_.twist.angular, 2, 1e-6);
  EXPECT_NEAR(odometry_.twist.linear, 2, 0.01);
}

TEST_F(PoseOfBase, IsMissedAfterTheTimeOutWithTheFrameThatIsMissing) {
  const segue::task::RealtimeLogDrain drain;
  send(made_transform("odom", "base", 1, 2));
  pass(900ms);
  EXPECT_EQ(task_.state(), TaskState::Running) << "other transforms may still come";
  pass(200ms);
  EXPECT_EQ(task_.state_name(), "no_transform");
  EXPECT_THAT(task_.error_message(), HasSubstr("no pose of 'base': no transform names frame 'map'"));
  send(made_transform("map", "odom", 1, 0));
  EXPECT_EQ(task_.state(), TaskState::Running);
  for (int i = 0; i < 30; ++i) {
    pass(50ms);
    send(made_transform("odom", "base", 2 + 0.05 * i, 2));
  }
  EXPECT_EQ(task_.state_name(), "no_transform") << "although something comes all the time";
  EXPECT_THAT(task_.error_message(), HasSubstr("no newer transform has come of frame 'odom'"));
}

TEST_F(PoseOfBase, IsMissedForTheReasonOfNow) {
  pass(1100ms);
  EXPECT_THAT(task_.error_message(), HasSubstr("no transform names frame 'base'"));
  send(made_transform("odom", "base", 1, 2));
  EXPECT_EQ(task_.state_name(), "no_transform");
  EXPECT_THAT(task_.error_message(), HasSubstr("no transform names frame 'map'"));
}

TEST_F(PoseOfBase, OfStaticTransformsIsToldOnceAndNeverMissed) {
  send_static(made_transform("map", "base", 5, 2));
  ASSERT_EQ(ends_.pose.read(pose_), ReadStatus::NewData);
  EXPECT_EQ(pose_.time, 0);
  pass(5s);
  EXPECT_EQ(task_.state(), TaskState::Running);
  send_static(made_transform("map", "base", 6, 2));
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::OldData);
  send_static(made_transform("map", "base", 6, 3));
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::NewData) << "somebody has calibrated it";
}

TEST_F(PoseOfBase, HasNoMovingTransformsFromBeforeAStopButTheStaticOnes) {
  send_static(made_transform("map", "odom", 0, 10));
  send(made_transform("odom", "base", 1, 2));
  ASSERT_EQ(ends_.pose.read(pose_), ReadStatus::NewData);
  network_.stop("base");
  ASSERT_TRUE(task_.start(TestNetwork::soon()));
  network_.run_ready();
  EXPECT_EQ(ends_.pose.read(pose_), ReadStatus::OldData);
  send(made_transform("odom", "base", 3, 4));
  ASSERT_EQ(ends_.pose.read(pose_), ReadStatus::NewData);
  EXPECT_EQ(pose_.pose.position.x(), 14);
}

TEST_F(PoseOfBase, KnowsTheFramesForWhoAsks) {
  send_static(made_transform("map", "odom", 0, 10));
  send(made_transform("odom", "base", 3, 4));
  const auto frames = network_.call("base", "frames");
  ASSERT_TRUE(frames) << to_string(frames.error());
  const auto frame = [](const char* name, const char* parent, bool is_static, double newest) {
    return Value::map({{"frame", name}, {"parent", parent}, {"is_static", is_static}, {"newest", newest}});
  };
  EXPECT_EQ(*frames, Value::list({frame("base", "odom", false, 3), frame("map", "", false, 0),
                                  frame("odom", "map", true, 0)}));
}

TEST(PoseOfAFrame, NeedsTwoFrames) {
  TestNetwork network;
  segue::task::Task& task =
      network.add("pose", "from_ros2::Transform", Value::map({{"frame", "a"}, {"child", "a"}}));
  const auto configured = task.configure(TestNetwork::soon());
  ASSERT_FALSE(configured);
  EXPECT_THAT(to_string(configured.error()), HasSubstr("'frame' and 'child' must be two frames"));
}

struct StaticEnds : segue::task::Component {
  segue::task::OutputPort<tf2_msgs::TFMessage> sent{*this, "sent"};
  segue::task::InputPort<tf2_msgs::TFMessage> told{*this, "told"};
};

std::vector<std::string> children(const tf2_msgs::TFMessage& message) {
  std::vector<std::string> all;
  for (const auto& transform : message.transforms)
    all.push_back(transform.child_frame_id);
  return all;
}

TEST(StaticTransforms, OfAllPublishersAreInOneMessage) {
  StaticEnds ends;
  TestNetwork network;
  segue::task::Task& task = network.add("all", "from_ros2::StaticTransforms", Value::map({{"most", 3}}));
  network.connect(ends.sent, network.input("all", "in"));
  network.connect(network.output("all", "out"), ends.told);
  network.start("all");
  tf2_msgs::TFMessage told;
  const auto send = [&](std::vector<geometry_msgs::TransformStamped> transforms) {
    ends.sent.write({std::move(transforms)});
    network.run_ready();
    EXPECT_EQ(ends.told.read(told), ReadStatus::NewData);
    return children(told);
  };
  EXPECT_THAT(send({made_transform("base", "laser", 0, 1), made_transform("base", "camera", 0, 2)}),
              ElementsAre("laser", "camera"));
  EXPECT_THAT(send({made_transform("base", "gps", 0, 3)}), ElementsAre("laser", "camera", "gps"));
  EXPECT_THAT(send({made_transform("arm", "laser", 0, 4)}), ElementsAre("laser", "camera", "gps"));
  EXPECT_EQ(told.transforms.front().transform.translation.x, 4) << "the last one of each frame counts";
  EXPECT_EQ(task.state(), TaskState::Running);
  const segue::task::RealtimeLogDrain drain;
  EXPECT_THAT(send({made_transform("base", "sonar", 0, 5)}), ElementsAre("laser", "camera", "gps"));
  EXPECT_EQ(task.state_name(), "left_out");
}

TEST(StaticTransforms, AreToldAtTheStartAsURDFHasThem) {
  StaticEnds ends;
  TestNetwork network;
  const Value laser = Value::map({{"frame", "base"},
                                  {"child", "laser"},
                                  {"xyz", Value::list({0.2, 0.0, 0.3})},
                                  {"rpy", Value::list({0.1, 0.2, 0.3})}});
  network.add("laser", "to_ros2::StaticTransforms", Value::map({{"transforms", Value::list({laser})}}));
  network.connect(network.output("laser", "out"), ends.told);
  network.start("laser");
  tf2_msgs::TFMessage told;
  ASSERT_EQ(ends.told.read(told), ReadStatus::NewData);
  ASSERT_THAT(children(told), ElementsAre("laser"));
  EXPECT_EQ(told.transforms[0].header.frame_id, "base");
  EXPECT_GT(told.transforms[0].header.stamp.sec, 0) << "tools take 0 for a delay of many years";
  EXPECT_EQ(told.transforms[0].transform.translation.z, 0.3);
  // As tf2's Quaternion::setRPY(0.1, 0.2, 0.3).
  EXPECT_NEAR(told.transforms[0].transform.rotation.x, 0.0342707985504821, 1e-12);
  EXPECT_NEAR(told.transforms[0].transform.rotation.y, 0.10602051106179562, 1e-12);
  EXPECT_NEAR(told.transforms[0].transform.rotation.z, 0.14357217502739192, 1e-12);
  EXPECT_NEAR(told.transforms[0].transform.rotation.w, 0.9833474432563559, 1e-12);
}

TEST(StaticTransforms, ThatCannotBeAreRefused) {
  const auto why = [](const Value& transforms) {
    TestNetwork network;
    segue::task::Task& task =
        network.add("fixed", "to_ros2::StaticTransforms", Value::map({{"transforms", transforms}}));
    const auto configured = task.configure(TestNetwork::soon());
    return configured ? std::string() : to_string(configured.error());
  };
  const auto one = [](const char* frame, const char* child) {
    return Value::map({{"frame", frame}, {"child", child}});
  };
  EXPECT_EQ(why(Value::list({one("base", "laser"), one("base", "camera")})), "");
  EXPECT_THAT(why(Value::list({one("base", "")})),
              HasSubstr("transform of '' in 'base': both frames need a name"));
  EXPECT_THAT(why(Value::list({one("base", "base")})), HasSubstr("two frames"));
  EXPECT_THAT(why(Value::list({one("base", "laser"), one("arm", "laser")})),
              HasSubstr("one other frame only"));
}

}  // namespace
}  // namespace ros2_messages
