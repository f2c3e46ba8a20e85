// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission_script/scripted_data.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

using type::Value;

struct ScriptedData::Step {
  Step(StepPtr previous, Change what) : before(std::move(previous)), change(std::move(what)) {}
  Step(const Step&) = delete;
  Step& operator=(const Step&) = delete;
  ~Step();

  mutable StepPtr before;                      ///< null: the first, or `value` is known
  mutable std::shared_ptr<const Value> value;  ///< after the change; null: not computed yet
  const Change change;
};

/// Chains are long, so steps that go with this one are not destroyed within each other.
ScriptedData::Step::~Step() {
  static thread_local std::vector<StepPtr>* outermost = nullptr;
  if (before == nullptr) return;
  if (outermost != nullptr) {
    outermost->push_back(std::move(before));
    return;
  }
  std::vector<StepPtr> released;
  released.push_back(std::move(before));
  outermost = &released;
  while (!released.empty()) {
    const StepPtr next = std::move(released.back());
    released.pop_back();
  }
  outermost = nullptr;
}

ScriptedData::ScriptedData(std::shared_ptr<const Functions> functions)
    : functions_(std::move(functions)),
      mutex_(std::make_shared<Mutex>()),
      initial_(functions_, &functions_->declared.initial) {}
ScriptedData::~ScriptedData() = default;
ScriptedData::ScriptedData(const ScriptedData& other) = default;

std::shared_ptr<WorldData> ScriptedData::clone() const {
  return std::make_shared<ScriptedData>(*this);
}

void ScriptedData::changed(const std::string& fact, bool holds) {
  const std::string of = (holds ? "+" : "-") + fact.substr(0, fact.find('('));
  if (std::ranges::find(functions_->declared.effects, of, &DataEffect::of) ==
      functions_->declared.effects.end())
    return;
  last_ = std::make_shared<const Step>(std::move(last_), Change{fact, holds});
}

ScriptedData::Task ScriptedData::next(std::size_t most) const {
  Task task{initial_, {}, nullptr, true};
  const Lock lock(*mutex_);
  std::vector<const StepPtr*> open;
  const StepPtr* step = &last_;
  for (; *step != nullptr && (*step)->value == nullptr; step = &(*step)->before)
    open.push_back(step);
  if (*step != nullptr) task.base = (*step)->value;
  task.is_last = open.size() <= most;
  const std::size_t count = std::min(open.size(), most);
  for (std::size_t i = 0; i < count; ++i) {
    task.until = *open[open.size() - 1 - i];
    task.changes.push_back(task.until->change);
  }
  return task;
}

void ScriptedData::computed(const Task& task, Value value) const {
  if (task.until == nullptr) return;
  auto known = std::make_shared<const Value>(std::move(value));
  StepPtr released;  // without the lock
  const Lock lock(*mutex_);
  if (task.until->value != nullptr) return;
  task.until->value = std::move(known);
  released = std::move(task.until->before);
}

Result<void> attach_declared(const Mission& mission, AttachedData& data) {
  for (const DeclaredData& declared : mission.world_data) {
    if (data.contains(declared.name)) {
      return fail(ErrorCode::InvalidArgument, "the mission declares the world data " + quote(declared.name) +
                                                  ", and the program attaches data of that name, too");
    }
    data.emplace(
        declared.name,
        std::make_shared<const ScriptedData>(std::make_shared<const ScriptedData::Functions>(
            ScriptedData::Functions{declared, script_file(mission, declared.functions, declared.where)})));
  }
  return {};
}

}  // namespace segue::mission
