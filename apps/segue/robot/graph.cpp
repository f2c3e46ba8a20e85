// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/task_graph.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "../connection.hpp"
#include "../models.hpp"

namespace segue::cli {

namespace {

using draw::TaskGraph;
using type::Value;

struct GraphOptions {
  std::string file;  ///< a network file; empty: the running robot
  bool dot = false;
  bool svg = false;
  ModelSources sources;
};

/// "task.port", whose last part is the port.
std::pair<std::string, std::string> parts_of(const std::string& port) {
  const auto dot = port.rfind('.');
  return dot == std::string::npos ? std::pair{port, std::string()}
                                  : std::pair{port.substr(0, dot), port.substr(dot + 1)};
}

TaskGraph graph_of(const Value& status) {
  TaskGraph graph;
  graph.name = printable_at(status, "robot");
  for (const Value& task : list_at(status, "tasks")) {
    const std::string host = printable_at(task, "host");
    const std::string process = printable_at(task, "process");
    graph.tasks.push_back({printable_at(task, "id"), printable_at(task, "component"),
                           printable_at(task, "state_name"),
                           process.empty() || host.empty() ? process : host + "/" + process});
  }
  const auto is_there = [&](const std::string& id) {
    return std::ranges::find(graph.tasks, id, &TaskGraph::Task::id) != graph.tasks.end();
  };
  for (const Value& connection : list_at(status, "connections")) {
    auto [from_task, from_port] = parts_of(printable_at(connection, "from"));
    auto [to_task, to_port] = parts_of(printable_at(connection, "to"));
    if (!is_there(from_task) || !is_there(to_task)) continue;
    graph.connections.push_back({from_task, from_port, to_task, to_port, printable_at(connection, "policy")});
  }
  return graph;
}

TaskGraph graph_of(const model::Network& network) {
  TaskGraph graph;
  graph.name = network.name.str();
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

/// Notes which of these inputs of the task no connection leads to.
void note_unwritten(const std::vector<std::string>& inputs, const TaskGraph& graph, TaskGraph::Task& task) {
  for (const std::string& input : inputs) {
    const auto leads_there = [&](const TaskGraph::Connection& one) {
      return one.to_task == task.id && one.to_port == input;
    };
    if (std::ranges::none_of(graph.connections, leads_there)) task.unwritten.push_back(input);
  }
}

/// A task that has gone in the meantime has none.
void find_unwritten(control::RobotService& robot, TaskGraph& graph) {
  for (TaskGraph::Task& task : graph.tasks) {
    const auto details = robot.task(task.id);
    if (!details) continue;
    note_unwritten(port_names(*details, "input"), graph, task);
  }
}

void find_unwritten(const model::ComponentCatalog& catalog, TaskGraph& graph) {
  for (TaskGraph::Task& task : graph.tasks) {
    const auto* component = catalog.find(model::ComponentName(task.component));
    if (component == nullptr) continue;
    std::vector<std::string> inputs;
    for (const model::PortModel& port : component->ports) {
      if (port.direction == model::Direction::Input && !port.dynamic) inputs.push_back(port.name);
    }
    note_unwritten(inputs, graph, task);
  }
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
  for (const std::uint32_t index : draw::order_of_flow(graph)) {
    const TaskGraph::Task& task = graph.tasks[index];
    text += coloured(Colour::Bold, task.id) + "  " + task.component + ", " + task.state;
    if (!task.process.empty()) text += ", in " + task.process;
    text += '\n' + outputs_text(graph, task.id);
    if (!task.unwritten.empty()) text += "  nothing writes to " + listed(task.unwritten) + '\n';
  }
  return text.empty() ? "no tasks\n" : text;
}

Value to_value(const TaskGraph& graph) {
  Value::List tasks;
  for (const std::uint32_t index : draw::order_of_flow(graph)) {
    const TaskGraph::Task& task = graph.tasks[index];
    tasks.push_back(Value::map({{"id", task.id},
                                {"component", task.component},
                                {"state", task.state},
                                {"process", task.process},
                                {"unwritten", Value::List(task.unwritten.begin(), task.unwritten.end())}}));
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
    print_content(draw::to_dot(graph));
  } else if (options.svg) {
    print_content(draw::to_svg(graph));
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
  TaskGraph graph = graph_of(*network);
  find_unwritten(catalog, graph);
  return show_graph(graph, options, context);
}

}  // namespace

void add_graph(Verb& app, Context& context) {
  const auto options = std::make_shared<GraphOptions>();
  Verb& verb = add_verb(
      app, context, "graph", "who is connected with whom, in a running robot or a network file",
      "  segue graph                               # of the running robot\n"
      "  segue graph controllers/explore.yaml\n  segue graph --svg > graph.svg              # as a drawing",
      [options, &context] {
        if (!options->file.empty()) return show_file(*options, context);
        return with_robot(context, [&](control::RobotService& robot) {
          const auto status = robot.status();
          if (!status) return failed(context, status.error());
          TaskGraph graph = graph_of(*status);
          find_unwritten(robot, graph);
          return show_graph(graph, *options, context);
        });
      });
  verb.option("NETWORK", options->file,
              "a network file, or several: a.yaml+b.yaml (default: what the robot runs)");
  const Option dot = verb.flag("--dot", options->dot, "print it for Graphviz");
  verb.flag("--svg", options->svg, "draw it").excludes(dot);
  add_model_options(verb, options->sources);
  add_robot_option(verb, context);
}

}  // namespace segue::cli
