// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_test_support.hpp>
#include <segue/journal/schema.hpp>

#include <gmock/gmock.h>

#include <array>
#include <fstream>

namespace segue::journal {
namespace {

using namespace std::chrono_literals;
using testing::all_of;
using testing::change;
using testing::Folder;
using ::testing::HasSubstr;
using testing::soon;
using testing::transition;

void write_some(const std::filesystem::path& path) {
  Journal journal(path);
  for (std::uint64_t i = 1; i <= 5; ++i)
    journal.add(transition(i));
  ASSERT_TRUE(journal.flush(soon()));
}

ErrorCode code_of(const std::filesystem::path& path) {
  const auto reader = JournalReader::open(path);
  EXPECT_FALSE(reader);
  return reader ? ErrorCode::Internal : reader.error().code;
}

TEST(JournalReader, FailsWithoutAFile) {
  const Folder folder;
  EXPECT_EQ(code_of(folder / "none"), ErrorCode::NotFound);
  std::ofstream(folder / "empty").close();
  EXPECT_EQ(code_of(folder / "empty"), ErrorCode::NotFound);
}

TEST(JournalReader, GivesTheLatestEntries) {
  const Folder folder;
  write_some(folder / "j");
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  const auto latest = reader->transitions(2, JournalReader::Actions::Without);
  ASSERT_TRUE(latest);
  ASSERT_EQ(latest->size(), 2U);
  EXPECT_EQ(latest->at(0).request, 4U);
  EXPECT_EQ(latest->at(1).request, 5U);
  EXPECT_TRUE(latest->at(1).actions.empty());
}

TEST(JournalReader, AVersionIsRecordedOnce) {
  const Folder folder;
  const VersionEntry first{std::chrono::system_clock::time_point(std::chrono::seconds(1)), "explore", "1f",
                           "a/explore.yaml", "network: explore\ntasks: {}\n"};
  VersionEntry again = first;
  again.time += std::chrono::hours(1);
  VersionEntry long_one = first;
  long_one.version = "2f";
  long_one.text.assign((std::size_t{1} << 20) + 1, '#');
  TransitionEntry done = transition(1);
  done.from_version = "1f";
  done.to_version = "2f";
  done.runs_version = "2f";
  {
    Journal journal(folder / "j");
    for (const VersionEntry& entry : {first, again, long_one})
      journal.add(entry);
    journal.add(done);
    ASSERT_TRUE(journal.flush(soon()));
  }
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  const auto versions = reader->versions(10);
  ASSERT_TRUE(versions);
  ASSERT_EQ(versions->size(), 2U);
  EXPECT_EQ(versions->at(0), first);
  EXPECT_EQ(versions->at(1).version, "2f");
  EXPECT_EQ(versions->at(1).text, "") << "it is too long";
  EXPECT_EQ(all_of(folder / "j").at(0), done);
}

/// Makes a journal as an older Segue left it, which knew that many steps of the schema.
void leave_older_file(const std::filesystem::path& path, std::size_t steps, const std::string& sql) {
  auto old = detail::Database::open(path, detail::Database::Mode::Write);
  ASSERT_TRUE(old && detail::bring_up_to_date(*old, detail::schema_steps().first(steps)));
  ASSERT_TRUE(old->execute(sql));
}

TEST(JournalReader, AFileOfTheFirstVersionIsBroughtUpToDate) {
  const Folder folder;
  leave_older_file(
      folder / "j", 1,
      R"(INSERT INTO "transition" VALUES (1, 7, 0, '', '', 'a', 'b', 'b', '', 'done', '', '', 0, 0,
                      0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, 0))");
  EXPECT_EQ(code_of(folder / "j"), ErrorCode::Unsupported);
  write_some(folder / "j");
  const auto entries = all_of(folder / "j");
  ASSERT_EQ(entries.size(), 6U);
  EXPECT_EQ(entries.front().request, 7U);
  EXPECT_EQ(entries.front().runs_version, "");
}

TEST(JournalReader, AFileWithoutMissionsIsBroughtUpToDate) {
  const Folder folder;
  leave_older_file(folder / "j", 2,
                   R"(INSERT INTO request (request, time, who, what) VALUES (7, 0, '', 'a'))");
  const MissionEntry began{{}, MissionEntry::Kind::Began, "somebody", "patrol"};
  {
    Journal journal(folder / "j");
    journal.add(began);
  }
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->requests(10)->at(0).request, 7U);
  ASSERT_EQ(reader->missions(10)->size(), 1U);
  EXPECT_EQ(reader->missions(10)->at(0), began);
}

