// SPDX-License-Identifier: Apache-2.0
#include "picture.hpp"

#include <algorithm>

namespace film {

Picture::Picture(int width, int height)
    : width_(width),
      height_(height),
      rgb_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {}

Area Picture::inside(const Area& area) const {
  const int left = std::clamp(area.left, 0, width_);
  const int top = std::clamp(area.top, 0, height_);
  return {left, top, std::clamp(area.left + area.width, left, width_) - left,
          std::clamp(area.top + area.height, top, height_) - top};
}

void Picture::fill(const Area& area, Colour colour) {
  const Area seen = inside(area);
  for (int y = seen.top; y < seen.top + seen.height; ++y) {
    for (int x = seen.left; x < seen.left + seen.width; ++x)
      blend(x, y, colour, 255);
  }
}

void Picture::put(const messages::Image& image, int left, int top) {
  const Area seen = inside({left, top, static_cast<int>(image.width), static_cast<int>(image.height)});
  for (int y = seen.top; y < seen.top + seen.height && seen.width > 0; ++y) {
    const auto from = (static_cast<std::ptrdiff_t>(y - top) * image.width + (seen.left - left)) * 3;
    std::copy_n(image.rgb.begin() + from, seen.width * 3, at(seen.left, y));
  }
}

void Picture::blend(int x, int y, Colour colour, std::uint8_t cover) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  std::uint8_t* const pixel = at(x, y);
  const auto mix = [cover](std::uint8_t below, std::uint8_t above) {
    return static_cast<std::uint8_t>((below * (255 - cover) + above * cover + 127) / 255);
  };
  pixel[0] = mix(pixel[0], colour.red);
  pixel[1] = mix(pixel[1], colour.green);
  pixel[2] = mix(pixel[2], colour.blue);
}

}  // namespace film
