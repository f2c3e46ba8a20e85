// SPDX-License-Identifier: Apache-2.0
#include "ros2_ports.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/node_topics.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace segue::cli {

namespace {

using type::Value;

/// A task of components/ros2 that has ports for topics.
struct TopicTask {
  const model::Task* task = nullptr;
  bool is_node = false;
  std::vector<ros2::NodeTopic> topics;
};

Value property(const model::Task& task, std::string_view name) {
  const Value* found = task.properties.is_map() ? task.properties.find(name) : nullptr;
  return found == nullptr ? Value() : *found;
}

class PortCheck {
 public:
  PortCheck(const model::Network& network, Diagnostics& diagnostics)
      : network_(network), diagnostics_(diagnostics) {}

  void run() {
    for (const model::Task& task : network_.tasks)
      add(task);
    for (const model::Connection& connection : network_.connections)
      check(connection);
  }

 private:
  void add(const model::Task& task) {
    const std::string& component = task.component.str();
    if (component == "ros2::Node" || component == "ros2::ManagedNode") {
      check_topics(task);
      tasks_[task.id.str()] = {&task, true, ros2::topics_of_task(task.properties)};
    } else if (component == "ros2::Subscription" || component == "ros2::Publisher") {
      const bool is_published = component == "ros2::Subscription";
      const Value port = Value::map({{"topic", property(task, "topic")}, {"type", property(task, "type")}});
      tasks_[task.id.str()] = {
          &task, false,
          ros2::topics_of_task(Value::map({{"name", "/"},
                                           {is_published ? "publishes" : "subscribes",
                                            Value::map({{is_published ? "out" : "in", port}})}}))};
    }
  }

  void check_topics(const model::Task& task) {
    for (const char* name : {"publishes", "subscribes"}) {
      const Value* ports = task.properties.is_map() ? task.properties.find(name) : nullptr;
      if (ports == nullptr || !ports->is_map()) continue;
      for (const auto& [port, entry] : ports->as_map()) {
        const auto settings =
            ros2::topic_settings(port, entry, task.id.str() + "." + std::string(name) + "." + port);
        if (!settings) report("wrong-topic", settings.error().message, place_of(entry, task.where));
      }
    }
  }

  void check(const model::Connection& connection) {
    const auto* from = end_of(connection, connection.from, true);
    const auto* to = end_of(connection, connection.to, false);
    if (from == nullptr || to == nullptr) return;
    const std::string what = "connection " + to_string(connection.from) + " -> " + to_string(connection.to);
    const auto domain = [&](const model::PortRef& end) {
      return property(*tasks_.at(end.task.str()).task, "domain");
    };
    if (from->topic == to->topic && domain(connection.from) == domain(connection.to)) {
      report("same-topic",
             what + ": both are topic " + from->topic +
                 " of ROS 2, on which the samples travel already: no connection is needed, and with one they "
                 "would come twice",
             connection.where);
    } else if (from->type != to->type) {
      report("type-mismatch",
             what + ": " + from->topic + " is " + from->type + ", but " + to->topic + " is " + to->type,
             connection.where);
    }
  }

  /// nullptr: no topic; what is wrong is reported.
  const ros2::NodeTopic* end_of(const model::Connection& connection, const model::PortRef& end,
                                bool is_output) {
    const auto task = tasks_.find(end.task.str());
    if (task == tasks_.end()) return nullptr;
    const auto& topics = task->second.topics;
    const auto found = std::ranges::find_if(topics, [&](const ros2::NodeTopic& topic) {
      return topic.port == end.port && topic.is_published == is_output;
    });
    if (found != topics.end()) return &*found;
    if (task->second.is_node && !(is_output && end.port == "state"))
      report_unknown(connection, end, is_output);
    return nullptr;
  }

  void report_unknown(const model::Connection& connection, const model::PortRef& end, bool is_output) {
    const char* name = is_output ? "publishes" : "subscribes";
    const Value ports = property(*tasks_.at(end.task.str()).task, name);
    std::vector<std::string> names;
    if (ports.is_map()) {
      for (const auto& [port, entry] : ports.as_map())
        names.push_back(port);
    }
    // One that is wrong has been reported.
    if (std::ranges::find(names, end.port) != names.end()) return;
    report("unknown-port",
           "connection " + to_string(connection) + ": property " + name + " of task " +
               quote(end.task.str()) + " has no " + quote(end.port) +
               (names.empty() ? "" : did_you_mean_or_list(end.port, names, "it has")),
           connection.where);
  }

  SourceLocation place_of(const Value& value, SourceLocation where) const {
    if (value.mark().line == 0) return where;
    where.line = static_cast<int>(value.mark().line);
    where.column = static_cast<int>(value.mark().column);
    return where;
  }

  void report(std::string code, std::string message, SourceLocation where) {
    if (where.file.empty()) where.file = network_.file;
    diagnostics_.error(std::move(code), std::move(message), std::move(where));
  }

  const model::Network& network_;
  Diagnostics& diagnostics_;
  std::map<std::string, TopicTask> tasks_;
};

}  // namespace

void check_ros2_ports(const model::Network& network, Diagnostics& diagnostics) {
  PortCheck(network, diagnostics).run();
}

}  // namespace segue::cli
