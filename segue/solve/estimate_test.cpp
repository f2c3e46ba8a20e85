// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_sites.hpp>
#include <segue/solve/estimate.hpp>
#include <segue/solve/solve.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <support/random_transitions.hpp>

namespace segue::solve {
namespace {

using model::ActionKind;
using model::ActionTimes;
using model::Phase;
using model::TaskId;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

model::Action action(int id, ActionKind kind, const char* task, Phase phase, std::vector<int> after = {}) {
  model::Action created;
  created.id = id;
  created.kind = kind;
  created.what = model::TaskAction{TaskId(task)};
  created.phase = phase;
  created.after = std::move(after);
  return created;
}

/// Tasks a, b and c, each of a component of its own, in processes pa, pb and pc.
model::Network three_tasks() {
  model::Network network;
  for (const char* id : {"a", "b", "c"}) {
    model::Task task;
    task.id = TaskId(id);
    task.component = model::ComponentName(std::string("demo::") + id);
    network.tasks.push_back(task);
    model::Deployment process;
    process.process = model::ProcessName(std::string("p") + id);
    process.tasks = {{task.id, id}};
    network.deployments.push_back(process);
  }
  return network;
}

void measure(ActionTimes& times, const char* component, ActionKind kind, Duration duration, int count = 30) {
  for (int i = 0; i < count; ++i)
    times.actions[{component, kind, model::kLocalHost}].add(duration);
}

ActionTimes three_measured() {
  ActionTimes times;
  measure(times, "demo::a", ActionKind::Configure, 100ms);
  measure(times, "demo::b", ActionKind::Configure, 30ms);
  measure(times, "demo::c", ActionKind::Configure, 50ms);
  measure(times, "demo::a", ActionKind::Start, 10ms);
  measure(times, "demo::b", ActionKind::Start, 10ms);
  measure(times, "demo::c", ActionKind::Start, 40ms);
  return times;
}

/// Configure a, b, then c after b (prepare); start all (commit).
model::Transition six_actions() {
  model::Transition transition;
  transition.actions = {action(1, ActionKind::Configure, "a", Phase::Prepare),
                        action(2, ActionKind::Configure, "b", Phase::Prepare),
                        action(3, ActionKind::Configure, "c", Phase::Prepare, {2}),
                        action(4, ActionKind::Start, "a", Phase::Commit, {1}),
                        action(5, ActionKind::Start, "b", Phase::Commit, {2}),
                        action(6, ActionKind::Start, "c", Phase::Commit, {3, 5})};
  return transition;
}

void expect_near(const model::DurationRange& range, Duration expected) {
  EXPECT_NEAR(static_cast<double>(range.typical.count()), static_cast<double>(expected.count()), 1e6);
  // The range of constant durations is the error that the simulation leaves out.
  const double slack = 1e6 + 0.04 * static_cast<double>(expected.count());
  EXPECT_NEAR(static_cast<double>(range.low.count()), static_cast<double>(expected.count()), slack);
  EXPECT_NEAR(static_cast<double>(range.high.count()), static_cast<double>(expected.count()), slack);
}

TEST(Estimate, RunsPhasesSequentiallyAndActionsConcurrently) {
  const Estimate found = estimate(three_tasks(), six_actions(), three_measured());
  expect_near(found.of(Phase::Prepare), 100ms);
  expect_near(found.of(Phase::Commit), 50ms);
  expect_near(found.of(Phase::Retire), 0ms);
  expect_near(found.total, 150ms);
  EXPECT_EQ(found.never_measured, 0);
  EXPECT_THAT(found.critical_path, ElementsAre(1, 5, 6));
}

TEST(Estimate, OfAnEmptyTransitionIsZero) {
  EXPECT_EQ(typical_duration({}, {}, Phase::Prepare, {}, {}), Duration(0));
  const Estimate found = estimate({}, {}, {});
  EXPECT_EQ(found.total, model::DurationRange{});
  EXPECT_THAT(found.critical_path, IsEmpty());
}

TEST(TypicalDuration, PrefersWhatIsKnownToWhatWasLearned) {
  const auto phase = [](Phase which, const ActionTimes& times, std::vector<std::optional<Duration>> known) {
    const Duration found = typical_duration(three_tasks(), six_actions(), which, times, known);
    return std::chrono::duration_cast<std::chrono::milliseconds>(found + 500us);  // logarithms round
  };
  EXPECT_EQ(phase(Phase::Prepare, three_measured(), {}), 100ms) << "a, beside b and then c";
  EXPECT_EQ(phase(Phase::Prepare, three_measured(), {20ms}), 80ms) << "b and then c";
  EXPECT_EQ(phase(Phase::Prepare, three_measured(), {{}, 300ms, {}}), 350ms);
  EXPECT_EQ(phase(Phase::Commit, three_measured(), {1s, 1s, 1s}), 50ms);
  EXPECT_EQ(phase(Phase::Prepare, {}, {{}, 30ms, {}}), 30ms) << "what nobody measured takes no time";
}

TEST(Estimate, AddsUsualWaits) {
  ActionTimes times = three_measured();
  for (int i = 0; i < 30; ++i)
    times.waits.add(5ms);
  expect_near(estimate(three_tasks(), six_actions(), times).total, 165ms);
}

TEST(Estimate, RunsQuickActionsOfAProcessSequentially) {
  ActionTimes times;
  measure(times, "demo::a", ActionKind::Configure, 100us);
  model::Transition transition;
  for (int id = 1; id <= 100; ++id)
    transition.actions.push_back(action(id, ActionKind::Configure, "a", Phase::Prepare));
  expect_near(estimate(three_tasks(), transition, times).total, 10ms);
}

TEST(Estimate, IsDeterministic) {
  ActionTimes times = three_measured();
  measure(times, "demo::a", ActionKind::Configure, 300ms, 5);
  const auto once = estimate(three_tasks(), six_actions(), times);
  EXPECT_EQ(once, estimate(three_tasks(), six_actions(), times));
  EXPECT_LT(once.total.low, once.total.high);
}

TEST(Estimate, EstimatesUnmeasuredActionsFromOthersOfTheirKind) {
  ActionTimes times = three_measured();
  times.actions.erase({"demo::a", ActionKind::Configure, model::kLocalHost});
  const auto found = estimate(three_tasks(), six_actions(), times);
  EXPECT_EQ(found.never_measured, 1);
  EXPECT_GE(found.total.low, 100ms);
  EXPECT_LE(found.total.high, 400ms);
}

TEST(Estimate, PrefersOthersOnTheSameHost) {
  ActionTimes times;
  for (int i = 0; i < 30; ++i) {
    times.actions[{"demo::x", ActionKind::Configure, model::HostName("slow")}].add(10s);
    times.actions[{"demo::x", ActionKind::Configure, model::kLocalHost}].add(10ms);
  }
  model::Transition transition;
  transition.actions = {action(1, ActionKind::Configure, "a", Phase::Prepare)};
  EXPECT_LT(estimate(three_tasks(), transition, times).total.high, 100ms);
  times.actions.erase({"demo::x", ActionKind::Configure, model::kLocalHost});
  EXPECT_GT(estimate(three_tasks(), transition, times).total.low, 1s);
}

TEST(Estimate, IsWideWithoutMeasurements) {
  const auto found = estimate(three_tasks(), six_actions(), {});
  EXPECT_EQ(found.never_measured, 6);
  EXPECT_GT(found.total.high, 4 * found.total.low);
}

TEST(Estimate, TheRangeNarrowsWithMoreMeasurements) {
  const auto width = [](int count) {
    ActionTimes times;
    for (int i = 0; i < count; ++i) {
      measure(times, "demo::a", ActionKind::Configure, 80ms, 1);
      measure(times, "demo::a", ActionKind::Configure, 125ms, 1);
    }
    model::Transition transition;
    transition.actions = {action(1, ActionKind::Configure, "a", Phase::Prepare)};
    const auto range = estimate(three_tasks(), transition, times).total;
    return static_cast<double>(range.high.count()) / static_cast<double>(range.low.count());
  };
  EXPECT_GT(width(1), width(10));
}

TEST(ActionSites, DistinguishOldAndNewIncarnations) {
  model::Network current = three_tasks();
  model::Network target = three_tasks();
  target.deployments[0].process = model::ProcessName("elsewhere");
  target.connections = {{{TaskId("a"), "out"}, {TaskId("b"), "in"}, {}, {}}};
  current.connections = {{{TaskId("c"), "out"}, {TaskId("a"), "in"}, {}, {}}};
  const auto transition = diff(current, target, {});
  ASSERT_TRUE(transition);
  const auto sites = action_sites(current, *transition);
  ASSERT_EQ(sites.size(), transition->actions.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const auto& each = transition->actions[i];
    EXPECT_EQ(sites[i].key.kind, each.kind);
    EXPECT_EQ(sites[i].key.host, model::kLocalHost);
    if (each.kind == ActionKind::Stop || each.kind == ActionKind::Cleanup) {
      EXPECT_EQ(sites[i].process.str(), "pa");
    } else if (each.kind == ActionKind::Configure || each.kind == ActionKind::Start) {
      EXPECT_EQ(sites[i].process.str(), "elsewhere");
      EXPECT_EQ(sites[i].key.component, "demo::a");
    } else if (each.kind == ActionKind::Deploy) {
      EXPECT_EQ(sites[i].key.component, "segue");
    } else if (each.kind == ActionKind::Connect) {
      EXPECT_EQ(sites[i].key.component, model::kBetweenProcesses);
      EXPECT_EQ(sites[i].process.str(), "pb");
    }
  }
}

TEST(ActionSites, NameACallByItsOperation) {
  model::Transition transition;
  model::Action call;
  call.id = 1;
  call.kind = ActionKind::CallOperation;
  call.what = model::CallAction{TaskId("a"), "reset", {}};
  model::Action unknown = action(2, ActionKind::Stop, "nobody", Phase::Commit);
  transition.actions = {call, unknown};
  const auto sites = action_sites(three_tasks(), transition);
  EXPECT_EQ(sites[0].key.component, "demo::a.reset");
  EXPECT_EQ(sites[1].key.component, "");
}

}  // namespace
}  // namespace segue::solve
