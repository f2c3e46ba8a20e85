// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/describe_component.hpp>

#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/model/port_pattern.hpp>
#include <segue/task/component_registry.hpp>

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <system_error>

namespace segue::task_host {

namespace {

namespace fs = std::filesystem;

/// The folder of the program that runs.
fs::path program_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path();
}

/// <prefix>/lib/segue, seen from the shared library with the registry of components
/// (<prefix>/lib/libsegue_task.so, or the same in a multi-architecture folder).
std::vector<fs::path> installed_folders() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&task::registered_components), &info) == 0 ||
      info.dli_fname == nullptr) {
    return {};
  }
  const fs::path own = fs::path(info.dli_fname).parent_path();
  return {own / "segue", own.parent_path() / "segue"};
}

std::vector<fs::path> environment_folders() {
  const char* variable = std::getenv("SEGUE_LIBRARY_PATH");
  std::vector<fs::path> folders;
  std::string_view rest = variable == nullptr ? "" : variable;
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    if (colon > 0) {
      folders.emplace_back(rest.substr(0, colon));
    }
    rest.remove_prefix(std::min(colon + 1, rest.size()));
  }
  return folders;
}

std::vector<std::string> shown(const std::vector<fs::path>& folders) {
  std::vector<std::string> texts;
  for (const auto& folder : folders) {
    texts.push_back(folder.string());
  }
  return texts;
}

constexpr std::string_view kPrefix = "lib";
constexpr std::string_view kSuffix = ".so";

