// SPDX-License-Identifier: Apache-2.0
//
// The machinery below describe.hpp that does not depend on the C++ type it handles, so that describing one
// more type compiles little. Not for users.
#pragma once

#include <segue/type/type_info.hpp>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::type::detail {

struct DescribedType;

struct DescribedField {
  std::string name;
  std::size_t offset = 0;
  DescribedType* type = nullptr;
};

/// What describing a type tells. Made once and never destroyed.
struct Shape {
  Type type;
  std::vector<DescribedField> fields;  ///< Compound
  DescribedType* element = nullptr;    ///< Array, Container
};

/// Items of a container whose size may change, or of an optional (size 0 or 1).
struct Sequence {
  std::size_t (*size)(const void* object) = nullptr;
  const void* (*item)(const void* object, std::size_t index) = nullptr;
  /// Makes it hold `size` items and gives the first; items are default values, but an optional keeps what it
  /// has.
  void* (*resize)(void* object, std::size_t size) = nullptr;
  /// The same, but items that were there keep what they have, and with it their memory.
  void* (*reuse)(void* object, std::size_t size) = nullptr;
};

/// A matrix whose sizes may change. Its numbers lie together, by rows or by columns as the type's name says.
struct Grid {
  DescribedType* number = nullptr;
  std::array<std::size_t, 2> (*size)(const void* object) = nullptr;  ///< rows, columns
  const void* (*numbers)(const void* object) = nullptr;
  /// Makes it that large, which fits the memory there can be, and gives the first number, unset. Answers
  /// false where the type has fixed another number of rows or columns.
  bool (*resize)(void* object, const std::array<std::size_t, 2>& size, void*& numbers) = nullptr;
};

/// What flat.hpp needs to know of a type; set by plan_flat().
struct FlatPlan {
  bool possible = false;
  bool checked = false;   ///< travels as bytes, but not every byte is allowed: has enums or booleans
  std::size_t least = 0;  ///< the fewest bytes that an object takes, at least 1
};

/// Conversions of types whose values do not look like their type (matrices as lists of rows).
struct Conversion {
  Value (*to_value)(const void* object) = nullptr;
  Result<void> (*from_value)(void* object, const Value& value, std::string_view path) = nullptr;
};

/// One C++ type; constant initialised, one per type and process.
struct DescribedType {
  TypeInfo info;  ///< type, hash and described are set by complete()
  void (*name)(std::string& text) = nullptr;
  void (*describe)(Shape& shape) = nullptr;
  Sequence sequence;
  Conversion conversion;
  Grid grid;
  FlatPlan flat;
  Shape* shape = nullptr;
  DescribedType* next_announced = nullptr;
};

/// Lets find_type_info() find the type although nothing has used it yet. Cheap: runs before main.
bool announce(DescribedType& described);

/// Describes and registers the type and all it is made of when it is first used. Thread safe.
const TypeInfo& complete(DescribedType& described);

/// Plans types that are complete but for this. They may refer to one another, and to others planned before.
void plan_flat(std::span<DescribedType* const> fresh);

/// For describe(): the type of a part, which is described too if it has not been yet. Only within complete().
const Type* part(DescribedType& described);

void describe_number(Shape& shape, NumericCategory category, std::size_t size,
                     std::int64_t nanoseconds_per_tick);
void describe_enum(Shape& shape, NumericCategory category, std::size_t size);
void describe_container(Shape& shape, std::string_view kind, std::size_t size, DescribedType& element);
void describe_array(Shape& shape, std::size_t count, DescribedType& element);
void describe_compound(Shape& shape, std::size_t size);
void add_symbol(Shape& shape, std::string_view name, std::int64_t value);
void add_field(Shape& shape, std::string_view name, std::size_t offset, DescribedType& type);

/// "demo::Pose" as "/demo/Pose".
void append_type_name(std::string& text, std::string_view cpp_name);
std::string number_name(NumericCategory category, std::size_t size);

/// "/std/chrono/milliseconds", or with other representations "/std/chrono/duration</double,1,1000>".
void append_duration_name(std::string& text, std::string_view number, std::int64_t numerator,
                          std::int64_t denominator);

/// std::vector<bool>, whose items have no address.
Value bits_to_value(const void* object);
Result<void> bits_from_value(void* object, const Value& value, std::string_view path);

/// Whole conversions; from_value leaves the object unchanged on failure.
Value to_value(const DescribedType& described, const void* object);
Result<void> from_value(const DescribedType& described, void* object, const Value& value,
                        std::string_view path);
/// Converts in place; after a failure the object holds something between old and new.
Result<void> assign(const DescribedType& described, void* object, const Value& value, std::string_view path);

/// "path: expected a number, got 'far'", with the value's line and column.
Error unexpected_value(std::string_view path, std::string_view expected, const Value& value);
Error at_value(std::string_view path, std::string message, const Value& value);

}  // namespace segue::type::detail
