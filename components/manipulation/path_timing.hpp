// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trajectory.hpp"

#include <segue/base/result.hpp>

#include <span>
#include <vector>

namespace manipulation {

/// Set points along a path of joint configurations, at equal distances in time, from rest to rest: no joint
/// exceeds its limits of velocity, acceleration and jerk. Corners are rounded by parabolas (Kunz and Stilman,
/// "Time-optimal trajectory generation for path following", RSS 2012, use circles); the velocity on the path
/// is the highest that velocities and accelerations allow, by a pass forward and one backward over its
/// points; a moving average then bounds the jerk (Biagiotti and Melchiorri, "FIR filters for online
/// trajectory planning", 2012). make() allocates, nothing else does. One thread at a time.
class PathTiming {
 public:
  struct Options {
    double corner = 0.01;  ///< rad: how far rounded corners lie from those of the path, at most
    double period = 0.01;  ///< s, between set points
  };

  /// InvalidArgument unless there is a point, and in each of them a finite number for each joint within its
  /// limits, and unless the motion takes less than ten minutes.
  static segue::Result<PathTiming> make(const std::vector<std::vector<double>>& points,
                                        std::span<const JointLimits> limits, const Options& options);

  [[nodiscard]] double duration() const;
  /// Positions `time` seconds after the beginning; before and after the motion, those of its ends. Requires
  /// room for one number for each joint.
  void at(double time, std::span<double> positions) const;

 private:
  PathTiming(std::size_t joints, double period) : joints_(joints), period_(period) {}
  /// The number of the last set point.
  [[nodiscard]] std::size_t last() const { return set_points_.size() / joints_ - 1; }

  std::size_t joints_;
  double period_;
  std::vector<double> set_points_;  ///< all joints of the first one, then of the next
};

}  // namespace manipulation
