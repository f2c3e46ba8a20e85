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

struct TypeInfo;

/// How objects of a type are handled; each gets the type's TypeInfo. See there.
struct TypeFunctions {
  void (*construct)(const TypeInfo& self, void* memory) = nullptr;
  void (*destroy)(const TypeInfo& self, void* object) noexcept = nullptr;
  void (*copy)(const TypeInfo& self, void* to, const void* from) = nullptr;
  Value (*to_value)(const TypeInfo& self, const void* object) = nullptr;
  Result<void> (*from_value)(const TypeInfo& self, void* object, const Value& value,
                             std::string_view path) = nullptr;
};

/// Lets ports and properties handle objects of a type at run time. One per type and process;
/// immutable; valid until the library that defined it is unloaded (component libraries never are). Of a C++
/// type it is type_info<T>(), of another one make_type_info() (made_type.hpp).
struct TypeInfo {
  const Type* type = nullptr;
  std::uint64_t hash = 0;           ///< structural_hash(*type)
  std::size_t size = 0;             ///< sizeof
  std::size_t alignment = 0;        ///< alignof
  bool trivially_copyable = false;  ///< no pointers inside: may travel as bytes
  TypeFunctions functions{};
  const detail::DescribedType* described = nullptr;  ///< internals, for read_flat and the like

  [[nodiscard]] std::string_view name() const { return type->name; }

  /// Makes the default value in `memory`.
  void construct(void* memory) const { functions.construct(*this, memory); }
  void destroy(void* object) const noexcept { functions.destroy(*this, object); }
  /// Assigns; reuses the memory that `to` has.
  void copy(void* to, const void* from) const { functions.copy(*this, to, from); }
  [[nodiscard]] Value to_value(const void* object) const { return functions.to_value(*this, object); }
  /// Leaves `object` unchanged on failure. `path` ("properties.range") begins the error message.
  Result<void> from_value(void* object, const Value& value, std::string_view path) const {
    return functions.from_value(*this, object, value, path);
  }
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
