// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::type {

enum class TypeKind : std::uint8_t {
  Null,
  Numeric,
  Enum,
  Compound,
  Container,
  Array,
  Pointer,
  Opaque,
  Alias
};

enum class NumericCategory : std::uint8_t { Bool, Signed, Unsigned, Float };

class Type;

/// A name of an enumeration, with its value.
struct EnumSymbol {
  std::string name;
  std::int64_t value = 0;
  friend bool operator==(const EnumSymbol&, const EnumSymbol&) = default;
};

/// A member of a compound; the offset is in bytes.
struct Field {
  std::string name;
  const Type* type = nullptr;
  std::size_t offset = 0;
};

/// A data type: the kinds of the paper's model (numeric, enum, compound, container) and those that typelib
/// adds (array, pointer, opaque, alias, null). Immutable once registered; owned by a TypeRegistry or, for
/// described C++ types, by the process. Names are typelib's: "/double", "/std/vector</base/Pose>",
/// "/double[3]".
class Type {
 public:
  TypeKind kind = TypeKind::Null;
  std::string name;
  std::size_t size = 0;  ///< in bytes; 0 where it is not fixed or not known

  NumericCategory category = NumericCategory::Signed;  ///< Numeric
  /// Numeric that counts time: nanoseconds per tick ("100ms" is accepted for it); 0 for plain numbers.
  std::int64_t nanoseconds_per_tick = 0;
  std::vector<EnumSymbol> symbols;  ///< Enum
  std::vector<Field> fields;        ///< Compound
  std::string container_kind;       ///< Container: "/std/vector", "/std/string", "/std/optional" ...
  /// Container, Array, Pointer: type of the elements; Alias: target; Opaque: marshalling type or nullptr.
  const Type* element = nullptr;
  std::size_t count = 0;  ///< Array: number of elements

  [[nodiscard]] bool is_string() const {
    return kind == TypeKind::Container && container_kind == "/std/string";
  }
  [[nodiscard]] bool is_optional() const {
    return kind == TypeKind::Container && container_kind == "/std/optional";
  }
  /// Whether the whole layout is known: no null, pointer or opaque without marshalling type inside.
  [[nodiscard]] bool is_complete() const;
  /// The target of an alias, through chains of aliases; else this type.
  [[nodiscard]] const Type& resolved() const;
};

/// A 64-bit hash of the structure: kinds, field names and types in order, enum symbols in any order, and
/// sizes and offsets where the layout is fixed (no container or pointer inside). Names of types and aliases
/// do not count. Equal on every machine. Recursive types are allowed.
std::uint64_t structural_hash(const Type& type);

/// A readable definition over several lines, for messages about types that do not match.
std::string definition(const Type& type);

/// Typelib's spelling of a type name: accepts "double", "::base::Pose", "boost::int32_t",
/// "std::vector< ::base::Pose >" and "/std/vector<base/Pose>". "/int" becomes "/int32_t", "/string"
/// "/std/string", "void" "/nil"; integers go by their size (char has 8 bits and a sign, long has 64, as in
/// typelib). Fails where brackets do not balance or characters are out of place.
Result<std::string> canonical_type_name(std::string_view name);

/// Owns types by name. Addresses stay valid as long as the registry lives. Not thread safe while types are
/// added.
class TypeRegistry {
 public:
  TypeRegistry();  ///< with numbers, "/bool", std::chrono's durations, "/nil" and "/std/string"
  ~TypeRegistry();
  TypeRegistry(TypeRegistry&&) noexcept;
  TypeRegistry& operator=(TypeRegistry&&) noexcept;

  /// The type; nullptr if unknown. "/T[n]", "/std/vector</T>" and "/T*" are created as needed where T is
  /// known.
  const Type* find(std::string_view name);
  [[nodiscard]] const Type* find(std::string_view name) const;
  /// Registers under the canonical name; AlreadyExists if a type of other structure has that name. Requires
  /// that the parts of the type belong to this registry. An alias whose canonical name is taken keeps its
  /// own.
  Result<const Type*> add(Type type);
  /// Registers types that may refer to one another (recursion), by canonical names that are all new.
  Result<void> add_all(std::vector<std::unique_ptr<Type>> types);
  /// Registers a copy of a type from elsewhere (such as a described C++ type) and of all its parts.
  Result<const Type*> copy(const Type& type);
  /// All types, in the order of registration.
  [[nodiscard]] std::vector<const Type*> types() const;
  /// Copies every type of `other` that is missing here; fails at the first contradiction.
  Result<void> merge(const TypeRegistry& other);

 private:
  Result<void> copy_in(const std::vector<const Type*>& others);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::type
