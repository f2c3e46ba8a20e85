// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/controller_progress.hpp>

#include <utility>

namespace segue::mission {

using type::Value;

namespace {

constexpr const char* kTells = "tells";
constexpr const char* kTold = "told";

}  // namespace

Value ControllerProgress::to_value() const {
  type::ValueMap set;
  for (const MemberValue& one : properties)
    set.append(to_string(one.member), one.value);
  type::ValueMap counts;
  for (const auto& [task, count] : updates)
    counts.append(task, count);
  return Value::map({{"stage", stage == Stage::Told ? kTold : kTells},
                     {"controller", controller},
                     {"set", std::move(set)},
                     {"updates", std::move(counts)}});
}

ControllerProgress ControllerProgress::of(const Value& value) {
  ControllerProgress progress;
  if (value.is_null()) return progress;
  progress.stage = Stage::Tells;
  const Value* stage = value.find("stage");
  const Value* controller = value.find("controller");
  const Value* set = value.find("set");
  const Value* updates = value.find("updates");
  if (stage == nullptr || *stage != Value(kTold) || controller == nullptr || !controller->is_string() ||
      set == nullptr || !set->is_map() || updates == nullptr || !updates->is_map())
    return progress;
  progress.stage = Stage::Told;
  progress.controller = controller->as_string();
  for (const auto& [name, one] : set->as_map())
    progress.properties.push_back({parse_member(name), one, {}});
  for (const auto& [task, count] : updates->as_map())
    progress.updates.emplace(task, count.is_integer() ? count.as_uint() : 0);
  return progress;
}

}  // namespace segue::mission
