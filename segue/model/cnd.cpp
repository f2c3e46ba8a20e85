// SPDX-License-Identifier: Apache-2.0
#include <segue/model/file_parts.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace segue::model::detail {

using type::Value;
using type::ValueMap;

namespace {

const Value* first_entry(const Value& root, std::string_view key) {
  const Value* section = root.find(key);
  if (section == nullptr || !section->is_map() || section->as_map().empty()) return nullptr;
  return &section->as_map().begin()->second;
}

bool has_any(const Value* entry, std::initializer_list<std::string_view> keys) {
  return entry != nullptr && std::ranges::any_of(keys, [&](auto key) { return entry->find(key) != nullptr; });
}

std::optional<Trigger> trigger_of(const std::string& type) {
  if (type == "PERIODIC") return Trigger::Periodic;
  if (type == "PORT_DRIVEN" || type == "TRIGGERED") return Trigger::PortDriven;
  if (type == "FD_DRIVEN" || type == "FILE_DESCRIPTOR") return Trigger::FileDescriptorDriven;
  return std::nullopt;
}

/// Seconds, as CND gives them, to the nanosecond.
std::optional<Duration> seconds(const Value* value) {
  if (value == nullptr || !value->is_number()) return std::nullopt;
  const double number = value->as_double();
  if (!(number > 0) || number > 1e6) return std::nullopt;
  return Duration(std::llround(number * 1e9));
}

/// `type: NONE` means the component's default activity, as no activity does.
std::optional<Activity> read_cnd_activity(const Value& value, const std::string& what, const Source& source) {
  Fields fields(value, "the activity of " + what, source);
  const std::string type = fields.text("type");
  const Value* period = fields.find("period");
  const bool real_time = fields.boolean("realtime", false);
  const auto priority = fields.integer("priority", 0, 99, "bad-priority");
  fields.finish();
  if (type.empty() || type == "NONE") return std::nullopt;
  Activity activity;
  const auto trigger = trigger_of(type);
  if (!trigger) {
    source.warning("unknown-activity",
                   fields.what() + ": the type " + quote(type) + " has no counterpart; the default is used",
                   value);
    return std::nullopt;
  }
  activity.trigger = *trigger;
  if (activity.trigger == Trigger::Periodic) {
    const auto duration = seconds(period);
    if (!duration) {
      source.error("bad-duration", fields.what() + ": 'period' must be seconds above 0",
                   period == nullptr ? value : *period);
    }
    activity.period = duration.value_or(Duration::zero());
  }
  if (real_time) {
    activity.scheduler = Scheduler::Fifo;
    activity.priority = static_cast<int>(std::max<std::int64_t>(1, priority.value_or(1)));
  }
  return activity;
}

/// The newer exporter's list of {Name, Type, Value}.
void read_property_list(const Value& list, const std::string& what, ValueMap& properties,
                        const Source& source) {
  for (const Value& item : list.as_list()) {
    Fields fields(item, "a property of " + what, source);
    const std::string name = fields.text("Name");
    fields.ignore("Type");
    if (name.empty()) {
      source.error("missing-key", fields.what() + " lacks 'Name'", item);
    } else if (const Value* value = fields.find("Value")) {
      properties.set(name, *value);
    }
    fields.finish();
  }
}

Task read_cnd_task(const std::string& id, const Value& value, const Source& source) {
  Fields fields(value, "task " + quote(id), source);
  check_name(id, fields.what(), value, source);
  Task task;
  task.id = TaskId(id);
  task.where = source.at(value);
  task.component = ComponentName(fields.required_name("type", "name its component"));
  const std::string state = fields.text("state");
  if (const auto known = task_state_from(state)) {
    task.state = *known;
  } else if (!state.empty()) {
    source.error("bad-state",
                 fields.what() + ": 'state' must be PRE_OPERATIONAL, STOPPED or RUNNING, got " + quote(state),
                 *fields.find("state"));
  }
  task.config_names = fields.texts("config_names");
  fields.ignore("config_file");
  if (const Value* config = fields.find("config", Value::Kind::Map)) task.properties = *config;
  if (const Value* list = fields.find("properties", Value::Kind::List)) {
    read_property_list(*list, fields.what(), task.properties.as_map(), source);
  }
  if (const Value* activity = fields.find("activity", Value::Kind::Map)) {
    task.activity = read_cnd_activity(*activity, fields.what(), source);
  }
  fields.finish();
  return task;
}

Deployment read_cnd_deployment(const std::string& key, const Value& value, const Source& source) {
  Fields fields(value, "deployment " + quote(key), source);
  Deployment deployment;
  deployment.where = source.at(value);
  deployment.host = host_named(fields.name("hostID"));
  const std::string deployer = fields.name("deployer");
  deployment.deployer = deployer.empty() ? "orogen" : deployer;
  deployment.process = ProcessName(fields.required_name("process_name"));
  if (const Value* tasks = fields.find("taskList", Value::Kind::Map)) {
    for (const auto& [task, name_value] : tasks->as_map()) {
      std::string name = scalar_text(name_value).value_or("");
      check_name(task, fields.what() + ": 'taskList'", name_value, source);
      if (name.empty()) name = task;
      check_name(name, fields.what() + ": task " + quote(task), name_value, source);
      deployment.tasks.push_back({TaskId(task), std::move(name)});
    }
  }
  fields.finish();
  return deployment;
}

PortRef read_cnd_end(Fields& connection, std::string_view key, const Source& source) {
  const Value* value = connection.require(key);
  if (value == nullptr) return {};
  Fields fields(*value, connection.what() + ": " + quote(key), source);
  PortRef ref{TaskId(fields.required_name("task_id")), fields.required_name("port_name")};
  fields.finish();
  return ref;
}

Policy read_cnd_policy(Fields& fields, const Source& source) {
  constexpr std::array<std::string_view, 3> kTypes = {"DATA", "BUFFER", "CIRCULAR_BUFFER"};
  Policy policy;
  if (auto type = fields.choice("type", kTypes, "bad-policy")) policy.kind = static_cast<BufferKind>(*type);
  const auto size = fields.integer("size", 0, kLargestBuffer, "bad-size");
  // Rock's transport is ignored: the processes of the tasks decide about the transport here.
  fields.ignore("transport");
  for (const std::string_view key : {"lock_policy", "pull", "data_size", "name_id"})
    fields.ignore(key);
  policy.init = fields.boolean("init", false) && policy.kind == BufferKind::Data;
  if (policy.kind == BufferKind::Data) return policy;
  if (!size) {
    source.warning("missing-key", fields.what() + ": a buffer needs 'size'; 1 is assumed", fields.value());
  } else if (*size == 0) {
    source.error("bad-size", fields.what() + ": a buffer of size 0 holds nothing", *fields.find("size"));
  }
  policy.size = static_cast<std::size_t>(size.value_or(1));
  return policy;
}

std::optional<Connection> read_cnd_connection(const std::string& key, const Value& value,
                                              const Source& source) {
  Fields fields(value, "connection " + quote(key), source);
  Connection connection;
  connection.where = source.at(value);
  connection.from = read_cnd_end(fields, "from", source);
  connection.to = read_cnd_end(fields, "to", source);
  connection.policy = read_cnd_policy(fields, source);
  fields.finish();
  return connection;
}

template <class Read>
void read_section(Fields& fields, std::string_view key, Read read) {
  const Value* section = fields.find(key, Value::Kind::Map);
  if (section == nullptr) return;
  for (const auto& [name, value] : section->as_map())
    read(name, value);
}

}  // namespace

