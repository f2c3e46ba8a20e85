// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_test_support.hpp>
#include <segue/journal/schema.hpp>
#include <support/full_disk.hpp>

#include <gmock/gmock.h>

#include <fstream>

/// The robot keeps running whatever happens to the file.
namespace segue::journal {
namespace {

using segue::testing::FullDisk;
using testing::all_of;
using testing::change;
using testing::Folder;
using testing::soon;
using testing::transition;
using testing::Troubles;
using Kind = Trouble::Kind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::uint64_t> requests_in(const std::filesystem::path& path) {
  std::vector<std::uint64_t> requests;
  for (const auto& entry : all_of(path))
    requests.push_back(entry.request);
  return requests;
}

TEST(JournalTrouble, AFullDiskIsReportedAndWritingResumes) {
  const Folder folder;
  Troubles troubles;
  Journal journal(folder / "j", {}, troubles.listener());
  journal.add(transition(1));
  ASSERT_TRUE(journal.flush(soon()));
  {
    const FullDisk full(150'000);
    for (std::uint64_t i = 2; i <= 4; ++i)
      journal.add(transition(i, 4000));
    EXPECT_FALSE(journal.flush(soon()));
    EXPECT_FALSE(journal.flush(soon()));
    EXPECT_THAT(troubles.wait_for(Kind::Unwritable).message, HasSubstr("cannot be written"));
    EXPECT_THAT(requests_in(folder / "j"), ElementsAre(1));
  }
  EXPECT_TRUE(journal.flush(soon()));
  EXPECT_EQ(troubles.wait_for(Kind::Resumed).lost, 0U);
  EXPECT_THAT(troubles.kinds(), ElementsAre(Kind::Unwritable, Kind::Resumed));
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(1, 2, 3, 4));
  EXPECT_TRUE(JournalReader::open(folder / "j")->check());
  EXPECT_EQ(journal.lost(), 0U);
}

TEST(JournalTrouble, EntriesThatExceedTheQueueAreDroppedAndCounted) {
  const Folder folder;
  Troubles troubles;
  JournalOptions options;
  options.queue = 10'000;
  Journal journal(folder / "j", options, troubles.listener());
  ASSERT_TRUE(journal.flush(soon()));
  {
    const FullDisk full(100'000);
    for (std::uint64_t i = 1; i <= 10; ++i)
      journal.add(transition(i, 4000));
    EXPECT_FALSE(journal.flush(soon()));
  }
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(9, 10));
  EXPECT_EQ(journal.lost(), 8U);
  const auto gaps = JournalReader::open(folder / "j")->gaps(10);
  ASSERT_TRUE(gaps);
  std::uint64_t lost = 0;
  for (const GapEntry& gap : *gaps)
    lost += gap.lost;
  EXPECT_EQ(lost, 8U);
}

TEST(JournalTrouble, AFolderThatCannotBeCreatedIsReportedAndTriedAgain) {
  const Folder folder;
  std::ofstream(folder / "in_the_way") << "a file";
  Troubles troubles;
  Journal journal(folder / "in_the_way/j", {}, troubles.listener());
  journal.add(transition(1));
  const auto failed = journal.flush(soon());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::PermissionDenied);
  (void)troubles.wait_for(Kind::Unwritable);
  std::filesystem::remove(folder / "in_the_way");
  EXPECT_TRUE(journal.flush(soon()));
  (void)troubles.wait_for(Kind::Resumed);
  EXPECT_THAT(requests_in(folder / "in_the_way/j"), ElementsAre(1));
}

TEST(JournalTrouble, ARemovedFileIsCreatedAgain) {
  const Folder folder;
  Journal journal(folder / "j");
  journal.add(transition(1));
  ASSERT_TRUE(journal.flush(soon()));
  for (const char* name : {"j", "j-wal", "j-shm"})
    std::filesystem::remove(folder / name);
  journal.add(transition(2));
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(2));
}

