// SPDX-License-Identifier: Apache-2.0
#include "simulated_rover.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cmath>
#include <string>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The simulated robot, in place of its hardware: takes set points and delivers what sensors measure. Each
/// update simulates the same time, so that a slow computer makes the robot slow, but never different.
class Simulation final : public Component {
 public:
  Simulation()
      : Component(
            {.doc = "Simulates a rover with six wheels, an arm, a gripper and sensors in a room (MuJoCo)",
             .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 protected:
  segue::Result<void> on_configure() override {
    constexpr std::chrono::duration<double> kSimulated(SimulatedRover::kStep);
    steps_ = static_cast<int>(std::lround(*step_ / kSimulated));
    if (steps_ < 1 || steps_ > 500) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "step must be from 2 ms to 1 s");
    }
    if (*rays_ < 1 || *rays_ > 4096) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "rays must be from 1 to 4096");
    }
    pattern_.rays = *rays_;
    pattern_.angle_step = *rays_ > 1 ? -2 * pattern_.first_angle / static_cast<double>(*rays_ - 1) : 0;
    pattern_.maximum_range = *maximum_range_;
    auto made = SimulatedRover::create(
        {*start_, *seed_, *range_noise_, *angular_noise_, *acceleration_noise_, *scatter_, *loaded_, steps_});
    if (!made) return std::move(made.error());
    rover_ = std::move(*made);
    prime();
    return {};
  }

  segue::Result<void> on_start() override {
    next_scan_ = rover_->time();
    last_command_ = rover_->time();
    ages_ = {};
    return {};
  }

  void on_update() override {
    take_commands();
    rover_->step(steps_);
    if (rover_->failed()) {
      exception("the simulation has become unstable: are all set points numbers?");
      return;
    }
    write_state();
    write_scan();
  }

  void on_cleanup() override { rover_.reset(); }

 private:
  void take_commands() {
    ++ages_.wheels;
    ++ages_.arm;
    if (wheels_in_.read(wheels_) == ReadStatus::NewData) {
      last_command_ = rover_->time();
      rover_->command_wheels(wheels_);
      ages_.wheels = 0;
    } else if (rover_->time() - last_command_ > std::chrono::duration<double>(*timeout_).count()) {
      wheels_.speeds = {};
      rover_->command_wheels(wheels_);
    }
    if (const auto command = arm_in_.take()) {
      rover_->command_arm(command->positions);
      ages_.arm = 0;
    }
    if (gripper_in_.read(gripper_) == ReadStatus::NewData) rover_->command_gripper(gripper_.opening);
    ages_.time = rover_->time();
    ages_.clock = std::chrono::duration<double>(now().time_since_epoch()).count();
    ages_out_.write(ages_);
  }

  segue::Result<void> place_box(std::uint32_t box, const messages::Pose& pose) {
    if (box >= kBoxes) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "there are boxes 0 to " + std::to_string(kBoxes - 1));
    }
    if (!pose.position.allFinite() || !pose.orientation.coeffs().allFinite() ||
        pose.orientation.norm() < 0.5) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "the pose must consist of finite numbers, and its orientation must be of length 1");
    }
    rover_->place_box(box, {pose.position, pose.orientation.normalized()});
    return {};
  }

  void write_scan() {
    if (rover_->time() < next_scan_) return;
    next_scan_ += std::chrono::duration<double>(*scan_period_).count();
    if (auto scan = scan_out_.loan()) {
      rover_->scan(pattern_, *scan);
      scan.publish();
    }
  }

  /// Samples of the sizes that all later ones will have.
  void prime() {
    messages::JointState joints;
    messages::LaserScan scan;
    SceneState scene;
    rover_->read_wheels(joints);
    wheels_out_.prime(joints);
    rover_->read_arm(joints);
    arm_out_.prime(joints);
    rover_->read_gripper(joints);
    gripper_out_.prime(joints);
    scan.ranges.resize(pattern_.rays);
    scan_out_.prime(scan);
    rover_->read_scene(scene);
    scene_out_.prime(scene);
    boxes_.markers.resize(kBoxes);
    boxes_out_.prime(boxes_);
  }

  void write_state() {
    if (auto state = wheels_out_.loan()) {
      rover_->read_wheels(*state);
      state.publish();
    }
    if (auto state = arm_out_.loan()) {
      rover_->read_arm(*state);
      state.publish();
    }
    if (auto state = gripper_out_.loan()) {
      rover_->read_gripper(*state);
      state.publish();
    }
    if (auto scene = scene_out_.loan()) {
      rover_->read_scene(*scene);
      scene.publish();
    }
    rover_->read_imu(imu_);
    imu_out_.write(imu_);
    pose_out_.write(rover_->pose());
    time_out_.write(rover_->time());
    boxes_.time = rover_->time();
    for (std::size_t number = 0; number < kBoxes; ++number)
      boxes_.markers[number] = {static_cast<std::int32_t>(number), rover_->box(number)};
    boxes_out_.write(boxes_);
  }

  InputPort<WheelCommand> wheels_in_{*this, "wheels", {.doc = "set points of the wheels"}};
  InputPort<messages::JointCommand> arm_in_{*this, "arm", {.doc = "set points of the arm: positions"}};
  InputPort<GripperCommand> gripper_in_{*this, "gripper", {.doc = "set point of the gripper"}};
  OutputPort<messages::JointState> wheels_out_{
      *this, "wheel_state", {.doc = "six steering joints, then six wheels"}};
  OutputPort<messages::JointState> arm_out_{*this, "arm_state", {.doc = "six joints"}};
  OutputPort<messages::JointState> gripper_out_{
      *this, "gripper_state", {.doc = "opening between the fingers, and the force of each"}};
  OutputPort<messages::Imu> imu_out_{
      *this, "imu", {.doc = "inertial measurement unit in the middle of the rover"}};
  OutputPort<messages::LaserScan> scan_out_{*this, "scan", {.doc = "distances ahead and aside"}};
  OutputPort<SceneState> scene_out_{*this, "scene", {.doc = "what cameras need to draw what they see"}};
  OutputPort<messages::Odometry> pose_out_{
      *this, "pose", {.doc = "where the rover really is, in the frame of the room"}};
  OutputPort<messages::Markers> boxes_out_{
      *this, "boxes", {.doc = "where the centres of the boxes really are, in the frame of the room"}};
  OutputPort<SetPointAges> ages_out_{
      *this, "set_point_ages", {.doc = "how old what this update went by was"}};
  OutputPort<double> time_out_{*this, "time", {.doc = "the robot's clock, s"}};
  Property<std::chrono::milliseconds> step_{*this,
                                            "step",
                                            std::chrono::milliseconds(10),
                                            {.doc = "simulated time of each update; a multiple of 2 ms"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(500),
      {.doc = "the wheels stop after this time without set points, as motor controllers do"}};
  Property<std::uint64_t> seed_{*this, "seed", 1, {.doc = "of the noise of sensors, and of scatter"}};
  Property<messages::Pose2D> start_{*this, "start", {}, {.doc = "of the rover, in the frame of the room"}};
  Property<messages::Pose2D> scatter_{*this,
                                      "scatter",
                                      {},
                                      {.doc = "by how much boxes lie elsewhere at the beginning, at most, "
                                              "along the axes of the room and turned"}};
  Property<bool> loaded_{
      *this, "loaded", false, {.doc = "the boxes lie on the deck at the beginning, not on the table"}};
  Property<std::uint32_t> rays_{*this, "rays", 271, {.doc = "of a scan, which covers 270 degrees"}};
  Property<double> maximum_range_{*this, "maximum_range", 8.0, {.doc = "m, of a scan"}};
  Property<std::chrono::milliseconds> scan_period_{*this,
                                                   "scan_period",
                                                   std::chrono::milliseconds(100),
                                                   {.live = true, .doc = "simulated time between scans"}};
  Property<double> range_noise_{*this, "range_noise", 0.005, {.doc = "m, standard deviation"}};
  Property<double> angular_noise_{*this, "angular_noise", 0.002, {.doc = "rad/s, standard deviation"}};
  Property<double> acceleration_noise_{
      *this, "acceleration_noise", 0.02, {.doc = "m/s^2, standard deviation"}};
  Operation<segue::Result<void>(std::uint32_t, messages::Pose)> place_box_{
      *this,
      "place_box",
      {"box", "pose"},
      [this](std::uint32_t box, const messages::Pose& pose) { return place_box(box, pose); },
      RunsIn::TaskThread,
      "puts a box elsewhere in the room, as a person does"};
  std::unique_ptr<SimulatedRover> rover_;
  ScanPattern pattern_;
  int steps_ = 1;
  double next_scan_ = 0;
  double last_command_ = 0;
  WheelCommand wheels_;
  SetPointAges ages_;
  GripperCommand gripper_;
  messages::Imu imu_;
  messages::Markers boxes_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::Simulation)
