// SPDX-License-Identifier: Apache-2.0
#include "marker_finder.hpp"
#include "rover_model.hpp"

#include <segue/task/component.hpp>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Looks for AprilTags in images. Allocates memory, and takes milliseconds for each image.
class MarkerDetector final : public Component {
 public:
  MarkerDetector()
      : Component(
            {.doc = "Finds AprilTags (36h11) in images and estimates their poses in the frame of the camera",
             .trigger_on = {"image"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*marker_side_ <= 0 || *field_of_view_ <= 0 || *field_of_view_ >= M_PI) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "marker_side must be positive and field_of_view between 0 and pi");
    }
    finder_ = std::make_unique<MarkerFinder>(*marker_side_, *field_of_view_);
    return {};
  }

  void on_update() override {
    const auto image = image_in_.take();
    if (!image) return;
    finder_->find(*image, markers_);
    (markers_.markers.empty() ? searching_ : found_).enter();
    markers_out_.write(markers_);
  }

  void on_cleanup() override { finder_.reset(); }

 private:
  State found_{*this, "found"};
  State searching_{*this, "searching"};
  InputPort<messages::Image> image_in_{*this, "image", {.doc = "from a camera without distortion"}};
  OutputPort<messages::Markers> markers_out_{
      *this, "markers", {.doc = "what each image shows; of several with the same number the largest"}};
  Property<double> marker_side_{*this, "marker_side", kMarkerSide, {.doc = "m, of the black border"}};
  Property<double> field_of_view_{
      *this, "field_of_view", kFieldOfView, {.doc = "rad, of the height of images"}};
  std::unique_ptr<MarkerFinder> finder_;
  messages::Markers markers_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::MarkerDetector)
