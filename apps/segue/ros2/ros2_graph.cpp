// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "../output.hpp"
#include "ros2_components.hpp"
#include "ros2_robot.hpp"
#include "ros2_system.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct DescribeOptions {
  Ros2SystemOptions system;
  std::vector<std::string> nodes;
  bool all = false;
  std::string types;  ///< a folder; empty: they are not asked for
  std::string model;  ///< a file for the nodes as tasks, or "-"; empty: they are shown
};

std::string process_text(const Value& node) {
  const Value* process = node.find("process");
  if (process == nullptr) return {};
  const std::string pid = one_line(*process->find("pid"));
  if (process->find("package") != nullptr)
    return fmt::format("{} {} ({})", printable_at(*process, "package"), printable_at(*process, "executable"),
                       pid);
  const auto& words = list_at(*process, "command");
  const std::string program =
      words.empty() ? "" : std::filesystem::path(words.front().as_string()).filename();
  return fmt::format("{} ({})", program, pid);
}

std::string count_at(const Value& node, std::string_view key) {
  return std::to_string(list_at(node, key).size());
}

/// Of a component, the name of its container.
std::string container_name(const Value& node) {
  const Value* container = node.find("container");
  return container == nullptr ? std::string() : printable_at(*container, "name");
}

void print_nodes(const Value::List& nodes) {
  using enum Table::Align;
  const bool has_components =
      std::ranges::any_of(nodes, [](const Value& node) { return node.find("container") != nullptr; });
  std::vector<Table::Column> columns = {
      {"NODE"},           {"MANAGED"}, {"PUBLISHES", Right}, {"SUBSCRIBES", Right}, {"SERVICES", Right},
      {"ACTIONS", Right}, {"PROCESS"}};
  if (has_components) columns.insert(columns.end() - 1, {"CONTAINER"});
  Table table(columns);
  for (const Value& node : nodes) {
    std::vector<std::string> cells = {printable_at(node, "name"),
                                      node.find("managed")->as_bool() ? "yes" : "",
                                      count_at(node, "publishers"),
                                      count_at(node, "subscriptions"),
                                      count_at(node, "services"),
                                      count_at(node, "actions"),
                                      process_text(node)};
    if (has_components) cells.insert(cells.end() - 1, container_name(node));
    table.add(std::move(cells));
  }
  print(table.text());
}

int list_nodes(const Ros2SystemOptions& options, const Context& context) {
  const auto seen = look_at_ros2(options, Value::map({{"containers", true}}));
  if (!seen) return failed(context, seen.error());
  if (context.json()) {
    print_json(*seen->find("nodes"));
  } else {
    print_nodes(list_at(*seen, "nodes"));
  }
  print_problems(*seen);
  return kDone;
}

/// "/words: /listener gets nothing from /voice: reliability: best_effort is offered, reliable is requested"
void print_mismatches(const Value& topic) {
  const auto node = [](const Value& mismatch, std::string_view key) {
    const std::string name = printable_at(mismatch, key);
    return name.empty() ? "(not of a node)" : name;
  };
  for (const Value& one : list_at(topic, "mismatches")) {
    std::vector<std::string> reasons;
    for (const Value& reason : list_at(one, "reasons"))
      reasons.push_back(printable(reason.as_string()));
    print(fmt::format("{}: {} gets nothing from {}: {}\n", printable_at(topic, "topic"),
                      node(one, "subscription"), node(one, "publisher"), fmt::join(reasons, "; ")));
  }
}

struct TopicsOptions {
  Ros2SystemOptions system;
  std::vector<std::string> topics;  ///< empty: all
};

/// Those that are named, in that order; all where none are.
Result<Value::List> choose_topics(const Value::List& seen, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return seen;
  std::vector<std::string> names;
  for (const Value& topic : seen)
    names.push_back(topic.find("topic")->as_string());
  Value::List chosen;
  for (const std::string& name : wanted) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      return fail(ErrorCode::NotFound, "no topic " + quote(name) +
                                           did_you_mean_or_list(name, names, "there are") +
                                           (names.empty() ? "; no topic was found at all" : ""));
    chosen.push_back(seen[static_cast<std::size_t>(found - names.begin())]);
  }
  return chosen;
}

