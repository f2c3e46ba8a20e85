// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/file_parts.hpp>

namespace segue::model::detail {

using type::Value;
using type::ValueMap;

Value text_list(const std::vector<std::string>& texts) {
  return Value(Value::List(texts.begin(), texts.end()));
}

void write_scheduling(ValueMap& map, Scheduler scheduler, int priority, const std::vector<int>& cpus) {
  if (scheduler != Scheduler::Normal) map.append("scheduler", to_string(scheduler));
  if (priority != 0) map.append("priority", priority);
  if (!cpus.empty()) map.append("cpu", Value::List(cpus.begin(), cpus.end()));
}

Value write_activity(const Activity& activity) {
  ValueMap map;
  if (activity.trigger == Trigger::Periodic) {
    map.append("periodic", format_duration(activity.period));
  } else if (!activity.triggers.empty()) {
    map.append(std::string(to_string(activity.trigger)),
               Value(Value::List(activity.triggers.begin(), activity.triggers.end())));
  } else {
    map.append("trigger", to_string(activity.trigger));
  }
  write_scheduling(map, activity.scheduler, activity.priority, activity.cpus);
  if (!activity.thread.empty()) map.append("thread", activity.thread);
  if (activity.optional) map.append("optional", true);
  if (activity.update_deadline > Duration::zero()) {
    map.append("update_deadline", format_duration(activity.update_deadline));
  }
  if (activity.spin > Duration::zero()) map.append("spin", format_duration(activity.spin));
  const bool plain = map.size() == 1 && map.find("trigger") != nullptr;
  return plain ? Value(to_string(activity.trigger)) : Value(std::move(map));
}

Value write_task(const Task& task) {
  ValueMap map;
  map.append("component", task.component.str());
  if (task.state != TaskState::Running) map.append("state", to_string(task.state));
  if (!task.config_names.empty()) map.append("config_names", text_list(task.config_names));
  if (task.properties.is_map() && !task.properties.as_map().empty()) {
    map.append("properties", task.properties);
  }
  if (task.activity) map.append("activity", write_activity(*task.activity));
  if (!task.exclusive.empty()) map.append("exclusive", text_list(task.exclusive));
  if (task.takes_over) map.append("takes_over", task.takes_over->str());
  if (task.on_failure) map.append("on_failure", to_string(*task.on_failure));
  return map;
}

namespace {

Value write_port_ref(const PortRef& ref) {
  if (ref.port.find('.') == std::string::npos) return to_string(ref);
  return Value::map({{"task", ref.task.str()}, {"port", ref.port}});
}

}  // namespace

void write_connection(ValueMap& map, const Connection& connection) {
  map.append("from", write_port_ref(connection.from));
  map.append("to", write_port_ref(connection.to));
  const Policy& policy = connection.policy;
  if (policy.kind != BufferKind::Data) {
    map.append("policy", to_string(policy.kind));
    map.append("size", static_cast<std::uint64_t>(policy.size));
  }
  if (policy.transport != Transport::Automatic) map.append("link", to_string(policy.transport));
  if (policy.init) map.append("init", true);
}

void write_process(ValueMap& map, const Deployment& deployment) {
  const Deployment plain;
  if (deployment.host != kLocalHost) map.append("host", deployment.host.str());
  if (deployment.deployer != plain.deployer) map.append("deployer", deployment.deployer);
  write_scheduling(map, deployment.scheduler, deployment.priority, deployment.cpus);
  if (deployment.optional) map.append("optional", true);
  if (!deployment.limits.empty()) map.append("limits", write_limits(deployment.limits));
  if (deployment.on_failure) map.append("on_failure", to_string(*deployment.on_failure));
  if (!deployment.libraries.empty()) {
    map.append("libraries", Value::List(deployment.libraries.begin(), deployment.libraries.end()));
  }
  if (deployment.environment.empty()) return;
  ValueMap environment;
  for (const auto& [key, text] : deployment.environment)
    environment.set(key, text);
  map.append("environment", std::move(environment));
}

}  // namespace segue::model::detail
