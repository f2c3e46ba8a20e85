// SPDX-License-Identifier: Apache-2.0
#include "marker_finder.hpp"

#include "marker_pose.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <algorithm>
#include <cmath>
#include <map>

namespace rover {
namespace {

struct Free {
  void operator()(apriltag_detector_t* detector) const noexcept { apriltag_detector_destroy(detector); }
  void operator()(apriltag_family_t* family) const noexcept { tag36h11_destroy(family); }
  void operator()(image_u8_t* image) const noexcept { image_u8_destroy(image); }
  void operator()(zarray_t* detections) const noexcept { apriltag_detections_destroy(detections); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

/// Pixels that a detected marker covers.
double area(const apriltag_detection_t& detection) {
  double twice = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double* const from = detection.p[i];
    const double* const to = detection.p[(i + 1) % 4];
    twice += from[0] * to[1] - to[0] * from[1];
  }
  return std::abs(twice) / 2;
}

messages::Pose pose_of(const apriltag_detection_t& detection, double side, const Projection& projection) {
  Corners corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners.at(i) = {detection.p[i][0], detection.p[i][1]};
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> homography(detection.H->data);
  return marker_pose(corners, homography, side, projection);
}

Owned<image_u8_t> grey(const messages::Image& image) {
  Owned<image_u8_t> result(image_u8_create(image.width, image.height));
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::uint8_t* pixel = image.rgb.data() + y * image.width * 3;
    std::uint8_t* const row = result->buf + y * static_cast<std::size_t>(result->stride);
    for (std::size_t x = 0; x < image.width; ++x, pixel += 3)
      row[x] = static_cast<std::uint8_t>((pixel[0] + 2 * pixel[1] + pixel[2]) / 4);
  }
  return result;
}

}  // namespace

struct MarkerFinder::Implementation {
  double marker_side;
  double field_of_view;
  Owned<apriltag_family_t> family{tag36h11_create()};
  Owned<apriltag_detector_t> detector{apriltag_detector_create()};
};

MarkerFinder::MarkerFinder(double marker_side, double field_of_view)
    : implementation_(new Implementation{marker_side, field_of_view}) {
  apriltag_detector_add_family(implementation_->detector.get(), implementation_->family.get());
  implementation_->detector->quad_decimate = 1;  // the markers are small
}

MarkerFinder::~MarkerFinder() = default;

void MarkerFinder::find(const messages::Image& image, messages::Markers& markers) {
  markers.time = image.time;
  markers.markers.clear();
  if (image.rgb.empty() || image.rgb.size() != std::size_t{image.width} * image.height * 3) return;
  const Owned<image_u8_t> pixels = grey(image);
  const Owned<zarray_t> detections(apriltag_detector_detect(implementation_->detector.get(), pixels.get()));
  std::map<int, apriltag_detection_t*> largest;
  for (int i = 0; i < zarray_size(detections.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections.get(), i, &detection);
    apriltag_detection_t*& best = largest[detection->id];
    if (best == nullptr || area(*best) < area(*detection)) best = detection;
  }
  const double focal_length = image.height / (2 * std::tan(implementation_->field_of_view / 2));
  const Projection projection{focal_length, image.width / 2.0, image.height / 2.0};
  for (const auto& found : largest)
    markers.markers.push_back(
        {found.first, pose_of(*found.second, implementation_->marker_side, projection)});
}

}  // namespace rover
