// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/type.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace segue::type {

namespace detail {
struct DescribedType;
}

/// Lets ports and properties handle objects of a C++ type at run time. One per described type and process;
/// immutable; valid until the library that defined it is unloaded (component libraries never are).
struct TypeInfo {
  const Type* type = nullptr;
  std::uint64_t hash = 0;                     ///< structural_hash(*type)
  std::size_t size = 0;                       ///< sizeof
  std::size_t alignment = 0;                  ///< alignof
  bool trivially_copyable = false;            ///< no pointers inside: may travel as bytes
  void (*construct)(void* memory) = nullptr;  ///< default value
  void (*destroy)(void* object) noexcept = nullptr;
  void (*copy)(void* to, const void* from) = nullptr;  ///< assignment; reuses the capacity of `to`
  Value (*to_value)(const void* object) = nullptr;
  /// Leaves `object` unchanged on failure. `path` ("properties.range") begins the error message.
  Result<void> (*from_value)(void* object, const Value& value, std::string_view path) = nullptr;
  const detail::DescribedType* described = nullptr;  ///< internals, for read_flat and the like

  [[nodiscard]] std::string_view name() const { return type->name; }
};

/// The TypeInfo of a C++ type: numbers, bool, std::string, std::vector, std::array, C arrays, std::optional,
/// std::chrono durations and time points, enums and structs named by SEGUE_TYPE, and Eigen's dense matrices
/// where <segue/type/eigen.hpp> is included. Defined in describe.hpp.
template <class T>
const TypeInfo& type_info();

/// The TypeInfo registered under that name in this process (every SEGUE_TYPE and every type used by a port),
/// or nullptr. Thread safe.
const TypeInfo* find_type_info(std::string_view name);

/// Registers a type; the first one of a name stays. Thread safe; called by the first use of type_info<T>().
void register_type_info(const TypeInfo& info);

}  // namespace segue::type