/// "libdemo.so" -> "demo"; empty for other files.
std::string library_name(const fs::path& file) {
  const std::string name = file.filename().string();
  const bool fits =
      name.size() > kPrefix.size() + kSuffix.size() && name.starts_with(kPrefix) && name.ends_with(kSuffix);
  return fits ? name.substr(kPrefix.size(), name.size() - kPrefix.size() - kSuffix.size()) : std::string();
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

/// Whether the component's code is in that file, also where the program links the library itself.
bool lies_in(const task::ComponentEntry& entry, const fs::path& file) {
  Dl_info info{};
  return ::dladdr(reinterpret_cast<const void*>(entry.make), &info) != 0 && info.dli_fname != nullptr &&
         same_file(info.dli_fname, file);
}

std::vector<task::ComponentEntry> entries_of(const std::string& library, const fs::path& file) {
  std::vector<task::ComponentEntry> entries;
  for (auto& entry : task::registered_components()) {
    if (entry.library == library || lies_in(entry, file)) {
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

Result<void> check_families(const task::Component& component) {
  for (const auto& family : component.port_families()) {
    if (auto usable = model::check_port_pattern(family.pattern); !usable) {
      return fail(ErrorCode::InvalidArgument,
                  "component " + quote(component.component_name()) + " declares dynamic ports that cannot be")
          .because_of(std::move(usable.error()));
    }
  }
  return {};
}

Error not_found(std::string_view name, const std::vector<fs::path>& folders) {
  const auto known = installed_libraries();
  return fail(ErrorCode::NotFound,
              "no component library " + quote(name) + " (a file " + quote("lib" + std::string(name) + ".so") +
                  ") in " + listed(shown(folders)) + did_you_mean(name, known) +
                  "; set SEGUE_LIBRARY_PATH to look elsewhere",
              std::string(name));
}

Result<void> open_library(const std::string& name, const fs::path& file) {
  const task::LibraryScope scope(name);
  // RTLD_LOCAL, since two libraries may use the same symbols; the symbols that they share are in
  // libsegue_*.so.
  void* handle = nullptr;
  try {
    handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  } catch (const std::exception& exception) {
    return fail(ErrorCode::IoError, "loading " + quote(file.string()) + " threw: " + exception.what(), name);
  }
  if (handle == nullptr) {
    const char* reason = ::dlerror();
    return fail(
        ErrorCode::IoError,
        "cannot load " + quote(file.string()) + ": " + (reason == nullptr ? "no reason given" : reason),
        name);
  }
  return {};
}

Result<void> check_rejected(const std::string& library) {
  for (const auto& rejected : task::take_rejected_components()) {
    if (rejected.library != library) {
      continue;
    }
    const auto first = task::find_component(rejected.name);
    const std::string other =
        first && !first->library.empty() ? "library " + quote(first->library) : "the program";
    return fail(
        ErrorCode::AlreadyExists,
        "component " + quote(rejected.name) + " is already offered by " + other + "; load only one of them",
        library);
  }
  return {};
}

Result<void> check_entries(const std::string& library, const fs::path& file) {
  const auto entries = entries_of(library, file);
  if (entries.empty()) {
    return fail(ErrorCode::InvalidArgument,
                quote(file.string()) + " offers no components; name them with SEGUE_COMPONENT", library);
  }
  for (const auto& entry : entries) {
    if (entry.abi != task::kComponentAbi) {
      return fail(ErrorCode::Unsupported,
                  quote(file.string()) + " was built against another version of Segue (" + quote(entry.abi) +
                      ", this is " + quote(task::kComponentAbi) + "); build it anew",
                  library);
    }
  }
  return {};
}

}  // namespace

std::vector<fs::path> library_folders() {
  std::vector<fs::path> folders = environment_folders();
  if (const fs::path program = program_folder(); !program.empty()) {
    folders.push_back((program / ".." / "lib" / "segue").lexically_normal());
  }
  for (auto& folder : installed_folders()) {
    folders.push_back(std::move(folder));
  }
  std::vector<fs::path> unique;
  for (auto& folder : folders) {
    if (std::find(unique.begin(), unique.end(), folder) == unique.end()) {
      unique.push_back(std::move(folder));
    }
  }
  return unique;
}

Result<fs::path> find_library(std::string_view name) {
  if (!is_identifier(name)) {
    return fail(
        ErrorCode::InvalidArgument,
        quote(name) +
            " is not a valid name of a component library: letters, digits, '_', '-', '.' only, never a path");
  }
  const auto folders = library_folders();
  for (const auto& folder : folders) {
    std::error_code error;
    fs::path file = folder / ("lib" + std::string(name) + ".so");
    if (fs::is_regular_file(file, error)) {
      return file;
    }
  }
  return not_found(name, folders);
}

std::vector<std::string> installed_libraries() {
  std::set<std::string> names;
  for (const auto& folder : library_folders()) {
    std::error_code error;
    for (const auto& file : fs::directory_iterator(folder, error)) {
      if (const std::string name = library_name(file.path()); is_identifier(name)) {
        names.insert(name);
      }
    }
  }
  return {names.begin(), names.end()};
}

Result<void> read_library_models(std::string_view name, model::ComponentCatalog& catalog) {
  auto file = find_library(name);
  if (!file) {
    return std::move(file.error());
  }
  const fs::path models = file->parent_path() / (std::string(name) + ".components.yaml");
  Diagnostics diagnostics;
  if (!model::load_components(models, catalog, diagnostics)) {
    return diagnostics.to_error(ErrorCode::ParseError);
  }
  return {};
}

Result<void> LibrarySet::load(std::string_view name) {
  if (std::find(loaded_.begin(), loaded_.end(), name) != loaded_.end()) {
    return {};
  }
  const auto file = find_library(name);
  if (!file) {
    return file.error();
  }
  return load_file(std::string(name), *file);
}

Result<std::string> LibrarySet::load_path(const fs::path& file) {
  std::string name = library_name(file);
  if (!is_identifier(name)) {
    return fail(ErrorCode::InvalidArgument,
                quote(file.string()) + " is not a component library; its name must be lib<name>.so");
  }
  std::error_code error;
  const fs::path whole = fs::absolute(file, error);
  if (auto loaded = load_file(name, error ? file : whole); !loaded) {
    return std::move(loaded.error());
  }
  return name;
}

Result<void> LibrarySet::load_file(const std::string& name, const fs::path& file) {
  static_cast<void>(task::take_rejected_components());
  if (auto opened = open_library(name, file); !opened) {
    return opened;
  }
  if (auto unique = check_rejected(name); !unique) {
    return unique;
  }
  if (auto good = check_entries(name, file); !good) {
    return good;
  }
  loaded_.push_back(name);
  files_.push_back(file);
  return {};
}

bool LibrarySet::offers(const task::ComponentEntry& entry) const {
  return entry.library.empty() || std::find(loaded_.begin(), loaded_.end(), entry.library) != loaded_.end();
}

bool LibrarySet::has(const model::ComponentName& component) const {
  const auto entry = task::find_component(component.str());
  return entry && offers(*entry);
}

Result<std::unique_ptr<task::Component>> LibrarySet::create(const model::ComponentName& component) const {
  const auto entry = task::find_component(component.str());
  if (entry && offers(*entry)) {
    return entry->create();
  }
  std::vector<std::string> known;
  for (const auto& name : components()) {
    known.push_back(name.str());
  }
  const std::string hint = did_you_mean(component.str(), known);
  return fail(
      ErrorCode::NotFound,
      "no loaded library offers component " + quote(component.str()) +
          (hint.empty() ? "; name its library under 'libraries' of the robot file, or use stand-ins" : hint),
      component.str());
}

std::vector<model::ComponentName> LibrarySet::components() const {
  std::vector<model::ComponentName> names;
  for (const auto& entry : task::registered_components()) {
    if (offers(entry)) {
      names.emplace_back(entry.name);
    }
  }
  return names;
}

Result<std::vector<model::ComponentModel>> LibrarySet::export_models(std::string_view library,
                                                                     type::TypeRegistry& types) const {
  const auto place = std::find(loaded_.begin(), loaded_.end(), library);
  if (place == loaded_.end() && !library.empty()) {
    return fail(ErrorCode::NotFound, "component library " + quote(library) + " is not loaded",
                std::string(library));
  }
  const fs::path file = library.empty() ? fs::path("/proc/self/exe")
                                        : files_.at(static_cast<std::size_t>(place - loaded_.begin()));
  std::vector<model::ComponentModel> models;
  for (const auto& entry : entries_of(std::string(library), file)) {
    auto component = entry.create();
    if (!component) {
      return std::move(component.error());
    }
    if (auto added = detail::add_types(**component, types); !added) {
      return std::move(added.error());
    }
    if (auto usable = check_families(**component); !usable) {
      return std::move(usable.error());
    }
    models.push_back(describe(**component));
    models.back().library = library;
  }
  return models;
}

}  // namespace segue::task_host
