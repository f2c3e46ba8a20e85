// SPDX-License-Identifier: Apache-2.0
#include "path_timing.hpp"
#include "types.hpp"

#include "../messages/motion.hpp"
#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Moves an arm along a path that a planner has found, from rest to rest, and keeps to that path. It measures
/// time by the robot's clock, that of the joints.
class JointPathFollower final : public Component {
 public:
  JointPathFollower()
      : Component(
            {.doc = "Commands set points along a path of configurations, within all limits of the joints",
             .trigger_on = {"joints"}}) {}

 private:
  segue::Result<void> on_configure() override {
    joint_limits_.clear();
    for (const JointLimit& joint : *limits_)
      joint_limits_.push_back({joint.lower, joint.upper, {joint.velocity, joint.acceleration, joint.jerk}});
    if (auto usable = Trajectory::create(joint_limits_); !usable) return std::move(usable.error());
    if (!(*corner_ >= 0) || !(*tolerance_ > 0)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "corner must not be negative, tolerance must be positive");
    }
    command_.positions.assign(joint_limits_.size(), 0);
    command_out_.prime(command_);
    measured_.assign(joint_limits_.size(), 0);
    return {};
  }

  segue::Result<void> on_start() override {
    timing_.reset();
    known_ = false;
    begins_ = false;
    refused_ = false;
    return {};
  }

  void on_update() override {
    const auto joints = joints_in_.take();
    if (!joints || !usable(*joints)) return;
    std::ranges::copy(joints->positions, measured_.begin());
    time_ = joints->time;
    known_ = true;
    if (!timing_ || refused_) {
      (refused_ ? refused_state_ : idle_).enter();
      return;
    }
    if (begins_ && !begin()) {
      refused_state_.enter();
      return;
    }
    timing_->at(time_ - begin_, command_.positions);
    command_.time = time_;
    command_out_.write(command_);
    (arrived() ? reached_ : moving_).enter();
  }

  void on_cleanup() override { timing_.reset(); }

  /// Begins the path. False, and the path is refused: the arm is too far from where it begins. follow() could
  /// not check that where the path came before the first sample of the joints.
  bool begin() {
    begins_ = false;
    begin_ = time_;
    timing_->at(0, command_.positions);
    if (distance(command_.positions) <= *start_tolerance_) return true;
    refused_ = true;
    return false;
  }

  [[nodiscard]] bool usable(const messages::JointState& joints) const {
    const auto finite = [](double position) { return std::isfinite(position); };
    return joints.positions.size() == measured_.size() && std::ranges::all_of(joints.positions, finite);
  }
  [[nodiscard]] bool arrived() const {
    return time_ - begin_ >= timing_->duration() && distance(command_.positions) <= *tolerance_;
  }
  /// The distance of the joint that is farthest from `positions`.
  [[nodiscard]] double distance(const std::vector<double>& positions) const {
    double farthest = 0;
    for (std::size_t joint = 0; joint < measured_.size(); ++joint)
      farthest = std::max(farthest, std::abs(positions[joint] - measured_[joint]));
    return farthest;
  }

  segue::Result<void> follow(const messages::JointPath& path) {
    if (timing_ && !refused_ && (begins_ || time_ - begin_ < timing_->duration())) {
      return segue::fail(segue::ErrorCode::InvalidState, "the arm still follows another path");
    }
    auto made = PathTiming::make(path.points, joint_limits_, {.corner = *corner_, .period = kPeriod});
    if (!made) return std::move(made.error());
    if (const double away = known_ ? distance(path.points.front()) : 0; away > *start_tolerance_) {
      return segue::fail(segue::ErrorCode::InvalidState,
                         "the path begins " + std::to_string(away) + " rad away from where the arm is");
    }
    timing_ = std::move(*made);
    begins_ = true;
    refused_ = false;
    moving_.enter();
    return {};
  }

  static constexpr double kPeriod = 0.01;  // s

  State idle_{*this, "idle"};
  State moving_{*this, "moving"};
  State reached_{*this, "reached"};
  State refused_state_{*this, "refused"};
  InputPort<messages::JointState> joints_in_{
      *this, "joints", {.doc = "of the arm, in the order of the property limits"}};
  OutputPort<messages::JointCommand> command_out_{*this, "command", {.doc = "positions"}};
  Property<std::vector<JointLimit>> limits_{*this, "limits", {}, {.doc = "of each joint, in order"}};
  Property<double> corner_{
      *this, "corner", 0.01, {.doc = "rad; rounded corners are no farther from those of the path"}};
  Property<double> tolerance_{
      *this,
      "tolerance",
      0.01,
      {.live = true, .doc = "rad; distance of each joint at which the end is reached"}};
  Property<double> start_tolerance_{
      *this,
      "start_tolerance",
      0.05,
      {.live = true, .doc = "rad; a path that begins farther away from the arm is refused"}};
  Operation<segue::Result<void>(messages::JointPath)> follow_{
      *this,
      "follow",
      {"path"},
      [this](const messages::JointPath& path) { return follow(path); },
      RunsIn::TaskThread,
      "moves along this path; the state is reached at its end, refused if it does not begin where the arm "
      "is"};

  std::vector<JointLimits> joint_limits_;
  messages::JointCommand command_;
  std::vector<double> measured_;
  std::optional<PathTiming> timing_;  ///< of the path that was followed last
  double time_ = 0;
  double begin_ = 0;
  bool begins_ = false;  ///< with the next sample of the joints
  bool known_ = false;
  bool refused_ = false;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::JointPathFollower)
