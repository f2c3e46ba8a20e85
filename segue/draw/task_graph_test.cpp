// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/task_graph.hpp>

#include <gmock/gmock.h>

namespace segue::draw {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TaskGraph::Task task(const std::string& id, const std::string& process = "") {
  return {id, "demo::" + id, "running", process, {}};
}

TaskGraph rover() {
  TaskGraph graph;
  graph.name = "rover";
  graph.tasks = {task("guard"), task("drive"), task("odometry", "motion"), task("laser", "a<b")};
  graph.connections = {{"laser", "scan", "guard", "scan", "data"},
                       {"drive", "wheels", "odometry", "wheels", "buffer"},
                       {"odometry", "pose", "guard", "pose", "data"},
                       {"guard", "velocity", "drive", "set_point", "data"}};
  return graph;
}

TEST(TaskGraph, IsOrderedAlongTheConnections) {
  EXPECT_THAT(order_of_flow(rover()), ElementsAre(3, 0, 1, 2)) << "of the loop, the first of the graph";
  EXPECT_THAT(order_of_flow({}), ElementsAre());
  TaskGraph itself{"", {task("a")}, {{"a", "out", "a", "in", "data"}}};
  EXPECT_THAT(order_of_flow(itself), ElementsAre(0));
}

TEST(TaskGraph, OrdersManyTasksAtOnce) {
  TaskGraph graph;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    graph.tasks.push_back(task(std::to_string(i)));
    if (i > 0) graph.connections.push_back({std::to_string(i), "out", std::to_string(i - 1), "in", "data"});
  }
  const auto order = order_of_flow(graph);
  ASSERT_EQ(order.size(), 3000U);
  EXPECT_EQ(order.front(), 2999U);
  EXPECT_EQ(order.back(), 0U);
}

TEST(TaskGraph, HasAClusterForEachProcessInGraphviz) {
  const std::string dot = to_dot(rover());
  EXPECT_THAT(dot, HasSubstr("subgraph \"cluster_motion\" {\n    label=\"motion\";\n    \"odometry\""));
  EXPECT_THAT(dot, HasSubstr("  \"laser\" -> \"guard\" [label=\"scan -> scan\"];\n"));
}

TEST(TaskGraph, IsDrawn) {
  const std::string svg = to_svg(rover());
  EXPECT_THAT(svg, HasSubstr("laser.scan -&gt; guard.scan (data)"));
  EXPECT_THAT(svg, HasSubstr("wheels (buffer)"));
  EXPECT_THAT(svg, HasSubstr("set_point"));
  EXPECT_THAT(svg, HasSubstr("closes a loop"));
  EXPECT_THAT(svg, HasSubstr("a&lt;b"));
  EXPECT_THAT(svg, Not(HasSubstr("a<b")));
  TaskGraph tree = rover();
  tree.connections.pop_back();
  EXPECT_THAT(to_svg(tree), Not(HasSubstr("closes a loop")));
  EXPECT_THAT(to_svg({}), HasSubstr("0 tasks"));
}

}  // namespace
}  // namespace segue::draw
