// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../../../components/rover/renderer.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "font.hpp"
#include "frame.hpp"
#include "picture.hpp"

namespace film {

/// Draws frames: each pane has its title and clock, the rover from outside with what one of its own cameras
/// sees in the corner, and the texts. One thread at a time.
class Stage {
 public:
  static constexpr int kWidth = 960;
  static constexpr int kHeight = 540;

  /// With the fonts DejaVu Sans of this folder. Unsupported where they cannot be read.
  static segue::Result<Stage> open(const std::filesystem::path& fonts);

  /// The picture is valid until the next call. NotFound for a camera that there is not, InvalidArgument for
  /// positions of another model.
  segue::Result<const Picture*> draw(const Frame& frame);

 private:
  Stage(Font normal, Font bold) : normal_(std::move(normal)), bold_(std::move(bold)) {}

  segue::Result<void> draw_pane(const Pane& pane, const Area& area);
  segue::Result<void> draw_view(const rover::SceneState& scene, const std::string& camera, const Area& area);
  void draw_title(const Pane& pane, const Area& area);
  void draw_caption(const Pane& pane, const Area& area);
  /// Within the area, vertically in its middle.
  void write(const Font& font, std::string_view text, const Area& area, int largest, int smallest,
             Colour colour);

  Font normal_;
  Font bold_;
  std::map<std::tuple<std::string, int, int>, std::unique_ptr<rover::Renderer>> cameras_;
  messages::Image image_;
  Picture picture_{kWidth, kHeight};
};

}  // namespace film
