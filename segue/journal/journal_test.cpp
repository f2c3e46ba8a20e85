// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_test_support.hpp>

#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>

namespace segue::journal {
namespace {

using testing::action;
using testing::all_of;
using testing::Folder;
using testing::soon;
using testing::transition;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Journal, KeepsEveryFieldOfEveryEntry) {
  const Folder folder;
  TransitionEntry whole = transition(7);
  whole.who = "mission 'survey' -> \"it's\"";
  whole.cause = "request";
  whole.runs = "explore";
  whole.undone = "restored";
  whole.error = "explore: configure slam: no map\nsecond line";
  whole.solve = 1ms;
  whole.total = 2s;
  whole.prepare = 1s;
  whole.commit = 200ms;
  whole.retire = 800ms;
  whole.ahead = PreparedAhead{4, 1500ms};
  whole.predicted = Prediction{{1s, 2s, 3s}, {100ms, 150ms, 200ms}};
  whole.actions[0].waited = 3us;
  whole.actions[1].outcome = "failed";
  whole.actions[1].error = "no map";
  const RequestEntry request{7, whole.time, "mission", "manual"};
  MissionEntry began{whole.time, MissionEntry::Kind::Began, "segue mission run (pid 7)", "survey"};
  began.mode = "concurrent";
  const MissionEntry asked{
      whole.time, MissionEntry::Kind::Asked, "segue mission run", "survey", "fetch 'it'/go;", 3, "go_to"};
  const MissionEntry ended{
      whole.time, MissionEntry::Kind::Ended, "", "survey", "fetch", 1, "", "aborted", "no map", 1500ms};
  const DifferenceEntry difference{whole.time, "slam", "task 'slam' is in exception", "restarted"};
  {
    Journal journal(folder / "deep/er/journal.sqlite");
    journal.add(request);
    journal.add(whole);
    journal.add(difference);
    for (const MissionEntry& entry : {began, asked, ended})
      journal.add(entry);
    EXPECT_TRUE(journal.flush(soon()));
  }
  auto reader = JournalReader::open(folder / "deep/er/journal.sqlite");
  ASSERT_TRUE(reader);
  EXPECT_THAT(*reader->transitions(10), ElementsAre(whole));
  EXPECT_THAT(*reader->requests(10), ElementsAre(request));
  EXPECT_THAT(*reader->differences(10), ElementsAre(difference));
  EXPECT_THAT(*reader->missions(10), ElementsAre(began, asked, ended));
  EXPECT_THAT(*reader->missions(2), ElementsAre(asked, ended));
  EXPECT_TRUE(reader->gaps(10)->empty());
  EXPECT_EQ(reader->invalid_rows(), 0U);
}

TEST(Journal, WritesWaitingEntriesWhenItEnds) {
  const Folder folder;
  {
    Journal journal(folder / "j");
    for (std::uint64_t i = 1; i <= 500; ++i)
      journal.add(transition(i));
  }
  const auto entries = all_of(folder / "j");
  ASSERT_EQ(entries.size(), 500U);
  for (std::uint64_t i = 0; i < 500; ++i)
    EXPECT_EQ(entries[i].request, i + 1);
}

TEST(Journal, TakesAPathInTheCurrentFolder) {
  const Folder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder / "");
  {
    Journal journal("j");
    std::filesystem::current_path(before);
    journal.add(transition(1));
    EXPECT_TRUE(journal.flush(soon()));
  }
  EXPECT_EQ(all_of(folder / "j").size(), 1U);
}

TEST(Journal, ContinuesAnExistingFile) {
  const Folder folder;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    Journal journal(folder / "j");
    journal.add(transition(i));
  }
  EXPECT_EQ(all_of(folder / "j").size(), 3U);
}

TEST(Journal, KeepsDurationStatisticsOverRestarts) {
  const Folder folder;
  const model::ActionKey key{"demo::A", model::ActionKind::Configure, model::kLocalHost};
  {
    Journal journal(folder / "j");
    EXPECT_TRUE(journal.times()->actions.empty());
    journal.add(transition(1));
    ASSERT_TRUE(journal.flush(soon()));
    EXPECT_THAT(journal.times()->actions.at(key).recent, ElementsAre(1ms, 2ms));
  }
  Journal journal(folder / "j");
  for (std::uint64_t i = 2; i <= 30; ++i)
    journal.add(transition(i));
  ASSERT_TRUE(journal.flush(soon()));
  const auto& record = journal.times()->actions.at(key);
  EXPECT_EQ(record.count, 60U);
  EXPECT_NEAR(static_cast<double>(record.mean.count()), 1.5e6, 1e3);
  EXPECT_EQ(record.recent.size(), model::DurationRecord::kRecent);
  EXPECT_EQ(*JournalReader::open(folder / "j")->times(), *journal.times());
}

TEST(Journal, LearnsOfRobotsOfOneNameInTwoFoldersApart) {
  const Folder folder;
  std::filesystem::create_directories(folder / "kitchen/controllers");
  std::filesystem::create_directories(folder / "garden");
  const auto learn = [&](const std::string& robot, Duration took, std::uint64_t request) {
    JournalOptions options;
    options.robot_folder = std::filesystem::canonical(folder / robot);
    Journal journal(folder / "j", options);
    TransitionEntry entry = transition(request, 1);
    entry.actions[0].duration = took;
    journal.add(entry);
    EXPECT_TRUE(journal.flush(soon()));
    return journal.times()->actions.begin()->second.recent;
  };
  EXPECT_THAT(learn("kitchen", 1ms, 1), ElementsAre(1ms));
  EXPECT_THAT(learn("garden", 9ms, 2), ElementsAre(9ms));
  EXPECT_THAT(learn("kitchen", 2ms, 3), ElementsAre(1ms, 2ms));
  auto reader = JournalReader::open(folder / "j");
  ASSERT_TRUE(reader);
  const auto near = [&](const std::string& file) {
    return reader->times_near(file)->actions.begin()->second.recent;
  };
  EXPECT_THAT(near(folder / "kitchen/controllers/explore.yaml"), ElementsAre(1ms, 2ms));
  EXPECT_THAT(near(folder / "garden/not_yet/there.yaml"), ElementsAre(9ms));
  EXPECT_THAT(near(folder / "elsewhere.yaml"), ElementsAre(1ms, 2ms)) << "it learned last";
  EXPECT_THAT(reader->times()->actions.begin()->second.recent, ElementsAre(1ms, 2ms));
}

