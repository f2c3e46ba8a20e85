// SPDX-License-Identifier: Apache-2.0
#include "stage.hpp"

#include <algorithm>
#include <utility>

namespace film {
namespace {

constexpr Colour kGround{24, 26, 31};
constexpr Colour kBright{245, 245, 245};
constexpr Colour kPale{170, 176, 186};
constexpr Colour kDone{120, 220, 140};

constexpr int kGap = 4;  ///< between panes
constexpr int kMargin = 12;
constexpr int kTitleHeight = 40;
constexpr int kCaptionHeight = 96;
constexpr int kDetailHeight = 28;
constexpr int kNoteHeight = 48;
constexpr int kLabelHeight = 20;
constexpr int kClockSize = 28;
constexpr double kInsetShare = 0.3;  ///< of the width of a pane

/// The image of the rover's own camera: in the upper right corner of the scene.
Area inset_of(const Area& scene) {
  const int width = static_cast<int>(kInsetShare * scene.width);
  return {scene.left + scene.width - kMargin - width, scene.top + kMargin, width, width * 3 / 4};
}

}  // namespace

segue::Result<Stage> Stage::open(const std::filesystem::path& fonts) {
  auto normal = Font::open(fonts / "DejaVuSans.ttf");
  if (!normal) return std::move(normal.error());
  auto bold = Font::open(fonts / "DejaVuSans-Bold.ttf");
  if (!bold) return std::move(bold.error());
  return Stage(std::move(*normal), std::move(*bold));
}

segue::Result<const Picture*> Stage::draw(const Frame& frame) {
  picture_.fill({0, 0, kWidth, kHeight}, kGround);
  const int panes = static_cast<int>(frame.panes.size());
  const int width = (kWidth - kGap * (panes - 1)) / panes;
  const int height = kHeight - (frame.note ? kNoteHeight : 0);
  int left = 0;
  for (const Pane& pane : frame.panes) {
    if (auto drawn = draw_pane(pane, {left, 0, width, height}); !drawn) return std::move(drawn.error());
    left += width + kGap;
  }
  if (frame.note)
    write(bold_, *frame.note, {kMargin, height, kWidth - 2 * kMargin, kNoteHeight}, 24, 12, kDone);
  return &picture_;
}

segue::Result<void> Stage::draw_pane(const Pane& pane, const Area& area) {
  const Area scene = {area.left, kTitleHeight, area.width, area.height - kTitleHeight - kCaptionHeight};
  const Area inset = inset_of(scene);
  if (auto drawn = draw_view(pane.scene, "room", scene); !drawn) return drawn;
  picture_.fill({inset.left - 2, inset.top - 2, inset.width + 4, inset.height + kLabelHeight + 4}, kGround);
  if (auto drawn = draw_view(pane.scene, pane.camera, inset); !drawn) return drawn;
  write(normal_, pane.camera + " camera",
        {inset.left + 4, inset.top + inset.height, inset.width - 8, kLabelHeight}, 14, 9, kBright);
  draw_title(pane, {area.left + kMargin, 0, area.width - 2 * kMargin, kTitleHeight});
  draw_caption(pane,
               {area.left + kMargin, scene.top + scene.height, area.width - 2 * kMargin, kCaptionHeight});
  return {};
}

segue::Result<void> Stage::draw_view(const rover::SceneState& scene, const std::string& camera,
                                     const Area& area) {
  auto& renderer = cameras_[{camera, area.width, area.height}];
  if (!renderer) {
    auto made = rover::Renderer::create(camera, area.width, area.height, true);
    if (!made) return std::move(made.error());
    renderer = std::move(*made);
  }
  if (!renderer->render(scene, image_))
    return segue::fail(segue::ErrorCode::InvalidArgument, "the scene is not one of this rover");
  picture_.put(image_, area.left, area.top);
  return {};
}

void Stage::draw_title(const Pane& pane, const Area& area) {
  const int widest =
      bold_.width("0000.0 s", kClockSize);  // so that the clock does not change the title's size
  const int clock = std::min(widest, bold_.width(pane.clock, kClockSize));
  const Area right = {area.left + area.width - clock, area.top, clock, area.height};
  write(bold_, pane.clock, right, kClockSize, 10, pane.is_done ? kDone : kBright);
  write(normal_, pane.title, {area.left, area.top, area.width - widest - kMargin, area.height}, 22, 10,
        kBright);
}

void Stage::draw_caption(const Pane& pane, const Area& area) {
  const int above = area.height - kDetailHeight;
  write(bold_, pane.text, {area.left, area.top, area.width, above}, 24, 11, pane.is_done ? kDone : kBright);
  write(normal_, pane.detail, {area.left, area.top + above, area.width, kDetailHeight}, 17, 9, kPale);
}

void Stage::write(const Font& font, std::string_view text, const Area& area, int largest, int smallest,
                  Colour colour) {
  const FittedText fitted = fit_text(font, text, area, largest, smallest);
  const int height = line_height(fitted.size) * static_cast<int>(fitted.lines.size());
  int baseline = area.top + (area.height - height) / 2 + fitted.size;
  for (const std::string& line : fitted.lines) {
    font.write(picture_, area.left, baseline, line, fitted.size, colour);
    baseline += line_height(fitted.size);
  }
}

}  // namespace film
