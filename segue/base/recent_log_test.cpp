// SPDX-License-Identifier: Apache-2.0
#include <segue/base/recent_log.hpp>

#include <gtest/gtest.h>

namespace segue {
namespace {

class RecentLog : public ::testing::Test {
 protected:
  RecentLog() {
    set_log_sink([](LogLevel, std::string_view, std::string_view) {});
  }
  ~RecentLog() override { set_log_sink({}); }
  RecentLog(const RecentLog&) = delete;
  RecentLog& operator=(const RecentLog&) = delete;
};

TEST_F(RecentLog, HasTheLinesOfASourceInTheirOrder) {
  EXPECT_TRUE(recent_log("nobody").empty());
  log(LogLevel::Warning, "ordered", "first");
  log(LogLevel::Error, "ordered.not", "another source");
  log(LogLevel::Info, "ordered", "second");
  const auto lines = recent_log("ordered");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].message, "first");
  EXPECT_EQ(lines[0].level, LogLevel::Warning);
  EXPECT_EQ(lines[1].message, "second");
  EXPECT_EQ(lines[1].number, lines[0].number + 2);
  EXPECT_LE(lines[0].time, lines[1].time);
}

TEST_F(RecentLog, KeepsNoLineBelowTheLogLevel) {
  log(LogLevel::Debug, "quiet", "a detail");
  EXPECT_TRUE(recent_log("quiet").empty());
}

TEST_F(RecentLog, KeepsTheNewestLines) {
  for (int i = 0; i < 150; ++i)
    log(LogLevel::Info, "chatty", std::to_string(i));
  const auto lines = recent_log("chatty");
  ASSERT_EQ(lines.size(), 100U);
  EXPECT_EQ(lines.front().message, "50");
  EXPECT_EQ(lines.back().message, "149");
}

TEST_F(RecentLog, CutsLongLinesBetweenCharacters) {
  std::string text = "x";
  for (int i = 0; i < 2000; ++i)
    text += "é";
  log(LogLevel::Info, "long", text);
  EXPECT_EQ(recent_log("long").front().message, text.substr(0, 1999));
}

TEST_F(RecentLog, ForgetsTheSourceThatWasSilentForTheLongestTime) {
  log(LogLevel::Info, "silent", "once");
  log(LogLevel::Info, "again", "once");
  for (int i = 0; i < 254; ++i)
    log(LogLevel::Info, "many" + std::to_string(i), "once");
  log(LogLevel::Info, "again", "twice");
  log(LogLevel::Info, "silent no more", "once");
  log(LogLevel::Info, "one more", "once");
  EXPECT_TRUE(recent_log("silent").empty());
  EXPECT_EQ(recent_log("again").size(), 2U);
  EXPECT_EQ(recent_log("one more").size(), 1U);
}

}  // namespace
}  // namespace segue
