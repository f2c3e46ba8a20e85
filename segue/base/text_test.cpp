// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/base/id.hpp>
#include <segue/base/life_cycle.hpp>
#include <segue/base/log.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/base/utf8.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace segue {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

TEST(Markup, NothingOfATextIsTakenForMarkup) {
  EXPECT_EQ(escape_markup("<a b='c' d=\"e\">&</a>"),
            "&lt;a b=&#39;c&#39; d=&quot;e&quot;&gt;&amp;&lt;/a&gt;");
  EXPECT_EQ(escape_markup("gr\u00fc\u00df\x01\tx\ny"), "gr\u00fc\u00df  x\ny");
}

TEST(Quote, EscapesControlCharactersAndShortensLongText) {
  EXPECT_EQ(quote("far"), "'far'");
  EXPECT_EQ(quote("a\nb\x01"), "'a\\nb\\x01'");
  EXPECT_EQ(quote(std::string(100, 'x')), "'" + std::string(80, 'x') + "...'");
}

TEST(Quote, EscapesWhatATerminalWouldObeyAndCutsNoCharacter) {
  EXPECT_EQ(quote("a\xc2\x9b"
                  "b\xff"),
            "'a\\xc2\\x9bb\\xff'");
  EXPECT_EQ(quote(std::string(79, 'x') + "\u00fcy"), "'" + std::string(79, 'x') + "...'");
}

TEST(Printable, EscapesControlCharactersOfOneAndTwoBytes) {
  EXPECT_EQ(printable("\x1b[2Jgr\u00fc\u00df\t\n\r\x7f"), "\\x1b[2Jgr\u00fc\u00df\t\n\\x0d\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J")
      << "CSI as one character";
}

TEST(Printable, EscapesBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J")
      << "CSI for a terminal in Latin 1";
  EXPECT_EQ(printable("\xc0\x9b \xe0\x80\x9b \xe2\x82"), "\\xc0\\x9b \\xe0\\x80\\x9b \\xe2\\x82")
      << "overlong, cut";
  EXPECT_EQ(printable("a\u202eb\u2066\u200f"), "a\\xe2\\x80\\xaeb\\xe2\\x81\\xa6\\xe2\\x80\\x8f")
      << "right to left";
  EXPECT_EQ(printable("\u20ac \U0001f916"), "\u20ac \U0001f916");
}

TEST(Log, WritesNoControlCharactersToStandardError) {
  ::testing::internal::CaptureStderr();
  log(LogLevel::Warning, "a\x1b", "b\x1b[2J\r");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "warning: a\\x1b: b\\x1b[2J\\x0d\n");
}

TEST(Beginning, CutsNoCharacter) {
  EXPECT_EQ(beginning_of("abc", 3), "abc");
  EXPECT_EQ(beginning_of("abc", 2), "ab");
  EXPECT_EQ(beginning_of("aé", 2), "a");
  EXPECT_EQ(beginning_of("\xe2\x82\xac", 2), "");
  EXPECT_EQ(beginning_of("\x80\x80", 1), "") << "what is not UTF-8";
  EXPECT_EQ(beginning_of("", 0), "");
}

TEST(DidYouMean, SuggestsTheNearestNameOrNothing) {
  const std::vector<std::string> names = {"velodyne", "odometry"};
  EXPECT_EQ(did_you_mean("velodine", names), ", did you mean 'velodyne'?");
  EXPECT_EQ(did_you_mean("zzz", names), "");
}

TEST(DidYouMean, ListsTheNamesWhereNoneIsNear) {
  const std::vector<std::string> names = {"look", "take"};
  EXPECT_EQ(did_you_mean_or_list("lok", names, "it has"), ", did you mean 'look'?");
  EXPECT_EQ(did_you_mean_or_list("zzzz", names, "it has"), "; it has look and take");
  EXPECT_EQ(did_you_mean_or_list("zzzz", {}, "it has"), "");
  const std::vector<std::string> many(14, "take");
  EXPECT_THAT(did_you_mean_or_list("zzzz", many, "it has"), ::testing::EndsWith("take and 2 more"));
}

TEST(DidYouMean, SuggestsNoNameThatDiffersInMoreThanAThird) {
  EXPECT_EQ(did_you_mean("planning", std::vector<std::string>{"planxyng"}), ", did you mean 'planxyng'?");
  EXPECT_EQ(did_you_mean("planning", std::vector<std::string>{"plxyzing"}), "");
}

TEST(DidYouMean, SuggestsTheFirstOfNamesThatAreEquallyNear) {
  EXPECT_EQ(did_you_mean("arm", std::vector<std::string>{"arm_1", "arm_2"}), ", did you mean 'arm_1'?");
}

