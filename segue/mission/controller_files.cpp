// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/model/condition_parts.hpp>

#include <utility>

namespace segue::mission {

namespace detail {

using model::detail::read_conditions;
using model::detail::read_member;
using type::Value;
using type::ValueMap;

namespace {

std::vector<MemberValue> read_member_values(Fields& fields, std::string_view key, std::string_view example,
                                            const Source& source) {
  std::vector<MemberValue> values;
  const Value* map = fields.find(key, Value::Kind::Map);
  if (map == nullptr) return values;
  for (const auto& [name, value] : map->as_map())
    values.push_back({read_member(name, example, fields.what() + ": " + quote(key), value, source), value,
                      source.at(value)});
  return values;
}

Duration read_positive(Fields& fields, std::string_view key, Duration otherwise, const Source& source) {
  const auto duration = fields.duration(key).value_or(otherwise);
  if (duration < Duration::zero())
    source.error("bad-duration", fields.what() + ": " + quote(key) + " must not be negative", fields.value());
  return duration;
}

/// The way in which an entry of `until` ends an action; nothing, with an error, unless exactly one way is
/// given.
std::optional<decltype(EndCondition::when)> read_when(Fields& fields, const Source& source) {
  std::vector<RobotCondition> found = read_conditions(fields, source);
  const bool is_time = fields.find("after") != nullptr;
  if (is_time && found.empty()) return TimeIsUp{read_positive(fields, "after", {}, source)};
  if (!is_time && found.size() == 1) return std::move(found.front());
  fields.ignore("after");
  source.error(
      "bad-until",
      fields.what() + ": expected exactly one of {task, state}, {port, where}, {call, is} and {after}",
      fields.value());
  return std::nullopt;
}

std::vector<EndCondition> read_until(Fields& action, const Source& source) {
  std::vector<EndCondition> all;
  for (const Value& item : action.entries("until")) {
    Fields fields(item, "'until' of " + action.what(), source);
    auto when = read_when(fields, source);
    EndCondition condition;
    condition.outcome = fields.text("outcome");
    condition.where = source.at(item);
    fields.finish();
    if (!when) continue;
    condition.when = std::move(*when);
    if (condition.outcome.empty() && std::holds_alternative<TimeIsUp>(condition.when))
      condition.outcome = kAbortedName;
    all.push_back(std::move(condition));
  }
  return all;
}

std::vector<OutputSource> read_sources(Fields& fields, const Source& source) {
  std::vector<OutputSource> sources;
  const Value* map = fields.find("outputs", Value::Kind::Map);
  if (map == nullptr) return sources;
  for (const auto& [output, port] : map->as_map()) {
    const auto text = model::detail::scalar_text(port).value_or("");
    sources.push_back({output,
                       read_member(text, "odometry.pose", fields.what() + ": 'outputs'", port, source),
                       source.at(port)});
  }
  return sources;
}

Value write_when(const TimeIsUp& when) {
  return Value::map({{"after", format_duration(when.after)}});
}
Value write_when(const RobotCondition& when) {
  return model::detail::write_condition(when);
}

void write_member_values(ValueMap& map, std::string_view key, const std::vector<MemberValue>& values) {
  if (values.empty()) return;
  ValueMap entries;
  for (const MemberValue& one : values)
    entries.append(to_string(one.member), one.value);
  map.append(std::string(key), std::move(entries));
}

ObservedFact read_observed_fact(const std::string& name, const Value& value, const Source& source) {
  Fields fields(value, "the observed fact " + quote(name), source);
  ObservedFact observed;
  observed.where = source.at(value);
  const auto fact = parse_fact(name, "");
  if (fact && ground(*fact)) {
    observed.fact = *fact;
    observed.fact.where = observed.where;
  } else {
    source.error("bad-fact",
                 fields.what() + ": expected a fact such as 'holding(box)', without a sign and inputs",
                 value);
  }
  auto when = read_one_condition(fields, "{task, state}, {port, where} and {call, is}", source);
  observed.settle = read_positive(fields, "settle", ObservedFact::kSettle, source);
  fields.finish();
  if (when) observed.when = std::move(*when);
  return observed;
}

}  // namespace

std::vector<ObservedFact> read_observed(Fields& fields, const Source& source) {
  std::vector<ObservedFact> all;
  const Value* map = fields.find("observe", Value::Kind::Map);
  if (map == nullptr) return all;
  for (const auto& [name, value] : map->as_map())
    all.push_back(read_observed_fact(name, value, source));
  return all;
}

void write_observed(ValueMap& map, const std::vector<ObservedFact>& observed) {
  if (observed.empty()) return;
  ValueMap entries;
  for (const ObservedFact& one : observed) {
    Value entry = write_when(one.when);
    if (one.settle != ObservedFact::kSettle) entry.as_map().append("settle", format_duration(one.settle));
    entries.append(to_string(one.fact), std::move(entry));
  }
  map.append("observe", std::move(entries));
}

ControllerUse read_controller(Fields& fields, const Source& source) {
  ControllerUse use;
  use.controller = fields.text("controller");
  use.set = read_member_values(fields, "set", "planner.speed", source);
  use.call = read_member_values(fields, "call", "planner.set_goal", source);
  use.write = read_member_values(fields, "write", "planner.goal", source);
  use.until = read_until(fields, source);
  use.outputs = read_sources(fields, source);
  constexpr std::array<std::string_view, 2> kAfterwards = {"keep", "stop"};
  use.stop = fields.choice("afterwards", kAfterwards, "bad-afterwards").value_or(0) == 1;
  return use;
}

Value write_controller(const ControllerUse& use) {
  ValueMap map;
  map.append("controller", use.controller);
  write_member_values(map, "set", use.set);
  write_member_values(map, "call", use.call);
  write_member_values(map, "write", use.write);
  Value::List until;
  for (const EndCondition& condition : use.until) {
    Value entry = std::visit([](const auto& when) { return write_when(when); }, condition.when);
    if (!condition.outcome.empty()) entry.as_map().append("outcome", condition.outcome);
    until.push_back(std::move(entry));
  }
  if (!until.empty()) map.append("until", std::move(until));
  ValueMap outputs;
  for (const OutputSource& one : use.outputs)
    outputs.append(one.output, to_string(one.port));
  if (!outputs.empty()) map.append("outputs", std::move(outputs));
  if (use.stop) map.append("afterwards", "stop");
  return map;
}

}  // namespace detail
}  // namespace segue::mission