TEST(Journal, TakesNoSamplesFromFailures) {
  const Folder folder;
  Journal journal(folder / "j");
  TransitionEntry entry = transition(1);
  entry.actions[0].outcome = "failed";
  entry.actions[1].outcome = "skipped";
  journal.add(entry);
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_TRUE(journal.times()->actions.empty());
}

TEST(Journal, RemovesTheOldestTransitionsAndKeepsTheirStatistics) {
  const Folder folder;
  JournalOptions options;
  options.keep_actions = 100;
  Journal journal(folder / "j", options);
  for (std::uint64_t i = 1; i <= 200; ++i) {
    journal.add(transition(i, 9));
    journal.add(RequestEntry{i, {}, "", "manual"});
    journal.add(MissionEntry{{}, MissionEntry::Kind::Began, "", "survey", std::to_string(i)});
    ASSERT_TRUE(journal.flush(soon()));
  }
  const auto entries = all_of(folder / "j");
  EXPECT_LE(entries.size(), 10U);
  EXPECT_GE(entries.size(), 8U);
  EXPECT_EQ(entries.back().request, 200U);
  EXPECT_EQ(entries.front().request, 200 - entries.size() + 1);
  EXPECT_EQ(JournalReader::open(folder / "j")->requests(1000)->size(), 10U);
  const auto missions = JournalReader::open(folder / "j")->missions(1000);
  ASSERT_EQ(missions->size(), 10U);
  EXPECT_EQ(missions->back().action, "200");
  EXPECT_EQ(journal.times()->actions.begin()->second.count, 200U * 9U);
  EXPECT_LT(std::filesystem::file_size(folder / "j"), 200'000U);
}

TEST(Journal, KeepsATransitionThatIsLargerThanItsBounds) {
  const Folder folder;
  JournalOptions options;
  options.keep_actions = 10;
  options.queue = 10;
  Journal journal(folder / "j", options);
  journal.add(transition(1, 50));
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_EQ(all_of(folder / "j").at(0).actions.size(), 50U);
  EXPECT_EQ(journal.lost(), 0U);
}

TEST(Journal, TakesEntriesOfManyThreadsWhileOthersRead) {
  const Folder folder;
  Journal journal(folder / "j");
  std::vector<std::thread> threads;
  for (std::uint64_t thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t i = 0; i < 50; ++i) {
        journal.add(transition(thread * 50 + i, 3));
        (void)journal.times()->actions.size();
        if (i % 25 == 0) {
          EXPECT_TRUE(journal.flush(soon()));
        }
      }
    });
  }
  for (int i = 0; i < 20; ++i)
    EXPECT_LE(all_of(folder / "j").size(), 200U);
  for (auto& thread : threads)
    thread.join();
  ASSERT_TRUE(journal.flush(soon()));
  EXPECT_EQ(all_of(folder / "j").size(), 200U);
}

TEST(Journal, TwoWritersLoseNothingOfEachOther) {
  const Folder folder;
  Journal first(folder / "j");
  Journal second(folder / "j");
  for (std::uint64_t i = 1; i <= 20; ++i) {
    first.add(transition(i));
    second.add(transition(100 + i));
  }
  ASSERT_TRUE(first.flush(soon()));
  ASSERT_TRUE(second.flush(soon()));
  EXPECT_EQ(all_of(folder / "j").size(), 40U);
  EXPECT_EQ(JournalReader::open(folder / "j")->times()->actions.begin()->second.count, 80U);
}

TEST(JournalPath, FollowsTheEnvironment) {
  ::setenv("XDG_STATE_HOME", "/var/state", 1);
  EXPECT_EQ(*default_path("artemis"), "/var/state/segue/artemis/journal.sqlite");
  ::setenv("XDG_STATE_HOME", "relative", 1);
  ::setenv("HOME", "/home/x", 1);
  EXPECT_EQ(*default_path("artemis"), "/home/x/.local/state/segue/artemis/journal.sqlite");
  EXPECT_EQ(default_path("../artemis").error().code, ErrorCode::InvalidArgument);
  ::unsetenv("HOME");
  EXPECT_EQ(default_path("artemis").error().code, ErrorCode::NotFound);
}

TEST(DurationSamples, AreOfSuccessfulActionsOnly) {
  TransitionEntry entry;
  entry.actions = {action(1, 100ms), action(2, 100us), action(3, 5ms)};
  entry.actions[1].waited = 3ms;
  entry.actions[2].outcome = "failed";
  const DurationSamples samples = duration_samples(entry);
  ASSERT_EQ(samples.actions.size(), 2U);
  EXPECT_EQ(samples.actions[0].second, 100ms);
  EXPECT_EQ(samples.actions[1].second, 100us);
  EXPECT_EQ(samples.waits.at(1), 3ms);
}

}  // namespace
}  // namespace segue::journal
