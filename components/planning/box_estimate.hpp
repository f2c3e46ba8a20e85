// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "types.hpp"

#include "../messages/sensors.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace planning {

/// The pose nearest to it in which a cube stands upright: which of its sides is up does not matter, so that
/// its orientation is a turn about z by less than a quarter.
messages::Pose upright(const messages::Pose& cube);

/// Where boxes that stand still and upright are, from several images: medians of what was seen. Allocates.
/// One thread at a time.
class BoxEstimate {
 public:
  explicit BoxEstimate(std::size_t images) : images_(images) {}

  /// A pose in the frame of the rover, as one image shows it. Poses that are not finite are ignored.
  void add(std::int32_t id, const messages::Pose& pose);
  /// Nothing until there have been enough images of it.
  [[nodiscard]] std::optional<messages::Pose> pose(std::int32_t id) const;

 private:
  std::size_t images_;
  std::map<std::int32_t, std::vector<messages::Pose>> seen_;  ///< the latest ones
};

}  // namespace planning