TEST(Listed, JoinsAsInASentence) {
  EXPECT_EQ(listed(std::vector<std::string>{"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(listed(std::vector<std::string>{"a"}), "a");
}

TEST(Counted, OneIsNoPlural) {
  EXPECT_EQ(counted(0, "action"), "0 actions");
  EXPECT_EQ(counted(1, "action"), "1 action");
  EXPECT_EQ(counted(2, "action"), "2 actions");
}

TEST(Split, KeepsEmptyParts) {
  EXPECT_EQ(split("a,,b,", ','), (std::vector<std::string_view>{"a", "", "b", ""}));
  EXPECT_EQ(split("", ','), (std::vector<std::string_view>{""}));
}

TEST(ParseDuration, NeedsAUnit) {
  EXPECT_EQ(parse_duration("100ms").value(), milliseconds(100));
  EXPECT_EQ(parse_duration("1.5 s").value(), milliseconds(1500));
  EXPECT_EQ(parse_duration("2min").value(), std::chrono::minutes(2));
  for (const char* wrong : {"", "100", "ms", "1 lightyear", "nan s", "1e300s", "1ms "}) {
    EXPECT_FALSE(parse_duration(wrong)) << wrong;
  }
}

RC_GTEST_PROP(FormatDuration, IsReadBackExactly, (std::int64_t count)) {
  const Duration duration(count % 4'000'000'000'000'000);
  RC_ASSERT(parse_duration(format_duration(duration)).value() == duration);
}

TEST(FormatDuration, PicksAUnitThatReadsWell) {
  EXPECT_EQ(format_duration(milliseconds(100)), "100ms");
  EXPECT_EQ(format_duration(milliseconds(1500)), "1.5s");
  EXPECT_EQ(format_duration(nanoseconds(0)), "0s");
  EXPECT_EQ(format_duration(std::chrono::seconds(9'000'000'000)), "9000000000s");
}

TEST(SizeTest, ReadsNumberAndUnit) {
  EXPECT_EQ(parse_size("512MB").value(), 512'000'000U);
  EXPECT_EQ(parse_size("64 MiB").value(), 64U << 20);
  EXPECT_EQ(parse_size("7B").value(), 7U);
  EXPECT_EQ(parse_size("0").value(), 0U);
}

TEST(SizeTest, RefusesWhatIsNoSize) {
  for (const auto* wrong : {"", "MB", "10", "-1MB", "1.5MB", "1mb", "20000000TB", "18446744073709551616B"})
    EXPECT_FALSE(parse_size(wrong)) << wrong;
}

RC_GTEST_PROP(SizeTest, WhatIsWrittenReadsTheSame, (std::uint64_t size, std::uint8_t zeros)) {
  const std::uint64_t bytes = size << (zeros % 50);
  RC_ASSERT(parse_size(format_size(bytes)).value() == bytes);
}

TEST(IsIdentifier, AcceptsNamesAndRefusesPaths) {
  EXPECT_TRUE(is_identifier("demo::Filter"));
  EXPECT_TRUE(is_identifier("head_demo_control-Task1"));
  for (const char* wrong : {"", "../x", "a/b", "-x", "a b", "."})
    EXPECT_FALSE(is_identifier(wrong)) << wrong;
  EXPECT_FALSE(is_identifier(std::string(256, 'a')));
}

TEST(MatchesGlob, KnowsStarAndQuestionMark) {
  EXPECT_TRUE(matches_glob("*.yaml", "a.yaml"));
  EXPECT_TRUE(matches_glob("a?c*", "abcdef"));
  EXPECT_TRUE(matches_glob("*b*d", "abbcd"));
  EXPECT_FALSE(matches_glob("*.yaml", "a.yml"));
  EXPECT_FALSE(matches_glob("", "a"));
}

TEST(TaskState, IsReadInEitherCase) {
  EXPECT_EQ(task_state_from("RUNNING"), TaskState::Running);
  EXPECT_EQ(task_state_from("pre_operational"), TaskState::PreOperational);
  EXPECT_EQ(task_state_from("flying"), std::nullopt);
}

TEST(Id, OfDifferentKindsDoNotMix) {
  using TaskId = Id<struct A>;
  using HostName = Id<struct B>;
  static_assert(!std::is_convertible_v<TaskId, HostName>);
  EXPECT_LT(TaskId("a"), TaskId("b"));
}

TEST(IsoTime, IsInUtcWithMilliseconds) {
  using namespace std::chrono;
  EXPECT_EQ(iso_time(system_clock::time_point(seconds(1'795'000'000) + milliseconds(7))),
            "2026-11-18T11:06:40.007Z");
}

TEST(FormatQuantity, HasThreeDigitsAndAPrefix) {
  EXPECT_EQ(format_quantity(0, "B"), "0 B");
  EXPECT_EQ(format_quantity(99.96, "Hz"), "100 Hz");
  EXPECT_EQ(format_quantity(999.4, "B"), "999 B");
  EXPECT_EQ(format_quantity(999.6, "B"), "1 kB");
  EXPECT_EQ(format_quantity(9'180'197, "B/s"), "9.18 MB/s");
  EXPECT_EQ(format_quantity(2e16, "B"), "20000 TB");
}

TEST(RoundedText, IsThreeDigitsWithAUnit) {
  using namespace std::chrono_literals;
  EXPECT_EQ(format_seconds(79749ns), "79.7 us");
  EXPECT_EQ(format_seconds(4109974658ns), "4.11 s");
  EXPECT_EQ(format_seconds(128us), "128 us");
  EXPECT_EQ(format_seconds(999600ns), "1 ms") << "not 1e+03 us";
  EXPECT_EQ(format_seconds(0.9996), "1 s");
  EXPECT_EQ(format_seconds(1.5), "1.5 s");
  EXPECT_EQ(format_seconds(12345s), "12345 s");
  EXPECT_EQ(format_seconds(0.0), "0 us");
}

}  // namespace
}  // namespace segue
