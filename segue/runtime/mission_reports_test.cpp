// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_reader.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/temporary_files.hpp>

#include <gmock/gmock.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// Reports of missions in the journal of the robot.
namespace segue::runtime {
namespace {

using journal::MissionEntry;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using type::Value;
using Kind = MissionEntry::Kind;

std::int64_t since_1970() {
  return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Value entry(std::uint64_t number, const char* kind, const char* action = "", Value more = Value::map({})) {
  more.as_map().set("number", number);
  more.as_map().set("time_ns", since_1970());
  more.as_map().set("kind", kind);
  more.as_map().set("action", action);
  return more;
}

Value report_of(Value::List entries, std::uint64_t lost = 0) {
  return Value::map(
      {{"mission", "patrol"},
       {"happened",
        Value::map({{"sent_ns", since_1970()}, {"lost", lost}, {"entries", std::move(entries)}})}});
}

std::string line_of(const MissionEntry& one) {
  std::string line(to_string(one.kind));
  for (const std::string& part : {one.action, one.controller, one.outcome, one.error})
    line += part.empty() ? "" : " " + part;
  return line;
}

class ReportedMission : public ::testing::Test {
 protected:
  ReportedMission() {
    RuntimeOptions options;
    options.journal = folder_ / "journal.sqlite";
    robot_.emplace(std::move(options));
    EXPECT_FALSE(runtime()
                     .add_controller(testing::network_of("network: one\ntasks: {a: {component: x::A}}"))
                     .has_errors());
    lease_ = *served().take_lease("segue mission run");
  }

  Runtime& runtime() { return robot_->runtime; }
  ServedRuntime& served() { return robot_->runtime.served(); }
  void report(Value::List entries, std::uint64_t lost = 0) {
    EXPECT_TRUE(served().report(lease_, report_of(std::move(entries), lost)));
  }
  /// Ends the robot.
  journal::JournalReader journal() {
    robot_.reset();
    auto reader = journal::JournalReader::open(folder_ / "journal.sqlite");
    EXPECT_TRUE(reader);
    return std::move(*reader);
  }
  std::vector<std::string> lines() {
    std::vector<std::string> all;
    const auto entries = *journal().missions(100'000);
    for (const MissionEntry& one : entries)
      all.push_back(line_of(one));
    return all;
  }

  segue::testing::TemporaryFiles files_;
  const std::filesystem::path folder_ = files_.folder();
  std::optional<testing::StandInRobot> robot_;
  std::uint64_t lease_ = 0;
};

TEST_F(ReportedMission, IsInTheJournalOfTheRobot) {
  const auto before = std::chrono::system_clock::now();
  report({entry(1, "began"), entry(2, "began", "there", Value::map({{"iteration", 3}}))});
  report({entry(3, "asked", "there", Value::map({{"controller", "one"}}))});
  report({entry(4, "ended", "there",
                Value::map({{"outcome", "aborted"}, {"error", "no way"}, {"duration_ns", 1'500'000'000}})),
          entry(5, "ended", "", Value::map({{"outcome", "done"}}))});
  EXPECT_EQ(served().reported(), Value::map({{"mission", "patrol"}})) << "status does not have it";
  served().end_lease(lease_);
  const auto entries = *journal().missions(10);
  ASSERT_THAT(entries, SizeIs(5)) << "nothing was lost";
  EXPECT_EQ(entries[0].who, "segue mission run");
  EXPECT_EQ(entries[0].mission, "patrol");
  EXPECT_EQ(entries[0].action, "");
  EXPECT_EQ(entries[1].iteration, 3U);
  EXPECT_EQ(line_of(entries[2]), "asked there one");
  EXPECT_EQ(line_of(entries[3]), "ended there aborted no way");
  EXPECT_EQ(entries[3].duration, std::chrono::milliseconds(1500));
  EXPECT_EQ(line_of(entries[4]), "ended done");
  for (const MissionEntry& one : entries) {
    EXPECT_GE(one.time, before);
    EXPECT_LE(one.time, std::chrono::system_clock::now());
  }
}

TEST_F(ReportedMission, CountsOnceThoughItIsReportedTwice) {
  report({entry(1, "began")});
  report({entry(1, "began"), entry(2, "began", "there")});
  report({entry(2, "began", "there")});
  served().end_lease(lease_);
  EXPECT_THAT(lines(),
              ElementsAre("began", "began there",
                          "ended lost whoever ran it gave the robot back without saying how it ended"));
}

TEST_F(ReportedMission, IsLostWithTheRobot) {
  report({entry(1, "began")});
  RequestOptions theirs;
  theirs.take_over = true;
  theirs.who = "segue switch";
  EXPECT_EQ(runtime().switch_to(model::NetworkName("one"), theirs).outcome, Outcome::Done);
  EXPECT_EQ(served().report(lease_, report_of({entry(2, "began", "there")})).error().code,
            ErrorCode::InvalidState);
  EXPECT_THAT(lines(), ElementsAre("began", "ended lost the robot was taken over by segue switch"));
}

TEST_F(ReportedMission, IsTakenFromItsHolderOnly) {
  EXPECT_EQ(served().report(lease_ + 1, report_of({entry(1, "began")})).error().code,
            ErrorCode::InvalidState);
  EXPECT_EQ(served().report(0, report_of({entry(1, "began")})).error().code, ErrorCode::InvalidState);
  EXPECT_THAT(lines(), IsEmpty());
}

TEST_F(ReportedMission, MayNotBeMoreThanItsShare) {
  const auto most = std::numeric_limits<std::int64_t>::max();
  Value::List many;
  for (std::uint64_t i = 1; i <= 20'000; ++i)
    many.push_back(entry(i, "began", "there"));
  report(std::move(many));
  const std::string long_text(100'000, 'x');
  Value wild =
      entry(20'001, "ended", long_text.c_str(), Value::map({{"error", long_text}, {"duration_ns", -7}}));
  wild.as_map().set("time_ns", -most);
  report({wild, Value("nothing"), Value::map({{"number", most}, {"kind", "danced"}})}, 17);
  EXPECT_TRUE(served().report(lease_, Value::map({{"happened", 3}})));
  EXPECT_TRUE(
      served().report(lease_, Value::map({{"happened", Value::map({{"entries", "x"}, {"sent_ns", -1}})}})));
  EXPECT_TRUE(served().report(lease_, Value::list({1, 2})));
  served().end_lease(lease_);
  auto reader = journal();
  const auto entries = *reader.missions(100'000);
  EXPECT_GE(entries.size(), 5000U);
  EXPECT_LT(entries.size(), 20'000U);
  for (const MissionEntry& one : entries) {
    EXPECT_LT(one.action.size(), 2000U);
    EXPECT_LT(one.error.size(), 3000U);
    EXPECT_GE(one.duration, Duration::zero());
  }
  std::uint64_t lost = 0;
  const auto gaps = *reader.gaps(100);
  for (const auto& gap : gaps) {
    lost += gap.lost;
    EXPECT_THAT(gap.reason, HasSubstr("a mission did more than is recorded"));
  }
  EXPECT_EQ(lost + entries.size(), 20'001U + 1U + 17U)
      << "those too many, of an unknown kind, and lost before";
}

TEST_F(ReportedMission, HasTheTimeOfTheRobotWhereItsOwnIsAnother) {
  const auto before = std::chrono::system_clock::now();
  Value early = report_of({entry(1, "began")});
  const std::int64_t hour = 3'600'000'000'000;
  early.as_map().find("happened")->as_map().set("sent_ns", since_1970() - hour);
  EXPECT_TRUE(served().report(lease_, early));
  Value late = report_of({entry(2, "began", "there")});
  Value& happened = *late.as_map().find("happened");
  happened.as_map().set("sent_ns", since_1970() + hour);
  happened.as_map().find("entries")->as_list().front().as_map().set("time_ns", since_1970() + hour);
  EXPECT_TRUE(served().report(lease_, late));
  const auto entries = *journal().missions(2);
  ASSERT_THAT(entries, SizeIs(2));
  for (const MissionEntry& one : entries) {
    EXPECT_GE(one.time, before - std::chrono::minutes(1));
    EXPECT_LE(one.time, std::chrono::system_clock::now());
  }
}

TEST_F(ReportedMission, NeedsNoJournal) {
  testing::StandInRobot without;
  const auto lease = *without.runtime.served().take_lease("somebody");
  EXPECT_TRUE(without.runtime.served().report(lease, report_of({entry(1, "began")}, 3)));
  without.runtime.served().end_lease(lease);
}

std::string recent(ServedRuntime& runtime, std::uint64_t after = 0) {
  std::string line;
  const Value mission = runtime.mission(after, false);
  for (const Value& one : mission.find("entries")->as_list())
    line += one.find("kind")->as_string() + " " + one.find("action")->as_string() + "; ";
  return line + mission.find("state")->as_string();
}

TEST_F(ReportedMission, IsShownToWhoeverLooks) {
  EXPECT_TRUE(served().mission(0, true).is_null());
  report({entry(1, "began"), entry(2, "began", "there")});
  EXPECT_EQ(recent(served()), "began ; began there; running");
  Value doing = report_of({entry(3, "ended", "there", Value::map({{"outcome", "success"}}))});
  doing.as_map().set("state", "paused");
  EXPECT_TRUE(served().report(lease_, doing));
  const Value shown = served().mission(0, false);
  const auto last = shown.find("entries")->as_list()[1].find("number")->as_uint();
  EXPECT_EQ(recent(served(), last), "ended there; paused");
  EXPECT_EQ(shown.find("plan"), nullptr);
  EXPECT_EQ(*shown.find("run"), Value(1));
  served().end_lease(lease_);
  EXPECT_EQ(recent(served(), last), "ended there; ended ; ended");
  EXPECT_EQ(*served().mission(0, false).find("outcome"), Value(journal::kLost));
}

TEST_F(ReportedMission, IsAskedForItsPlanWhenSomebodyLooks) {
  report({entry(1, "began")});
  EXPECT_THAT(served().take_commands(lease_), IsEmpty());
  (void)served().mission(0, false);
  EXPECT_THAT(served().take_commands(lease_), IsEmpty());
  EXPECT_TRUE(served().mission(0, true).find("plan")->is_null());
  EXPECT_TRUE(served().send_command("pause"));
  EXPECT_THAT(served().take_commands(lease_),
              ElementsAre(control::HolderRequest{1, "pause", {}}, control::HolderRequest{0, "plan", {}}));
  EXPECT_TRUE(served().report(lease_, Value::map({{"mission", "patrol"}, {"plan", "here"}})));
  EXPECT_EQ(*served().mission(0, true).find("plan"), Value("here"));
  EXPECT_THAT(served().take_commands(lease_), IsEmpty());
  EXPECT_EQ(served().reported(), Value::map({{"mission", "patrol"}})) << "for status()";
  report({entry(2, "ended"), entry(3, "began")});
  EXPECT_TRUE(served().mission(0, true).find("plan")->is_null()) << "that of the next mission is another one";
}

TEST_F(ReportedMission, IsShownAsFarAsItIsKept) {
  report({entry(1, "began")});
  std::uint64_t number = 1;
  for (std::size_t sent = 0; sent < 4500; sent += 500) {
    Value::List entries;
    for (int i = 0; i < 500; ++i)
      entries.push_back(entry(++number, "began", "a"));
    report(std::move(entries));
  }
  const Value first = served().mission(0, false);
  EXPECT_THAT(first.find("entries")->as_list(), SizeIs(2000));
  const auto last = first.find("entries")->as_list().back().find("number")->as_uint();
  EXPECT_EQ(served().mission(last, false).find("entries")->as_list().front().find("number")->as_uint(),
            last + 1);
}

}  // namespace
}  // namespace segue::runtime
