// SPDX-License-Identifier: Apache-2.0
#include <segue/model/file_parts.hpp>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace segue::model::detail {

using type::Value;

namespace {

/// `port_driven: true`, or what triggers an update: `port_driven: [scan]`. `which` names it in messages.
bool read_driven_by(Trigger trigger, std::string_view which, Fields& fields, Activity& activity,
                    const Source& source) {
  const std::string_view key = to_string(trigger);
  const Value* value = fields.find(key);
  if (value == nullptr || !value->is_list()) return fields.boolean(key, false);
  for (std::string& name : fields.texts(key)) {
    if (!activity.triggers.insert(name).second)
      source.error("bad-activity", fields.what() + ": " + quote(key) + " names " + quote(name) + " twice",
                   *value);
  }
  if (value->as_list().empty()) {
    source.error("bad-activity",
                 fields.what() + ": " + quote(key) + " names no " + std::string(which) +
                     "; leave the list out for all of them",
                 *value);
  }
  return true;
}

/// `{trigger: port_driven}`, `{periodic: 100ms}`, `{port_driven: [scan]}`; exactly one of them.
std::optional<Trigger> read_trigger(Fields& fields, Activity& activity, const Source& source) {
  std::vector<Trigger> given;
  if (auto period = fields.duration("periodic")) {
    activity.period = *period;
    given.push_back(Trigger::Periodic);
  } else if (fields.find("periodic") != nullptr) {
    return std::nullopt;
  }
  for (const auto& [trigger, which] :
       {std::pair(Trigger::PortDriven, "input"), std::pair(Trigger::FileDescriptorDriven, "file descriptor")})
    if (read_driven_by(trigger, which, fields, activity, source)) given.push_back(trigger);
  if (auto choice = fields.choice("trigger", kTriggerNames, "bad-activity")) {
    given.push_back(static_cast<Trigger>(*choice));
  }
  if (auto period = fields.duration("period")) {
    activity.period = *period;
    if (given != std::vector{Trigger::Periodic}) {
      source.error("bad-activity", fields.what() + ": 'period' needs 'trigger: periodic'",
                   *fields.find("period"));
    }
  }
  if (given.size() == 1) return given.front();
  source.error("bad-activity",
               fields.what() +
                   " must say once what makes the task update: 'periodic: 100ms', "
                   "'trigger: port_driven' or 'trigger: fd_driven'",
               fields.value());
  return std::nullopt;
}

std::optional<Activity> short_activity(const Value& value, const std::string& what, const Source& source) {
  Activity activity;
  if (value.as_string() == "port_driven") return activity;
  if (value.as_string() == "fd_driven") {
    activity.trigger = Trigger::FileDescriptorDriven;
    return activity;
  }
  const std::string hint = value.as_string() == "periodic"
                               ? ": a period is missing, write '{periodic: 100ms}'"
                               : ": expected 'port_driven', 'fd_driven' or a map such as {periodic: 100ms}";
  source.error("bad-activity", what + " cannot be " + quote(value.as_string()) + hint, value);
  return std::nullopt;
}

std::optional<std::string> problem_of_priority(Scheduler scheduler, int priority) {
  const bool real_time = scheduler != Scheduler::Normal;
  if (real_time && (priority < 1 || priority > 99)) {
    return "scheduler " + std::string(to_string(scheduler)) + " needs a priority from 1 to 99, got " +
           std::to_string(priority);
  }
  if (!real_time && priority != 0) {
    return "a priority needs 'scheduler: fifo' or 'scheduler: round_robin'";
  }
  return std::nullopt;
}

std::optional<std::string> problem_of_deadline(Duration deadline) {
  constexpr Duration kMost = std::chrono::hours(24);
  if (deadline >= Duration::zero() && deadline <= kMost) return std::nullopt;
  return "'update_deadline' must be longer than nothing and at most 24h, not " + format_duration(deadline);
}

/// Zero: none is given.
Duration read_update_deadline(Fields& fields, const Source& source) {
  const auto deadline = fields.duration("update_deadline");
  if (!deadline) return {};
  const auto problem = *deadline == Duration::zero() ? std::optional<std::string>(
                                                           "'update_deadline' must be "
                                                           "longer than nothing")
                                                     : problem_of_deadline(*deadline);
  if (!problem) return *deadline;
  source.error("bad-duration", fields.what() + ": " + *problem, *fields.find("update_deadline"));
  return {};
}

std::optional<std::string> problem_of_spin(const Activity& activity) {
  if (activity.spin < Duration::zero() || activity.spin > kLongestSpin) {
    return "'spin' must be longer than nothing and at most " + format_duration(kLongestSpin) + ", not " +
           format_duration(activity.spin);
  }
  if (activity.trigger == Trigger::Periodic && activity.spin >= activity.period &&
      activity.spin > Duration::zero()) {
    return "'spin' must be shorter than the period, or the thread never sleeps: " +
           format_duration(activity.spin) + " of " + format_duration(activity.period);
  }
  return std::nullopt;
}

/// Requires that trigger and period have been read. Zero: none is given.
Duration read_spin(Fields& fields, Activity activity, const Source& source) {
  const auto spin = fields.duration("spin");
  if (!spin) return {};
  activity.spin = *spin;
  const auto problem = *spin == Duration::zero()
                           ? std::optional<std::string>("'spin' must be longer than nothing; leave it out")
                           : problem_of_spin(activity);
  if (!problem) return *spin;
  source.error("bad-duration", fields.what() + ": " + *problem, *fields.find("spin"));
  return {};
}

}  // namespace

