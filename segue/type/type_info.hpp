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

/// What ports and properties need to handle values of a C++ type without knowing it. One per described type
/// and process, immutable, valid until the library that defined it is unloaded (component libraries never
/// are).
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
  const detail::DescribedType* described = nullptr;  ///< what it is made of, for read_flat and its like

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

/// Registers; the first of a name stays. Thread safe; called by type_info<T>() when it is first used.
void register_type_info(const TypeInfo& info);

}  // namespace segue::type
