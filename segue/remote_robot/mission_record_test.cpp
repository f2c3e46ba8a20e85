// SPDX-License-Identifier: Apache-2.0
#include <segue/remote_robot/mission_record.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace segue::remote_robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using type::Value;
using Kind = mission::StateEvent::Kind;

std::vector<std::string> lines_of(const Value& happened) {
  std::vector<std::string> lines;
  for (const Value& entry : happened.find("entries")->as_list()) {
    std::string line;
    for (const char* key : {"kind", "action", "controller", "outcome", "error"}) {
      if (const Value* text = entry.find(key)) line += (line.empty() ? "" : " ") + text->as_string();
    }
    lines.push_back(line);
  }
  return lines;
}

TEST(MissionRecord, SaysWhatAMissionDid) {
  MissionRecord record;
  record.observe({Kind::Began, "nowhere", 0});
  EXPECT_FALSE(record.has_waiting()) << "no mission has begun";
  EXPECT_EQ(record.waiting().second, 0U);
  record.began("patrol", "concurrent");
  EXPECT_EQ(record.mission(), "patrol");
  record.observe({Kind::Began, "there", 2});
  record.asked({"there", 2, "go_to"});
  record.asked({"there", 2, ""});
  record.observe({Kind::Began, "", 0});
  record.observe({Kind::Ended, "there", 2, "aborted", "no way"});
  record.ended("done", "");
  const auto [happened, last] = record.waiting();
  EXPECT_THAT(lines_of(happened), ElementsAre("began", "began there", "asked there go_to",
                                              "ended there aborted no way", "ended done"));
  EXPECT_EQ(last, 5U);
  const auto& entries = happened.find("entries")->as_list();
  EXPECT_EQ(*entries[0].find("mode"), Value("concurrent"));
  EXPECT_EQ(entries[1].find("mode"), nullptr);
  EXPECT_EQ(entries[1].find("iteration")->as_uint(), 2U);
  EXPECT_GE(entries[3].find("duration_ns")->as_int(), 0);
  EXPECT_GE(entries[4].find("duration_ns")->as_int(), entries[3].find("duration_ns")->as_int());
  EXPECT_LE(entries[4].find("time_ns")->as_int(), happened.find("sent_ns")->as_int());
}

TEST(MissionRecord, KeepsWhatTheRobotHasNotTaken) {
  MissionRecord record({.waiting = 100, .at_once = 2});
  record.began("patrol");
  record.observe({Kind::Began, "a", 0});
  record.observe({Kind::Ended, "a", 0, "success"});
  EXPECT_THAT(lines_of(record.waiting().first), ElementsAre("began", "began a"));
  EXPECT_THAT(lines_of(record.waiting().first), ElementsAre("began", "began a"));
  record.taken(record.waiting().second);
  EXPECT_TRUE(record.has_waiting());
  EXPECT_THAT(lines_of(record.waiting().first), ElementsAre("ended a success"));
  record.taken(record.waiting().second);
  EXPECT_FALSE(record.has_waiting());
}

TEST(MissionRecord, IsBounded) {
  MissionRecord record({.waiting = 3, .at_once = 10});
  record.began("patrol");
  for (std::uint64_t i = 0; i < 10; ++i)
    record.observe({Kind::Began, "a", i});
  record.observe({Kind::Ended, "a", 9, "aborted", std::string(100'000, 'x')});
  const auto [happened, last] = record.waiting();
  EXPECT_EQ(happened.find("lost")->as_uint(), 9U);
  EXPECT_EQ(happened.find("entries")->as_list().size(), 3U);
  EXPECT_LT(happened.find("entries")->as_list().back().find("error")->as_string().size(), 2000U);
  EXPECT_EQ(last, 12U);
}

}  // namespace
}  // namespace segue::remote_robot