std::optional<std::string> problem_of(const Activity& activity) {
  const bool periodic = activity.trigger == Trigger::Periodic;
  if (periodic && activity.period <= Duration::zero()) return "the period must be longer than nothing";
  if (auto problem = problem_of_deadline(activity.update_deadline)) return problem;
  if (auto problem = problem_of_spin(activity)) return problem;
  if (periodic && !activity.triggers.empty())
    return "only a task that is driven by ports or file descriptors names what triggers it";
  return problem_of_priority(activity.scheduler, activity.priority);
}

Scheduling read_scheduling(Fields& fields, const Source& source) {
  Scheduling result;
  if (auto choice = fields.choice("scheduler", kSchedulerNames, "bad-scheduler")) {
    result.scheduler = static_cast<Scheduler>(*choice);
  }
  const Value* given = fields.find("priority");
  const auto priority = fields.integer("priority", 0, 99, "bad-priority");
  result.priority = static_cast<int>(priority.value_or(0));
  result.cpus = fields.integers("cpu", 0, kMostCpus - 1);
  const bool reported = given != nullptr && !priority;
  if (auto problem = problem_of_priority(result.scheduler, result.priority); problem && !reported) {
    source.error("bad-priority", fields.what() + ": " + *problem, given == nullptr ? fields.value() : *given);
  }
  return result;
}

std::optional<Activity> read_activity(const Value& value, const std::string& what, const Source& source) {
  const std::string name = "the activity of " + what;
  if (value.is_string()) return short_activity(value, name, source);
  Fields fields(value, name, source);
  if (!fields.is_map()) return std::nullopt;
  Activity activity;
  const auto trigger = read_trigger(fields, activity, source);
  Scheduling scheduling = read_scheduling(fields, source);
  activity.scheduler = scheduling.scheduler;
  activity.priority = scheduling.priority;
  activity.cpus = std::move(scheduling.cpus);
  activity.thread = fields.name("thread");
  activity.optional = fields.boolean("optional", false);
  activity.update_deadline = read_update_deadline(fields, source);
  activity.trigger = trigger.value_or(Trigger::PortDriven);
  activity.spin = read_spin(fields, activity, source);
  fields.finish();
  if (!trigger) return std::nullopt;
  if (activity.trigger == Trigger::Periodic && activity.period <= Duration::zero()) {
    source.error("bad-duration", name + ": the period must be longer than nothing", value);
  }
  return activity;
}

