// SPDX-License-Identifier: Apache-2.0
#include "renderer.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <string>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A camera of the simulated rover: draws the newest scene with a model of its own, so that the simulation
/// never waits for it, whatever process it is in. Drawing allocates memory and takes milliseconds: give it no
/// thread group with tasks that have real-time demands.
class Camera final : public Component {
 public:
  Camera()
      : Component({.doc = "Takes pictures with a camera of the simulated rover or of its room (OSMesa)",
                   .activity = segue::periodic(std::chrono::milliseconds(100))}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*width_ > kLargestWidth || *height_ > kLargestHeight) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "images are at most " + std::to_string(kLargestWidth) + " x " +
                             std::to_string(kLargestHeight) + " pixels, not " + std::to_string(*width_) +
                             " x " + std::to_string(*height_));
    }
    auto made = Renderer::create(*camera_, static_cast<int>(*width_), static_cast<int>(*height_));
    if (!made) return std::move(made.error());
    renderer_ = std::move(*made);
    messages::Image image;
    image.rgb.resize(std::size_t{3} * *width_ * *height_);
    image_out_.prime(image);
    return {};
  }

  void on_update() override {
    const auto scene = scene_in_.take();
    if (!scene) return;
    auto image = image_out_.loan();
    if (!image) return;
    if (!renderer_->render(*scene, *image)) {
      exception("the scene is not one of this rover: are all its parts of the same version?");
      return;
    }
    image.publish();
  }

  void on_cleanup() override { renderer_.reset(); }

 private:
  InputPort<SceneState> scene_in_{*this, "scene", {.doc = "where everything is"}};
  OutputPort<messages::Image> image_out_{*this, "image", {.doc = "what the camera sees"}};
  Property<std::string> camera_{
      *this, "camera", "mast", {.doc = "mast, deck, gripper, or room, which follows the rover from outside"}};
  Property<std::uint32_t> width_{*this, "width", 640, {.doc = "pixels, at most 640"}};
  Property<std::uint32_t> height_{*this, "height", 480, {.doc = "pixels, at most 480"}};
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::Camera)
