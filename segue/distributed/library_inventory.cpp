// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/library_inventory.hpp>

#include <segue/base/file.hpp>
#include <segue/base/sha256.hpp>
#include <segue/task_host/component_library.hpp>

namespace segue::distributed {

namespace {

LibraryInfo read_library(const std::string& name, const std::filesystem::path& file) {
  LibraryInfo info{name, {}, {}};
  if (const auto content = read_file(file)) {
    info.digest = sha256(*content);
  }
  model::ComponentCatalog catalog;
  if (task_host::read_library_models(name, catalog)) {
    for (const auto* component : catalog.all()) {
      info.components.push_back(component->name);
    }
  }
  return info;
}

}  // namespace

std::vector<LibraryInfo> LibraryInventory::list() {
  std::vector<LibraryInfo> all;
  const Lock lock(mutex_);
  for (const auto& name : task_host::installed_libraries()) {
    const auto file = task_host::find_library(name);
    if (!file) {
      continue;
    }
    const auto stamp = stamp_of(*file);
    if (!stamp) {
      continue;  // it has just been removed
    }
    auto& known = known_[*file];
    if (known.info.name.empty() || known.stamp != *stamp) {
      known = {*stamp, read_library(name, *file)};
    }
    all.push_back(known.info);
  }
  return all;
}

}  // namespace segue::distributed