int list_topics(const TopicsOptions& options, const Context& context) {
  const auto seen = look_at_ros2(options.system, Value::map({}));
  const auto topics = seen ? choose_topics(list_at(*seen, "topics"), options.topics) : seen.error();
  if (!topics) return failed(context, topics.error());
  if (context.json()) {
    print_json(Value(*topics));
    return kDone;
  }
  Table table({{"TOPIC"}, {"TYPE"}, {"PUBLISHERS"}, {"SUBSCRIPTIONS"}});
  for (const Value& topic : *topics)
    table.add({printable_at(topic, "topic"), joined_names(*topic.find("types")),
               joined_names(*topic.find("publishers")), joined_names(*topic.find("subscriptions"))});
  print(table.text());
  for (const Value& topic : *topics)
    print_mismatches(topic);
  return kDone;
}

std::string quality_text(const Value& quality) {
  std::string text;
  for (const auto& [name, value] : quality.as_map()) {
    const bool is_word = name == "reliability" || name == "durability" || name == "liveliness";
    text += (text.empty() ? "" : ", ") + (is_word ? value.as_string() : name + " " + value.as_string());
  }
  return text;
}

/// The table with a title, indented; nothing where it has no lines.
void print_section(const Value& node, const std::string& key, const std::string& title,
                   std::vector<Table::Column> columns,
                   const std::function<std::vector<std::string>(const Value&)>& cells) {
  const auto& list = list_at(node, key);
  if (list.empty()) return;
  Table table(std::move(columns));
  for (const Value& one : list)
    table.add(cells(one));
  print('\n' + coloured(Colour::Bold, title) + '\n' + table.text());
}

std::string limits_text(const Value& parameter) {
  std::string text = parameter.find("read_only")->as_bool() ? "read-only" : "";
  const auto add = [&](const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : ", ") + more;
  };
  if (const Value* range = parameter.find("range")) {
    add(fmt::format("{} to {}", one_line(*range->find("from")), one_line(*range->find("to"))));
    if (number_at(*range, "step") != 0) add("step " + one_line(*range->find("step")));
  }
  add(printable_at(parameter, "constraints"));
  return text;
}

void print_node(const Value& node) {
  std::string about = node.find("managed")->as_bool() ? "managed" : "";
  if (const std::string state = printable_at(node, "state"); !state.empty()) about += ", " + state;
  print(coloured(Colour::Bold, printable_at(node, "name")) + (about.empty() ? "" : " (" + about + ")") +
        '\n');
  if (const std::string process = process_text(node); !process.empty()) print("process: " + process + '\n');
  if (const Value* container = node.find("container"))
    print(fmt::format("container: {}, component {}: {}\n", container_name(node),
                      one_line(*container->find("id")), plugin_text(*container)));
  if (node.find("components") != nullptr) {
    print_section(node, "components", "Components", {{"ID"}, {"NODE"}, {"PLUGIN"}}, [](const Value& one) {
      return std::vector{one_line(*one.find("id")), printable_at(one, "name"), plugin_text(one)};
    });
  }
  for (const auto& [key, title] :
       {std::pair{"publishers", "Publishers"}, {"subscriptions", "Subscriptions"}}) {
    print_section(node, key, title, {{"TOPIC"}, {"TYPE"}, {"QUALITY"}}, [](const Value& topic) {
      return std::vector{printable_at(topic, "topic"), printable_at(topic, "type"),
                         quality_text(*topic.find("quality"))};
    });
  }
  for (const auto& [key, title] : {std::pair{"services", "Services"},
                                   {"clients", "Calls services"},
                                   {"actions", "Actions"},
                                   {"action_clients", "Uses actions"}}) {
    print_section(node, key, title, {{"NAME"}, {"TYPE"}}, [](const Value& one) {
      return std::vector{printable_at(one, "name"), printable_at(one, "type")};
    });
  }
  print_section(node, "parameters", "Parameters", {{"NAME"}, {"VALUE"}, {"KIND"}, {"LIMITS"}, {"MEANING"}},
                [](const Value& one) {
                  return std::vector{printable_at(one, "name"), one_line(*one.find("value")),
                                     printable_at(one, "kind"), limits_text(one),
                                     printable_at(one, "description")};
                });
}

/// In words: that there are several nodes of the name, and which parts its description lacks.
std::vector<std::string> notes_of(const Value& node) {
  std::vector<std::string> notes;
  const std::string name = printable_at(node, "name");
  if (number_at(node, "copies") > 1)
    notes.push_back(fmt::format("{} nodes have the name {}", number_at(node, "copies"), name));
  if (const double unseen = number_at(node, "unseen_endpoints"); unseen > 0)
    notes.push_back(
        fmt::format("{}: {} of its topics or services have not been found in time (--wait)", name, unseen));
  for (const Value& problem : list_at(node, "problems"))
    notes.push_back(name + ": " + problem.as_string());
  return notes;
}

