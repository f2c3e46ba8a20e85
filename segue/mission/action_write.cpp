// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>

namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

Value text_list(const std::vector<std::string>& texts) {
  return Value(Value::List(texts.begin(), texts.end()));
}

Value write_facts(const std::vector<Fact>& facts, std::string_view yes, std::string_view no) {
  Value::List list;
  for (const Fact& fact : facts)
    list.emplace_back(std::string(fact.positive ? yes : no) + to_string(fact));
  return list;
}

bool is_empty_map(const Value& value) {
  return value.is_map() && value.as_map().empty();
}

Value write_use(const ResourceUse& use) {
  ValueMap map;
  map.append(std::string(kResourceOperationNames[static_cast<std::size_t>(use.operation)]), use.resource);
  if (use.count != 1) map.append("count", use.count);
  if (!is_empty_map(use.parameters)) map.append("parameters", use.parameters);
  if (use.keep) map.append("keep", true);
  return map;
}

Value write_run(const Callback& callback) {
  return Value::map({{"callback", callback.name}});
}

Value write_run(const Script& script) {
  return Value::map({{"python", write_script(script)}});
}

Value write_run(const Simulated& simulated) {
  ValueMap map;
  if (simulated.duration != Duration::zero()) map.append("duration", format_duration(simulated.duration));
  if (!simulated.outcomes.empty()) map.append("outcomes", text_list(simulated.outcomes));
  write_values(map, "outputs", simulated.outputs);
  if (!simulated.error.empty()) map.append("error", simulated.error);
  return Value::map({{"simulated", std::move(map)}});
}

Value write_run(const Decision& decision) {
  Value::List rules;
  for (const DecisionRule& rule : decision.rules) {
    ValueMap map;
    ValueMap when;
    for (const auto& [state, outcome] : rule.when)
      when.append(state, outcome);
    if (!when.empty()) map.append("when", std::move(when));
    map.append("outcome", rule.outcome);
    rules.emplace_back(std::move(map));
  }
  return Value::map({{"decide", std::move(rules)}});
}

Value write_run(const ControllerUse& use) {
  return write_controller(use);
}

Value write_run(const PoolCall& call) {
  return write_pool_call(call);
}

Value write_run(std::monostate /*nothing*/) {
  return {};
}

void write_effects(ValueMap& map, const Action& action) {
  if (action.effects.empty() && action.changes.empty()) return;
  Value::List effects = write_facts(action.effects, "+", "-").as_list();
  for (const DataChange& change : action.changes)
    effects.push_back(Value::map({{change.field, change.value}}));
  map.append("effects", std::move(effects));
}

Value write_port(const Port& port) {
  if (port.value.is_null()) return port.type;
  return Value::map({{"type", port.type}, {"default", port.value}});
}

}  // namespace

void write_ports(ValueMap& map, std::string_view key, const std::vector<Port>& ports) {
  if (ports.empty()) return;
  ValueMap entries;
  for (const Port& port : ports)
    entries.append(port.name, write_port(port));
  map.append(std::string(key), std::move(entries));
}

void write_values(ValueMap& map, std::string_view key, const std::vector<PortValue>& values) {
  if (values.empty()) return;
  ValueMap entries;
  for (const PortValue& value : values)
    entries.append(value.port, value.value);
  map.append(std::string(key), std::move(entries));
}

void write_outcomes(ValueMap& map, const std::vector<std::string>& outcomes) {
  if (outcomes != std::vector<std::string>{"success"}) map.append("outcomes", text_list(outcomes));
}

void write_needs(ValueMap& map, const std::vector<Fact>& preconditions,
                 const std::vector<ResourceUse>& resources) {
  if (!preconditions.empty()) map.append("preconditions", write_facts(preconditions, "", "!"));
  if (resources.empty()) return;
  Value::List uses;
  for (const ResourceUse& use : resources)
    uses.push_back(write_use(use));
  map.append("resources", std::move(uses));
}

Value write_action(const Action& action) {
  ValueMap map;
  if (!action.description.empty()) map.append("description", action.description);
  write_ports(map, "inputs", action.inputs);
  write_ports(map, "outputs", action.outputs);
  write_outcomes(map, action.outcomes);
  write_needs(map, action.preconditions, action.resources);
  if (!action.during.empty()) map.append("while", write_facts(action.during, "", "!"));
  write_effects(map, action);
  if (action.pure) map.append("pure", true);
  if (action.sensing) map.append("sensing", true);
  if (action.reads_world) map.append("reads_world", true);
  if (!action.reads_data.empty()) map.append("reads_world", text_list(action.reads_data));
  if (action.strict) map.append("strict", true);
  if (action.controllers) map.append("controllers", text_list(*action.controllers));
  ValueMap expect;
  if (action.expected_duration) expect.append("duration", format_duration(*action.expected_duration));
  if (!action.expected_outcome.empty()) expect.append("outcome", action.expected_outcome);
  ValueMap likelihoods;
  for (const OutcomeLikelihood& one : action.likelihoods)
    likelihoods.append(one.outcome, one.likelihood);
  if (!likelihoods.empty()) expect.append("likelihood", std::move(likelihoods));
  if (!expect.empty()) map.append("expect", std::move(expect));
  Value run = std::visit([](const auto& how) { return write_run(how); }, action.run);
  if (!run.is_null()) map.append("run", std::move(run));
  return map;
}

Value write_script(const Script& script) {
  if (script.text.empty() && !script.isolated) return script.file;
  ValueMap map;
  map.append(script.text.empty() ? "file" : "text", script.text.empty() ? script.file : script.text);
  if (script.isolated) map.append("isolated", true);
  return map;
}

Value write_resource(const Resource& resource) {
  ValueMap map;
  map.append("class", kResourceClassNames[static_cast<std::size_t>(resource.kind)]);
  if (resource.of_robot) map.append("of", "robot");
  if (resource.count != (resource.of_robot ? Resource::kNoCount : 1)) map.append("count", resource.count);
  if (!is_empty_map(resource.parameters)) map.append("parameters", resource.parameters);
  if (resource.commutes) map.append("commutes", true);
  if (resource.observe) map.append("observe", write_observed_units(*resource.observe));
  return map;
}

}  // namespace segue::mission::detail
