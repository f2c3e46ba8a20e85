// SPDX-License-Identifier: Apache-2.0
// A topic whose only sample comes while a robot switches, through the real command line.
#include <support/dds_domain.hpp>

#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>

#include <gmock/gmock.h>

#include "../../components/ros2/peers/peer.hpp"
#include "../system/system_test.hpp"

namespace std_msgs {
struct Int32 {
  std::int32_t data = 0;
};
}  // namespace std_msgs
SEGUE_TYPE(std_msgs::Int32, data)

namespace segue::testing {
namespace {

using ::ros2::testing::Bytes;
using ::ros2::testing::Middleware;

const ::segue::ros2::Quality kLatched = [] {
  ::segue::ros2::Quality quality;
  quality.durability = ::segue::ros2::Durability::TransientLocal;
  return quality;
}();

class LatchedTopics : public SystemTest, public ::testing::WithParamInterface<Middleware> {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    const auto domain = dds_domain_of_process();
    ::setenv("ROS_DOMAIN_ID", std::to_string(domain).c_str(), 1);
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    peer = GetParam() == Middleware::FastDds ? ::ros2::testing::make_fast_peer(domain)
                                             : ::ros2::testing::make_cyclone_peer(domain);
    peer->advertise({"/floor", "std_msgs/msg/Int32", "", kLatched});
    peer->subscribe({"/floor_of_map", "std_msgs/msg/Int32", "", kLatched});
    write("rover/robot.yaml",
          "robot: rover\nlibraries: [segue_components_ros2]\ncontrollers: [controllers/*.yaml]\n");
    write("rover/controllers/idle.yaml", "tasks: {}\n");
    // What starts slowly keeps the switch from committing.
    write("rover/controllers/relay.yaml", R"(
tasks:
  floor: {component: 'ros2::Subscription', properties: {topic: /floor, type: std_msgs/msg/Int32, durability: transient_local}}
  relay: {component: 'ros2::Publisher', properties: {topic: /floor_of_map, type: std_msgs/msg/Int32, durability: transient_local}}
  slow: {component: 'slow::Sensor', properties: {stand_in: {start: 3s}}}
connections:
  - {from: floor.out, to: relay.in, policy: buffer, size: 10}
deployments:
  from_ros2: {tasks: [floor]}
  to_ros2: {tasks: [relay]}
)");
    start({"--controller", "idle", "--stand-in"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("idle"));
  }

  std::unique_ptr<::ros2::testing::Peer> peer;
};

INSTANTIATE_TEST_SUITE_P(Of, LatchedTopics, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         [](const auto& given) {
                           return given.param == Middleware::FastDds ? "FastDds" : "Cyclone";
                         });

TEST_P(LatchedTopics, AreNotLostToASwitch) {
  const std_msgs::Int32 floor{7};
  const auto& type = type::type_info<std_msgs::Int32>();
  Bytes message(type::cdr_size(type, &floor));
  type::write_cdr(type, &floor, message);
  peer->publish(message);
  const auto switched = segue({"switch", "relay"});
  ASSERT_EQ(switched.status, 0) << switched.output << switched.errors;
  std::vector<Bytes> relayed;
  ASSERT_TRUE(eventually([&] { return !(relayed = peer->take()).empty(); }))
      << segue({"call", "floor.statistics"}).output;
  EXPECT_THAT(relayed, ::testing::ElementsAre(message));
}

}  // namespace
}  // namespace segue::testing
