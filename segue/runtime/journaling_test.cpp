// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/journaling.hpp>

#include <gtest/gtest.h>

namespace segue::runtime {
namespace {

using model::ActionKind;
using model::Phase;
using namespace std::chrono_literals;

ActionRecord record(int id, ActionKind kind, Phase phase, std::vector<int> after, Duration started,
                    Duration duration) {
  ActionRecord created;
  created.action.id = id;
  created.action.kind = kind;
  created.action.what = model::TaskAction{model::TaskId("a")};
  created.action.phase = phase;
  created.action.after = std::move(after);
  created.started = started;
  created.duration = duration;
  created.executed = true;
  return created;
}

model::Network one_task() {
  model::Network network;
  network.tasks.emplace_back();
  network.tasks.back().id = model::TaskId("a");
  network.tasks.back().component = model::ComponentName("demo::A");
  return network;
}

SwitchResult three_actions() {
  SwitchResult result;
  result.request = 7;
  result.to = model::NetworkName("manual");
  result.solve_time = 1ms;
  result.actions = {record(1, ActionKind::Cleanup, Phase::Prepare, {}, 1ms, 10ms),
                    record(2, ActionKind::Configure, Phase::Prepare, {1}, 14ms, 20ms),
                    record(3, ActionKind::Start, Phase::Commit, {2}, 40ms, 5ms)};
  return result;
}

model::Transition transition_of(const SwitchResult& result) {
  model::Transition transition;
  for (const auto& each : result.actions)
    transition.actions.push_back(each.action);
  return transition;
}

TEST(JournalEntry, HoldsDurationsAndWaitsOfActions) {
  const auto result = three_actions();
  const auto entry = journal_entry(result, one_task(), transition_of(result), {});
  EXPECT_EQ(entry.request, 7U);
  EXPECT_EQ(entry.to, "manual");
  EXPECT_EQ(entry.outcome, "done");
  EXPECT_EQ(entry.total, 45ms);
  ASSERT_EQ(entry.actions.size(), 3U);
  EXPECT_EQ(entry.actions[0].waited, 1ms);
  EXPECT_EQ(entry.actions[1].waited, 3ms);
  EXPECT_EQ(entry.actions[2].waited, 6ms);
  EXPECT_EQ(entry.actions[2].component, "demo::A");
  EXPECT_EQ(entry.actions[2].duration, 5ms);
  EXPECT_FALSE(entry.predicted);
}

TEST(JournalEntry, SeparatesTheWorkOfAnActionFromWaitingForOthersOfItsBatch) {
  auto result = three_actions();
  result.actions[1].took = 4ms;
  const auto entry = journal_entry(result, one_task(), transition_of(result), {});
  EXPECT_EQ(entry.actions[1].duration, 4ms);
  EXPECT_EQ(entry.actions[1].waited, 3ms + 16ms);
  EXPECT_EQ(entry.actions[2].waited, 6ms) << "since the reported end of its predecessor";
  EXPECT_EQ(entry.total, 45ms);
}

TEST(JournalEntry, TakesQuickActionsOfOneProcessAsSequential) {
  auto result = three_actions();
  for (std::size_t i = 0; i < 3; ++i) {
    result.actions[i] = record(static_cast<int>(i) + 1, ActionKind::Start, Phase::Commit, {}, 1ms, 2ms);
    result.actions[i].took = 100us;
  }
  const auto entry = journal_entry(result, one_task(), transition_of(result), {});
  for (const auto& action : entry.actions) {
    EXPECT_EQ(action.duration, 100us);
    EXPECT_EQ(action.waited, 1ms + 2ms - 300us);
  }
}

TEST(JournalEntry, PredictsFromEarlierDurations) {
  const auto result = three_actions();
  model::ActionTimes known;
  for (const auto& each :
       journal::duration_samples(journal_entry(result, one_task(), transition_of(result), {})).actions) {
    for (int i = 0; i < 20; ++i)
      known.actions[each.first].add(each.second);
  }
  const auto entry = journal_entry(result, one_task(), transition_of(result), known);
  ASSERT_TRUE(entry.predicted);
  EXPECT_NEAR(std::chrono::duration<double>(entry.predicted->total.typical).count(), 0.035, 0.002);
  EXPECT_NEAR(std::chrono::duration<double>(entry.predicted->commit.typical).count(), 0.005, 0.001);
}

TEST(JournalEntry, HoldsFailedAndSkippedActions) {
  auto result = three_actions();
  result.outcome = Outcome::Failed;
  result.error = fail(ErrorCode::HookFailed, "no map", "a");
  result.actions[1].error = result.error;
  result.actions[2].executed = false;
  const auto entry = journal_entry(result, one_task(), transition_of(result), {});
  EXPECT_EQ(entry.outcome, "failed");
  EXPECT_EQ(entry.error, "a: no map");
  EXPECT_EQ(entry.actions[1].outcome, "failed");
  EXPECT_EQ(entry.actions[1].error, "a: no map");
  EXPECT_EQ(entry.actions[2].outcome, "skipped");
  EXPECT_EQ(entry.total, 34ms);
}

TEST(JournalEntry, KeepsActionsOfAReplannedTransition) {
  auto result = three_actions();
  const auto transition = transition_of(result);
  result.actions.push_back(record(1, ActionKind::Stop, Phase::Commit, {}, 50ms, 2ms));
  const auto entry = journal_entry(result, one_task(), transition, {});
  ASSERT_EQ(entry.actions.size(), 4U);
  EXPECT_EQ(entry.actions[3].waited, Duration(0));
  EXPECT_EQ(entry.total, 52ms);
}

TEST(JournalEntry, HoldsWhatUndidTheTransitionAndWhenActionsEnded) {
  auto result = three_actions();
  result.outcome = Outcome::Cancelled;
  result.cancelled_by = "ann";
  result.duration = 90ms;
  result.undo.emplace();
  result.undo->restored = true;
  result.undo->actions = {record(1, ActionKind::Stop, Phase::Commit, {}, 60ms, 20ms)};
  const auto entry = journal_entry(result, one_task(), transition_of(result), {});
  EXPECT_EQ(entry.outcome, "cancelled");
  EXPECT_EQ(entry.undone, "restored");
  EXPECT_EQ(entry.cancelled_by, "ann");
  EXPECT_EQ(entry.lasted, 90ms);
  EXPECT_EQ(entry.total, 45ms);
  EXPECT_EQ(entry.actions[1].ended, 34ms);
  ASSERT_EQ(entry.undo_actions.size(), 1U);
  EXPECT_EQ(entry.undo_actions[0].label, "stop a");
  EXPECT_EQ(entry.undo_actions[0].ended, 80ms);
}

TEST(JournalEntry, ANetworkIsTheSameTextWhateverTheOrderOfItsParts) {
  model::Network network = one_task();
  network.tasks.push_back(network.tasks.front());
  network.tasks.back().id = model::TaskId("b");
  model::Network other = network;
  std::swap(other.tasks.front(), other.tasks.back());
  EXPECT_EQ(network_text(network), network_text(other));
  EXPECT_EQ(
      network_text(one_task()),
      R"({"tasks":[{"id":"a","component":"demo::A","state":"running","host":"","process":""}],"connections":[]})");
}

}  // namespace
}  // namespace segue::runtime
