// SPDX-License-Identifier: Apache-2.0
// Makes a film of what the port `scene` of the simulated rover has said, of one run or of two side by side.
#include "frame.hpp"
#include "stage.hpp"
#include "webp_film.hpp"

#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>

namespace {

using namespace segue;

constexpr double kLastFrame = 3.0;  // s, for which the last one is shown

volatile std::sig_atomic_t interrupted = 0;

/// Makes the film of all lines of standard input; the number of frames.
Result<int> make_film(const char* file) {
  auto made = film::WebpFilm::create(film::Stage::kWidth, film::Stage::kHeight);
  if (!made) return std::move(made.error());
  auto stage = film::Stage::open(ROVER_FILM_FONTS);
  if (!stage) return std::move(stage.error());
  int frames = 0;
  std::optional<double> begin;
  double end = 0;
  for (std::string line; std::getline(std::cin, line);) {
    if (interrupted != 0) return fail(ErrorCode::Cancelled, "interrupted");
    auto frame = film::read_frame(line);
    if (!frame) return std::move(frame.error());
    if (begin && frame->time <= end) continue;  // a film does not go back
    if (!begin) begin = frame->time;
    end = frame->time;
    const auto picture = stage->draw(*frame);
    if (!picture) return picture.error();
    if (auto added = made->add((*picture)->rgb(), static_cast<int>(1000 * (end - *begin))); !added)
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
        "FRAMES has a line of JSON for each frame:\n"
        "  time   in seconds, which increases\n"
        "  panes  one, or two side by side, each a map of\n"
        "    positions  as in the port rover.scene\n"
        "    camera     mast, deck or gripper: whose image is shown in the corner\n"
        "    title, clock   above the scene\n"
        "    text, detail   below it\n"
        "    done       optional: true shows clock and text in another colour\n"
        "  note   optional: below all panes; if any frame has one, all should, if only an empty one\n",
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
