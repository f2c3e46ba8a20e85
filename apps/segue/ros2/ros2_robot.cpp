// SPDX-License-Identifier: Apache-2.0
#include "ros2_robot.hpp"

#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/node_topics.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string_view>

#include "ros2_components.hpp"

namespace segue::cli {

namespace {

using type::Value;
using type::ValueMap;

const std::string& text_at(const Value& map, std::string_view key) {
  return map.find(key)->as_string();
}

bool is_hidden(std::string_view node) {
  return node.substr(node.rfind('/') + 1).starts_with('_');
}

bool is_own(const Value& node) {
  const Value* process = node.find("process");
  if (process == nullptr || process->find("command")->as_list().empty()) return false;
  const std::filesystem::path program = process->find("command")->as_list().front().as_string();
  return program.filename().string().starts_with("segue");
}

/// Whether the robot can start it: its program is known, and has this node only.
bool can_start(const Value& node) {
  const Value* process = node.find("process");
  return process != nullptr && process->find("package") != nullptr && process->find("nodes")->as_int() == 1;
}

/// All nodes have these, and few users set them.
bool is_common(const std::string& name, const Value& value) {
  return name.starts_with("qos_overrides.") || name == "start_type_description_service" ||
         (name == "use_sim_time" && value == Value(false));
}

/// Whether a network file can say it: that an empty list is one of texts, and that a number is a byte, it
/// cannot.
bool can_say(const Value& parameter) {
  const Value& value = *parameter.find("value");
  const std::string& kind = text_at(parameter, "kind");
  if (value.is_null() || kind == "byte array") return false;
  return !value.is_list() || !value.as_list().empty() || kind == "string array";
}

/// Those that can be set; those that are read-only are given to a program at its start.
Value parameters_of(const Value& node, bool is_started, std::vector<std::string>& left_out) {
  ValueMap parameters;
  for (const Value& one : node.find("parameters")->as_list()) {
    const std::string& name = text_at(one, "name");
    const Value& value = *one.find("value");
    if (is_common(name, value)) continue;
    if (can_say(one) && (is_started || !one.find("read_only")->as_bool())) {
      parameters.set(name, value);
    } else if (!value.is_null()) {
      left_out.push_back(name);
    }
  }
  return Value(std::move(parameters));
}

Value process_of(const Value& process) {
  ValueMap map;
  map.set("package", text_at(process, "package"));
  map.set("executable", text_at(process, "executable"));
  for (const char* list : {"remappings", "arguments"}) {
    if (!process.find(list)->as_list().empty()) map.set(list, *process.find(list));
  }
  return Value(std::move(map));
}

/// "robot_talker" for "/robot/talker", with a number where that is taken.
std::string task_id(std::string_view node, std::set<std::string>& taken) {
  std::string id(node.substr(std::min(node.size(), node.find_first_not_of('/'))));
  std::ranges::replace_if(
      id, [](unsigned char c) { return c >= 0x80 || std::isalnum(c) == 0; }, '_');
  const std::string first = id;
  for (int number = 2; !taken.insert(id).second; ++number)
    id = first + "_" + std::to_string(number);
  return id;
}

std::string indented(const std::string& text, std::string_view margin) {
  std::string all;
  for (const std::string_view line : split(text, '\n')) {
    if (!line.empty()) all.append(margin).append(line).append("\n");
  }
  return all;
}

/// Names come from others, and may have line ends.
std::string comment(const std::string& text, std::string_view margin = "  # ") {
  return indented(printable(text), margin);
}

/// Of a node that the robot does not start, where it runs.
std::string note_on_process(const Value& node) {
  const Value* process = node.find("process");
  if (process == nullptr) return "its program is not known: it is not on this computer, or another user's";
  const std::int64_t pid = process->find("pid")->as_int();
  if (const std::int64_t nodes = process->find("nodes")->as_int(); nodes > 1)
    return fmt::format("in process {} with {} other nodes", pid, nodes - 1);
  return fmt::format("process {}, whose program is not in an installation of packages", pid);
}

/// All nodes have these topics.
bool is_common_topic(std::string_view topic) {
  return topic == "/rosout" || topic == "/parameter_events" || topic.ends_with("/transition_event");
}

/// "scan" for "/robot/scan" of node "/robot/lidar" and for "/front/scan", "front_scan" where that is taken.
std::string port_name(const std::string& topic, std::set<std::string>& taken) {
  std::string whole = topic.substr(topic.find_first_not_of('/'));
  std::string name = whole.substr(whole.rfind('/') + 1);
  std::ranges::replace(whole, '/', '_');
  if (!taken.contains(name)) whole = name;
  name = whole;
  for (int number = 2; !taken.insert(name).second; ++number)
    name = whole + "_" + std::to_string(number);
  return name;
}

/// The quality of the endpoint in the task, which is to fit that of the node.
void add_quality(const Value& told, bool is_published, ValueMap& topic) {
  const auto copy = [&](const char* key, const char* usual) {
    const Value* value = told.find(key);
    if (value != nullptr && *value != Value(usual)) topic.set(key, *value);
  };
  // Whoever subscribes requests no more than is offered, and whoever publishes offers what is requested.
  if (is_published) copy("reliability", "reliable");
  copy("durability", "volatile");
  if (is_published) return;
  copy("liveliness", "automatic");
  for (const char* key : {"deadline", "lease"})
    copy(key, "");
}

/// The property `publishes` or `subscribes`.
Value ports_of(const Value& node, bool is_published, std::set<std::string>& taken) {
  ValueMap ports;
  const std::string& name = text_at(node, "name");
  for (const Value& seen : node.find(is_published ? "publishers" : "subscriptions")->as_list()) {
    const std::string& topic = text_at(seen, "topic");
    if (is_common_topic(topic) || topic.find_first_not_of('/') == std::string::npos) continue;
    const std::string port = port_name(topic, taken);
    ValueMap settings;
    if (ros2::resolve_topic(port, name, {}).value_or("") != topic) settings.set("topic", topic);
    settings.set("type", *seen.find("type"));
    add_quality(*seen.find("quality"), is_published, settings);
    ports.set(port, settings.size() == 1 ? *settings.find("type") : Value(std::move(settings)));
  }
  return Value(std::move(ports));
}

void add_ports(const Value& node, ValueMap& properties) {
  std::set<std::string> taken{"state"};
  for (const auto& [key, is_published] : {std::pair{"publishes", true}, {"subscribes", false}}) {
    if (Value ports = ports_of(node, is_published, taken); !ports.as_map().empty())
      properties.set(key, std::move(ports));
  }
}

/// As a program of its own or in its container.
bool can_bring_up(const Value& node) {
  return can_start(node) || can_load(node);
}

std::string task_text(const Value& node, const std::string& id, bool starts, bool with_ports = false) {
  const bool is_started = starts && can_bring_up(node);
  std::vector<std::string> left_out;
  ValueMap properties;
  properties.set("name", text_at(node, "name"));
  if (with_ports) add_ports(node, properties);
  if (Value parameters = parameters_of(node, is_started, left_out); !parameters.as_map().empty())
    properties.set("parameters", std::move(parameters));
  std::string notes;
  if (is_started && can_load(node)) {
    properties.set("process", loading_process(node));
  } else if (is_started) {
    properties.set("process", process_of(*node.find("process")));
    notes += comment("of installation " + text_at(*node.find("process"), "installation"));
  } else if (starts) {
    notes += comment(note_on_process(node));
  }
  if (starts) {
    for (const std::string& note : notes_on_component(node))
      notes += comment(note);
  }
  if (!left_out.empty()) notes += comment("parameters that cannot be set: " + listed(left_out));
  for (const Value& problem : node.find("problems")->as_list())
    notes += comment(problem.as_string());
  const char* component = node.find("managed")->as_bool() ? "ros2::ManagedNode" : "ros2::Node";
  const Value task = Value::map({{"component", component}, {"properties", Value(std::move(properties))}});
  return notes + "  " + id + ":\n" + indented(type::to_yaml(task), "    ");
}

/// The topics between nodes, for readers of the file.
std::string topics_text(const Value& topics) {
  std::string text;
  const auto names = [](const Value& list) {
    std::string all;
    for (const Value& name : list.as_list())
      all += (all.empty() ? "" : ", ") + (name.as_string().empty() ? "(not of a node)" : name.as_string());
    return all.empty() ? std::string("(nobody)") : all;
  };
  for (const Value& topic : topics.as_list()) {
    const std::string& name = text_at(topic, "topic");
    if (name == "/rosout" || name == "/parameter_events") continue;
    const auto& types = topic.find("types")->as_list();
    text += comment(fmt::format("{} ({}): {} -> {}", name, types.front().as_string(),
                                names(*topic.find("publishers")), names(*topic.find("subscriptions"))),
                    "#   ");
  }
  return text.empty()
             ? text
             : "# Topics, on which nodes talk to each other without Segue (`segue ros2 describe NODE "
               "--model -` has them as ports):\n" +
                   text;
}

}  // namespace

Ros2Robot ros2_robot(const Value& seen, const std::string& name, bool starts) {
  Ros2Robot robot;
  std::set<std::string> ids;
  std::string tasks;
  for (const Value& node : seen.find("nodes")->as_list()) {
    const std::string& node_name = text_at(node, "name");
    if (is_hidden(node_name) || is_own(node) || (starts && starts_with_components(node))) continue;
    tasks += task_text(node, task_id(node_name, ids), starts);
    robot.nodes.push_back(node_name);
    if (starts && can_bring_up(node)) robot.started.push_back(node_name);
  }
  const Value all(Value::List(ids.begin(), ids.end()));
  robot.files.push_back(
      {"robot.yaml",
       fmt::format("# Made by `segue import ros2`.\nrobot: {}\nlibraries: [segue_components_ros2]\n"
                   "controllers: [controllers/*.yaml]\n",
                   name)});
  robot.files.push_back(
      {"controllers/nodes.yaml",
       "# The nodes of ROS 2 that ran. Those with a `process` are started by the robot: end them before.\n" +
           topics_text(*seen.find("topics")) + "network: nodes\ntasks:\n" + tasks + "deployments:\n" +
           indented(type::to_yaml(Value::map({{"ros2", Value::map({{"tasks", all}})}})), "  ")});
  return robot;
}

std::string ros2_tasks(const std::vector<Value>& nodes) {
  std::set<std::string> ids;
  std::string text;
  for (const Value& node : nodes)
    text += task_text(node, task_id(text_at(node, "name"), ids), true, true);
  const bool starts = std::ranges::any_of(nodes, can_bring_up);
  return (starts ? "# The robot starts those with a `process`: end them before, or leave that out.\n" : "") +
         ("tasks:\n" + text);
}

}  // namespace segue::cli
