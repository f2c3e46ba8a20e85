// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/port_pattern.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace segue::model::detail {

using type::Value;

namespace {

constexpr std::string_view kPose = "/base/samples/RigidBodyState";

std::string read_type(Fields& fields, std::string_view key, ComponentModel& model, const Source& source) {
  const Value* type = fields.find(key);
  if (type == nullptr) return {};
  return rock_type_name(scalar_text(*type).value_or(""), model, *type, source);
}

/// `wrapper: ro_ptr` is a read-only pointer, which every sample is here; any other wrapper is a type of its
/// own:
/// "/spatio_temporal</maps/grid/MLSMap>".
std::string wrapped(const std::string& type, const std::string& wrapper) {
  if (type.empty() || wrapper.empty() || wrapper == "ro_ptr") return type;
  return "/" + wrapper + "<" + type + ">";
}

void read_interface_ports(Fields& task, std::string_view key, Direction direction, ComponentModel& model,
                          const Source& source) {
  for (const Value& item : task.entries(key)) {
    Fields fields(item, "an entry of " + quote(key) + " of " + task.what(), source);
    PortModel port;
    port.name = fields.required_name("name");
    port.direction = direction;
    port.type = wrapped(read_type(fields, "type", model, source), fields.text("wrapper"));
    port.doc = fields.text("doc");
    for (const std::string_view hint :
         {"needs_reliable_connection", "needs_buffered_connection", "transform_output"})
      fields.ignore(hint);
    fields.finish();
    if (!port.name.empty()) model.ports.push_back(std::move(port));
  }
}

void read_interface_families(Fields& task, ComponentModel& model, const Source& source) {
  constexpr std::array<std::string_view, 2> kDirections = {"input", "output"};
  for (const Value& item : task.entries("dynamic_ports")) {
    Fields fields(item, "an entry of 'dynamic_ports' of " + task.what(), source);
    fields.require("pattern");
    fields.require("direction");
    const auto direction = fields.choice("direction", kDirections, "bad-direction");
    PortModel port = rock_family(fields.text("pattern"), static_cast<Direction>(direction.value_or(0)),
                                 wrapped(read_type(fields, "type", model, source), fields.text("wrapper")));
    fields.finish();
    if (auto usable = check_port_pattern(port.name); !usable) {
      source.error("bad-pattern", fields.what() + ": " + usable.error().message, item);
    }
    model.ports.push_back(std::move(port));
  }
}

void read_interface_properties(Fields& task, ComponentModel& model, const Source& source) {
  for (const Value& item : task.entries("properties")) {
    Fields fields(item, "a property of " + task.what(), source);
    PropertyModel property;
    property.name = fields.required_name("name");
    property.type = read_type(fields, "type", model, source);
    property.live = fields.boolean("dynamic", false);
    property.doc = fields.text("doc");
    if (const Value* value = fields.find("default")) {
      property.default_value = rock_default(*value, property, source);
    }
    fields.finish();
    if (!property.name.empty()) model.properties.push_back(std::move(property));
  }
}

void read_interface_operations(Fields& task, ComponentModel& model, const Source& source) {
  constexpr std::array<std::string_view, 2> kThreads = {"callee_thread", "caller_thread"};
  for (const Value& item : task.entries("operations")) {
    Fields fields(item, "an operation of " + task.what(), source);
    OperationModel operation;
    operation.name = fields.required_name("name");
    operation.result = read_type(fields, "returns", model, source);
    operation.caller_thread = fields.choice("runs_in", kThreads, "bad-thread").value_or(0) == 1;
    operation.doc = fields.text("doc");
    for (const Value& argument : fields.entries("arguments")) {
      Fields argument_fields(argument, "an argument of " + fields.what(), source);
      const std::string name = argument_fields.required_name("name");
      operation.arguments.push_back(
          {name, read_type(argument_fields, "type", model, source), argument_fields.text("doc")});
      argument_fields.finish();
    }
    fields.finish();
    if (!operation.name.empty()) model.operations.push_back(std::move(operation));
  }
}

/// Seconds, sometimes written as text.
std::optional<Duration> seconds_or_text(const Value* value) {
  if (value == nullptr) return std::nullopt;
  const std::string text = scalar_text(*value).value_or("");
  double number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = status == std::errc{} && end == text.data() + text.size();
  if (!whole || !(number > 0) || number > 1e6) return std::nullopt;
  return Duration(std::llround(number * 1e9));
}

void read_default_activity(Fields& task, ComponentModel& model, const Source& source) {
  const Value* value = task.find("default_activity", Value::Kind::Map);
  if (value == nullptr) return;
  Fields fields(*value, "the default activity of " + task.what(), source);
  model.own_activity = true;
  if (auto trigger = fields.choice("type", kTriggerNames, "bad-activity")) {
    model.activity.trigger = static_cast<Trigger>(*trigger);
  }
  const auto period = seconds_or_text(fields.find("period"));
  if (model.activity.trigger == Trigger::Periodic) {
    if (!period) source.error("bad-duration", fields.what() + ": 'period' must be seconds above 0", *value);
    model.activity.period = period.value_or(Duration::zero());
  }
  // A missing list means all input ports.
  const Value* ports = fields.find("ports");
  if (ports != nullptr && ports->is_list()) model.trigger_ports = fields.texts("ports");
  fields.finish();
}

void add_property(ComponentModel& model, std::string name, std::string type, Value value, std::string doc) {
  if (model.find_property(name) != nullptr) return;
  model.properties.push_back({std::move(name), std::move(type), std::move(value), false, std::move(doc)});
}

/// Adds the ports and properties of the transformer plugin, which specifications do not list.
void read_transformer(Fields& task, ComponentModel& model, const Source& source) {
  const Value* value = task.find("transformer", Value::Kind::Map);
  if (value == nullptr) return;
  Fields fields(*value, "the transformer of " + task.what(), source);
  fields.ignore("kind");
  model.ports.push_back({"dynamic_transformations", Direction::Input, std::string(kPose), false, false,
                         "from the transformer plugin"});
  add_property(model, "static_transformations", "/std/vector<" + std::string(kPose) + ">", {},
               "transformations that do not change");
  if (const Value* latency = fields.find("max_latency")) {
    add_property(model, "transformer_max_latency", "/double", *latency,
                 "seconds that samples are waited for");
  }
  for (const Value& item : fields.entries("transformations")) {
    Fields transformation(item, "a transformation of " + task.what(), source);
    for (const std::string_view key : {"from", "to"}) {
      const std::string frame = transformation.name(key);
      if (!frame.empty()) add_property(model, frame + "_frame", "/std/string", frame, "name of a frame");
    }
    transformation.finish();
  }
  for (const Value& item : fields.entries("aligned_ports")) {
    Fields port(item, "an aligned port of " + task.what(), source);
    const Value* period = port.find("period");
    const std::string name = port.required_name("port");
    add_property(model, name + "_period", "/double", period == nullptr ? Value() : *period,
                 "seconds between samples");
    port.finish();
  }
  fields.finish();
}

void read_interface_task(const std::string& name, const Value& value, ComponentCatalog& catalog,
                         const Source& source) {
  Fields task(value, "component " + quote(name), source);
  check_name(name, task.what(), value, source);
  if (const Value* see = task.find("see")) {
    source.warning("reference",
                   task.what() + " is described in " + type::describe(*see) + "; load that file as well",
                   value);
    return;
  }
  ComponentModel model;
  model.name = ComponentName(name);
  model.where = source.at(value);
  model.doc = task.text("note");
  model.parent = task.name("subclasses");
  model.abstract = task.boolean("abstract", false);
  task.ignore("kind");
  task.ignore("needs_configuration");
  read_interface_ports(task, "input_ports", Direction::Input, model, source);
  read_interface_ports(task, "output_ports", Direction::Output, model, source);
  read_interface_families(task, model, source);
  read_interface_properties(task, model, source);
  read_interface_operations(task, model, source);
  model.nominal_states = task.texts("runtime_states");
  model.error_states = task.texts("error_states");
  read_default_activity(task, model, source);
  read_transformer(task, model, source);
  task.finish();
  catalog.add(std::move(model));
}

bool is_interface_task(const Value& value) {
  constexpr std::array<std::string_view, 4> kKeys = {"input_ports", "output_ports", "subclasses", "see"};
  return std::ranges::any_of(kKeys, [&](auto key) { return value.find(key) != nullptr; });
}

}  // namespace

bool is_rock_interface(const Value& root) {
  const Value* tasks = root.find("tasks");
  if (tasks == nullptr || !tasks->is_map() || tasks->as_map().empty()) return false;
  return is_interface_task(tasks->as_map().begin()->second);
}

void read_rock_interface(const Value& root, ComponentCatalog& catalog, const Source& source) {
  Fields file(root, "the file", source);
  for (const std::string_view key :
       {"source", "project", "uses_task_libraries", "note", "dynamic_ports_seen"})
    file.ignore(key);
  for (const auto& [name, value] : file.find("tasks")->as_map())
    read_interface_task(name, value, catalog, source);
  file.finish();
}

}  // namespace segue::model::detail
