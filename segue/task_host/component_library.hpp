// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/task/component.hpp>
#include <segue/task/component_registry.hpp>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_host {

/// The search path of component libraries: $SEGUE_LIBRARY_PATH (colon separated), then `<folder of the
/// program>/../lib/segue`, then the install prefix.
std::vector<std::filesystem::path> library_folders();

/// The library's file ("lib<name>.so" in one of the folders). `name` must be an identifier, never a path.
Result<std::filesystem::path> find_library(std::string_view name);

/// Names of all libraries in the folders, sorted.
std::vector<std::string> installed_libraries();

/// The models that the build wrote beside a library ("<name>.components.yaml"), read without loading it.
Result<void> read_library_models(std::string_view name, model::ComponentCatalog& catalog);

/// Loaded component libraries and the components they offer. Libraries stay loaded until the process ends.
class LibrarySet {
 public:
  /// Loads a library by name with dlopen; loading it again does nothing. Fails with the loader's message,
  /// where the library was built against another version of Segue, or where it provides a component that
  /// another library has.
  Result<void> load(std::string_view name);
  /// Loads a library from a file anywhere ("build/lib/libdemo.so"); returns the library's name. Fails like
  /// load(). For build tools: robots name libraries, never paths.
  Result<std::string> load_path(const std::filesystem::path& file);

  /// Components compiled into this program (SEGUE_COMPONENT in an executable) are offered without load().
  [[nodiscard]] bool has(const model::ComponentName& component) const;
  Result<std::unique_ptr<task::Component>> create(const model::ComponentName& component) const;
  /// Sorted.
  [[nodiscard]] std::vector<model::ComponentName> components() const;
  /// Creates one instance of each component of `library` ("": of this program) and reads its interface. Fails
  /// with the first that cannot be created.
  Result<std::vector<model::ComponentModel>> export_models(std::string_view library,
                                                           type::TypeRegistry& types) const;

 private:
  Result<void> load_file(const std::string& name, const std::filesystem::path& file);
  [[nodiscard]] bool offers(const task::ComponentEntry& entry) const;

  std::vector<std::string> loaded_;
  std::vector<std::filesystem::path> files_;  ///< of loaded_
};

/// A component's interface, read from an instance: dynamic ports are those that it has now.
model::ComponentModel describe(const task::Component& component);

/// The component model file of a loaded library, as the build writes it beside the library.
Result<std::string> write_library_models(const LibrarySet& libraries, std::string_view library);

}  // namespace segue::task_host
