// SPDX-License-Identifier: Apache-2.0
#include "../../../components/rover/osmesa_suppressions.hpp"
#include "../../../components/rover/simulated_rover.hpp"
#include "font.hpp"
#include "frame.hpp"
#include "stage.hpp"
#include "webp_film.hpp"

#include <segue/base/file.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <webp/decode.h>
#include <webp/demux.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace film {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

Font open_font() {
  auto font = Font::open(std::string(segue::paths::kFonts) + "/DejaVuSans.ttf");
  EXPECT_TRUE(font) << to_string(font.error());
  return std::move(*font);
}

rover::SceneState scene_at(const messages::Pose2D& place) {
  const auto rover = rover::SimulatedRover::create({.start = place});
  EXPECT_TRUE(rover) << to_string(rover.error());
  rover::SceneState scene;
  (*rover)->read_scene(scene);
  return scene;
}

Pane pane_of(const std::string& text, const messages::Pose2D& place = {0.85, 0, 0}) {
  return {scene_at(place), "mast", "a run", "1.0 s", text, "controller: drive", false};
}

/// Draws frames of the same stage.
class FilmStage : public ::testing::Test {
 protected:
  void SetUp() override {
    auto stage = Stage::open(segue::paths::kFonts);
    ASSERT_TRUE(stage) << to_string(stage.error());
    stage_.emplace(std::move(*stage));
  }
  Picture draw(const Frame& frame) {
    const auto picture = stage_->draw(frame);
    EXPECT_TRUE(picture) << to_string(picture.error());
    return picture ? **picture : Picture(Stage::kWidth, Stage::kHeight);
  }
  std::optional<Stage> stage_;
};

/// Whether the pictures are equal in these columns and rows.
bool equal_in(const Picture& one, const Picture& other, const Area& area) {
  for (int y = area.top; y < area.top + area.height; ++y) {
    const auto from = (std::ptrdiff_t{y} * one.width() + area.left) * 3;
    if (!std::equal(one.rgb().begin() + from, one.rgb().begin() + from + std::ptrdiff_t{area.width} * 3,
                    other.rgb().begin() + from))
      return false;
  }
  return true;
}
constexpr Area kLeftHalf{0, 0, Stage::kWidth / 2 - 2, Stage::kHeight};
constexpr Area kRightHalf{Stage::kWidth / 2 + 2, 0, Stage::kWidth / 2 - 2, Stage::kHeight};

std::string many_states(int count) {
  std::string text = "a_state_0";
  for (int i = 1; i < count; ++i)
    text += ", a_state_" + std::to_string(i);
  return text;
}

TEST(FilmText, IsAsLargeAsItsPlaceAllows) {
  const Font font = open_font();
  const auto few = fit_text(font, "drive, raise_hand", {0, 0, 450, 60}, 24, 10);
  EXPECT_EQ(few.size, 24);
  EXPECT_THAT(few.lines, ElementsAre("drive, raise_hand"));
  const auto many = fit_text(font, many_states(12), {0, 0, 450, 60}, 24, 10);
  EXPECT_LT(many.size, 24);
  EXPECT_LE(static_cast<int>(many.lines.size()) * line_height(many.size), 60);
  std::string joined;
  for (const std::string& line : many.lines) {
    EXPECT_LE(font.width(line, many.size), 450) << line;
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, many_states(12)) << "nothing is cut off";
}

TEST(FilmText, BreaksAWordThatIsWiderThanItsPlace) {
  const Font font = open_font();
  const std::string word(60, 'm');
  const auto fitted = fit_text(font, word, {0, 0, 200, 1000}, 20, 20);
  EXPECT_GT(fitted.lines.size(), 1U);
  for (const std::string& line : fitted.lines)
    EXPECT_LE(font.width(line, 20), 200);
  EXPECT_EQ(std::accumulate(fitted.lines.begin(), fitted.lines.end(), std::string()), word);
}

TEST(FilmText, SaysThatItIsCutOffWhereItCannotFit) {
  const Font font = open_font();
  const auto fitted = fit_text(font, many_states(500), {0, 0, 200, 40}, 24, 10);
  EXPECT_THAT(fitted.lines, SizeIs(3));
  EXPECT_TRUE(fitted.lines.back().ends_with("...")) << fitted.lines.back();
  EXPECT_LE(font.width(fitted.lines.back(), fitted.size), 200);
}

TEST(FilmText, NeedsAFont) {
  const auto font = Font::open("/nowhere.ttf");
  ASSERT_FALSE(font);
  EXPECT_THAT(font.error().message, HasSubstr("/nowhere.ttf"));
}

TEST(FilmFrame, IsReadFromALine) {
  const auto frame = read_frame(
      R"({"time": 1.5, "note": "", "panes": [{"positions": [1, 2.5], "camera": "mast", "title": "a", "clock": "b",)"
      R"( "text": "c", "detail": "d"}, {"positions": [], "camera": "deck", "title": "", "clock": "", "text": "",)"
      R"( "detail": "", "done": true}]})");
  ASSERT_TRUE(frame) << to_string(frame.error());
  EXPECT_EQ(frame->time, 1.5);
  EXPECT_EQ(frame->note, "");
  ASSERT_THAT(frame->panes, SizeIs(2));
  EXPECT_THAT(frame->panes[0].scene.positions, ElementsAre(1, 2.5));
  EXPECT_EQ(frame->panes[0].text, "c");
  EXPECT_FALSE(frame->panes[0].is_done);
  EXPECT_EQ(frame->panes[1].camera, "deck");
  EXPECT_TRUE(frame->panes[1].is_done);
}

