// SPDX-License-Identifier: Apache-2.0
#include "found_parameters.hpp"

namespace ros2 {

using segue::Lock;
using segue::type::Value;

FoundParameters& FoundParameters::of_this_process() {
  static FoundParameters all;
  return all;
}

bool FoundParameters::knows(const Name& parameter) const {
  const Lock lock(mutex_);
  const auto known = all_.find(parameter);
  return known != all_.end() && !known->second.value.is_null();
}

void FoundParameters::note(const void* task, const Name& parameter, Value found) {
  const Lock lock(mutex_);
  all_.try_emplace(parameter, Found{std::move(found)}).first->second.tasks.insert(task);
}

std::optional<Value> FoundParameters::find(const void* task, const Name& parameter) const {
  const Lock lock(mutex_);
  const auto known = all_.find(parameter);
  if (known == all_.end() || known->second.value.is_null()) return {};
  const auto& tasks = known->second.tasks;
  return tasks == std::set{task} ? std::optional(known->second.value) : std::nullopt;
}

void FoundParameters::let_go(const void* task, const Name& parameter) {
  const Lock lock(mutex_);
  const auto known = all_.find(parameter);
  if (known == all_.end()) return;
  known->second.tasks.erase(task);
  if (known->second.tasks.empty()) all_.erase(known);
}

}  // namespace ros2
