// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/sensors.hpp"
#include "rover_model.hpp"
#include "types.hpp"

#include <memory>
#include <string>

namespace rover {

/// Draws what a camera sees, of the rover or the one in the room that follows it, on the processor (OSMesa),
/// without a screen. Any thread, one at a time. Drawing allocates: not for threads with real-time demands.
class Renderer {
 public:
  /// InvalidArgument for images without a size or larger than kLargestWidth x kLargestHeight, NotFound for
  /// cameras that there are not, Unsupported without OpenGL.
  static segue::Result<std::unique_ptr<Renderer>> create(const std::string& camera, int width, int height);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws the scene into `image`, with the caption in the lower left corner unless it is empty (ASCII; lines
  /// end with \n). False, and `image` is unchanged: the scene is not one of this model.
  bool render(const SceneState& scene, messages::Image& image, const std::string& caption = {});

 private:
  struct Implementation;
  explicit Renderer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rover
