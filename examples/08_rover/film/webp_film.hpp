// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

/// An animated picture in the format WebP, made frame by frame without losses (libwebp). One thread at a
/// time.
namespace film {

class WebpFilm {
 public:
  /// Of so many pixels. Unsupported where libwebp makes none.
  static segue::Result<WebpFilm> create(int width, int height);
  WebpFilm(WebpFilm&&) noexcept;
  ~WebpFilm();

  /// Shows `rgb` (three bytes a pixel, row by row from the top) from `time_ms` on, which increases.
  segue::Result<void> add(std::span<const std::uint8_t> rgb, int time_ms);
  /// Writes the film, whose last frame is shown until `end_ms`.
  segue::Result<void> write(const std::filesystem::path& file, int end_ms);

 private:
  struct Encoder;
  explicit WebpFilm(std::unique_ptr<Encoder> encoder);
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace film