std::optional<FailurePolicy> read_failure_policy(Fields& fields) {
  const auto choice = fields.choice("on_failure", kFailurePolicyNames, "bad-on-failure");
  return choice ? std::optional(static_cast<FailurePolicy>(*choice)) : std::nullopt;
}

std::vector<Include> read_includes(Fields& fields, const Source& source) {
  std::vector<Include> includes;
  const Value* value = fields.find("include");
  for (std::string& file : fields.texts("include"))
    includes.push_back({std::move(file), source.at(*value)});
  return includes;
}

std::string name_from_file(const std::string& file) {
  std::string name = std::filesystem::path(file).filename().string();
  for (const std::string_view suffix : {".yaml", ".yml", ".json", ".cnd"}) {
    if (name.size() > suffix.size() && name.ends_with(suffix)) name.resize(name.size() - suffix.size());
  }
  return name;
}

void warn_of_sections(const Network& network, Diagnostics& diagnostics) {
  const auto names_sections = [](const Task& task) { return !task.config_names.empty(); };
  const auto first = std::ranges::find_if(network.tasks, names_sections);
  if (first == network.tasks.end()) return;
  const auto count = std::count_if(first, network.tasks.end(), names_sections);
  const std::string others = count == 1 ? "" : " and " + std::to_string(count - 1) + " more";
  diagnostics.warning("sections-not-read",
                      "task " + quote(first->id.str()) + others +
                          ": the configuration sections that 'config_names' lists are not read: no file "
                          "config/orogen/" +
                          first->component.str() + ".yml was found in the network's folder or one around it",
                      first->where);
}

void read_definition(Fields& fields, Task& task, const Source& source) {
  if (fields.is_map() || fields.value().is_null()) {
    task.component = ComponentName(fields.required_name("component", "name its component"));
  }
  task.config_names = fields.texts("config_names");
  if (const Value* properties = fields.find("properties", Value::Kind::Map)) task.properties = *properties;
  if (const Value* activity = fields.find("activity")) {
    task.activity = read_activity(*activity, fields.what(), source);
  }
  task.exclusive = fields.texts("exclusive");
  task.on_failure = read_failure_policy(fields);
}

Task read_task(const std::string& id, const Value& value, const Source& source) {
  Fields fields(value, "task " + quote(id), source);
  check_name(id, "task " + quote(id), value, source);
  Task task;
  task.id = TaskId(id);
  task.where = source.at(value);
  read_definition(fields, task, source);
  if (auto state = fields.choice("state", kTaskStateNames, "bad-state")) {
    task.state = static_cast<TaskState>(*state);
  }
  if (const std::string old = fields.name("takes_over"); !old.empty()) task.takes_over = TaskId(old);
  fields.finish();
  return task;
}

namespace {

/// "velodyne.scans": the port is the part after the last dot, so the id of a task may contain dots; a port
/// with dots needs the form {task: logger, port: a.b}.
std::optional<PortRef> read_port_ref(const Value& value, const std::string& what, const Source& source) {
  if (value.is_map()) {
    Fields fields(value, what, source);
    PortRef ref{TaskId(fields.required_name("task")), fields.required_name("port")};
    fields.finish();
    return ref.task.empty() || ref.port.empty() ? std::nullopt : std::optional(ref);
  }
  const std::string text = scalar_text(value).value_or("");
  const auto dot = text.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == text.size()) {
    source.error(
        "bad-port",
        what + ": expected a task and its port such as 'velodyne.scans', got " + type::describe(value),
        value);
    return std::nullopt;
  }
  PortRef ref{TaskId(text.substr(0, dot)), text.substr(dot + 1)};
  const bool good =
      check_name(ref.task.str(), what, value, source) && check_name(ref.port, what, value, source);
  return good ? std::optional(ref) : std::nullopt;
}

}  // namespace

