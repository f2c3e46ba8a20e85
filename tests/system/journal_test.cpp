// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal.hpp>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using namespace std::chrono_literals;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A robot that has ended, and its journal.
class JournalFiles : public SystemTest {
 protected:
  static journal::TransitionEntry transition(std::uint64_t request) {
    journal::TransitionEntry entry;
    entry.request = request;
    entry.time = std::chrono::system_clock::time_point(1'800'000'000s);
    entry.from = "explore";
    entry.to = "manual";
    entry.outcome = journal::kDone;
    entry.total = 30ms;
    entry.commit = 5ms;
    entry.actions = {{1,
                      model::ActionKind::Configure,
                      model::Phase::Prepare,
                      "configure a",
                      "demo::Drive",
                      model::kLocalHost,
                      {},
                      {},
                      {},
                      25ms,
                      {},
                      journal::kDone,
                      {}}};
    if (request > 1) entry.predicted = journal::Prediction{{20ms, 25ms, 40ms}, {1ms, 2ms, 4ms}};
    return entry;
  }

  void leave(const std::string& file, std::uint64_t requests = 3) const {
    journal::Journal journal(folder_ / file);
    for (std::uint64_t i = 1; i <= requests; ++i)
      journal.add(transition(i));
    journal.add(journal::DifferenceEntry{{}, "slam", "task 'slam' is in exception", "restarted"});
    ASSERT_TRUE(journal.flush(RealClock::instance().now() + kPatience));
  }
};

TEST_F(JournalFiles, HistoryIsReadWithoutARunningRobot) {
  leave("state/segue/rover/journal.sqlite");
  const auto finished = segue({"history"});
  EXPECT_EQ(finished.status, 0) << finished.errors;
  EXPECT_TRUE(
      contains(finished.output,
               "2027-01-15 08:00:00  explore -> manual: done, 1 action in 30 ms (commit 5 ms); expected "
               "20 ms to 40 ms (commit 1 ms to 4 ms)"))
      << finished.output;
  EXPECT_TRUE(contains(finished.output, "as expected: 2 of 2 in total, 0 of 2 in commit")) << finished.output;
  const auto entries = json({"history", "--robot", "rover", "-n", "2"});
  ASSERT_EQ(entries.as_list().size(), 2U);
  EXPECT_EQ(entries.as_list()[0].find("request")->as_int(), 2);
  EXPECT_NE(entries.as_list()[0].find("predicted_s"), nullptr);
}

TEST_F(JournalFiles, TheSlowestActionsComeFirstWithHints) {
  auto first = transition(1);
  first.actions[0].duration = 150ms;
  auto start = first.actions[0];
  start.kind = model::ActionKind::Start;
  start.phase = model::Phase::Commit;
  start.label = "start b";
  start.duration = 12ms;
  auto failed = start;
  failed.label = "start c";
  failed.outcome = "failed";
  failed.duration = 10s;
  first.actions.insert(first.actions.end(), {start, failed});
  auto second = transition(2);
  second.actions[0].duration = 250ms;
  {
    journal::Journal journal(folder_ / "old.sqlite");
    journal.add(std::move(first));
    journal.add(std::move(second));
    ASSERT_TRUE(journal.flush(RealClock::instance().now() + kPatience));
  }
  const auto listed = segue({"history", "--slowest", "--journal", "old.sqlite"});
  EXPECT_EQ(listed.status, 0) << listed.errors;
  EXPECT_TRUE(contains(listed.output, "segue prepare")) << listed.output;
  EXPECT_TRUE(contains(listed.output, "move work from on_start to on_configure")) << listed.output;
  const auto actions = json({"history", "--slowest", "--journal", "old.sqlite"}).as_list();
  ASSERT_EQ(actions.size(), 2U) << "what failed says nothing about how long it takes";
  EXPECT_EQ(actions[0].find("action")->as_string(), "configure a");
  EXPECT_EQ(actions[0].find("count")->as_int(), 2);
  EXPECT_DOUBLE_EQ(actions[0].find("mean_s")->as_double(), 0.2);
  EXPECT_DOUBLE_EQ(actions[0].find("most_s")->as_double(), 0.25);
  EXPECT_EQ(actions[1].find("action")->as_string(), "start b");
  EXPECT_EQ(json({"history", "--slowest", "-n", "1", "--journal", "old.sqlite"}).as_list().size(), 1U);
  EXPECT_EQ(segue({"history", "--slowest", "--missions"}).status, 2);
}

TEST_F(JournalFiles, AGivenFileIsRead) {
  leave("old.sqlite");
  EXPECT_EQ(json({"history", "--journal", "old.sqlite"}).as_list().size(), 3U);
  const auto differences = segue({"history", "--journal", "old.sqlite", "--differences"});
  EXPECT_TRUE(contains(differences.output, "task 'slam' is in exception: restarted")) << differences.output;
}

TEST_F(JournalFiles, MissingAndDamagedFilesAreReported) {
  EXPECT_EQ(segue({"history"}).status, 3);
  EXPECT_EQ(segue({"history", "--robot", "nobody"}).status, 3);
  EXPECT_EQ(segue({"history", "--journal", "none.sqlite"}).status, 1);
  write("broken.sqlite", std::string(5000, 'x'));
  const auto broken = segue({"history", "--journal", "broken.sqlite"});
  EXPECT_EQ(broken.status, 1);
  EXPECT_TRUE(contains(broken.errors, "cannot read the journal")) << broken.errors;
  leave("state/segue/rover/journal.sqlite");
  leave("state/segue/crane/journal.sqlite");
  const auto unclear = segue({"history", "--all"});
  EXPECT_EQ(unclear.status, 1);
  EXPECT_TRUE(contains(unclear.errors, "crane and rover")) << unclear.errors;
}

TEST_F(JournalFiles, ATransitionIsEstimated) {
  leave("old.sqlite", 30);
  write("one.yaml", "network: one\ntasks:\n  a: {component: \"demo::Drive\", state: stopped}\n");
  const auto text = segue({"diff", "-", "one.yaml", "--estimate", "--journal", "old.sqlite"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_TRUE(contains(text.output, "critical path")) << text.output;
  EXPECT_TRUE(contains(text.output, "1 of 2 actions have not been measured yet")) << text.output;
  const auto value = json({"diff", "-", "one.yaml", "--estimate", "--journal", "old.sqlite"});
  const auto* estimate = value.find("estimate_s");
  ASSERT_NE(estimate, nullptr);
  EXPECT_EQ(estimate->find("never_measured")->as_int(), 1);
  EXPECT_EQ(estimate->find("critical_path")->as_list().size(), 2U);
  EXPECT_EQ(segue({"diff", "-", "one.yaml", "--estimate"}).status, 1);
  EXPECT_EQ(segue({"diff", "-", "one.yaml", "--journal", "old.sqlite"}).status, 2);
}

class JournalOfARobot : public SystemTest {};

TEST_F(JournalOfARobot, OutlivesItAndPredictsItsNextSwitch) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  const auto last = json({"history"}).as_list().back();
  EXPECT_NE(last.find("predicted_s"), nullptr);
  EXPECT_TRUE(contains(segue({"history"}).output, "; expected ")) << segue({"history"}).output;
  (void)stop();
  const auto entries = json({"history"});
  ASSERT_EQ(entries.as_list().size(), 5U);  // the last two bring it to rest and shut it down
  const auto& switched = entries.as_list()[1];
  EXPECT_EQ(switched.find("to")->as_string(), "manual");
  EXPECT_EQ(switched.find("outcome")->as_string(), "done");
  EXPECT_TRUE(contains(switched.find("who")->as_string(), "segue switch"));
  EXPECT_FALSE(switched.find("actions")->as_list().empty());
  const auto estimate = json({"diff", "rover/controllers/explore.yaml", "rover/controllers/manual.yaml",
                              "--robot-file", "rover/robot.yaml", "--estimate"});
  EXPECT_EQ(estimate.find("estimate_s")->find("never_measured")->as_int(), 0);
}

TEST_F(JournalOfARobot, IsKeptOnRequestOnly) {
  start({"--controller", "explore", "--no-journal"});
  (void)stop();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "state"));
  start({"--controller", "explore", "--journal", "here.sqlite"});
  (void)stop();
  EXPECT_EQ(json({"history", "--journal", "here.sqlite"}).as_list().size(), 3U);
}

using PlannedByTheJournal = SystemTest;

TEST_F(PlannedByTheJournal, ADryRunSaysHowLongTheSwitchTakes) {
  start();
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  ASSERT_TRUE(eventually([&] {
    return json({"switch", "manual", "--dry-run"}).find("estimate_s") != nullptr;
  })) << "what was measured is written a little later";
  const auto plan = json({"switch", "manual", "--dry-run"});
  EXPECT_EQ(plan.find("estimate_s")->find("actions")->as_list().size(),
            plan.find("actions")->as_list().size());
  const auto text = segue({"switch", "manual", "--dry-run"});
  EXPECT_TRUE(contains(text.output, "expected\n  total ")) << text.output;
}

}  // namespace
}  // namespace segue::testing
