// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/declared_data.hpp>
#include <segue/mission/mission_file_parts.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

std::string described(const DeclaredData& data) {
  return "the world data " + quote(data.name);
}

DeclaredData read_one(const std::string& name, const Value& value, const Source& source) {
  DeclaredData data;
  data.name = name;
  data.where = source.at(value);
  Fields fields(value, described(data), source);
  if (const Value* initial = fields.require("initial", "what they are when the mission begins"))
    data.initial = *initial;
  if (const Value* script = fields.require("python", "the script with the functions that 'effects' names"))
    data.functions = read_script(*script, fields.what(), source);
  if (data.functions.isolated)
    source.error("bad-script", fields.what() + ": only the scripts of actions can be 'isolated'", value);
  const Value* effects = fields.find("effects", Value::Kind::Map);
  fields.finish();
  if (effects == nullptr) return data;
  for (const auto& [of, function] : effects->as_map())
    data.effects.push_back(
        {of, model::detail::scalar_text(function).value_or(std::string()), source.at(function)});
  return data;
}

/// Whether JSON, by which scripts get values, has the number everywhere in the value.
bool is_finite(const Value& value) {
  if (value.kind() == Value::Kind::Float) return std::isfinite(value.as_double());
  if (value.is_list()) return std::ranges::all_of(value.as_list(), is_finite);
  return !value.is_map() ||
         std::ranges::all_of(value.as_map(), [](const auto& entry) { return is_finite(entry.second); });
}

bool can_happen(const Mission& mission, std::string_view predicate, bool becomes_true) {
  return std::ranges::any_of(mission.actions, [&](const Action& action) {
    return std::ranges::any_of(action.effects, [&](const Fact& fact) {
      return fact.predicate == predicate && fact.positive == becomes_true;
    });
  });
}

void check_effect(const Mission& mission, const DeclaredData& data, const DataEffect& effect,
                  Diagnostics& diagnostics) {
  const std::string what = described(data);
  const bool has_sign = effect.of.starts_with('+') || effect.of.starts_with('-');
  const std::string predicate = effect.of.substr(has_sign ? 1 : 0);
  if (!has_sign || !is_identifier(predicate)) {
    diagnostics.error("bad-effect",
                      what +
                          ": 'effects' must be for the names of facts that become true or false, such as "
                          "+holding or -holding, not " +
                          quote(effect.of),
                      effect.where);
    return;
  }
  if (!is_identifier(effect.function)) {
    diagnostics.error(
        "bad-function",
        what + ": expected the name of a function in its script for " + effect.of + ", such as " + predicate,
        effect.where);
  }
  if (!can_happen(mission, predicate, effect.of.front() == '+')) {
    diagnostics.warning("never-called", what + ": no action has an effect " + effect.of, effect.where);
  }
}

}  // namespace

std::vector<DeclaredData> read_declared_data(Fields& fields, const Source& source) {
  std::vector<DeclaredData> all;
  const Value* map = fields.find("world_data", Value::Kind::Map);
  if (map == nullptr) return all;
  for (const auto& [name, value] : map->as_map())
    all.push_back(read_one(name, value, source));
  return all;
}

void write_declared_data(ValueMap& map, const std::vector<DeclaredData>& all) {
  if (all.empty()) return;
  ValueMap entries;
  for (const DeclaredData& data : all) {
    ValueMap effects;
    for (const DataEffect& effect : data.effects)
      effects.append(effect.of, effect.function);
    ValueMap entry;
    entry.append("initial", data.initial);
    entry.append("python", write_script(data.functions));
    if (!data.effects.empty()) entry.append("effects", std::move(effects));
    entries.append(data.name, std::move(entry));
  }
  map.append("world_data", std::move(entries));
}

void check_declared_data(const Mission& mission, Diagnostics& diagnostics) {
  const bool is_read = std::ranges::any_of(mission.actions, &Action::reads_world);
  for (const DeclaredData& data : mission.world_data) {
    if (!is_identifier(data.name))
      diagnostics.error("bad-name", described(data) + ": the name must be an identifier, such as scene",
                        data.where);
    if (!is_finite(data.initial))
      diagnostics.error("bad-value",
                        described(data) +
                            ": 'initial' is infinite or not a number somewhere, which cannot "
                            "be passed to a script",
                        data.where);
    for (const DataEffect& effect : data.effects)
      check_effect(mission, data, effect, diagnostics);
    if (!is_read)
      diagnostics.warning("never-read", described(data) + ": no action declares 'reads_world'", data.where);
  }
}

}  // namespace segue::mission::detail