TEST(JournalReader, AFileWithoutWhatWasPreparedAheadIsBroughtUpToDate) {
  const Folder folder;
  leave_older_file(
      folder / "j", 3,
      R"(INSERT INTO "transition" VALUES (1, 7, 0, '', '', 'a', 'b', 'b', '', 'done', '', '', 0, 0,
                      0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, 0, '', '', ''))");
  TransitionEntry later = transition(8);
  later.ahead = PreparedAhead{2, 30ms};
  {
    Journal journal(folder / "j");
    journal.add(later);
  }
  const auto entries = all_of(folder / "j");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].request, 7U);
  EXPECT_EQ(entries[0].ahead, std::nullopt);
  EXPECT_EQ(entries[1], later);
  EXPECT_EQ(later.ahead->saved(10ms), 20ms);
  EXPECT_EQ(later.ahead->saved(1s), 0ms);
}

TEST(JournalReader, AFileWithoutWhoCancelledIsBroughtUpToDate) {
  const Folder folder;
  leave_older_file(
      folder / "j", 4,
      R"(INSERT INTO "transition" VALUES (1, 7, 0, '', '', 'a', 'b', 'b', '', 'done', '', '', 0, 0,
                      0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, 0, '', '', '', NULL, NULL))");
  TransitionEntry later = transition(8);
  later.outcome = "cancelled";
  later.undone = "restored";
  later.cancelled_by = "ann";
  {
    Journal journal(folder / "j");
    journal.add(later);
  }
  const auto entries = all_of(folder / "j");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].cancelled_by, "");
  EXPECT_EQ(entries[1], later);
}

TEST(JournalReader, RefusesOtherFiles) {
  const Folder folder;
  std::ofstream(folder / "text") << "this is not a database, though it is long enough to be looked at: "
                                 << std::string(5000, 'x');
  EXPECT_EQ(code_of(folder / "text"), ErrorCode::ParseError);
  change(folder / "other", "CREATE TABLE t (x); PRAGMA user_version = 1");
  EXPECT_EQ(code_of(folder / "other"), ErrorCode::InvalidArgument);
}

TEST(JournalReader, RefusesAFileOfANewerSegue) {
  const Folder folder;
  write_some(folder / "j");
  change(folder / "j", "PRAGMA user_version = 99");
  const auto reader = JournalReader::open(folder / "j");
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::Unsupported);
  EXPECT_THAT(reader.error().message, HasSubstr("version 99"));
}

TEST(JournalReader, SkipsInvalidRows) {
  const Folder folder;
  write_some(folder / "j");
  change(folder / "j", R"(
    UPDATE action SET kind = 'dance' WHERE "transition" = 1 AND number = 0;
    UPDATE action SET phase = 7 WHERE "transition" = 2 AND number = 0;
    UPDATE action SET id = -5 WHERE "transition" = 3 AND number = 0;
    UPDATE "transition" SET total_low = 5, total_typical = 4, total_high = 6;
    INSERT INTO mission VALUES (1, 0, 'danced', '', 'patrol', '', 0, '', '', '', 0, '');
    INSERT INTO duration VALUES ('', 'a', 'start', 'h', 1, 5, '1 2', 0);
    INSERT INTO duration VALUES ('', 'b', 'start', 'h', 1, 5, 'x', 0);
    INSERT INTO duration VALUES ('', 'c', 'start', 'h', 1, 5, '5 ', 0);
    INSERT INTO duration VALUES ('', 'd', 'start', 'h', 1, -5, '5', 0);
    INSERT INTO duration VALUES ('', 'e', 'start', 'h', 1, 5, '-5', 0);
    INSERT INTO duration VALUES ('', 'f', 'start', 'h', 1, 5, '99999999999999999999', 0);
    INSERT INTO duration VALUES ('', 'g', 'start', 'h', 1, 5, '', 0);
    INSERT INTO duration VALUES ('', 'h', 'leap', 'h', 1, 5, '5', 0);)");
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  const auto entries = reader->transitions(10);
  ASSERT_TRUE(entries);
  EXPECT_EQ(entries->at(0).actions.size(), 1U);
  EXPECT_EQ(entries->at(1).actions.size(), 1U);
  EXPECT_EQ(entries->at(2).actions.size(), 1U);
  EXPECT_EQ(entries->at(3).actions.size(), 2U);
  EXPECT_FALSE(entries->at(3).predicted);
  const auto times = reader->times();
  ASSERT_TRUE(times);
  EXPECT_EQ(times->actions.size(), 1U);
  EXPECT_TRUE(reader->missions(10)->empty());
  EXPECT_EQ(reader->invalid_rows(), 12U);
}

