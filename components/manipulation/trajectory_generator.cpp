// SPDX-License-Identifier: Apache-2.0
#include "joint_input.hpp"
#include "trajectory.hpp"
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Stands between every controller and the joints: whatever is commanded, and when, the set points keep the
/// limits of the joints. Without commands the arm stays where it is, and comes to rest where nobody is
/// connected that could command it. The task that takes over from it goes on with its motion.
class TrajectoryGenerator final : public Component {
 public:
  TrajectoryGenerator()
      : Component(
            {.doc = "Turns commands into set points that keep all limits of the joints, with bounded jerk",
             .activity = segue::periodic(std::chrono::milliseconds(10)),
             .trigger_on = {"joints"}}) {}  // where a network makes it port driven

 private:
  static constexpr std::uint32_t kStateVersion = 1;
  static constexpr auto kAnyAge = std::chrono::hours(1);

  segue::Result<void> on_configure() override {
    std::vector<JointLimits> limits;
    for (const JointLimit& joint : *limits_)
      limits.push_back({joint.lower, joint.upper, {joint.velocity, joint.acceleration, joint.jerk}});
    auto made = Trajectory::create(limits);
    if (!made) return std::move(made.error());
    trajectory_.emplace(*made);
    set_points_.positions.assign(limits.size(), 0);
    set_points_.velocities.assign(limits.size(), 0);
    target_.assign(limits.size(), 0);
    set_points_out_.prime(set_points_);
    restored_ = false;
    return {};
  }

  segue::Result<void> on_start() override {
    joints_.begin(trajectory_->size());
    moving_arm_ = std::exchange(restored_, false);
    mode_ = Mode::Hold;
    time_.reset();
    if (!*robot_time_) time_ = seconds(now());
    return {};
  }

  void on_update() override {
    const bool joints_known = joints_.read(now(), kAnyAge);
    if (!joints_known && (!moving_arm_ || *robot_time_)) {
      waiting_.enter();
      return;
    }
    if (!moving_arm_) begin();
    while (const auto command = command_in_.take())
      accept(*command);
    if (mode_ != Mode::Hold && nobody_commands()) {
      trajectory_->stop();
      mode_ = Mode::Hold;
    }
    trajectory_->step(passed());
    publish();
  }

  void on_cleanup() override { trajectory_.reset(); }

  std::optional<SavedState> save_state() override {
    if (!trajectory_ || !moving_arm_) return std::nullopt;
    TrajectoryState state;
    for (std::size_t i = 0; i < trajectory_->size(); ++i) {
      state.positions.push_back(trajectory_->motion(i).position);
      state.velocities.push_back(trajectory_->motion(i).velocity);
      state.accelerations.push_back(trajectory_->motion(i).acceleration);
    }
    return make_state(state, kStateVersion);
  }

  segue::Result<void> restore_state(const SavedState& state) override {
    auto restored = read_state<TrajectoryState>(state, kStateVersion);
    if (!restored) return std::move(restored.error());
    const std::size_t size = trajectory_->size();
    if (restored->positions.size() != size || restored->velocities.size() != size ||
        restored->accelerations.size() != size) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "the motion of " + std::to_string(restored->positions.size()) +
                             " joints cannot be continued by " + std::to_string(size) + ": check limits");
    }
    std::array<JointMotion, kMostJoints> motions{};
    for (std::size_t i = 0; i < size; ++i)
      motions[i] = {restored->positions[i], restored->velocities[i], restored->accelerations[i]};
    trajectory_->begin({motions.data(), size});
    restored_ = true;
    return {};
  }

  static double seconds(segue::TimePoint time) {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
  }
  /// The time since the last update, s. After a longer pause it goes on where it was.
  double passed() {
    constexpr double kLongestUpdate = 0.1;  // s
    const double time = *robot_time_ ? joints_.time() : seconds(now());
    const double before = std::exchange(time_, time).value_or(time);
    return std::clamp(time - before, 0.0, kLongestUpdate);
  }

  /// Begins from the positions and velocities that the arm has.
  void begin() {
    std::array<JointMotion, kMostJoints> motions{};
    for (std::size_t i = 0; i < trajectory_->size(); ++i)
      motions[i] = {joints_.positions()[i], joints_.velocity(i), 0};
    trajectory_->begin({motions.data(), trajectory_->size()});
    moving_arm_ = true;
  }

  void accept(const messages::JointCommand& command) {
    if (!command.positions.empty()) {
      if (mode_ == Mode::Position && std::ranges::equal(command.positions, target_)) return;
      if (!trajectory_->move_to(command.positions)) return refuse();
      std::ranges::copy(command.positions, target_.begin());
      mode_ = Mode::Position;
    } else {
      if (!trajectory_->move_with(command.velocities)) return refuse();
      mode_ = Mode::Velocity;
      command_time_ = now();
    }
  }
  /// Whoever commanded until a switch cannot tell it to stop any more.
  [[nodiscard]] bool nobody_commands() {
    return !command_in_.connected() || (mode_ == Mode::Velocity && now() - command_time_ > *timeout_);
  }
  void refuse() {
    log(segue::LogLevel::Error, "ignored a command that has not one finite number for each joint");
  }

  void publish() {
    for (std::size_t i = 0; i < trajectory_->size(); ++i) {
      set_points_.positions[i] = trajectory_->motion(i).position;
      set_points_.velocities[i] = trajectory_->motion(i).velocity;
    }
    set_points_.time = *time_;
    set_points_out_.write(set_points_);
    (trajectory_->at_rest() ? holding_ : moving_).enter();
  }

  enum class Mode : std::uint8_t { Hold, Position, Velocity };

  State waiting_{*this, "waiting"};
  State holding_{*this, "holding"};
  State moving_{*this, "moving"};
  InputPort<messages::JointCommand> command_in_{
      *this,
      "command",
      {.doc = "positions, at which all joints arrive together; or, without positions, velocities. Comes to "
              "rest where nobody is connected"}};
  JointInput joints_{*this};
  OutputPort<messages::JointCommand> set_points_out_{*this, "set_points"};
  Property<std::vector<JointLimit>> limits_{*this, "limits", {}, {.doc = "of each joint, in order"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(200),
      {.live = true, .doc = "comes to rest after this time without another command of velocities"}};

  Property<bool> robot_time_{
      *this,
      "robot_time",
      false,
      {.doc = "go by the time in joints, as for a simulated arm, which may be slower than the clock"}};

  std::optional<Trajectory> trajectory_;
  messages::JointCommand set_points_;
  std::vector<double> target_;
  Mode mode_ = Mode::Hold;
  bool moving_arm_ = false;  ///< the trajectory has begun
  bool restored_ = false;
  std::optional<double> time_;  ///< s, of the last update
  segue::TimePoint command_time_;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::TrajectoryGenerator)
