// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/dot.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "connection.hpp"
#include "models.hpp"

namespace segue::cli {

namespace {

using draw::dot_quoted;
using type::Value;

struct GraphOptions {
  std::string file;  ///< a network file; empty: the running robot
  bool dot = false;
  ModelSources sources;
};

struct GraphTask {
  std::string id;
  std::string component;
  std::string state;
  std::string process;  ///< "HOST/PROCESS"; empty: that of the runtime
};

struct GraphConnection {
  std::string from_task;
  std::string from_port;
  std::string to_task;
  std::string to_port;
  std::string policy;
};

struct TaskGraph {
  std::vector<GraphTask> tasks;
  std::vector<GraphConnection> connections;
};

/// "task.port", whose last part is the port.
std::pair<std::string, std::string> parts_of(const std::string& port) {
  const auto dot = port.rfind('.');
  return dot == std::string::npos ? std::pair{port, std::string()}
                                  : std::pair{port.substr(0, dot), port.substr(dot + 1)};
}

TaskGraph graph_of(const Value& status) {
  TaskGraph graph;
  for (const Value& task : list_at(status, "tasks")) {
    const std::string host = printable_at(task, "host");
    const std::string process = printable_at(task, "process");
    graph.tasks.push_back({printable_at(task, "id"), printable_at(task, "component"),
                           printable_at(task, "state_name"),
                           process.empty() || host.empty() ? process : host + "/" + process});
  }
  for (const Value& connection : list_at(status, "connections")) {
    auto [from_task, from_port] = parts_of(printable_at(connection, "from"));
    auto [to_task, to_port] = parts_of(printable_at(connection, "to"));
    graph.connections.push_back({from_task, from_port, to_task, to_port, printable_at(connection, "policy")});
  }
  return graph;
}

TaskGraph graph_of(const model::Network& network) {
  TaskGraph graph;
  for (const auto& task : network.tasks) {
    std::string process;
    for (const auto& deployment : network.deployments) {
      if (std::ranges::find(deployment.tasks, task.id, &model::Placement::task) == deployment.tasks.end())
        continue;
      const bool is_here = deployment.host == model::kLocalHost;
      process = (is_here ? "" : deployment.host.str() + "/") + deployment.process.str();
    }
    graph.tasks.push_back({task.id.str(), task.component.str(), std::string(to_string(task.state)), process});
  }
  for (const auto& connection : network.connections) {
    graph.connections.push_back({connection.from.task.str(), connection.from.port, connection.to.task.str(),
                                 connection.to.port, std::string(to_string(connection.policy.kind))});
  }
  return graph;
}

/// The tasks along the connections: those that nothing leads to first; of a loop the one that comes first.
std::vector<const GraphTask*> in_order_of_flow(const TaskGraph& graph) {
  std::vector<const GraphTask*> order;
  std::set<std::string> placed;
  const auto waits = [&](const GraphTask& task) {
    return std::ranges::any_of(graph.connections, [&](const GraphConnection& connection) {
      return connection.to_task == task.id && connection.from_task != task.id &&
             !placed.contains(connection.from_task);
    });
  };
  while (order.size() < graph.tasks.size()) {
    const auto left = [&](const GraphTask& task) { return !placed.contains(task.id); };
    auto next =
        std::ranges::find_if(graph.tasks, [&](const auto& task) { return left(task) && !waits(task); });
    if (next == graph.tasks.end()) next = std::ranges::find_if(graph.tasks, left);
    placed.insert(next->id);
    order.push_back(&*next);
  }
  return order;
}

/// "scan -> map.scan, guard.scan", one line a port.
std::string outputs_text(const TaskGraph& graph, const std::string& task) {
  std::map<std::string, std::string> readers;
  for (const auto& connection : graph.connections) {
    if (connection.from_task != task) continue;
    std::string& text = readers[connection.from_port];
    text += (text.empty() ? "" : ", ") + connection.to_task + "." + connection.to_port;
    if (connection.policy != "data") text += " (" + connection.policy + ")";
  }
  std::string text;
  for (const auto& [port, all] : readers)
    text += "  " + port + " -> " + all + '\n';
  return text;
}

std::string text_of(const TaskGraph& graph) {
  std::string text;
  for (const GraphTask* task : in_order_of_flow(graph)) {
    text += coloured(Colour::Bold, task->id) + "  " + task->component + ", " + task->state;
    if (!task->process.empty()) text += ", in " + task->process;
    text += '\n' + outputs_text(graph, task->id);
  }
  return text.empty() ? "no tasks\n" : text;
}

/// For Graphviz: a box for each task, a frame for each process.
std::string dot_of(const TaskGraph& graph) {
  std::map<std::string, std::vector<const GraphTask*>> processes;
  for (const GraphTask& task : graph.tasks)
    processes[task.process].push_back(&task);
  std::string text =
      "digraph network {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n"
      "  edge [fontname=\"sans-serif\", fontsize=10];\n";
  for (const auto& [process, tasks] : processes) {
    const std::string indent = process.empty() ? "  " : "    ";
    if (!process.empty())
      text += fmt::format("  subgraph {} {{\n    label={};\n", dot_quoted("cluster_" + process),
                          dot_quoted(process));
    for (const GraphTask* task : tasks)
      text += fmt::format("{}{} [label={}];\n", indent, dot_quoted(task->id),
                          dot_quoted(task->id + "\n" + task->component));
    if (!process.empty()) text += "  }\n";
  }
  for (const auto& connection : graph.connections) {
    text += fmt::format("  {} -> {} [label={}];\n", dot_quoted(connection.from_task),
                        dot_quoted(connection.to_task),
                        dot_quoted(connection.from_port + " -> " + connection.to_port));
  }
  return text + "}\n";
}

Value to_value(const TaskGraph& graph) {
  Value::List tasks;
  for (const GraphTask* task : in_order_of_flow(graph)) {
    tasks.push_back(Value::map({{"id", task->id},
                                {"component", task->component},
                                {"state", task->state},
                                {"process", task->process}}));
  }
  Value::List connections;
  for (const auto& connection : graph.connections) {
    connections.push_back(Value::map({{"from", connection.from_task + "." + connection.from_port},
                                      {"to", connection.to_task + "." + connection.to_port},
                                      {"policy", connection.policy}}));
  }
  return Value::map({{"tasks", std::move(tasks)}, {"connections", std::move(connections)}});
}

int show_graph(const TaskGraph& graph, const GraphOptions& options, const Context& context) {
  if (options.dot) {
    print_content(dot_of(graph));
  } else if (context.json()) {
    print_json(to_value(graph));
  } else {
    print(text_of(graph));
  }
  return kDone;
}

int show_file(const GraphOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  const auto network = load_valid_network(options.file, catalog, diagnostics);
  if (!network || diagnostics.has_errors()) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  return show_graph(graph_of(*network), options, context);
}

}  // namespace

void add_graph(Verb& app, Context& context) {
  const auto options = std::make_shared<GraphOptions>();
  Verb& verb = add_verb(
      app, context, "graph", "who is connected with whom, in a running robot or a network file",
      "  segue graph                               # of the running robot\n"
      "  segue graph controllers/explore.yaml\n  segue graph --dot | dot -Tsvg > graph.svg  # with Graphviz",
      [options, &context] {
        if (!options->file.empty()) return show_file(*options, context);
        return with_robot(context, [&](control::RobotService& robot) {
          const auto status = robot.status();
          return status ? show_graph(graph_of(*status), *options, context) : failed(context, status.error());
        });
      });
  verb.option("NETWORK", options->file,
              "a network file, or several: a.yaml+b.yaml (default: what the robot runs)");
  verb.flag("--dot", options->dot, "print it for Graphviz");
  add_model_options(verb, options->sources);
  add_robot_option(verb, context);
}

}  // namespace segue::cli
