// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task {

class Component;

/// Changes whenever a library must be compiled anew to work with this Segue.
inline constexpr std::string_view kComponentAbi = "segue-0.1/1";

/// A component that can be made in this process.
struct ComponentEntry {
  std::string name;
  std::string library;  ///< the one whose loading brought it; empty: this program
  std::string abi;      ///< kComponentAbi of the Segue it was compiled against
  std::unique_ptr<Component> (*make)() = nullptr;

  /// A new one, which knows its name. Constructors that throw are an error, as is another ABI.
  [[nodiscard]] Result<std::unique_ptr<Component>> create() const;
};

/// All thread safe.
std::optional<ComponentEntry> find_component(std::string_view name);
/// Sorted by name.
std::vector<ComponentEntry> registered_components();
/// The first of a name stays; false if it was taken. Names are normalised: "::demo::Filter" is
/// "demo::Filter".
bool register_component(ComponentEntry entry);
/// Registrations that found their name taken since the last call.
std::vector<ComponentEntry> take_rejected_components();

/// While it lives, components registered by this thread (during dlopen) belong to `library`.
class LibraryScope {
 public:
  explicit LibraryScope(std::string library);
  LibraryScope(const LibraryScope&) = delete;
  LibraryScope& operator=(const LibraryScope&) = delete;
  ~LibraryScope();

 private:
  std::string previous_;
};

namespace detail {
struct Registration {
  Registration(std::string_view name, std::string_view abi, std::unique_ptr<Component> (*make)());
};
}  // namespace detail

}  // namespace segue::task