namespace {

/// The size of a buffer; for data it is 1.
std::size_t read_size(Fields& fields, BufferKind kind, const Source& source) {
  const Value* given = fields.find("size");
  const auto size = fields.integer("size", 1, kLargestBuffer, "bad-size");
  if (kind != BufferKind::Data) {
    if (given == nullptr) {
      source.error("missing-key", fields.what() + ": a " + std::string(to_string(kind)) + " needs 'size'",
                   fields.value());
    }
    return static_cast<std::size_t>(size.value_or(1));
  }
  if (size.value_or(1) != 1) {
    source.error("bad-size", fields.what() + ": 'size' needs 'policy: buffer' or 'policy: circular_buffer'",
                 *given);
  }
  return 1;
}

}  // namespace

Policy read_policy(Fields& fields, const Source& source) {
  Policy policy;
  const auto kind = fields.choice("policy", kBufferKindNames, "bad-policy");
  if (kind) policy.kind = static_cast<BufferKind>(*kind);
  const bool understood = kind.has_value() || fields.find("policy") == nullptr;
  if (understood) {
    policy.size = read_size(fields, policy.kind, source);
  } else {
    fields.ignore("size");
  }
  if (const auto link = fields.choice("link", kTransportNames, "bad-link")) {
    policy.transport = static_cast<Transport>(*link);
  }
  policy.init = fields.boolean("init", false);
  if (policy.init && policy.kind != BufferKind::Data) {
    source.error("bad-policy", fields.what() + ": 'init' is only for data connections", *fields.find("init"));
  }
  return policy;
}

std::optional<Connection> read_connection(Fields& fields, const Source& source) {
  const Value* from_value = fields.require("from");
  const Value* to_value = fields.require("to");
  Connection connection;
  connection.where = source.at(fields.value());
  connection.policy = read_policy(fields, source);
  if (from_value == nullptr || to_value == nullptr) return std::nullopt;
  auto from = read_port_ref(*from_value, fields.what() + ": 'from'", source);
  auto to = read_port_ref(*to_value, fields.what() + ": 'to'", source);
  if (!from || !to) return std::nullopt;
  connection.from = std::move(*from);
  connection.to = std::move(*to);
  return connection;
}

HostName host_named(std::string name) {
  if (name.empty() || name == "local") return kLocalHost;
  return HostName(std::move(name));
}

void read_process(Fields& fields, Deployment& deployment, const Source& source) {
  deployment.where = source.at(fields.value());
  deployment.host = host_named(fields.name("host"));
  if (const std::string deployer = fields.name("deployer"); !deployer.empty()) deployment.deployer = deployer;
  Scheduling scheduling = read_scheduling(fields, source);
  deployment.scheduler = scheduling.scheduler;
  deployment.priority = scheduling.priority;
  deployment.cpus = std::move(scheduling.cpus);
  deployment.optional = fields.boolean("optional", false);
  if (const Value* limits = fields.find("limits")) {
    deployment.limits = read_limits(*limits, "the limits of " + fields.what(), source);
  }
  deployment.on_failure = read_failure_policy(fields);
  deployment.libraries = fields.texts("libraries");
  const Value* environment = fields.find("environment", Value::Kind::Map);
  if (environment == nullptr) return;
  for (const auto& [key, value] : environment->as_map()) {
    auto text = value.is_null() ? std::optional(std::string{}) : scalar_text(value);
    const bool bad_key = key.empty() || key.find_first_of(std::string_view("=\0", 2)) != std::string::npos;
    if (bad_key || !text || text->find('\0') != std::string::npos) {
      source.error("bad-environment",
                   fields.what() + ": the environment variable " + quote(key) + " must be a name and a text",
                   value);
      continue;
    }
    deployment.environment.emplace_back(key, std::move(*text));
  }
}

}  // namespace segue::model::detail
