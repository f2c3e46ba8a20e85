// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/recent_samples.hpp"
#include "conversions.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ros2_messages {

/// Where one frame is in another one; or why that cannot be told.
struct Located {
  Problem problem = nullptr;   ///< ends where the name of `frame` is to follow; nullptr: there is a pose
  std::string_view frame;      ///< that the problem is about, or that the newest transform is the oldest of
  messages::TimedPose pose{};  ///< its time is 0 where nothing moves between the two
  bool moves = false;          ///< some transform between the two is not static
};

/// The tree of frames that `/tf` and `/tf_static` tell, each with the recent past of its pose in its parent's
/// frame. Answers as tf2's BufferCore does where transforms come in the order of their times. Only the
/// constructor allocates. One thread at a time.
class TransformTree {
 public:
  static constexpr std::size_t kLongestName = 127;
  /// Kept of each frame: at 50 Hz the last ten seconds.
  static constexpr std::size_t kHistory = 512;
  /// So many transforms in a row that are older than the one before are those of a clock that was set back.
  static constexpr int kLateOnes = 10;

  /// For so many frames, 37 kB each.
  explicit TransformTree(std::size_t frames);

  /// Takes a transform in, or says why it is left out: a static text. One that is older than the last one
  /// of its frame is left out silently.
  Problem insert(const geometry_msgs::TransformStamped& transform, bool is_static);

  /// The pose of `child` in `frame` at the newest time for which all transforms between them are known.
  [[nodiscard]] Located newest(std::string_view frame, std::string_view child);
  /// The same at a time in seconds, interpolated; a problem where some transform was not known yet, or is
  /// not.
  [[nodiscard]] Located at(std::string_view frame, std::string_view child, double time);

  struct Frame {
    std::string name;
    std::size_t parent = kNone;
    bool is_static = false;
    int late = 0;  ///< in a row
    messages::RecentSamples<messages::TimedPose, kHistory> poses;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// All that are known, in the order in which they were named first.
  [[nodiscard]] std::size_t size() const { return known_; }
  [[nodiscard]] const Frame& frame(std::size_t index) const { return frames_[index]; }

 private:
  [[nodiscard]] std::size_t find(std::string_view name) const;
  std::size_t find_or_add(std::string_view name);
  /// Sets `child_side_` and `frame_side_`: the frames on the way to the one that both are in.
  [[nodiscard]] Located connect(std::string_view frame, std::string_view child);
  [[nodiscard]] Located locate_at(double time) const;

  std::vector<Frame> frames_;
  std::size_t known_ = 0;
  std::vector<std::size_t> child_side_;
  std::vector<std::size_t> frame_side_;
};

}  // namespace ros2_messages