TEST(JournalReader, SeesEntriesWrittenAfterItWasOpened) {
  const Folder folder;
  Journal journal(folder / "j");
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->transitions(10)->empty());
  journal.add(transition(1));
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_EQ(reader->transitions(10)->size(), 1U);
}

TEST(JournalReader, ReadsAPathWithSpecialCharactersOfUris) {
  const Folder folder;
  write_some(folder / "50% of? #1");
  EXPECT_EQ(all_of(folder / "50% of? #1").size(), 5U);
}

TEST(JournalReader, FindsDamage) {
  const Folder folder;
  write_some(folder / "j");
  const auto size = std::filesystem::file_size(folder / "j");
  std::fstream file(folder / "j", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096);
  file << std::string(size - 4096, '\x5a');
  file.close();
  auto reader = JournalReader::open(folder / "j");
  const auto found = reader ? reader->check() : Result<void>(reader.error());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::ParseError);
}

TEST(Schema, BringsAnOlderFileUpToDateStepByStep) {
  const Folder folder;
  constexpr std::array<std::string_view, 3> kSteps = {
      "CREATE TABLE a (x)", "ALTER TABLE a ADD COLUMN y DEFAULT 7; INSERT INTO a (x) VALUES (1)",
      "UPDATE a SET x = x + y"};
  auto database = detail::Database::open(folder / "d", detail::Database::Mode::Write);
  ASSERT_TRUE(database);
  ASSERT_TRUE(detail::bring_up_to_date(*database, std::span(kSteps).first(1)));
  ASSERT_TRUE(detail::bring_up_to_date(*database, std::span(kSteps).first(1)));
  ASSERT_TRUE(detail::bring_up_to_date(*database, kSteps));
  ASSERT_TRUE(detail::bring_up_to_date(*database, kSteps));
  EXPECT_EQ(*database->integer("SELECT x FROM a"), 8);
  EXPECT_EQ(*database->integer("PRAGMA user_version"), 3);
  const auto older = detail::bring_up_to_date(*database, std::span(kSteps).first(2));
  ASSERT_FALSE(older);
  EXPECT_EQ(older.error().code, ErrorCode::Unsupported);
}

TEST(Schema, AStepThatFailsLeavesTheFileAsItWas) {
  const Folder folder;
  constexpr std::array<std::string_view, 2> kSteps = {"CREATE TABLE a (x)",
                                                      "INSERT INTO a VALUES (1); INSERT INTO b VALUES (1)"};
  auto database = detail::Database::open(folder / "d", detail::Database::Mode::Write);
  ASSERT_TRUE(database);
  ASSERT_TRUE(detail::bring_up_to_date(*database, std::span(kSteps).first(1)));
  EXPECT_FALSE(detail::bring_up_to_date(*database, kSteps));
  EXPECT_EQ(*database->integer("SELECT count(*) FROM a"), 0);
  EXPECT_EQ(*database->integer("PRAGMA user_version"), 1);
}

}  // namespace
}  // namespace segue::journal
