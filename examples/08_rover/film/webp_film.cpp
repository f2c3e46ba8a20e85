// SPDX-License-Identifier: Apache-2.0
#include "webp_film.hpp"

#include <segue/base/file.hpp>

#include <webp/encode.h>
#include <webp/mux.h>

#include <string_view>
#include <utility>

namespace film {
namespace {

segue::Error failure(const std::string& what) {
  return segue::fail(segue::ErrorCode::Unsupported, "libwebp " + what);
}

}  // namespace

struct WebpFilm::Encoder {
  WebPAnimEncoder* encoder = nullptr;
  WebPConfig config{};
  WebPPicture picture{};

  Encoder() = default;
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    WebPPictureFree(&picture);
    WebPAnimEncoderDelete(encoder);
  }
};

WebpFilm::WebpFilm(std::unique_ptr<Encoder> encoder) : encoder_(std::move(encoder)) {}
WebpFilm::WebpFilm(WebpFilm&&) noexcept = default;
WebpFilm::~WebpFilm() = default;

segue::Result<WebpFilm> WebpFilm::create(int width, int height) {
  auto made = std::make_unique<Encoder>();
  WebPAnimEncoderOptions options{};
  if (WebPConfigInit(&made->config) == 0 || WebPPictureInit(&made->picture) == 0 ||
      WebPAnimEncoderOptionsInit(&options) == 0)
    return failure("is not of the version of its headers");
  // Of scenes of few colours, files are hardly larger without losses, and neither text nor edges blur.
  constexpr float kEffort = 20;  // of 100
  constexpr int kQuick = 1;      // of 6: larger files in less time
  made->config.lossless = 1;
  made->config.quality = kEffort;
  made->config.method = kQuick;
  made->picture.width = width;
  made->picture.height = height;
  options.kmin = 0;  // the encoder decides where whole frames stand
  made->encoder = WebPAnimEncoderNew(width, height, &options);
  if (made->encoder == nullptr) return failure("makes no film of this size");
  return WebpFilm(std::move(made));
}

segue::Result<void> WebpFilm::add(std::span<const std::uint8_t> rgb, int time_ms) {
  WebPPicture& picture = encoder_->picture;
  picture.use_argb = 1;
  if (WebPPictureImportRGB(&picture, rgb.data(), picture.width * 3) == 0 ||
      WebPAnimEncoderAdd(encoder_->encoder, &picture, time_ms, &encoder_->config) == 0)
    return failure(std::string("does not take a frame: ") + WebPAnimEncoderGetError(encoder_->encoder));
  return {};
}

segue::Result<void> WebpFilm::write(const std::filesystem::path& file, int end_ms) {
  WebPData data{};
  if (WebPAnimEncoderAdd(encoder_->encoder, nullptr, end_ms, nullptr) == 0 ||
      WebPAnimEncoderAssemble(encoder_->encoder, &data) == 0)
    return failure(std::string("does not end the film: ") + WebPAnimEncoderGetError(encoder_->encoder));
  const std::unique_ptr<WebPData, void (*)(WebPData*)> cleared(&data, WebPDataClear);
  return segue::write_file(file, {reinterpret_cast<const char*>(data.bytes), data.size});
}

}  // namespace film