TEST(JournalTrouble, ADamagedFileIsRenamedAndANewOneCreated) {
  const Folder folder;
  for (int life = 1; life <= 7; ++life) {
    std::ofstream(folder / "j") << "damaged " << life << std::string(5000, 'x');
    Troubles troubles;
    Journal journal(folder / "j", {}, troubles.listener());
    journal.add(transition(1));
    ASSERT_TRUE(journal.flush(soon()));
    EXPECT_THAT(troubles.wait_for(Kind::Replaced).message, HasSubstr(".broken-" + std::to_string(life)));
  }
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(1));
  EXPECT_FALSE(std::filesystem::exists(folder / "j.broken-2"));
  EXPECT_TRUE(std::filesystem::exists(folder / "j.broken-3"));
  EXPECT_TRUE(std::filesystem::exists(folder / "j.broken-7"));
}

TEST(JournalTrouble, ALinkIsNotFollowed) {
  const Folder folder;
  Troubles troubles;
  std::filesystem::create_symlink(folder / "elsewhere", folder / "j");
  Journal journal(folder / "j", {}, troubles.listener());
  journal.add(transition(1));
  EXPECT_FALSE(journal.flush(soon()));
  EXPECT_THAT(troubles.wait_for(Kind::Unwritable).message, HasSubstr("is a symbolic link"));
  EXPECT_FALSE(std::filesystem::exists(folder / "elsewhere"));
  std::filesystem::remove(folder / "j");
  EXPECT_TRUE(journal.flush(soon()));
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(1));
}

TEST(JournalTrouble, ALinkToItsFolderIsFollowed) {
  const Folder folder;
  std::filesystem::create_directory(folder / "disk");
  std::filesystem::create_directory_symlink(folder / "disk", folder / "link");
  Journal journal(folder / "link" / "j", {}, {});
  journal.add(transition(1));
  EXPECT_TRUE(journal.flush(soon()));
  EXPECT_THAT(requests_in(folder / "disk" / "j"), ElementsAre(1));
}

TEST(JournalTrouble, ADamagedPageIsFoundWhenTheFileIsOpened) {
  const Folder folder;
  {
    Journal journal(folder / "j");
    journal.add(transition(1, 1000));
  }
  {
    std::fstream file(folder / "j", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(5 * 4096);
    file << std::string(4096, '\x5a');
  }
  Troubles troubles;
  Journal journal(folder / "j", {}, troubles.listener());
  (void)troubles.wait_for(Kind::Replaced);
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_TRUE(all_of(folder / "j").empty());
}

TEST(JournalTrouble, AFileOfANewerSegueIsNotTouched) {
  const Folder folder;
  { Journal(folder / "j").add(transition(1)); }
  change(folder / "j", "PRAGMA user_version = 99; PRAGMA wal_checkpoint(TRUNCATE)");
  Troubles troubles;
  Journal journal(folder / "j", {}, troubles.listener());
  journal.add(transition(2));
  const auto failed = journal.flush(soon());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::Unsupported);
  EXPECT_THAT(troubles.wait_for(Kind::Refused).message, HasSubstr("newer Segue"));
  EXPECT_FALSE(std::filesystem::exists(folder / "j.broken-1"));
  change(folder / "j", "PRAGMA user_version = " + std::to_string(detail::schema_steps().size()));
  EXPECT_TRUE(journal.flush(soon()));
  EXPECT_THAT(requests_in(folder / "j"), ElementsAre(1, 2));
}

TEST(JournalTrouble, ADatabaseOfAnotherProgramIsNotTouched) {
  const Folder folder;
  change(folder / "other", "CREATE TABLE t (x)");
  Troubles troubles;
  Journal journal(folder / "other", {}, troubles.listener());
  journal.add(transition(1));
  EXPECT_FALSE(journal.flush(soon()));
  EXPECT_THAT(troubles.wait_for(Kind::Refused).message, HasSubstr("another program"));
  change(folder / "other", "INSERT INTO t VALUES (1)");
}

}  // namespace
}  // namespace segue::journal
