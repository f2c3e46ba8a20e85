// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../test_network.hpp"
#include "test_arm.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <vector>

/// For tests only: a network with an arm that follows its set points exactly.
namespace manipulation::test {

/// A C++ value as that of a property or an argument.
template <class T>
segue::type::Value value_of(const T& value) {
  return segue::type::type_info<T>().to_value(&value);
}

/// The arm's driver, outside of the network.
struct Driver : segue::task::Component {
  segue::task::InputPort<messages::JointCommand> set_points{*this, "set_points"};
  segue::task::OutputPort<messages::JointState> joints{*this, "joints"};
  segue::task::InputPort<messages::Pose> pose{*this, "pose"};
  segue::task::OutputPort<messages::Markers> markers{*this, "markers"};
  segue::task::OutputPort<messages::Pose> target{*this, "target"};
  segue::task::InputPort<messages::Pose> object{*this, "object"};
};

inline std::vector<JointLimit> seven_limits() {
  std::vector<JointLimit> limits;
  for (const JointDescription& joint : seven_joints())
    limits.push_back({joint.lower, joint.upper, joint.velocity, 4, 40});
  return limits;
}

/// Forward kinematics and a trajectory generator that are connected with the driver.
class SimulatedArm : public components_test::TestNetwork {
 public:
  SimulatedArm() {
    add("kinematics", "manipulation::ForwardKinematics",
        segue::type::Value::map({{"joint_list", value_of(seven_joints())}}));
    connect(driver.joints, input("kinematics", "joints"));
    connect(output("kinematics", "pose"), driver.pose);
    add_generator("generator");
    start("kinematics");
    state.positions = bent();
    state.velocities.assign(7, 0);
  }
  void add_generator(const std::string& id) {
    add(id, "manipulation::TrajectoryGenerator",
        segue::type::Value::map({{"limits", value_of(seven_limits())}}));
    connect(driver.joints, input(id, "joints"));
    connect(output(id, "set_points"), driver.set_points);
  }
  void add_whole_body(const std::string& id) {
    add(id, "manipulation::WholeBodyController",
        segue::type::Value::map({{"joint_list", value_of(seven_joints())}}));
    connect(driver.joints, input(id, "joints"));
  }
  void step() {
    state.time = seconds();
    driver.joints.write(state);
    advance(std::chrono::milliseconds(10));
    if (driver.set_points.read(command) == segue::task::ReadStatus::NewData)
      state.positions = command.positions;
  }
  void run(double seconds) {
    for (const double end = this->seconds() + seconds; this->seconds() < end;)
      step();
  }

  Driver driver;
  messages::JointState state;
  messages::JointCommand command;
};

}  // namespace manipulation::test
