// SPDX-License-Identifier: Apache-2.0
#include "resource.hpp"

#include <algorithm>

namespace segue::task_network {

namespace {

ResourceClass class_of(std::string_view name) {
  const std::string_view prefix = name.substr(0, name.find(':'));
  if (prefix == "worldmodel") return ResourceClass::World;
  const auto found = std::ranges::find(kResourceClasses, prefix);
  if (found == kResourceClasses.end()) return ResourceClass::Task;
  return static_cast<ResourceClass>(found - kResourceClasses.begin());
}

}  // namespace

ResourceId ResourceTable::intern(std::string_view name) {
  const std::uint32_t number = names_.intern(name);
  if (number == resources_.size()) resources_.push_back({.kind = class_of(name)});
  return ResourceId{number};
}

std::optional<ResourceId> ResourceTable::find(std::string_view name) const {
  const auto number = names_.find(name);
  if (!number) return std::nullopt;
  return ResourceId{*number};
}

}  // namespace segue::task_network
