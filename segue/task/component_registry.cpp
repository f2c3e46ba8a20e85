// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/task/component.hpp>
#include <segue/task/component_registry.hpp>

#include <exception>
#include <map>

namespace segue::task {

namespace {

/// Created at first use, since registrations run before main.
struct Registry {
  Mutex mutex;
  std::map<std::string, ComponentEntry, std::less<>> entries SEGUE_GUARDED_BY(mutex);
  std::vector<ComponentEntry> rejected SEGUE_GUARDED_BY(mutex);

  static Registry& instance() {
    static auto* registry = new Registry;  // never destroyed: libraries unregister nothing at exit
    return *registry;
  }
};

std::string& current_library() {
  thread_local std::string library;
  return library;
}

}  // namespace

Result<std::unique_ptr<Component>> ComponentEntry::create() const {
  if (abi != kComponentAbi) {
    return fail(ErrorCode::Unsupported, "component " + quote(name) + " was built for " + quote(abi) +
                                            ", this program is " + quote(kComponentAbi) +
                                            "; compile its library anew");
  }
  try {
    auto component = make();
    component->set_component_name(name);
    return component;
  } catch (const std::exception& thrown) {
    return fail(ErrorCode::HookFailed, "the constructor of " + quote(name) + " threw: " + thrown.what());
  } catch (...) {
    return fail(ErrorCode::HookFailed,
                "the constructor of " + quote(name) + " threw something other than a std::exception");
  }
}

std::optional<ComponentEntry> find_component(std::string_view name) {
  Registry& registry = Registry::instance();
  const Lock lock(registry.mutex);
  const auto found = registry.entries.find(name);
  if (found == registry.entries.end()) return std::nullopt;
  return found->second;
}

std::vector<ComponentEntry> registered_components() {
  Registry& registry = Registry::instance();
  const Lock lock(registry.mutex);
  std::vector<ComponentEntry> entries;
  for (const auto& [name, entry] : registry.entries)
    entries.push_back(entry);
  return entries;
}

bool register_component(ComponentEntry entry) {
  if (entry.name.starts_with("::")) entry.name.erase(0, 2);
  Registry& registry = Registry::instance();
  const Lock lock(registry.mutex);
  const auto [place, is_new] = registry.entries.try_emplace(entry.name, entry);
  if (!is_new) registry.rejected.push_back(std::move(entry));
  return is_new;
}

std::vector<ComponentEntry> take_rejected_components() {
  Registry& registry = Registry::instance();
  const Lock lock(registry.mutex);
  return std::exchange(registry.rejected, {});
}

LibraryScope::LibraryScope(std::string library)
    : previous_(std::exchange(current_library(), std::move(library))) {}

LibraryScope::~LibraryScope() {
  current_library() = std::move(previous_);
}

detail::Registration::Registration(std::string_view name, std::string_view abi,
                                   std::unique_ptr<Component> (*make)()) {
  register_component({std::string(name), current_library(), std::string(abi), make});
}

}  // namespace segue::task
