// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/gateways.hpp>

#include <segue/base/sha256.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace segue::distributed {

namespace {

using model::Connection;
using model::HostName;
using model::Network;
using model::TaskId;
using type::Value;

constexpr char kMark = '>';
const model::ComponentName kSender{"gateway::Sender"};
const model::ComponentName kReceiver{"gateway::Receiver"};
constexpr const char* kIn = "in";
constexpr const char* kOut = "out";

std::string policy_tag(const Policy& policy) {
  std::string tag;
  if (policy.kind != BufferKind::Data) {
    tag = std::string(to_string(policy.kind)) + "_" + std::to_string(policy.size);
  }
  return policy.init ? tag + "_init" : tag;
}

/// "arm.pose>", "arm.pose>buffer_8", and for the receiver on host b "arm.pose>buffer_8>b".
TaskId sender_id(const Connection& connection) {
  return TaskId(to_string(connection.from) + kMark + policy_tag(connection.policy));
}
TaskId receiver_id(const TaskId& sender, const HostName& host) {
  return TaskId(sender.str() + kMark + host.str());
}

/// ROS 2 allows letters, digits and underscores between slashes. Other texts get a number as well, so that
/// "left-arm" and "left_arm" differ.
std::string topic_part(const std::string& text) {
  std::string part = text;
  std::replace_if(
      part.begin(), part.end(),
      [](char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); },
      '_');
  return part == text ? part : part + "_x" + sha256(text).substr(0, 12);
}

bool is_gateway(const model::Deployment& deployment) {
  return deployment.process == kGatewayProcess &&
         std::all_of(deployment.tasks.begin(), deployment.tasks.end(),
                     [](const model::Placement& placement) { return is_link_task(placement.task); });
}

/// The policy of one half; how samples get from process to process is decided there.
Policy half(Policy policy) {
  policy.transport = Transport::Automatic;
  return policy;
}

/// Adds senders, receivers and their processes to a network.
class Expander {
 public:
  Expander(Network network, const GatewaySettings& settings, const TypeOf& type_of)
      : network_(std::move(network)), settings_(settings), type_of_(type_of) {
    for (const auto& [task, process] : model::task_processes(network_)) {
      host_of_.emplace(task, normal(process.host));
    }
    for (const auto& task : network_.tasks) {
      tasks_.emplace(task.id, &task);
      ids_.insert(task.id);
      hosts_.insert(host_of(task.id));
    }
  }

  Network expand() {
    if (hosts_.size() < 2) {
      return std::move(network_);
    }
    add_gateways();
    std::vector<Connection> connections;
    for (auto& connection : network_.connections) {
      const bool known = tasks_.contains(connection.from.task) && tasks_.contains(connection.to.task);
      if (known && host_of(connection.from.task) != host_of(connection.to.task)) {
        add_link(connection, connections);
      } else {
        connections.push_back(std::move(connection));
      }
    }
    network_.connections = std::move(connections);
    for (auto& task : added_) {
      network_.tasks.push_back(std::move(task));
    }
    for (auto& [host, gateway] : gateways_) {
      network_.deployments.push_back(std::move(gateway));
    }
    return std::move(network_);
  }

 private:
  [[nodiscard]] HostName normal(const HostName& host) const {
    const bool own = std::find(settings_.own.begin(), settings_.own.end(), host) != settings_.own.end();
    return own ? model::kLocalHost : host;
  }
  [[nodiscard]] HostName host_of(const TaskId& task) const {
    const auto found = host_of_.find(task);
    return found == host_of_.end() ? model::kLocalHost : found->second;
  }

  /// One on each host; those that are there already get what is added.
  void add_gateways() {
    for (const auto& host : hosts_) {
      auto& gateway = gateways_[host];
      gateway.host = host;
      gateway.process = kGatewayProcess;
      gateway.libraries = {kGatewayLibrary};
    }
    std::erase_if(network_.deployments, [this](const model::Deployment& deployment) {
      const auto gateway = gateways_.find(normal(deployment.host));
      if (gateway == gateways_.end() || !is_gateway(deployment)) {
        return false;
      }
      gateway->second = deployment;
      return true;
    });
  }

  void add_link(const Connection& connection, std::vector<Connection>& connections) {
    const TaskId sender = sender_id(connection);
    const HostName there = host_of(connection.to.task);
    const TaskId receiver = receiver_id(sender, there);
    const Policy policy = half(connection.policy);
    if (add_task(sender, kSender, host_of(connection.from.task), connection)) {
      connections.push_back({connection.from, {sender, kIn}, policy, connection.where});
    }
    add_task(receiver, kReceiver, there, connection);
    connections.push_back({{receiver, kOut}, connection.to, policy, connection.where});
  }

