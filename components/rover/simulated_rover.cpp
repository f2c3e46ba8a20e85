// SPDX-License-Identifier: Apache-2.0
#include "simulated_rover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rover {
namespace {

// Controls, in the order of the model's actuators.
constexpr std::size_t kSteering = 0;
constexpr std::size_t kSpeeds = kWheels;
constexpr std::size_t kArmControls = 2 * kWheels;
constexpr std::size_t kGripperControl = 2 * kWheels + kArmJoints;

Eigen::Vector3d vector_at(const mjtNum* numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Quaterniond rotation_at(const mjtNum* matrix) {
  return Eigen::Quaterniond(
      Eigen::Matrix3d(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix)));
}

double heading(const mjtNum* matrix) {
  return std::atan2(matrix[3], matrix[0]);
}

}  // namespace

segue::Result<std::unique_ptr<SimulatedRover>> SimulatedRover::create(const SimulationOptions& options) {
  auto model = load_rover_model();
  if (!model) return std::move(model.error());
  // Warnings are found in the data (failed()); MuJoCo's own handler would write a file.
  mju_user_warning = [](const char*) {};
  return std::unique_ptr<SimulatedRover>(new SimulatedRover(std::move(*model), options));
}

SimulatedRover::SimulatedRover(ModelPtr model, const SimulationOptions& options)
    : model_(std::move(model)),
      data_(mj_makeData(model_.get())),
      options_(options),
      random_(options.seed),
      accelerations_(static_cast<std::size_t>(model_->nv)),
      forces_(accelerations_) {
  for (const char* kind : {"steer_", "drive_"}) {
    for (const WheelPlace& place : kWheelPlaces)
      wheels_.push_back(joint(std::string(kind) + place.name));
  }
  for (std::size_t index = 0; index < kArmJoints; ++index) {
    arm_.push_back(joint("arm_" + std::to_string(index + 1)));
    data_->qpos[model_->jnt_qposadr[arm_.back()]] = kArmHome.at(index);
    arm_splines_.emplace_back(kArmHome.at(index), options.arm_period, kStep);
  }
  for (std::size_t number = 0; number < kBoxes; ++number)
    boxes_.at(number) = joint("box_" + std::to_string(number));
  left_finger_ = joint("left_finger");
  body_ = mj_name2id(model_.get(), mjOBJ_BODY, "rover");
  lidar_ = mj_name2id(model_.get(), mjOBJ_SITE, "lidar");
  tool_ = mj_name2id(model_.get(), mjOBJ_SITE, "tool");
  mjtNum* const place = data_->qpos + model_->jnt_qposadr[joint("rover")];
  place[0] = options.start.x;
  place[1] = options.start.y;
  place[3] = std::cos(options.start.theta / 2);
  place[6] = std::sin(options.start.theta / 2);
  put_boxes();
  step(250);
  time_ = 0;
}

/// Where they lie at the beginning, scattered with random numbers of their own, so that the sensors' noise
/// does not depend on it. They fall by a hair: of boxes whose faces just touch, MuJoCo 2.2 finds contacts
/// where there are none, decimetres deep, and flings one box in ten off the deck.
void SimulatedRover::put_boxes() {
  constexpr double kAbove = 0.0005;  // m
  const Eigen::Rotation2Dd heading(options_.start.theta);
  std::mt19937_64 random(options_.seed);
  std::uniform_real_distribution<double> part(-1, 1);
  for (std::size_t number = 0; number < kBoxes; ++number) {
    messages::Pose pose = box(number);
    if (options_.loaded) {
      const auto& [x, y] = kDeckPlaces.at(number);
      pose.position.head<2>() =
          Eigen::Vector2d(options_.start.x, options_.start.y) + heading * Eigen::Vector2d(x, y);
      pose.position.z() = kDeckHeight + kBoxSide / 2;
    }
    pose.position.z() += kAbove;
    pose.position.x() += part(random) * options_.scatter.x;
    pose.position.y() += part(random) * options_.scatter.y;
    pose.orientation = Eigen::AngleAxisd(part(random) * options_.scatter.theta, Eigen::Vector3d::UnitZ());
    place_box(number, pose);
  }
}

int SimulatedRover::joint(const std::string& name) const {
  return mj_name2id(model_.get(), mjOBJ_JOINT, name.c_str());
}