bool is_cnd(const Value& root, const std::string& file) {
  if (root.find("network") != nullptr) return false;
  const Value* connections = root.find("connections");
  if (connections != nullptr && connections->is_list()) return false;
  const Value* task = first_entry(root, "tasks");
  if (has_any(task, {"component"})) return false;
  if (has_any(task, {"type", "config"})) return true;
  if (has_any(first_entry(root, "deployments"), {"hostID", "process_name", "taskList"})) return true;
  if (connections != nullptr && first_entry(root, "connections") != nullptr) return true;
  return file.find(".cnd") != std::string::npos;
}

NetworkPart read_cnd(const Value& root, const Source& source) {
  Fields fields(root, "the network", source);
  Network network;
  read_section(fields, "tasks", [&](const std::string& id, const Value& value) {
    network.tasks.push_back(read_cnd_task(id, value, source));
  });
  read_section(fields, "deployments", [&](const std::string& key, const Value& value) {
    network.deployments.push_back(read_cnd_deployment(key, value, source));
  });
  read_section(fields, "connections", [&](const std::string& key, const Value& value) {
    if (auto connection = read_cnd_connection(key, value, source)) {
      network.connections.push_back(std::move(*connection));
    }
  });
  auto includes = read_includes(fields, source);
  fields.finish();
  return {std::move(network), std::move(includes)};
}

}  // namespace segue::model::detail