  /// False where it is there already.
  bool add_task(const TaskId& id, const model::ComponentName& component, const HostName& host,
                const Connection& connection) {
    if (!ids_.insert(id).second) {
      return false;
    }
    model::Task task;
    task.id = id;
    task.component = component;
    task.properties = properties(connection, host);
    task.where = connection.where;
    gateways_[host].tasks.push_back({id, id.str()});
    added_.push_back(std::move(task));
    return true;
  }

  [[nodiscard]] Value properties(const Connection& connection, const HostName& host) const {
    const SampleType sample = type_of_(*tasks_.at(connection.from.task), connection.from.port);
    const std::string tag = policy_tag(connection.policy);
    type::ValueMap map;
    map.append("topic", topic_part(settings_.robot) + "/" + topic_part(connection.from.task.str()) + "/" +
                            topic_part(connection.from.port) + (tag.empty() ? "" : "/" + topic_part(tag)));
    map.append("type", sample.type);
    map.append("library", sample.library);
    map.append("policy", std::string(to_string(connection.policy.kind)));
    map.append("size", static_cast<std::uint64_t>(connection.policy.size));
    map.append("init", connection.policy.init);
    map.append("domain", settings_.domain);
    const auto own = settings_.addresses.find(host);
    map.append("interface", own == settings_.addresses.end() ? std::string() : own->second);
    return map;
  }

  Network network_;
  const GatewaySettings& settings_;
  const TypeOf& type_of_;
  std::map<TaskId, HostName> host_of_;
  std::map<TaskId, const model::Task*> tasks_;
  std::set<HostName> hosts_;
  std::map<HostName, model::Deployment> gateways_;
  std::set<TaskId> ids_;
  std::vector<model::Task> added_;
};

model::PropertyModel property(const char* name, const char* type, Value value, const char* doc) {
  return {name, type, std::move(value), false, doc};
}

model::ComponentModel link_model(const model::ComponentName& name, const char* port,
                                 model::Direction direction, const char* doc) {
  model::ComponentModel model;
  model.name = name;
  model.library = kGatewayLibrary;
  model.doc = doc;
  model.ports.push_back({port, direction, "", true, false, "samples of the topic's type"});
  model.properties = {property("topic", "/std/string", "", "name of the topic"),
                      property("type", "/std/string", "", "type of the samples; empty: they carry no value"),
                      property("library", "/std/string", "", "component library that defines the type"),
                      property("policy", "/std/string", "data", "data, buffer or circular_buffer"),
                      property("size", "/uint32_t", 1, "of the buffer, in samples"),
                      property("init", "/bool", false, "new readers get the last sample"),
                      property("domain", "/int32_t", 0, "DDS domain"),
                      property("interface", "/std/string", "", "address of this host; empty: any"),
                      property("peers", "/std/vector</std/string>", Value::List{},
                               "addresses of all hosts; empty: $SEGUE_PEERS")};
  model.activity.trigger = Trigger::PortDriven;
  return model;
}

}  // namespace

std::vector<model::ComponentModel> gateway_models() {
  return {link_model(kSender, kIn, model::Direction::Input, "Sends samples to other hosts"),
          link_model(kReceiver, kOut, model::Direction::Output, "Receives samples from another host")};
}

Network with_gateways(Network network, const GatewaySettings& settings, const TypeOf& type_of) {
  return Expander(std::move(network), settings, type_of).expand();
}

bool is_link_task(const TaskId& task) {
  return task_host::plain_id(task).str().find(kMark) != std::string::npos;
}

std::optional<TaskId> sender_of(const TaskId& receiver) {
  const std::string plain = task_host::plain_id(receiver).str();
  const auto first = plain.find(kMark);
  const auto last = plain.rfind(kMark);
  if (first == last) {
    return std::nullopt;
  }
  return TaskId(plain.substr(0, last));
}

Network without_gateways(Network network) {
  std::map<TaskId, model::PortRef> writer_of;  // by sender
  for (const auto& connection : network.connections) {
    if (is_link_task(connection.to.task)) {
      writer_of.emplace(connection.to.task, connection.from);
    }
  }
  std::vector<Connection> connections;
  for (auto& connection : network.connections) {
    if (is_link_task(connection.to.task)) {
      continue;
    }
    if (const auto sender = sender_of(connection.from.task)) {
      const auto writer = writer_of.find(*sender);
      if (writer == writer_of.end()) {
        continue;
      }
      connection.from = writer->second;
    }
    connections.push_back(std::move(connection));
  }
  network.connections = std::move(connections);
  std::erase_if(network.tasks, [](const model::Task& task) { return is_link_task(task.id); });
  std::erase_if(network.deployments, is_gateway);
  return network;
}

}  // namespace segue::distributed