void SimulatedRover::step(int steps) {
  for (int i = 0; i < steps; ++i)
    one_step();
  // Positions of bodies, for what is read after this; mj_step leaves those from before its last integration.
  mj_kinematics(model_.get(), data_.get());
  mj_camlight(model_.get(), data_.get());
}

void SimulatedRover::one_step() {
  mj_step1(model_.get(), data_.get());
  drive_arm();
  mj_step2(model_.get(), data_.get());
  time_ += kStep;
}

/// The servos as drives of arms have them: they follow a smooth motion through the set points, are told the
/// torque that this motion takes (damping and inertia, within the limits of torques), and bear the arm's own
/// weight. What the arm holds or meets, and a rover that moves, count as disturbance.
void SimulatedRover::drive_arm() {
  for (std::size_t index = 0; index < kArmJoints; ++index) {
    SetPointSpline& spline = arm_splines_[index];
    spline.advance(arm_set_points_.at(index));
    accelerations_[static_cast<std::size_t>(model_->jnt_dofadr[arm_[index]])] = spline.acceleration();
  }
  mj_mulM(model_.get(), data_.get(), forces_.data(), accelerations_.data());
  for (std::size_t index = 0; index < kArmJoints; ++index) {
    const int dof = model_->jnt_dofadr[arm_[index]];
    data_->qfrc_applied[dof] = data_->qfrc_bias[dof];
    const SetPointSpline& spline = arm_splines_[index];
    const double torque =
        forces_[static_cast<std::size_t>(dof)] + model_->dof_damping[dof] * spline.velocity();
    const std::size_t control = kArmControls + index;
    data_->ctrl[control] = spline.position() + torque / model_->actuator_gainprm[mjNGAIN * control];
  }
}

bool SimulatedRover::failed() const {
  return data_->warning[mjWARN_BADQPOS].number + data_->warning[mjWARN_BADQVEL].number +
             data_->warning[mjWARN_BADQACC].number + data_->warning[mjWARN_BADCTRL].number >
         0;
}

void SimulatedRover::command_wheels(const WheelCommand& command) {
  for (std::size_t wheel = 0; wheel < kWheels; ++wheel) {
    data_->ctrl[kSteering + wheel] =
        std::clamp(command.steering.at(wheel), -kLargestSteering, kLargestSteering);
    data_->ctrl[kSpeeds + wheel] = command.speeds.at(wheel);
  }
}

void SimulatedRover::command_arm(std::span<const double> angles) {
  for (std::size_t index = 0; index < std::min(angles.size(), kArmJoints); ++index)
    arm_set_points_.at(index) = std::clamp(angles[index], kArm.at(index).lowest, kArm.at(index).highest);
}

void SimulatedRover::command_gripper(double opening) {
  data_->ctrl[kGripperControl] = std::clamp(opening, 0.0, kLargestOpening) / 2;
}

void SimulatedRover::read(std::span<const int> joints, messages::JointState& state) const {
  state.time = time_;
  state.positions.resize(joints.size());
  state.velocities.resize(joints.size());
  state.efforts.resize(joints.size());
  for (std::size_t index = 0; index < joints.size(); ++index) {
    const int dof = model_->jnt_dofadr[joints[index]];
    state.positions[index] = data_->qpos[model_->jnt_qposadr[joints[index]]];
    state.velocities[index] = data_->qvel[dof];
    state.efforts[index] = data_->qfrc_actuator[dof];
  }
}

void SimulatedRover::read_wheels(messages::JointState& state) const {
  read(wheels_, state);
}

void SimulatedRover::read_arm(messages::JointState& state) const {
  read(arm_, state);
}

void SimulatedRover::read_gripper(messages::JointState& state) const {
  read({&left_finger_, 1}, state);
  state.positions[0] *= 2;
  state.velocities[0] *= 2;
  state.efforts[0] /= 2;  // the actuator moves both fingers
}

void SimulatedRover::read_imu(messages::Imu& imu) {
  const mjtNum* const sensors = data_->sensordata;
  imu.time = time_;
  imu.linear_acceleration = vector_at(sensors);
  imu.angular_velocity = vector_at(sensors + 3);
  for (int axis = 0; axis < 3; ++axis) {
    imu.linear_acceleration[axis] += noise(options_.acceleration_noise);
    imu.angular_velocity[axis] += noise(options_.angular_noise);
  }
  imu.orientation = Eigen::Quaterniond(sensors[6], sensors[7], sensors[8], sensors[9]);
}

