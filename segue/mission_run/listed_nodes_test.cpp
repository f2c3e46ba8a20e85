// SPDX-License-Identifier: Apache-2.0
// Lists and drawings of a concurrent run show the actions that count, whatever the plan consists of besides.
#include <segue/base/file.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAreArray;

/// Its plan has a join of the ways to `look`, copies of the values of `n`, a reader of the global variable
/// and a begin of `grasp`. The loop goes on until the third answer; the rounds that planning expects never
/// come.
constexpr const char* kForm = R"j(mission: form
actions:
  ask: {pure: true, outcomes: [left, right, away], run: {simulated: {duration: 2ms, outcomes: [left]}}}
  turn: {outputs: {n: int}, effects: ["+turned()"], run: {simulated: {duration: 3ms, outputs: {n: 1}}}}
  look: {pure: true, inputs: {n: int, g: int}, outputs: {pose: int}, run: {simulated: {duration: 4ms, outputs: {pose: 7}}}}
  reach: {inputs: {pose: int}, resources: [{block: arm}], run: {simulated: {duration: 2ms}}}
  again: {effects: ["-turned()"], outcomes: [more, enough], expect: {outcome: more}, run: {callback: again}}
globals: {g: {type: int, default: 5}}
start: ask
flows:
  - left.n -> look.n
  - right.n -> look.n
  - look.pose -> grasp.pose
states:
  ask: {on: {left: left, right: right, away: again}}
  left: {action: turn, on: {success: look}}
  right: {action: turn, on: {success: look}}
  look: {inputs: {g: $g}, on: {success: grasp}}
  grasp:
    resources: [{block: arm}]
    inputs: {pose: int}
    start: reach
    flows: [inputs.pose -> reach.pose]
    states:
      reach: {on: {success: return success}}
    on: {success: again}
  again: {on: {more: ask, enough: return success}}
)j";

class ListedNodes : public ::testing::Test {
 protected:
  ListedNodes()
      : file_(std::filesystem::temp_directory_path() / ("listed_" + std::to_string(::getpid()) + ".yaml")) {}
  ~ListedNodes() override { std::filesystem::remove(file_); }

  std::unique_ptr<FinishedRun> run(const std::string& text, RunMode mode, RunClock clock) const {
    EXPECT_TRUE(write_file(file_.string(), text));
    const auto plan = LoadedMission::load(file_).value();
    RunRequest request;
    request.mode = std::move(mode);
    request.clock = clock;
    request.runners.add("again", [rounds = std::make_shared<int>(0)](mission::ActionCall& call) {
      return mission::Ending{*call.outcome(++*rounds < 3 ? "more" : "enough"), {}};
    });
    auto ended = plan.run(request);
    EXPECT_TRUE(ended);
    return std::move(*ended);
  }

  const std::filesystem::path file_;
};

/// The names of the executions that count, sorted. Others were speculative and discarded, which on the real
/// clock is a matter of luck.
std::vector<std::string> on_the_path(const FinishedRun& run) {
  std::vector<std::string> names;
  for (const RunRow& row : run.rows()) {
    EXPECT_TRUE(row.started) << row.name << " was planned, but never reached";
    if (row.status == task_network::NodeStatus::Done) names.push_back(row.name.substr(0, row.name.find('#')));
  }
  std::ranges::sort(names);
  return names;
}

TEST_F(ListedNodes, AreTheSameInBothModesAndOnBothClocks) {
  const auto expected = on_the_path(*run(kForm, Sequential{}, RunClock::Virtual));
  ASSERT_EQ(expected.size(), 15U);
  for (const auto clock : {RunClock::Virtual, RunClock::Real}) {
    const auto concurrent = run(kForm, Concurrent{}, clock);
    EXPECT_THAT(on_the_path(*concurrent), ElementsAreArray(expected));
    EXPECT_EQ(concurrent->overview().actions, expected.size());
    EXPECT_EQ(concurrent->gantt().nodes.size(), concurrent->rows().size());
    EXPECT_EQ(concurrent->to_value().find("nodes")->as_list().size(), concurrent->rows().size());
  }
}

/// `look` waits for the reader of the global variable and for a join, and `reach` for the begin of its
/// container.
TEST_F(ListedNodes, WaitForActionsOnly) {
  const auto concurrent = run(kForm, Concurrent{}, RunClock::Virtual);
  std::map<std::string, std::string> waited_for;
  for (const RunRow& row : concurrent->rows())
    waited_for[row.name] = row.waited_for;
  EXPECT_EQ(waited_for.at("look"), "data n of left");
  EXPECT_EQ(waited_for.at("grasp/reach"), "data pose of look");
  const draw::Gantt& gantt = concurrent->gantt();
  std::size_t waits = 0;
  for (const auto& node : gantt.nodes) {
    for (const task_network::Wait& wait : node.waits) {
      ++waits;
      ASSERT_LT(task_network::index(wait.node), gantt.nodes.size()) << node.name;
      EXPECT_LE(gantt.nodes[task_network::index(wait.node)].bars.size(), 2U);
    }
  }
  EXPECT_GT(waits, gantt.nodes.size() / 2);
  EXPECT_TRUE(std::ranges::any_of(gantt.nodes, &draw::Gantt::Node::critical));
}

TEST_F(ListedNodes, ShowAContainerThatCouldNotBegin) {
  std::string text(kForm);
  text.insert(text.find("    start: reach"), "    preconditions: [\"!turned()\"]\n");
  const auto failed = run(text, Concurrent{}, RunClock::Virtual);
  EXPECT_EQ(failed->overview().outcome, "aborted");
  EXPECT_EQ(failed->rows().back().name, "grasp");
  EXPECT_EQ(failed->rows().back().status, task_network::NodeStatus::Failed);
}

}  // namespace
}  // namespace segue::mission_run
