// SPDX-License-Identifier: Apache-2.0
//
// TransformTree beside tf2, which Debian has from ROS 1: its BufferCore is that of ROS 2 in all that counts
// here.
#include "tf2_judge.hpp"
#include "../../components/ros2_messages/quantities.hpp"
#include "../../components/ros2_messages/transform_tree.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace ros2_messages {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

builtin_interfaces::Time stamp_of(std::int64_t time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(time / kSecond), static_cast<std::uint32_t>(time % kSecond)};
}

/// Frames below each other at random, some of them static, and transforms of them in the order of their
/// times, which both sides get.
class RandomFrames {
 public:
  explicit RandomFrames(std::uint32_t seed) : random_(seed) {
    for (std::size_t i = 0; i < kFrames; ++i) {
      const bool is_root = i == 0 || chance(0.1);
      frames_.push_back(
          {"frame_" + std::to_string(i), is_root ? i : below(i), chance(0.3), milliseconds_below(1000)});
    }
  }

  void send_one() {
    const std::size_t i = below(kFrames);
    Frame& frame = frames_[i];
    if (frame.parent == i) return;
    if (chance(0.02)) {
      frame.parent = below(i);
      frame.time += kMillisecond;  // at the same time it would be nothing new for tf2
      moved_ = true;
    }
    frame.time += milliseconds_below(300) - 1;  // the same once more now and then
    send(frame, frame.time);
  }

  /// Two frames, the other way round as well, now and at a time that is known or not.
  void compare_two() {
    const std::string a = frames_[below(kFrames)].name;
    const std::string b = frames_[below(kFrames)].name;
    if (a == b) return;
    compare(a, b, 0);
    compare(a, b, milliseconds_below(5000));
  }
  [[nodiscard]] int poses_compared() const { return poses_; }

 private:
  static constexpr std::size_t kFrames = 9;
  struct Frame {
    std::string name;
    std::size_t parent;  ///< its own index: none
    bool is_static;
    std::int64_t time;  ///< ns
  };

  std::size_t below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }
  bool chance(double share) { return std::bernoulli_distribution(share)(random_); }
  std::int64_t milliseconds_below(std::size_t limit) {
    return static_cast<std::int64_t>(below(limit)) * kMillisecond + 1;  // 0 is another word for the newest
  }
  double number() { return std::uniform_real_distribution<double>(-10, 10)(random_); }

  void send(const Frame& frame, std::int64_t time) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(number(), number(), number(), number()).normalized();
    const tf2_judge::Pose pose{time, {number(), number(), number()}, {q.x(), q.y(), q.z(), q.w()}};
    judge_.insert(frames_[frame.parent].name, frame.name, pose, frame.is_static);
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = frames_[frame.parent].name;
    transform.header.stamp = stamp_of(time);
    transform.child_frame_id = frame.name;
    transform.transform = {{pose.position[0], pose.position[1], pose.position[2]}, rotation(q)};
    RC_ASSERT(tree_.insert(transform, frame.is_static) == nullptr);
  }

  void compare(const std::string& frame, const std::string& child, std::int64_t time) {
    const auto expected = judge_.look_up(frame, child, time);
    const Located got =
        time == 0 ? tree_.newest(frame, child) : tree_.at(frame, child, seconds(stamp_of(time)));
    // A frame that comes to another parent begins anew here, while tf2 goes on with both.
    if (got.problem != nullptr && moved_) return;
    RC_ASSERT((got.problem == nullptr) == expected.has_value());
    if (!expected) return;
    ++poses_;
    if (got.moves) RC_ASSERT(std::abs(got.pose.time - seconds(stamp_of(expected->time))) < 1e-6);
    const auto& [x, y, z] = expected->position;
    const auto& [qx, qy, qz, qw] = expected->orientation;
    RC_ASSERT((got.pose.pose.position - Eigen::Vector3d(x, y, z)).norm() < 1e-5);
    RC_ASSERT(got.pose.pose.orientation.angularDistance(Eigen::Quaterniond(qw, qx, qy, qz)) < 1e-5);
  }

  std::mt19937 random_;
  std::vector<Frame> frames_;
  TransformTree tree_{kFrames};
  tf2_judge::Buffer judge_;
  bool moved_ = false;
  int poses_ = 0;
};

RC_GTEST_PROP(TransformTree, AnswersAsTf2Does, ()) {
  RandomFrames frames(*rc::gen::arbitrary<std::uint32_t>());
  for (int i = 0; i < 400; ++i) {
    frames.send_one();
    frames.compare_two();
  }
  RC_CLASSIFY(frames.poses_compared() > 50);
}

}  // namespace
}  // namespace ros2_messages
