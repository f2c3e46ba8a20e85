// SPDX-License-Identifier: Apache-2.0
// Makes a film of what the port `scene` of the simulated rover has said: the rover from outside, and in a
// corner what one of its own cameras sees.
#include "webp_film.hpp"

#include "../../../components/rover/renderer.hpp"

#include <segue/type/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace {

using namespace segue;

constexpr int kWidth = rover::kLargestWidth;
constexpr int kHeight = rover::kLargestHeight;
constexpr int kSmallWidth = 224;
constexpr int kSmallHeight = 168;
constexpr int kMargin = 10;
constexpr double kLastFrame = 2.0;  // s, for which the last one is shown

volatile std::sig_atomic_t interrupted = 0;

/// A line of the input.
struct Frame {
  rover::SceneState scene;
  std::string camera;
  std::string caption;
};

Result<Frame> read_frame(const std::string& line) {
  const auto value = type::parse_json(line);
  if (!value) return value.error();
  const Error unusable = fail(ErrorCode::ParseError,
                              "a frame needs 'time', 'positions' (numbers), 'camera' and 'caption' (texts)");
  if (!value->is_map()) return unusable;
  const auto* const time = value->find("time");
  const auto* const positions = value->find("positions");
  const auto* const camera = value->find("camera");
  const auto* const caption = value->find("caption");
  if (time == nullptr || !time->is_number() || positions == nullptr || !positions->is_list() ||
      camera == nullptr || !camera->is_string() || caption == nullptr || !caption->is_string())
    return unusable;
  Frame frame{{time->as_double(), {}}, camera->as_string(), caption->as_string()};
  for (const auto& position : positions->as_list()) {
    if (!position.is_number()) return unusable;
    frame.scene.positions.push_back(position.as_double());
  }
  return frame;
}

/// Draws frames, with cameras that are made when they are first needed.
class Studio {
 public:
  /// The image is valid until the next call.
  Result<const messages::Image*> draw(const Frame& frame) {
    auto room = camera("room", kWidth, kHeight);
    if (!room) return room.error();
    auto inside = camera(frame.camera, kSmallWidth, kSmallHeight);
    if (!inside) return inside.error();
    if (!(*room)->render(frame.scene, image_, frame.caption) ||
        !(*inside)->render(frame.scene, small_, frame.camera + " camera"))
      return fail(ErrorCode::InvalidArgument, "the scene is not one of this rover");
    put_small_image();
    return &image_;
  }

 private:
  Result<rover::Renderer*> camera(const std::string& name, int width, int height) {
    auto& renderer = cameras_[name];
    if (!renderer) {
      auto made = rover::Renderer::create(name, width, height);
      if (!made) return std::move(made.error());
      renderer = std::move(*made);
    }
    return renderer.get();
  }

  /// Into the lower right corner, in a white frame.
  void put_small_image() {
    const auto at = [this](int x, int y) {
      return image_.rgb.begin() + (std::ptrdiff_t{y} * kWidth + x) * 3;
    };
    constexpr int kLeft = kWidth - kMargin - kSmallWidth;
    constexpr int kTop = kHeight - kMargin - kSmallHeight;
    for (int y = -2; y < kSmallHeight + 2; ++y)
      std::fill_n(at(kLeft - 2, kTop + y), (kSmallWidth + 4) * 3, 255);
    for (int y = 0; y < kSmallHeight; ++y)
      std::copy_n(small_.rgb.begin() + std::ptrdiff_t{y} * kSmallWidth * 3, kSmallWidth * 3,
                  at(kLeft, kTop + y));
  }

  std::map<std::string, std::unique_ptr<rover::Renderer>> cameras_;
  messages::Image image_;
  messages::Image small_;
};

/// Makes the film of all lines of standard input; the number of frames.
Result<int> make_film(const char* file) {
  auto made = film::WebpFilm::create(kWidth, kHeight);
  if (!made) return std::move(made.error());
  Studio studio;
  int frames = 0;
  std::optional<double> begin;
  double end = 0;
  for (std::string line; std::getline(std::cin, line);) {
    if (interrupted != 0) return fail(ErrorCode::Cancelled, "interrupted");
    auto frame = read_frame(line);
    if (!frame) return std::move(frame.error());
    if (begin && frame->scene.time <= end) continue;  // a film does not go back
    if (!begin) begin = frame->scene.time;
    end = frame->scene.time;
    const auto image = studio.draw(*frame);
    if (!image) return image.error();
    if (auto added = made->add((*image)->rgb, static_cast<int>(1000 * (end - *begin))); !added)
      return std::move(added.error());
    ++frames;
  }
  if (frames == 0) return fail(ErrorCode::InvalidArgument, "there is no frame on standard input");
  if (auto written = made->write(file, static_cast<int>(1000 * (end - *begin + kLastFrame))); !written)
    return std::move(written.error());
  return frames;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || std::string_view(argv[1]).starts_with('-')) {
    std::fputs(
        "usage: rover_film FILE.webp < FRAMES\n"
        "FRAMES has a line of JSON for each frame: time and positions as in the port rover.scene, camera "
        "(mast\n"
        "or gripper: what is shown in the corner), and a caption.\n",
        stderr);
    return 2;
  }
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  for (const int signal : {SIGINT, SIGTERM})
    ::sigaction(signal, &action, nullptr);
  const auto frames = make_film(argv[1]);
  if (!frames) {
    std::fprintf(stderr, "rover_film: %s\n", to_string(frames.error()).c_str());
    return 1;
  }
  std::printf("%d frames\n", *frames);
  return 0;
}
