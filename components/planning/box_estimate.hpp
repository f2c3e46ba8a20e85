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
  /// A box must be seen in `images` of the last three times as many.
  explicit BoxEstimate(std::size_t images) : images_(images) {}

  /// Begins another image: poses that are added from now on are seen in it.
  void next_image() { ++image_; }
  /// A pose in the frame of the rover, as one image shows it. Poses that are not finite are ignored.
  void add(std::int32_t id, const messages::Pose& pose);
  /// Nothing where there are not enough images of it.
  [[nodiscard]] std::optional<messages::Pose> pose(std::int32_t id) const;

 private:
  struct Sight {
    std::size_t image = 0;
    messages::Pose pose;
  };
  std::size_t images_;
  std::size_t image_ = 0;
  std::map<std::int32_t, std::vector<Sight>> seen_;  ///< the latest `images_`
};

}  // namespace planning
