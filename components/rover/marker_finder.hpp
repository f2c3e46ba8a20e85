// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/sensors.hpp"

#include <memory>

namespace rover {

/// Finds AprilTags of the family 36h11 in images and estimates where they are (Olson, "AprilTag: A robust and
/// flexible visual fiducial system", ICRA 2011). Any thread, one at a time; allocates.
class MarkerFinder {
 public:
  /// `marker_side`: m, of the black border. `field_of_view`: rad, of the height of the images, which are
  /// taken without distortion.
  MarkerFinder(double marker_side, double field_of_view);
  ~MarkerFinder();
  MarkerFinder(const MarkerFinder&) = delete;
  MarkerFinder& operator=(const MarkerFinder&) = delete;

  /// Finds all markers in the image. Of markers that are there several times (a box has one on every side) it
  /// gives the one that looks largest. Finds nothing in an image whose data do not fit its size.
  void find(const messages::Image& image, messages::Markers& markers);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rover
