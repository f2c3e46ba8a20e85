// SPDX-License-Identifier: Apache-2.0
#include "files_test_support.hpp"

namespace segue::testing {
namespace {

TEST_F(Files, DiffTakesSeveralControllersAtOnce) {
  write("beside.yaml", "network: beside\ntasks:\n  c: {component: \"demo::Odometry\"}\n");
  write("other.yaml",
        "network: other\ntasks:\n  a: {component: \"demo::Drive\", properties: {timeout: 3s}}\n");
  const auto both = json({"diff", "two.yaml", "two.yaml+beside.yaml"});
  EXPECT_EQ(both.find("to")->as_string(), "beside+two");
  EXPECT_EQ(both.find("counts")->find("start")->as_int(), 1) << "the other task runs on";
  EXPECT_TRUE(contains(segue({"diff", "two.yaml+beside.yaml", "-", "--svg"}).output, "<svg"));
  const auto apart = segue({"diff", "-", "two.yaml+other.yaml"});
  EXPECT_EQ(apart.status, 1);
  EXPECT_TRUE(contains(apart.errors, "these controllers cannot run at once")) << apart.errors;
  const auto missing = segue({"diff", "-", "two.yaml+three.yaml"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_TRUE(contains(missing.errors, "three.yaml")) << missing.errors;
}

TEST_F(Files, DiffCountsItsActions) {
  const auto transition = json({"diff", "one.yaml", "two.yaml"});
  EXPECT_EQ(transition.find("from")->as_string(), "one");
  EXPECT_EQ(transition.find("to")->as_string(), "two");
  EXPECT_EQ(transition.find("order")->as_string(), "seamless");
  const auto& actions = transition.find("actions")->as_list();
  const Value& counts = *transition.find("counts");
  EXPECT_EQ(counts.find("total")->as_int(), static_cast<std::int64_t>(actions.size()));
  EXPECT_EQ(*counts.find("stop"), Value(1));
  EXPECT_EQ(*counts.find("disconnect"), Value(1));
  EXPECT_EQ(*counts.find("cleanup"), Value(1));
  EXPECT_EQ(*counts.find("state_changes"), Value(2));
  EXPECT_EQ(json({"diff", "one.yaml", "two.yaml", "--order", "paper"}).find("order")->as_string(), "paper");
}

TEST_F(Files, DiffFromAndToTheEmptyNetwork) {
  const auto up = json({"diff", "-", "one.yaml"});
  EXPECT_EQ(*up.find("counts")->find("start"), Value(2));
  EXPECT_EQ(*up.find("counts")->find("connect"), Value(1));
  const auto down = json({"diff", "one.yaml", "empty"});
  EXPECT_EQ(*down.find("counts")->find("stop"), Value(2));
  const auto none = segue({"diff", "one.yaml", "one.yaml"});
  EXPECT_EQ(none.status, 0);
  EXPECT_TRUE(contains(none.output, "nothing to do")) << none.output;
}

TEST_F(Files, TextOfDiffIsGroupedByPhase) {
  const auto finished = segue({"diff", "two.yaml", "one.yaml"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_TRUE(contains(finished.output, "two -> one: ")) << finished.output;
  EXPECT_TRUE(contains(finished.output, "prepare (")) << finished.output;
  EXPECT_TRUE(contains(finished.output, "a.velocity -> b.velocity")) << finished.output;
  EXPECT_FALSE(contains(finished.output, "\x1b")) << "no colours but on a terminal";
  const auto graph = segue({"diff", "two.yaml", "one.yaml", "--dot"});
  EXPECT_EQ(graph.output.rfind("digraph", 0), 0U) << graph.output;
}

/// The number of occurrences of a text.
std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST_F(Files, DiffDrawsATimeline) {
  const auto total = static_cast<std::size_t>(
      json({"diff", "two.yaml", "one.yaml"}).find("counts")->find("total")->as_int());
  ASSERT_GT(total, 3U);
  for (const char* order : {"seamless", "paper"}) {
    const auto picture = segue({"diff", "two.yaml", "one.yaml", "--order", order, "--svg"});
    EXPECT_EQ(picture.status, 0) << picture.errors;
    EXPECT_EQ(picture.output.rfind("<svg ", 0), 0U) << picture.output;
    EXPECT_TRUE(contains(picture.output, "</svg>\n"));
    EXPECT_EQ(occurrences(picture.output, "<title>"), total) << "one bar for each action";
    EXPECT_TRUE(contains(picture.output, "commit")) << picture.output;
    EXPECT_TRUE(contains(picture.output, "a.velocity -&gt; b.velocity")) << picture.output;
    EXPECT_FALSE(contains(picture.output, "nan")) << picture.output;
  }
  const auto nothing = segue({"diff", "one.yaml", "one.yaml", "--svg"});
  EXPECT_EQ(nothing.status, 0);
  EXPECT_TRUE(contains(nothing.output, "nothing to do")) << nothing.output;
  EXPECT_EQ(segue({"diff", "two.yaml", "one.yaml", "--svg", "--dot"}).status, 2);
}

TEST_F(Files, TheGraphOfADiffHoldsItsPhasesAndItsCriticalPath) {
  const auto graph = segue({"diff", "two.yaml", "one.yaml", "--dot"});
  EXPECT_TRUE(contains(graph.output, "subgraph cluster_commit")) << graph.output;
  EXPECT_GT(occurrences(graph.output, "penwidth=3"), 1U) << graph.output;
}

TEST_F(Files, ForceKillsRemovedProcesses) {
  write("deployed.yaml",
        "network: deployed\ntasks: {a: {component: demo::Odometry}}\n"
        "deployments: {p: {tasks: [a]}}\n");
  const auto forced = json({"diff", "deployed.yaml", "empty", "--force"});
  const auto& actions = forced.find("actions")->as_list();
  ASSERT_EQ(actions.size(), 1U);
  EXPECT_EQ(*actions[0].find("kind"), Value("undeploy"));
  EXPECT_EQ(*actions[0].find("kill"), Value(true));
}

}  // namespace
}  // namespace segue::testing
