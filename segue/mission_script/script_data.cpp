// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission_script/script_data.hpp>
#include <segue/mission_script/script_messages.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

/// In one message; further ones follow when these have been computed.
constexpr std::size_t kMostChanges = 10'000;

Value script_of(const ScriptedData::Functions& functions) {
  ValueMap script;
  const Script& declared = functions.declared.functions;
  if (declared.text.empty()) {
    script.append("file", functions.file.string());
  } else {
    script.append("text", declared.text);
    script.append("path", "world data " + functions.declared.name);
  }
  script.append("folder", functions.file.parent_path().string());
  return Value(std::move(script));
}

Value changes_of(const ScriptedData::Task& task, const DeclaredData& declared) {
  Value::List changes;
  for (const ScriptedData::Change& change : task.changes) {
    const FactParts parts = parts_of(change.fact);
    const std::string sign = change.holds ? "+" : "-";
    const auto effect = std::ranges::find(declared.effects, sign + parts.predicate, &DataEffect::of);
    changes.push_back(Value::list(
        {sign + change.fact, effect->function, Value::List(parts.arguments.begin(), parts.arguments.end())}));
  }
  return Value(std::move(changes));
}

}  // namespace

ScriptData::ScriptData(const WorldView& world) {
  for (const auto& [name, data] : world.data()) {
    if (auto scripted = std::dynamic_pointer_cast<const ScriptedData>(data))
      readings_.emplace(name, Reading{std::move(scripted)});
  }
}

Value ScriptData::names() const {
  Value::List names;
  for (const auto& [name, reading] : readings_)
    names.emplace_back(name);
  return Value(std::move(names));
}

ValueMap ScriptData::answer(const Value& request) {
  ValueMap answer;
  const std::string name = text_at(request, "name");
  const auto found = readings_.find(name);
  if (found == readings_.end()) {
    answer.append("error", "there are no data " + quote(name) + " to compute");
    answer.append("code", "not-found");
    return answer;
  }
  Reading& reading = found->second;
  if (const Value* value = request.find("value")) {
    const ScriptedData::Task done = std::exchange(reading.task, {});
    reading.data->computed(done, *value);
    if (done.is_last) {
      answer.append("value", Value());
      return answer;
    }
  }
  reading.task = reading.data->next(kMostChanges);
  const ScriptedData::Functions& functions = reading.data->functions();
  answer.append("value", Value::map({{"base", *reading.task.base},
                                     {"changes", changes_of(reading.task, functions.declared)},
                                     {"script", script_of(functions)},
                                     {"is_last", reading.task.is_last}}));
  return answer;
}

}  // namespace segue::mission::detail
