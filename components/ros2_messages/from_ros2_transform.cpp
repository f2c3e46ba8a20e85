// SPDX-License-Identifier: Apache-2.0
#include "quantities.hpp"
#include "transform_tree.hpp"

#include <segue/task/component.hpp>
#include <segue/task/input_timeout.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ros2_messages {

/// A frame, as the operation `frames` tells it.
struct KnownFrame {
  std::string frame;
  std::string parent;  ///< empty: no transform of it has come
  bool is_static = false;
  double newest = 0;  ///< s, the time of its newest transform
};
SEGUE_TYPE(KnownFrame, frame, parent, is_static, newest)

}  // namespace ros2_messages

namespace from_ros2 {

using namespace ros2_messages;  // NOLINT(google-build-using-namespace)
using namespace segue::task;    // NOLINT(google-build-using-namespace)
using std::chrono::milliseconds;

/// Where one frame of ROS 2 is in another one, by the chain of transforms between them.
class Transform final : public Component {
 public:
  Transform()
      : Component(
            {.doc = "The pose of a frame in another one, from tf2_msgs/msg/TFMessage on /tf and /tf_static",
             .trigger_on = {"in", "static"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (frame_->empty() || child_->empty() || *frame_ == *child_)
      return segue::fail(segue::ErrorCode::InvalidArgument, "'frame' and 'child' must be two frames");
    if (*most_frames_ < 2)
      return segue::fail(segue::ErrorCode::InvalidArgument, "'most_frames' must be 2 at least");
    return {};
  }
  /// Without transforms from before a stop: what moves has moved since.
  segue::Result<void> on_start() override {
    tree_.emplace(*most_frames_);
    told_.reset();
    told_at_ = now();
    if (const auto message = static_in_.latest()) insert(*message, true);
    return {};
  }
  void on_update() override {
    reason_ = 0;
    if (const Located located = take_all(); is_overdue(located)) say(why(located));
  }
  void on_error() override {
    const Located located = take_all();
    is_overdue(located) ? say(why(located)) : recovered();
  }
  void on_stop() override { tree_.reset(); }

 private:
  /// Takes in what has come, and tells the pose where it is a new one.
  Located take_all() {
    take(static_in_, true);
    take(in_, false);
    Located located = tree_->newest(*frame_, *child_);
    if (located.problem == nullptr && is_new(located.pose)) tell(located);
    return located;
  }

  void take(InputPort<tf2_msgs::TFMessage>& in, bool is_static) {
    constexpr int kMost = 64;  // the executor gives another turn where there are more
    for (int i = 0; i < kMost; ++i) {
      const auto message = in.take();
      if (!message) return;
      insert(*message, is_static);
    }
  }

  void insert(const tf2_msgs::TFMessage& message, bool is_static) {
    for (const geometry_msgs::TransformStamped& transform : message.transforms)
      report(tree_->insert(transform, is_static), transform.child_frame_id);
  }

  /// Once in a row, since broken transforms come at the rate of others.
  void report(Problem problem, std::string_view child) {
    if (problem == nullptr || problem == reported_) return;
    reported_ = problem;
    log(segue::LogLevel::Warning, text("{} (of '{}')", problem, child));
  }

  [[nodiscard]] bool is_new(const messages::TimedPose& pose) const {
    return !told_ || told_->time != pose.time || told_->pose.position != pose.pose.position ||
           told_->pose.orientation.coeffs() != pose.pose.orientation.coeffs();
  }

  void tell(const Located& located) {
    told_ = located.pose;
    told_at_ = now();
    pose_out_.write(*told_);
    odometry_out_.write({told_->time, in_plane(*told_), located.moves ? twist() : messages::Twist2D{}});
  }

  static messages::Pose2D in_plane(const messages::TimedPose& pose) {
    return {pose.pose.position.x(), pose.pose.position.y(), yaw(pose.pose.orientation)};
  }

  /// From the pose before: zero where the transforms do not go back so far.
  messages::Twist2D twist() {
    const double duration = std::chrono::duration<double>(*averaging_).count();
    const Located earlier = tree_->at(*frame_, *child_, told_->time - duration);
    if (earlier.problem != nullptr || !(duration > 0)) return {};
    const messages::Pose2D from = in_plane(earlier.pose);
    const messages::Pose2D to = in_plane(*told_);
    const double turn = std::remainder(to.theta - from.theta, 2 * M_PI);
    const double heading = from.theta + turn / 2;
    return {(std::cos(heading) * (to.x - from.x) + std::sin(heading) * (to.y - from.y)) / duration,
            turn / duration};
  }

  /// A static pose is never too old.
  [[nodiscard]] bool is_overdue(const Located& located) const {
    const segue::Duration most = timeout_.limit();
    return most > segue::Duration::zero() && now() - told_at_ >= most &&
           (located.problem != nullptr || located.moves);
  }

  /// Again where there is another reason now: a missing frame has come, and the next one is missing.
  void say(std::string_view reason) {
    const std::size_t hash = std::hash<std::string_view>()(reason);
    if (hash != std::exchange(reason_, hash)) error(no_transform_, reason);
  }

  std::string_view why(const Located& located) {
    return text("no pose of '{}': {} '{}'", *child_,
                located.problem != nullptr ? located.problem : "no newer transform has come of frame",
                located.frame);
  }

  /// Without allocation: to be used before the next one.
  template <class... Parts>
  std::string_view text(fmt::format_string<Parts...> format, Parts&&... parts) {
    const auto end = fmt::format_to_n(text_.data(), text_.size(), format, std::forward<Parts>(parts)...);
    return {text_.data(), std::min(end.size, text_.size())};
  }

  std::vector<KnownFrame> known_frames() {
    std::vector<KnownFrame> all;
    for (std::size_t i = 0; tree_ && i < tree_->size(); ++i) {
      const TransformTree::Frame& frame = tree_->frame(i);
      const bool has_parent = frame.parent != TransformTree::kNone;
      all.push_back({frame.name, has_parent ? tree_->frame(frame.parent).name : "", frame.is_static,
                     has_parent ? frame.poses.newest().time : 0});
    }
    std::ranges::sort(all, {}, &KnownFrame::frame);
    return all;
  }

  InputPort<tf2_msgs::TFMessage> in_{*this, "in", {.doc = "transforms that change, of /tf"}};
  InputPort<tf2_msgs::TFMessage> static_in_{*this, "static", {.doc = "those that do not, of /tf_static"}};
  OutputPort<messages::TimedPose> pose_out_{
      *this, "out", {.doc = "pose of 'child' in 'frame', when it is a new one"}};
  OutputPort<messages::Odometry> odometry_out_{
      *this, "odometry", {.doc = "the same in the plane, with the velocity that follows from it"}};
  Property<std::string> frame_{*this, "frame", "map", {.doc = "in which the pose is told"}};
  Property<std::string> child_{*this, "child", "base_link", {.doc = "whose pose is told"}};
  Property<std::uint32_t> most_frames_{
      *this, "most_frames", 64, {.doc = "how many frames there may be, of all robots together; 37 kB each"}};
  Property<milliseconds> averaging_{*this,
                                    "averaging",
                                    milliseconds(100),
                                    {.live = true, .doc = "time over which the velocity is averaged"}};
  InputTimeout timeout_{in_, "timeout", milliseconds(1000),
                        "how long there may be no new pose, unless nothing moves; 0: for ever"};
  Operation<std::vector<KnownFrame>()> frames_{*this,
                                               "frames",
                                               {},
                                               [this] { return known_frames(); },
                                               RunsIn::TaskThread,
                                               "the frames that are known, with their parents"};
  ErrorState no_transform_{*this, "no_transform"};

  std::optional<TransformTree> tree_;
  std::optional<messages::TimedPose> told_;
  segue::TimePoint told_at_{};
  Problem reported_ = nullptr;
  std::size_t reason_ = 0;  ///< hash of that of the error
  std::array<char, 200> text_{};
};

}  // namespace from_ros2

SEGUE_COMPONENT(from_ros2::Transform)