void SimulatedRover::scan(const ScanPattern& pattern, messages::LaserScan& scan) {
  constexpr std::array<mjtByte, mjNGROUP> kRoomOnly = {1, 0, 0, 0, 0, 0};
  scan.time = time_;
  scan.first_angle = pattern.first_angle;
  scan.angle_step = pattern.angle_step;
  scan.minimum_range = pattern.minimum_range;
  scan.maximum_range = pattern.maximum_range;
  scan.ranges.resize(pattern.rays);
  const mjtNum* const from = data_->site_xpos + std::ptrdiff_t{3} * lidar_;
  const mjtNum* const frame = data_->site_xmat + std::ptrdiff_t{9} * lidar_;
  for (std::size_t ray = 0; ray < pattern.rays; ++ray) {
    const double angle = pattern.first_angle + static_cast<double>(ray) * pattern.angle_step;
    const std::array<mjtNum, 3> local = {std::cos(angle), std::sin(angle), 0};
    std::array<mjtNum, 3> along{};
    mju_rotVecMat(along.data(), local.data(), frame);
    int geom = -1;
    double range = mj_ray(model_.get(), data_.get(), from, along.data(), kRoomOnly.data(), 1, -1, &geom);
    if (range >= 0) range += noise(options_.range_noise);
    const bool seen = geom >= 0 && range >= pattern.minimum_range && range <= pattern.maximum_range;
    scan.ranges[ray] = seen ? static_cast<float>(range) : std::numeric_limits<float>::infinity();
  }
}

void SimulatedRover::read_scene(SceneState& scene) const {
  scene.time = time_;
  scene.positions.assign(data_->qpos, data_->qpos + model_->nq);
}

messages::Odometry SimulatedRover::pose() const {
  const mjtNum* const place = data_->xpos + std::ptrdiff_t{3} * body_;
  const mjtNum* const matrix = data_->xmat + std::ptrdiff_t{9} * body_;
  const mjtNum* const velocity = data_->qvel + model_->jnt_dofadr[model_->body_jntadr[body_]];
  messages::Odometry odometry;
  odometry.time = time_;
  odometry.pose = {place[0], place[1], heading(matrix)};
  odometry.twist.linear = matrix[0] * velocity[0] + matrix[3] * velocity[1] + matrix[6] * velocity[2];
  odometry.twist.angular = velocity[5];
  return odometry;
}

messages::Pose SimulatedRover::box(std::size_t number) const {
  const mjtNum* const place = data_->qpos + model_->jnt_qposadr[boxes_.at(number)];
  return {vector_at(place), Eigen::Quaterniond(place[3], place[4], place[5], place[6])};
}

messages::Pose SimulatedRover::tool() const {
  return {vector_at(data_->site_xpos + std::ptrdiff_t{3} * tool_),
          rotation_at(data_->site_xmat + std::ptrdiff_t{9} * tool_)};
}

messages::Pose SimulatedRover::camera(const char* name) const {
  const int id = mj_name2id(model_.get(), mjOBJ_CAMERA, name);
  // MuJoCo's cameras look along -z with y upward: half a turn about x.
  const Eigen::Quaterniond half_turn(0, 1, 0, 0);
  return {vector_at(data_->cam_xpos + std::ptrdiff_t{3} * id),
          rotation_at(data_->cam_xmat + std::ptrdiff_t{9} * id) * half_turn};
}

void SimulatedRover::place_box(std::size_t number, const messages::Pose& pose) {
  const int joint = boxes_.at(number);
  mjtNum* const place = data_->qpos + model_->jnt_qposadr[joint];
  const std::array<double, 7> values = {pose.position.x(),    pose.position.y(),    pose.position.z(),
                                        pose.orientation.w(), pose.orientation.x(), pose.orientation.y(),
                                        pose.orientation.z()};
  std::copy(values.begin(), values.end(), place);
  std::fill_n(data_->qvel + model_->jnt_dofadr[joint], 6, 0.0);
}

}  // namespace rover
