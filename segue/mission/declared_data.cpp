// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/declared_data.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/world_values.hpp>

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
  if (const Value* script = fields.find("python"))
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

/// The values that an action looks at and changes.
class ValueCheck {
 public:
  ValueCheck(const Mission& mission, const Action& action, Diagnostics& diagnostics)
      : mission_(mission), action_(action), diagnostics_(diagnostics) {}

  void run() {
    for (const std::string& name : action_.reads_data)
      check_known(name, "'reads_world'", action_.where);
    for (const std::string& placeholder : world_placeholders(action_))
      check_known(placeholder_field(placeholder)->data, quote("{" + placeholder + "}"), action_.where);
    for (const DataChange& change : action_.changes)
      check(change);
    if (!action_.changes.empty() && action_.action_class() != ActionClass::Irreversible) {
      error("bad-effect",
            std::string("it is ") + (action_.sensing ? "sensing" : "pure") +
                ", so it cannot change world data: its result may be discarded",
            action_.changes.front().where);
    }
  }

 private:
  void error(std::string code, const std::string& message, const SourcePlace& where) {
    diagnostics_.error(std::move(code), "action " + quote(action_.name.str()) + ": " + message, where);
  }

  void check_known(std::string_view name, const std::string& where_named, const SourcePlace& where) {
    std::vector<std::string> names;
    for (const DeclaredData& data : mission_.world_data)
      names.push_back(data.name);
    const auto found = std::ranges::find(mission_.world_data, name, &DeclaredData::name);
    if (found == mission_.world_data.end()) {
      error("unknown-data",
            where_named + " names the world data " + quote(name) + ", which the mission does not have" +
                did_you_mean(std::string(name), names),
            where);
    } else if (!is_value(*found)) {
      error("scripted-data",
            where_named + " names the world data " + quote(name) +
                ", which follow facts by functions in Python: only scripts with 'reads_world: true' see them",
            where);
    }
  }

  void check(const DataChange& change) {
    check_known(world_field(change.field).data, "an effect on " + quote(change.field), change.where);
    for (const std::string& name : sources_of(change)) {
      if (placeholder_field(name) || position(action_.inputs, name) || position(action_.outputs, name))
        continue;
      error("unknown-port",
            "its effect on " + quote(change.field) + " uses " + quote(name) +
                ", which is neither an input nor an output of it" + suggestion(action_.inputs, name),
            change.where);
    }
  }

  const Mission& mission_;
  const Action& action_;
  Diagnostics& diagnostics_;
};

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
    if (!is_value(data)) entry.append("python", write_script(data.functions));
    if (!data.effects.empty()) entry.append("effects", std::move(effects));
    entries.append(data.name, std::move(entry));
  }
  map.append("world_data", std::move(entries));
}

void check_declared_data(const Mission& mission, Diagnostics& diagnostics) {
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
    if (is_value(data) && !data.effects.empty()) {
      diagnostics.error("bad-effect",
                        described(data) +
                            ": 'effects' names functions of the script under 'python', which is missing; a "
                            "value is changed by the effects of actions, as in effects: [{" +
                            data.name + ": \"{input}\"}]",
                        data.where);
    } else {
      for (const DataEffect& effect : data.effects)
        check_effect(mission, data, effect, diagnostics);
    }
    const auto reads = [&](const Action& action) {
      if (action.reads_world) return true;
      return std::ranges::binary_search(values_read(mission, action), data.name);
    };
    if (std::ranges::none_of(mission.actions, reads))
      diagnostics.warning("never-read", described(data) + ": no action declares 'reads_world'", data.where);
  }
  for (const Action& action : mission.actions)
    ValueCheck(mission, action, diagnostics).run();
}

}  // namespace segue::mission::detail
