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

/// One data type of the paper's model (numeric, enum, compound, container) extended by what typelib has
/// (array, pointer, opaque, alias, null). Immutable once registered; owned by a TypeRegistry or, for
/// described C++ types, by the process. Names are typelib's: "/double", "/std/vector</base/Pose>",
/// "/double[3]".
class Type {
 public:
  TypeKind kind = TypeKind::Null;
  std::string name;
  std::size_t size = 0;  ///< bytes; 0 where it is not fixed or not known

  NumericCategory category = NumericCategory::Signed;  ///< Numeric
  /// Numeric that counts time: nanoseconds per tick ("100ms" is accepted for it); 0 for plain numbers.
  std::int64_t nanoseconds_per_tick = 0;
  std::vector<EnumSymbol> symbols;  ///< Enum
  std::vector<Field> fields;        ///< Compound
  std::string container_kind;       ///< Container: "/std/vector", "/std/string", "/std/optional" ...
  const Type* element =
      nullptr;  ///< Container, Array, Pointer: of what; Alias: of which; Opaque: marshalled as, or null
  std::size_t count = 0;  ///< Array: number of elements

  [[nodiscard]] bool is_string() const {
    return kind == TypeKind::Container && container_kind == "/std/string";
  }
  [[nodiscard]] bool is_optional() const {
    return kind == TypeKind::Container && container_kind == "/std/optional";
  }
  /// Whether the layout is known throughout: no null, opaque without marshalling type, or pointer inside.
  [[nodiscard]] bool is_complete() const;
  /// What an alias stands for, however long the chain.
  [[nodiscard]] const Type& resolved() const;
};

/// A 64-bit hash over the structure: kinds, field names and types in their order, enum symbols in any order,
/// and where the layout is fixed (no container or pointer inside) sizes and offsets; not names of types nor
/// of aliases. Equal on every machine. Recursive types are allowed.
std::uint64_t structural_hash(const Type& type);

/// A definition a person can read, over several lines; shown when types do not match.
std::string definition(const Type& type);

/// Typelib's spelling of a type name: accepts "double", "::base::Pose", "boost::int32_t",
/// "std::vector< ::base::Pose >" and "/std/vector<base/Pose>". "/int" becomes "/int32_t", "/string"
/// "/std/string", "void" "/nil"; integers go by their size (char has 8 bits and a sign, long has 64, as in
/// typelib). Fails where brackets do not balance or characters are out of place.
Result<std::string> canonical_type_name(std::string_view name);

/// Types by name. Owns them; addresses stay valid as long as the registry lives. Not thread safe while it
/// grows.
class TypeRegistry {
 public:
  TypeRegistry();  ///< with numbers, "/bool", std::chrono's durations, "/nil" and "/std/string"
  ~TypeRegistry();
  TypeRegistry(TypeRegistry&&) noexcept;
  TypeRegistry& operator=(TypeRegistry&&) noexcept;

  /// The type, building "/T[n]", "/std/vector</T>" and "/T*" on the fly where T is known. nullptr if unknown.
  const Type* find(std::string_view name);
  [[nodiscard]] const Type* find(std::string_view name) const;
  /// Registers under the canonical name; AlreadyExists if that is taken by a type of other structure. What
  /// the type is made of must be of this registry. An alias whose canonical name is taken keeps its own.
  Result<const Type*> add(Type type);
  /// Registers types that may refer to one another (recursion), by canonical names that are all new.
  Result<void> add_all(std::vector<std::unique_ptr<Type>> types);
  /// Registers a copy of a type that lives elsewhere (a described C++ type) and of all it is made of.
  Result<const Type*> copy(const Type& type);
  /// All in the order in which they were registered.
  [[nodiscard]] std::vector<const Type*> types() const;
  /// Copies every type of `other` that is not here yet; fails at the first contradiction.
  Result<void> merge(const TypeRegistry& other);

 private:
  Result<void> copy_in(const std::vector<const Type*>& others);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::type