TEST(FilmFrame, SaysWhatIsWrong) {
  const auto why = [](const std::string& line) {
    const auto frame = read_frame(line);
    return frame ? std::string("nothing") : frame.error().message;
  };
  const std::string pane = R"({"positions": [], "camera": "mast", "title": "", "clock": "", "text": "")";
  EXPECT_THAT(why("{"), ::testing::Not("nothing"));
  EXPECT_THAT(why("[]"), HasSubstr("'time'"));
  EXPECT_THAT(why(R"({"time": 1})"), HasSubstr("'panes'"));
  EXPECT_THAT(why(R"({"time": 1, "panes": []})"), HasSubstr("one or 2"));
  EXPECT_THAT(why(R"({"time": 1, "panes": [{}]})"), HasSubstr("'positions'"));
  EXPECT_THAT(why(R"({"time": 1, "panes": [)" + pane + "}]}"), HasSubstr("'detail'"));
  EXPECT_THAT(why(R"({"time": 1, "panes": [)" + pane + R"(, "detail": "", "done": 1}]})"),
              HasSubstr("'done'"));
  EXPECT_THAT(why(R"({"time": 1, "note": 1, "panes": [)" + pane + R"(, "detail": ""}]})"),
              HasSubstr("'note'"));
}

TEST_F(FilmStage, ShowsBothRunsSideBySide) {
  const Frame before{0, {pane_of("drive"), pane_of("drive")}, ""};
  Frame after = before;
  after.panes[1] = pane_of("look", {-1.5, -0.6, 3.1});
  const Picture first = draw(before);
  const Picture second = draw(after);
  EXPECT_EQ(first.rgb().size(), std::size_t{960} * 540 * 3);
  EXPECT_TRUE(equal_in(first, second, kLeftHalf)) << "the left run has not changed";
  EXPECT_FALSE(equal_in(first, second, kRightHalf));
  after.note = "shorter";
  EXPECT_TRUE(equal_in(second, draw(after), {0, 0, Stage::kWidth, 490})) << "the note has a place of its own";
  EXPECT_FALSE(equal_in(second, draw(after), {0, 490, Stage::kWidth, 50}));
}

TEST_F(FilmStage, KeepsTextsInTheirPane) {
  const Frame few{0, {pane_of("drive"), pane_of("drive")}, std::nullopt};
  Frame many = few;
  many.panes[0].text = many_states(40);
  many.panes[0].detail = many_states(40);
  many.panes[0].title = many_states(40);
  many.panes[0].clock = "123456789.0 s";
  const Picture first = draw(few);
  const Picture second = draw(many);
  EXPECT_FALSE(equal_in(first, second, kLeftHalf));
  EXPECT_TRUE(equal_in(first, second, kRightHalf));
}

TEST_F(FilmStage, WritesATitleEquallyLargeWithAnyClock) {
  Frame frame{0, {pane_of("drive")}, std::nullopt};
  frame.panes[0].title = many_states(15);
  frame.panes[0].clock = "1.0 s";
  const Picture first = draw(frame);
  frame.panes[0].clock = "1111.0 s";
  EXPECT_TRUE(equal_in(first, draw(frame), {0, 0, Stage::kWidth * 3 / 4, Stage::kHeight}));
}

TEST_F(FilmStage, SaysWhatItCannotDraw) {
  Frame frame{0, {pane_of("drive")}, std::nullopt};
  frame.panes[0].camera = "stern";
  const auto unknown = stage_->draw(frame);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("no camera 'stern'"));
  frame.panes[0].camera = "mast";
  frame.panes[0].scene.positions = {1, 2, 3};
  const auto other = stage_->draw(frame);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("not one of this rover"));
}

TEST_F(FilmStage, IsFilmedWithoutLosses) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("segue_film_" + std::to_string(::getpid()) + ".webp");
  auto film = WebpFilm::create(Stage::kWidth, Stage::kHeight);
  ASSERT_TRUE(film) << to_string(film.error());
  std::vector<Picture> pictures;
  for (int i = 0; i < 3; ++i) {
    pictures.push_back(draw({0.1 * i, {pane_of("drive", {0.2 * i, 0, 0})}, std::nullopt}));
    ASSERT_TRUE(film->add(pictures.back().rgb(), 100 * i));
  }
  ASSERT_TRUE(film->write(file, 1000));
  const auto bytes = segue::read_file(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(bytes) << to_string(bytes.error());
  const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()};
  WebPAnimDecoderOptions options{};
  ASSERT_NE(WebPAnimDecoderOptionsInit(&options), 0);
  options.color_mode = MODE_RGBA;
  const std::unique_ptr<WebPAnimDecoder, void (*)(WebPAnimDecoder*)> decoder(
      WebPAnimDecoderNew(&data, &options), WebPAnimDecoderDelete);
  WebPAnimInfo info{};
  ASSERT_NE(WebPAnimDecoderGetInfo(decoder.get(), &info), 0);
  EXPECT_EQ(info.canvas_width, 960U);
  EXPECT_EQ(info.canvas_height, 540U);
  ASSERT_EQ(info.frame_count, 3U);
  for (const Picture& picture : pictures) {
    std::uint8_t* rgba = nullptr;
    int until = 0;
    ASSERT_NE(WebPAnimDecoderGetNext(decoder.get(), &rgba, &until), 0);
    std::size_t others = 0;
    for (std::size_t pixel = 0; pixel < picture.rgb().size() / 3; ++pixel)
      others += std::equal(rgba + pixel * 4, rgba + pixel * 4 + 3, &picture.rgb()[pixel * 3]) ? 0U : 1U;
    EXPECT_EQ(others, 0U) << "pixels that differ";
  }
}

}  // namespace
}  // namespace film
