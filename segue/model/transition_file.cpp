// SPDX-License-Identifier: Apache-2.0
#include <segue/model/controller_names.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/type/yaml.hpp>

#include <limits>
#include <unordered_map>
#include <utility>

namespace segue::model {

using detail::Fields;
using detail::Source;
using type::Value;
using type::ValueMap;

namespace {

ConfigAction read_config(Fields& fields, const Source& source) {
  ConfigAction action;
  const std::string task = fields.required_name("task");
  const Value* definition =
      fields.require("definition", "apply_config carries the whole task as the target network has it");
  if (definition != nullptr) action.definition = detail::read_task(task, *definition, source);
  const std::string host = fields.name("host");
  action.process.process = ProcessName(fields.name("process"));
  if (!host.empty() || !action.process.process.empty()) action.process.host = detail::host_named(host);
  action.name = fields.name("name");
  if (action.name.empty()) action.name = task;
  return action;
}

CallAction read_call(Fields& fields) {
  CallAction action;
  action.task = TaskId(fields.required_name("task"));
  action.operation = fields.required_name("operation");
  if (const Value* arguments = fields.find("arguments", Value::Kind::Map)) action.arguments = *arguments;
  return action;
}

DeploymentAction read_deployment(Fields& fields, ActionKind kind, const Source& source) {
  DeploymentAction action;
  detail::read_process(fields, action.deployment, source);
  action.deployment.process = ProcessName(fields.required_name("process"));
  if (kind == ActionKind::Undeploy) action.kill = fields.boolean("kill", false);
  return action;
}

void read_subject(Action& action, Fields& fields, const Source& source) {
  switch (action.kind) {
    case ActionKind::Recover:
    case ActionKind::Stop:
    case ActionKind::Cleanup:
    case ActionKind::Configure:
    case ActionKind::Start:
      action.what = TaskAction{TaskId(fields.required_name("task"))};
      return;
    case ActionKind::Disconnect:
    case ActionKind::Connect:
      if (auto connection = detail::read_connection(fields, source)) {
        action.what = ConnectionAction{std::move(*connection)};
      }
      return;
    case ActionKind::Undeploy:
    case ActionKind::Deploy:
      action.what = read_deployment(fields, action.kind, source);
      return;
    case ActionKind::ApplyConfig:
      action.what = read_config(fields, source);
      return;
    case ActionKind::HandOver:
      action.what = HandOverAction{TaskId(fields.required_name("from")), TaskId(fields.required_name("to"))};
      return;
    case ActionKind::CallOperation:
      action.what = read_call(fields);
  }
}

/// Maps written ids to our ids, which count from 1 in the order of the list.
using Ids = std::unordered_map<std::int64_t, int>;

void read_after(Action& action, Fields& fields, const Ids& earlier, const Source& source) {
  const Value* after = fields.find("after", Value::Kind::List);
  if (after == nullptr) return;
  for (const Value& item : after->as_list()) {
    auto found = item.kind() == Value::Kind::Int ? earlier.find(item.as_int()) : earlier.end();
    if (found == earlier.end()) {
      source.error(
          "unknown-action",
          fields.what() + ": 'after' must name earlier actions of the list, got " + type::describe(item),
          item);
      continue;
    }
    action.after.push_back(found->second);
  }
}

std::optional<Action> read_action(const Value& value, int id, Ids& ids, const Source& source) {
  Fields fields(value, "action " + std::to_string(id), source);
  if (!fields.is_map()) return std::nullopt;
  Action action;
  action.id = id;
  const auto written = fields.integer("id", 1, std::numeric_limits<int>::max(), "bad-id");
  fields.require("kind", "say what it does, such as 'stop' or 'connect'");
  const auto kind = fields.choice("kind", kActionKindNames, "bad-kind");
  if (auto phase = fields.choice("phase", kPhaseNames, "bad-phase")) {
    action.phase = static_cast<Phase>(*phase);
  }
  read_after(action, fields, ids, source);
  if (!ids.emplace(written.value_or(id), id).second) {
    source.error("duplicate-id", fields.what() + ": the id " + std::to_string(*written) + " is taken", value);
  }
  if (!kind) return std::nullopt;
  action.kind = static_cast<ActionKind>(*kind);
  read_subject(action, fields, source);
  fields.finish();
  return action;
}

/// Those of a union are joined: "arm+drive". Empty: the empty network.
NetworkName read_controllers(Fields& fields, std::string_view key, const Source& source) {
  const Value* value = fields.find(key);
  if (value == nullptr || !value->is_string()) return NetworkName(fields.name(key));
  const auto controllers = controllers_in(value->as_string());
  for (const NetworkName& controller : controllers) {
    if (!check_name(controller.str(), fields.what() + ": " + quote(key), *value, source)) return {};
  }
  return joined_name(controllers);
}

Transition read_transition_body(const Value& value, const Source& source) {
  Fields fields(value, "the transition", source);
  Transition transition;
  transition.file = source.file();
  transition.name = fields.name("name");
  if (transition.name.empty()) transition.name = detail::name_from_file(source.file());
  transition.from = read_controllers(fields, "from", source);
  transition.to = read_controllers(fields, "to", source);
  if (auto order = fields.choice("order", kOrderNames, "bad-order")) {
    transition.order = static_cast<Order>(*order);
  }
  if (const Value* actions = fields.find("actions", Value::Kind::List)) {
    Ids ids;
    for (const Value& item : actions->as_list()) {
      const int id = static_cast<int>(transition.actions.size()) + 1;
      auto action = read_action(item, id, ids, source);
      if (!action) continue;
      transition.actions.push_back(std::move(*action));
      transition.places.push_back(source.at(item));
    }
  }
  for (std::string& task : fields.texts("removes"))
    transition.removes.emplace_back(std::move(task));
  if (const Value* redefines = fields.find("redefines", Value::Kind::Map)) {
    for (const auto& [id, definition] : redefines->as_map())
      transition.redefines.push_back(detail::read_task(id, definition, source));
  }
  fields.ignore("counts");
  fields.ignore("estimate_s");
  fields.finish();
  return transition;
}

void write_subject(ValueMap& map, const TaskAction& action, ActionKind) {
  map.append("task", action.task.str());
}
void write_subject(ValueMap& map, const ConnectionAction& action, ActionKind) {
  detail::write_connection(map, action.connection);
}
void write_subject(ValueMap& map, const DeploymentAction& action, ActionKind) {
  map.append("host", action.deployment.host.str());
  map.append("process", action.deployment.process.str());
  if (action.kill) map.append("kill", true);
  ValueMap attributes;
  detail::write_process(attributes, action.deployment);
  attributes.erase("host");
  for (auto& [key, value] : attributes)
    map.append(key, std::move(value));
}
void write_subject(ValueMap& map, const ConfigAction& action, ActionKind) {
  map.append("task", action.definition.id.str());
  if (!action.process.host.empty()) map.append("host", action.process.host.str());
  if (!action.process.is_runtime()) map.append("process", action.process.process.str());
  if (action.name != action.definition.id.str()) map.append("name", action.name);
  map.append("definition", detail::write_task(action.definition));
}
void write_subject(ValueMap& map, const HandOverAction& action, ActionKind) {
  map.append("from", action.from.str());
  map.append("to", action.to.str());
}
void write_subject(ValueMap& map, const CallAction& action, ActionKind) {
  map.append("task", action.task.str());
  map.append("operation", action.operation);
  map.append("arguments", action.arguments);
}

Value write_counts(const ActionCounts& counts) {
  ValueMap map;
  for (std::size_t i = 0; i < kActionKindNames.size(); ++i)
    map.append(std::string(kActionKindNames.at(i)), counts.by_kind.at(i));
  map.append("state_changes", counts.state_changes());
  map.append("total", counts.total());
  return map;
}

ValueMap write_body(const Transition& transition) {
  ValueMap map;
  if (!transition.name.empty()) map.append("name", transition.name);
  map.append("from", transition.from.str());
  map.append("to", transition.to.str());
  map.append("order", to_string(transition.order));
  Value::List actions;
  actions.reserve(transition.actions.size());
  for (const Action& action : transition.actions)
    actions.push_back(to_value(action));
  map.append("actions", std::move(actions));
  if (!transition.removes.empty()) {
    Value::List removes;
    for (const TaskId& task : transition.removes)
      removes.emplace_back(task.str());
    map.append("removes", std::move(removes));
  }
  if (transition.redefines.empty()) return map;
  ValueMap redefines;
  for (const Task& task : transition.redefines)
    redefines.append(task.id.str(), detail::write_task(task));
  map.append("redefines", std::move(redefines));
  return map;
}

}  // namespace

Value to_value(const Action& action) {
  ValueMap map;
  map.append("id", action.id);
  map.append("kind", to_string(action.kind));
  std::visit([&](const auto& what) { write_subject(map, what, action.kind); }, action.what);
  map.append("phase", to_string(action.phase));
  map.append("after", Value::List(action.after.begin(), action.after.end()));
  return map;
}

Value to_value(const Transition& transition) {
  ValueMap map = write_body(transition);
  map.append("counts", write_counts(transition.counts()));
  return map;
}

std::string write_transition(const Transition& transition) {
  ValueMap body = write_body(transition);
  // The empty network has no name, so the key is omitted.
  if (transition.from.empty()) body.erase("from");
  if (transition.to.empty()) body.erase("to");
  return type::to_yaml(Value::map({{"transition", std::move(body)}}));
}

std::optional<Transition> read_transition(std::string_view text, const std::string& file,
                                          Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  const auto root = source.parse(text);
  if (!root) return std::nullopt;
  const Value* body = &*root;
  if (root->find("actions") == nullptr) {
    Fields fields(*root, "the file", source);
    body = fields.require("transition", "a transition file holds a transition");
    fields.finish();
  }
  if (body == nullptr) return std::nullopt;
  Transition transition = read_transition_body(*body, source);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return transition;
}

std::optional<Transition> load_transition(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto text = detail::read_text(file, diagnostics);
  return text ? read_transition(*text, file.string(), diagnostics) : std::nullopt;
}

}  // namespace segue::model
