// SPDX-License-Identifier: Apache-2.0
#include "exposure_test_support.hpp"

#include <segue/ros2/parameter_value.hpp>
#include <segue/type/json.hpp>

#include <string_view>

namespace ros2::testing {
namespace {

/// The events on /parameter_events, as texts: "/robot/drive changed speed=2.0, gains.p=1.5".
class ParameterEvents : public ExposedTasks {
 protected:
  void SetUp() override {
    ExposedTasks::SetUp();
    robot->add_task(kWitness);
  }
  /// Reads the topic, from a change on that is told.
  void read() {
    Quality quality;
    quality.depth = 1000;
    peer->subscribe(
        {.topic = "/parameter_events", .interface = "rcl_interfaces/msg/ParameterEvent", .quality = quality});
    // Nothing comes before the publisher has found the subscription, which nobody is told.
    ASSERT_TRUE(eventually([&] {
      robot->change(kWitness, "speed", ++marks_);
      take();
      return has_witness_;
    }));
    ASSERT_TRUE(are_told_all());
    told_.clear();
  }
  /// Of all other tasks than the witness.
  const Texts& told() {
    take();
    return told_;
  }
  bool is_told(const std::string& text) {
    return eventually([&] { return std::ranges::find(told(), text) != told_.end(); });
  }
  /// Whether what has changed so far has been told: the witness is, which comes last. The first time it may
  /// have been asked just now, in a round that began before the other changes.
  bool are_told_all() { return is_witness_told() && is_witness_told(); }

 private:
  static constexpr const char* kWitness = "witness";

  bool is_witness_told() {
    awaited_ = "speed=" + std::to_string(++marks_);
    robot->change(kWitness, "speed", marks_);
    return eventually([&] {
      take();
      return awaited_.empty();
    });
  }

  void take() {
    for (const Bytes& message : peer->take()) {
      const std::string text = text_of_event(codec_.decode(message).value());
      const bool is_witness = text.starts_with("/robot/witness");
      has_witness_ |= is_witness;
      if (!is_witness)
        told_.push_back(text);
      else if ((text + ",").find(awaited_ + ",") != text.npos)
        awaited_.clear();
    }
  }
  static std::string text_of_event(const Value& event) {
    std::string text = event.find("node")->as_string();
    EXPECT_GT(event.find("stamp")->find("sec")->as_int(), 0);
    for (const std::string_view kind : {"new", "changed", "deleted"}) {
      const auto& all = event.find(std::string(kind) + "_parameters")->as_list();
      for (const Value& one : all) {
        text += (&one == &all.front() ? " " + std::string(kind) + " " : ", ") +
                one.find("name")->as_string() + "=" +
                segue::type::to_json(segue::ros2::parameter_from(*one.find("value")), -1);
      }
    }
    return text;
  }

