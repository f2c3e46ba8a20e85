// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/recognition.hpp>
#include <segue/runtime/test_support.hpp>

#include <gmock/gmock.h>

#include <string>

namespace segue::runtime {
namespace {

using detail::running_controller;
using testing::network_of;

/// A robot whose runtime forgets what it knows, as if it had just begun.
class Recognition : public ::testing::Test {
 protected:
  Recognition() {
    for (const char* text : {"{network: drive, tasks: {base: {component: x::Base, properties: "
                             "{gain: 1}}, follower: {component: x::Follower}}, connections: "
                             "[follower.command -> base.command]}",
                             "{network: arm, tasks: {arm: {component: x::Arm, properties: {speed: 1}}}}",
                             "{network: dock, tasks: {base: {component: x::Base, properties: {gain: 1}}, "
                             "servo: {component: x::Servo}}, connections: [servo.command -> base.command]}"})
      EXPECT_FALSE(robot_.runtime.add_controller(network_of(text)).has_errors());
  }

  std::string recognised_after(const std::string& controller, const RequestOptions& options = {}) {
    EXPECT_EQ(robot_.runtime.switch_to(model::NetworkName(controller), options).outcome, Outcome::Done);
    robot_.runtime.reset_belief();
    return robot_.runtime.belief().name.str();
  }

  testing::StandInRobot robot_;
};

TEST_F(Recognition, FindsAControllerAndAUnion) {
  EXPECT_EQ(recognised_after("drive"), "drive");
  EXPECT_EQ(recognised_after("drive+arm"), "arm+drive");
}

TEST_F(Recognition, FindsWhatRunsBesideWhatIsReady) {
  ASSERT_TRUE(robot_.runtime.prepare({model::NetworkName("dock")}).get().at(0).ready);
  EXPECT_EQ(recognised_after("drive+arm"), "arm+drive");
  EXPECT_EQ(robot_.runtime.switch_to(model::NetworkName("dock")).outcome, Outcome::Done);
  EXPECT_EQ(recognised_after("dock"), "dock");
}

TEST_F(Recognition, FindsAControllerWhosePropertiesWereSet) {
  RequestOptions options;
  options.properties = {{model::TaskId("base"), "gain", 3}};
  EXPECT_EQ(recognised_after("drive+arm", options), "arm+drive");
  EXPECT_EQ(robot_.runtime.belief().find_task(model::TaskId("base"))->properties.find("gain")->as_int(), 3);
  EXPECT_THAT(robot_.runtime.observed_differences(), ::testing::IsEmpty());
  const auto again = robot_.runtime.switch_to(model::NetworkName("arm+drive"));
  EXPECT_EQ(again.outcome, Outcome::Done);
  EXPECT_FALSE(again.actions.empty()) << "the file's properties count again";
}

TEST_F(Recognition, DoesNotGuess) {
  EXPECT_EQ(recognised_after("drive"), "drive");
  model::Action stop;
  stop.kind = model::ActionKind::Stop;
  stop.what = model::TaskAction{model::TaskId("base")};
  ASSERT_TRUE(robot_.host.perform(stop, RealClock::instance().now() + std::chrono::seconds(30)));
  robot_.runtime.reset_belief();
  EXPECT_EQ(robot_.runtime.belief().name.str(), "");
}

TEST(RunningController, IsNotChosenByPropertiesAlone) {
  Controllers all;
  for (const char* text : {"{network: slow, tasks: {base: {component: x::Base, properties: {gain: 1}}}}",
                           "{network: fast, tasks: {base: {component: x::Base, properties: {gain: 2}}}}"}) {
    auto one = network_of(text);
    all.emplace(one.name, one);
  }
  const auto found = [&](const char* properties) {
    const auto observed = network_of(
        "{network: seen, tasks: {base: {component: x::Base, properties: " + std::string(properties) + "}}}");
    const auto controller = running_controller(observed, all, {});
    return controller ? controller->name.str() : "none";
  };
  EXPECT_EQ(found("{gain: 2}"), "fast");
  EXPECT_EQ(found("{gain: 3}"), "none");
}

}  // namespace
}  // namespace segue::runtime
