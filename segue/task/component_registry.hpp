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

/// Changes whenever component libraries must be recompiled to work with this Segue.
inline constexpr std::string_view kComponentAbi = "segue-0.1/7";

/// A component that can be created in this process.
struct ComponentEntry {
  std::string name;
  std::string library;  ///< the library that registered it; empty: this program
  std::string abi;      ///< kComponentAbi of the Segue it was compiled against
  std::unique_ptr<Component> (*make)() = nullptr;

  /// Creates a component and sets its name. Fails where the constructor throws and for another ABI
  /// (Unsupported).
  [[nodiscard]] Result<std::unique_ptr<Component>> create() const;
};

/// These functions are thread safe.
std::optional<ComponentEntry> find_component(std::string_view name);
/// Sorted by name.
std::vector<ComponentEntry> registered_components();
/// False if the name is taken, by an entry that stays. Names are normalised: "::demo::Filter" is
/// "demo::Filter".
bool register_component(ComponentEntry entry);
/// The registrations since the last call whose names were taken.
std::vector<ComponentEntry> take_rejected_components();

/// While an object lives, components registered by this thread (during dlopen) belong to `library`.
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