/// Says on standard error what could not be written.
Result<void> write_types(const std::vector<Value>& nodes, const std::string& folder) {
  std::map<std::string, std::string> written;
  for (const Value& node : nodes) {
    for (const auto& [path, text] : node.find("files")->as_map()) {
      const auto [known, is_new] = written.emplace(path, text.as_string());
      if (!is_new && known->second != text.as_string())
        print_note(fmt::format("{} has another {} than the node before, which is kept",
                               printable_at(node, "name"), path));
      if (!is_new) continue;
      const std::filesystem::path file = std::filesystem::path(folder) / path;
      std::error_code problem;
      std::filesystem::create_directories(file.parent_path(), problem);
      if (problem) return system_error(file.parent_path().string(), problem.value());
      if (auto done = write_file(file, text.as_string()); !done) return done;
    }
  }
  print_note("wrote " + counted(written.size(), "file") + " to " + folder);
  return {};
}

Result<void> write_tasks(const std::vector<Value>& nodes, const std::string& file) {
  const std::string text = ros2_tasks(nodes);
  if (file != "-") return write_file(file, text);
  print(text);
  return {};
}

void show(const std::vector<Value>& nodes, const Context& context) {
  if (context.json()) return print_json(Value(Value::List(nodes.begin(), nodes.end())));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i > 0) print("\n\n");
    print_node(nodes[i]);
  }
}

int describe(const DescribeOptions& options, const Context& context) {
  const auto seen = look_at_ros2(
      options.system, Value::map({{"all", options.all},
                                  {"nodes", Value(Value::List(options.nodes.begin(), options.nodes.end()))},
                                  {"types", !options.types.empty()}}));
  if (!seen) return failed(context, seen.error());
  std::vector<Value> nodes;
  for (const Value& node : list_at(*seen, "nodes")) {
    if (node.find("problems") != nullptr) nodes.push_back(node);
  }
  if (!options.types.empty()) {
    if (const auto done = write_types(nodes, options.types); !done) return failed(context, done.error());
  }
  if (options.model.empty()) {
    show(nodes, context);
    if (context.json()) return kDone;
  } else if (const auto done = write_tasks(nodes, options.model); !done) {
    return failed(context, done.error());
  }
  for (const Value& node : nodes) {
    for (const std::string& note : notes_of(node))
      print_note(note);
  }
  print_problems(*seen);
  return kDone;
}

}  // namespace

void add_ros2_graph(Verb& ros2, Context& context) {
  const auto options = std::make_shared<DescribeOptions>();
  Verb& nodes = add_verb(ros2, context, "nodes", "list the nodes that run",
                         "  segue ros2 nodes\n  segue ros2 nodes --domain 7 --wait 10s",
                         [options, &context] { return list_nodes(options->system, context); });
  add_ros2_system_options(nodes, options->system, false);
  const auto chosen = std::make_shared<TopicsOptions>();
  Verb& topics =
      add_verb(ros2, context, "topics", "list the topics of nodes that run, with the nodes on both sides",
               "  segue ros2 topics\n  segue ros2 topics /scan",
               [chosen, &context] { return list_topics(*chosen, context); });
  topics.option("TOPIC", chosen->topics, "these only");
  add_ros2_system_options(topics, chosen->system, false);
  Verb& describer =
      add_verb(ros2, context, "describe",
               "show a node's topics, services, actions and parameters, and its state where it is managed",
               "  segue ros2 describe /planner_server\n"
               "  segue ros2 describe --all --format json\n"
               "  segue ros2 describe /lidar --types interfaces\n"
               "  segue ros2 describe /lidar --model -",
               [options, &context] { return describe(*options, context); });
  const Option names =
      describer.option("NODE", options->nodes, "nodes; it ends as soon as they have been found");
  const Option all = describer.flag("--all", options->all, "all nodes");
  describer.require_any({names, all}, "NODE or --all");
  describer.option(
      "--types FOLDER", options->types,
      "write the definitions of types that are not built in, as the nodes tell them, to a folder that "
      "`interfaces` can name");
  describer.option(
      "--model FILE", options->model,
      "write the nodes as tasks of a network, with their topics as ports, to a file; -: show them");
  add_ros2_system_options(describer, options->system, true);
}

}  // namespace segue::cli