  segue::ros2::InterfaceLibrary library_;
  segue::ros2::MessageCodec codec_ =
      segue::ros2::MessageCodec::of(library_, "rcl_interfaces/msg/ParameterEvent").value();
  Texts told_;
  int marks_ = 0;
  bool has_witness_ = false;
  std::string awaited_;
};

constexpr const char* kAllOfArm =
    "/robot/arm new speed=0.5, count=3, name=\"left\", on=true, gains.p=1.5, gains.limits=[1,2], offsets=[]";

TEST_P(ParameterEvents, TellWhatSomebodyHasSet) {
  expose(true);
  read();
  robot->change("drive", "speed", 2.0);
  EXPECT_TRUE(is_told("/robot/drive changed speed=2.0"));
  robot->change("drive", "gains", Value::map({{"p", 2.5}, {"limits", Value::list({1, 3})}}));
  EXPECT_TRUE(is_told("/robot/drive changed gains.p=2.5, gains.limits=[1,3]"));
  EXPECT_EQ(*first_result(setter().ask(parameters({speed(3.0)}))).find("successful"), Value(true));
  EXPECT_TRUE(is_told("/robot/drive changed speed=3.0")) << "by a client of ROS 2";
  EXPECT_EQ(told().size(), 3U) << ::testing::PrintToString(told());
}

TEST_P(ParameterEvents, TellNothingThatHasNotChanged) {
  expose();
  read();
  robot->change("drive", "speed", 0.5);
  robot->configure("drive", ShownRobot::properties());
  ASSERT_TRUE(are_told_all());
  EXPECT_THAT(told(), IsEmpty());
}

TEST_P(ParameterEvents, TellWhatASwitchHasConfiguredAnew) {
  expose();
  read();
  Value properties = ShownRobot::properties();
  properties.as_map().set("count", 4);
  properties.as_map().set("name", "right");
  properties.as_map().set("speed", 1);
  properties.as_map().erase("offsets");
  properties.as_map().set("mode", "fast");
  robot->configure("drive", properties);
  EXPECT_TRUE(
      is_told("/robot/drive new mode=\"fast\" changed speed=1, count=4, name=\"right\" deleted offsets=[]"));
}

TEST_P(ParameterEvents, HaveAllParametersOfANodeThatAppears) {
  expose();
  read();
  robot->add_task("arm");
  EXPECT_TRUE(is_told(kAllOfArm));
  robot->remove_task("arm");
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/drive", "/robot/witness"}));
  robot->add_task("arm");
  EXPECT_TRUE(eventually([&] { return told().size() == 2; }));
  EXPECT_THAT(told(), ElementsAre(kAllOfArm, kAllOfArm));
}

TEST_P(ParameterEvents, AreNotToldToWhoeverComesLater) {
  expose();
  ASSERT_TRUE(are_nodes({"/exposure", "/robot/drive", "/robot/witness"}));
  robot->change("drive", "speed", 9.0);
  read();
  robot->change("drive", "count", 4);
  ASSERT_TRUE(are_told_all());
  EXPECT_THAT(told(), ElementsAre("/robot/drive changed count=4"));
}

TEST_P(ParameterEvents, CostTheRobotNothingWhileNobodyReads) {
  ValueMap more;
  more.set("log", false);
  expose(false, more);
  ASSERT_TRUE(are_nodes({"/exposure", "/robot/drive", "/robot/witness"}));
  for (const char* arm : {"arm", "other_arm"}) {
    robot->change("drive", "speed", 9.0);
    robot->add_task(arm);
    robot->configure("drive", ShownRobot::properties());
    ASSERT_TRUE(eventually([&] { return std::ranges::count(nodes(), "/robot/" + std::string(arm)) == 1; }));
  }
  EXPECT_EQ(robot->event_looks, 0);
  EXPECT_EQ(robot->reports, 0);
  read();
  EXPECT_GT(robot->event_looks, 0);
  peer.reset();
  // It takes its time until the publisher knows that nobody reads any more.
  EXPECT_TRUE(eventually([&] {
    auto get = asker("/robot/arm/get_parameters", "rcl_interfaces/srv/GetParameters");
    const int looks = robot->event_looks;
    robot->change("drive", "speed", looks);
    get.ask(names({"speed"}));
    get.ask(names({"speed"}));
    return robot->event_looks == looks;
  }));
}

TEST_P(ParameterEvents, BeginAgainWithTheRobot) {
  expose();
  read();
  robot->add_task("arm");
  ASSERT_TRUE(is_told(kAllOfArm));
  end_robot();
  EXPECT_TRUE(are_nodes({"/exposure"}));
  ASSERT_EQ(told().size(), 1U);
  serve();
  EXPECT_TRUE(eventually([&] { return std::ranges::count(told(), kAllOfArm) == 2; }));
  ASSERT_TRUE(are_told_all());
  EXPECT_EQ(std::ranges::count(told(), kAllOfArm), 2);
}

TEST_P(ParameterEvents, HaveTheLastOfManyChangesAndNoneTwice) {
  constexpr int kChanges = 100;
  expose();
  read();
  for (int i = 1; i <= kChanges; ++i)
    robot->change("drive", "count", 1000 + i);
  EXPECT_TRUE(is_told("/robot/drive changed count=" + std::to_string(1000 + kChanges)));
  ASSERT_TRUE(are_told_all());
  Texts each_once = told();
  std::ranges::sort(each_once);
  EXPECT_EQ(each_once, told()) << "in their order";
  EXPECT_EQ(std::ranges::adjacent_find(each_once), each_once.end());
}

TEST_P(ParameterEvents, AreToldAlthoughTheRobotForgetsItsEvents) {
  robot->add_task("arm");
  expose();
  read();
  robot->silence("drive");
  robot->change("drive", "speed", 2.0);
  ASSERT_TRUE(robot->entered.wait_until(soon()));
  robot->change("arm", "speed", 3.0);
  robot->forget_events();
  robot->release.open();
  robot->change("drive", "speed", 4.0);
  EXPECT_TRUE(is_told("/robot/arm changed speed=3.0"));
  EXPECT_TRUE(is_told("/robot/drive changed speed=4.0"));
}

TEST_P(ParameterEvents, AreToldBesideATaskThatDoesNotAnswer) {
  robot->add_task("arm");
  expose();
  read();
  robot->silence("arm");
  robot->change("arm", "speed", 2.0);
  ASSERT_TRUE(robot->entered.wait_until(soon()));
  robot->change("drive", "speed", 3.0);
  EXPECT_TRUE(is_told("/robot/drive changed speed=3.0"));
  robot->release.open();
  EXPECT_TRUE(is_told("/robot/arm changed speed=2.0")) << "it is asked again";
}

/// One endpoint is the publisher of all nodes: one that has just come would be found by no subscription yet.
TEST_P(ParameterEvents, AreOfAllNodes) {
  robot->add_task("arm");
  expose();
  ASSERT_TRUE(are_nodes({"/exposure", "/robot/arm", "/robot/drive", "/robot/witness"}));
  const auto participants = peer->others();
  const auto own = std::ranges::find_if(participants, [](const auto& one) { return one.nodes.size() == 4; });
  ASSERT_NE(own, participants.end());
  int with_it = 0;
  for (const auto& gid : own->nodes.front().publishers) {
    const bool is_shared = std::ranges::all_of(own->nodes, [&](const auto& node) {
      return std::ranges::find(node.publishers, gid) != node.publishers.end();
    });
    with_it += is_shared ? 1 : 0;
  }
  EXPECT_EQ(with_it, 1);
}

INSTANTIATE_TEST_SUITE_P(, ParameterEvents, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

}  // namespace
}  // namespace ros2::testing
