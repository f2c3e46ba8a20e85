// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/task_graph.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <queue>

#include <segue/draw/dot.hpp>

namespace segue::draw {

namespace {

/// By task: those that it writes to, and from how many others it reads.
struct Flow {
  std::vector<std::vector<std::uint32_t>> readers;
  std::vector<std::uint32_t> writers;
};

Flow flow_of(const TaskGraph& graph) {
  std::map<std::string_view, std::uint32_t> index;
  for (const TaskGraph::Task& task : graph.tasks)
    index.emplace(task.id, static_cast<std::uint32_t>(index.size()));
  Flow flow{std::vector<std::vector<std::uint32_t>>(graph.tasks.size()),
            std::vector<std::uint32_t>(graph.tasks.size())};
  for (const TaskGraph::Connection& connection : graph.connections) {
    const std::uint32_t from = index.at(connection.from_task);
    const std::uint32_t to = index.at(connection.to_task);
    if (from == to) continue;
    flow.readers[from].push_back(to);
    ++flow.writers[to];
  }
  return flow;
}

}  // namespace

std::vector<std::uint32_t> order_of_flow(const TaskGraph& graph) {
  Flow flow = flow_of(graph);
  const auto count = static_cast<std::uint32_t>(graph.tasks.size());
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> ready;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (flow.writers[i] == 0) ready.push(i);
  }
  std::vector<std::uint32_t> order;
  std::vector<bool> placed(count);
  std::uint32_t first_left = 0;
  while (order.size() < count) {
    std::uint32_t next = 0;
    if (ready.empty()) {
      while (placed[first_left])
        ++first_left;
      next = first_left;
    } else {
      next = ready.top();
      ready.pop();
      if (placed[next]) continue;
    }
    placed[next] = true;
    order.push_back(next);
    for (const std::uint32_t reader : flow.readers[next]) {
      if (--flow.writers[reader] == 0 && !placed[reader]) ready.push(reader);
    }
  }
  return order;
}

std::string to_dot(const TaskGraph& graph) {
  std::map<std::string, std::vector<const TaskGraph::Task*>> processes;
  for (const TaskGraph::Task& task : graph.tasks)
    processes[task.process].push_back(&task);
  std::string text =
      "digraph network {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n"
      "  edge [fontname=\"sans-serif\", fontsize=10];\n";
  const auto out = std::back_inserter(text);
  if (!graph.name.empty()) fmt::format_to(out, "  label={};\n", dot_quoted(graph.name));
  for (const auto& [process, tasks] : processes) {
    const std::string indent = process.empty() ? "  " : "    ";
    if (!process.empty()) {
      fmt::format_to(out, "  subgraph {} {{\n    label={};\n", dot_quoted("cluster_" + process),
                     dot_quoted(process));
    }
    for (const TaskGraph::Task* task : tasks)
      fmt::format_to(out, "{}{} [label={}];\n", indent, dot_quoted(task->id),
                     dot_quoted(task->id + "\n" + task->component));
    if (!process.empty()) text += "  }\n";
  }
  for (const TaskGraph::Connection& connection : graph.connections) {
    fmt::format_to(out, "  {} -> {} [label={}];\n", dot_quoted(connection.from_task),
                   dot_quoted(connection.to_task),
                   dot_quoted(connection.from_port + " -> " + connection.to_port));
  }
  return text + "}\n";
}

}  // namespace segue::draw
