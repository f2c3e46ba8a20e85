// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/sensors.hpp"
#include "rover_model.hpp"
#include "types.hpp"

#include <memory>
#include <string>

namespace rover {

/// The largest width and height of what a Renderer draws, in pixels; cameras deliver less (kLargestWidth).
inline constexpr int kLargestPicture = 2048;

/// Draws what a camera sees, of the rover or the one in the room that follows it, on the processor (OSMesa),
/// without a screen. Any thread, one at a time. Drawing allocates: not for threads with real-time demands.
class Renderer {
 public:
  /// `smooth`: edges are drawn without steps, which takes longer and which the robot's own cameras do not.
  /// InvalidArgument for images without a size or larger than kLargestPicture in a direction, NotFound for
  /// cameras that there are not, Unsupported without OpenGL.
  static segue::Result<std::unique_ptr<Renderer>> create(const std::string& camera, int width, int height,
                                                         bool smooth = false);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws the scene into `image`. False, and `image` is unchanged: the scene is not one of this model.
  bool render(const SceneState& scene, messages::Image& image);

 private:
  struct Implementation;
  explicit Renderer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rover
