// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"
#include "../messages/sensors.hpp"
#include "rover_model.hpp"
#include "set_point_spline.hpp"
#include "types.hpp"

#include <memory>
#include <random>
#include <span>
#include <string_view>
#include <vector>

namespace rover {

/// How a simulation begins, and how exact its sensors are.
struct SimulationOptions {
  messages::Pose2D start{};          ///< of the rover
  std::uint64_t seed = 1;            ///< of the sensors' noise
  double range_noise = 0.005;        ///< m, standard deviation
  double angular_noise = 0.002;      ///< rad/s, standard deviation
  double acceleration_noise = 0.02;  ///< m/s^2, standard deviation
  /// The most by which boxes lie elsewhere at the beginning: m in the frame of the room, and rad.
  messages::Pose2D scatter{};
  bool loaded = false;  ///< the boxes lie on the deck at the beginning (kDeckPlaces), not on the table
  int arm_period = 5;   ///< steps from one set point of the arm to the next
};

/// The rays that a laser scanner measures, counterclockwise from `first_angle`. Zero lies ahead.
struct ScanPattern {
  double first_angle = -2.356;
  double angle_step = 0.01745;
  std::size_t rays = 271;
  double minimum_range = 0.05;
  double maximum_range = 8.0;
};

/// The rover, its room and its sensors, simulated by MuJoCo: the hardware, without tasks. The same commands
/// at the same steps give the same results. One thread at a time. Nothing but create() allocates, once the
/// messages that are passed in have their size.
class SimulatedRover {
 public:
  static constexpr double kStep = 0.002;  ///< s

  /// Settles for half a second, in which the wheels take up the weight; then the time is zero.
  static segue::Result<std::unique_ptr<SimulatedRover>> create(const SimulationOptions& options);

  /// Advances time by this many steps of kStep.
  void step(int steps);
  [[nodiscard]] double time() const { return time_; }
  /// MuJoCo found numbers that are not numbers, or too large ones, and began anew: what is measured since is
  /// meaningless. Has not happened unless set points are such numbers.
  [[nodiscard]] bool failed() const;

  /// Set points hold until they are replaced; limits of joints and torques apply.
  void command_wheels(const WheelCommand& command);
  /// rad; those that are missing stay as they are. The arm moves along a spline of its set points, two
  /// periods of these (`arm_period`) later.
  void command_arm(std::span<const double> angles);
  void command_gripper(double opening);  ///< m

  /// Positions and speeds of six steering joints, then of six wheels, each as in kWheelPlaces.
  void read_wheels(messages::JointState& state) const;
  void read_arm(messages::JointState& state) const;
  /// The opening between the fingers and the force of each.
  void read_gripper(messages::JointState& state) const;
  void read_imu(messages::Imu& imu);
  void scan(const ScanPattern& pattern, messages::LaserScan& scan);
  void read_scene(SceneState& scene) const;

  /// The true poses, which no sensor knows, in the frame of the room.
  [[nodiscard]] messages::Odometry pose() const;
  [[nodiscard]] messages::Pose box(std::size_t number) const;
  [[nodiscard]] messages::Pose tool() const;
  /// In the frame of cameras (geometry.hpp). The camera must exist.
  [[nodiscard]] messages::Pose camera(const char* name) const;

  /// Puts a box somewhere else, at rest.
  void place_box(std::size_t number, const messages::Pose& pose);

 private:
  SimulatedRover(ModelPtr model, const SimulationOptions& options);
  [[nodiscard]] int joint(const std::string& name) const;
  void read(std::span<const int> joints, messages::JointState& state) const;
  void one_step();
  void drive_arm();
  void put_boxes();
  double noise(double deviation) { return deviation * normal_(random_); }

  ModelPtr model_;
  DataPtr data_;
  SimulationOptions options_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<int> wheels_;  ///< joints: steering, then drive
  std::vector<int> arm_;
  std::array<double, kArmJoints> arm_set_points_ = kArmHome;
  std::vector<SetPointSpline> arm_splines_;
  std::vector<mjtNum> accelerations_;  ///< wanted ones, of all degrees of freedom
  std::vector<mjtNum> forces_;         ///< what these take
  std::array<int, kBoxes> boxes_{};
  int left_finger_ = 0;
  int body_ = 0;
  int lidar_ = 0;
  int tool_ = 0;
  double time_ = 0;
};

}  // namespace rover
