// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../../../components/messages/sensors.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace film {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// In pixels from the upper left corner of a picture.
struct Area {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// Pixels to draw on. Nothing is drawn outside of it.
class Picture {
 public:
  Picture(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Three bytes a pixel, row by row from the top.
  [[nodiscard]] std::span<const std::uint8_t> rgb() const { return rgb_; }

  void fill(const Area& area, Colour colour);
  void put(const messages::Image& image, int left, int top);
  /// Of `cover` 255, the colour replaces what is there; of 0, nothing changes.
  void blend(int x, int y, Colour colour, std::uint8_t cover);

 private:
  [[nodiscard]] std::uint8_t* at(int x, int y) {
    return &rgb_[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(x)) *
                 3];
  }
  /// What of the area lies in the picture.
  [[nodiscard]] Area inside(const Area& area) const;

  int width_;
  int height_;
  std::vector<std::uint8_t> rgb_;
};

}  // namespace film
