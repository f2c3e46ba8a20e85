// SPDX-License-Identifier: Apache-2.0
//
// The parts of describe.hpp that do not depend on the described C++ type, so that each described type adds
// little code. Not for users.
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

/// Adjacent members whose bytes in memory are those in CDR, once the position there is a multiple of `most`.
struct CdrRun {
  std::size_t offset = 0;  ///< in the object
  std::size_t size = 0;
  std::size_t begin = 0;  ///< the first of the members
  std::size_t count = 0;  ///< 0: one member, at `begin`, that is not copied as bytes
  std::size_t first = 1;  ///< alignment of the first number
  std::size_t most = 1;   ///< the largest alignment of a number
  bool checked = false;   ///< some of the members are FlatPlan::checked
};

/// Precomputed facts for cdr_object.hpp; set by plan_cdr().
struct CdrPlan {
  bool possible = false;
  bool planned = false;
  bool packed = false;    ///< the whole object is a run, and trivially_copyable
  std::size_t first = 1;  ///< packed: as in CdrRun
  std::size_t most = 1;
  std::size_t least = 1;     ///< minimum size of an object in bytes, alignment aside
  std::vector<CdrRun> runs;  ///< Compound
};

/// The structure of a described type. Created once and never destroyed.
struct Shape {
  Type type;
  std::vector<DescribedField> fields{};  ///< Compound
  DescribedType* element = nullptr;      ///< Array, Container
  const void* initial = nullptr;         ///< of a made Compound: an object with its defaults; may be null
  CdrPlan cdr{};
};

/// Items of a container whose size may change, or of an optional (size 0 or 1). Each function gets the
/// container's type.
struct SequenceAccess {
  std::size_t (*size)(const DescribedType& self, const void* object) = nullptr;
  const void* (*item)(const DescribedType& self, const void* object, std::size_t index) = nullptr;
  /// Resizes to `size` items and returns the first; items are default values, but an optional keeps its
  /// value.
  void* (*resize)(const DescribedType& self, void* object, std::size_t size) = nullptr;
  /// Resizes to `size` items and returns the first; existing items keep their values and so their memory.
  void* (*reuse)(const DescribedType& self, void* object, std::size_t size) = nullptr;
};

/// A matrix that is not a vector. Its numbers are contiguous, by rows or by columns as the name of the type
/// says. The functions are those of a matrix of variable size; one of fixed size is an Array of its rows and
/// lies in the object itself.
struct MatrixAccess {
  DescribedType* number = nullptr;
  bool by_rows = false;
  std::array<std::size_t, 2> (*size)(const void* object) = nullptr;  ///< rows, columns
  const void* (*numbers)(const void* object) = nullptr;
  /// Resizes and returns the first number in `numbers`, uninitialized. False where the type fixes another
  /// number of rows or columns. Requires that the size has been checked to be reasonable.
  bool (*resize)(void* object, const std::array<std::size_t, 2>& size, void*& numbers) = nullptr;
  /// Whether the type permits so many rows and columns.
  bool (*fits)(const std::array<std::size_t, 2>& size) = nullptr;
};

/// Precomputed facts for flat.hpp; set by plan_flat().
struct FlatPlan {
  bool possible = false;
  bool checked =
      false;  ///< copied as bytes, but contains enums or booleans, of which not every byte is valid
  std::size_t least = 0;  ///< minimum size of an object in bytes, at least 1
};

/// Custom conversions, for types whose values differ from their structure (matrices as lists of rows).
struct Conversion {
  Value (*to_value)(const void* object) = nullptr;
  Result<void> (*from_value)(void* object, const Value& value, std::string_view path) = nullptr;
};

/// A described type; one per type and process. That of a C++ type is constant initialised.
struct DescribedType {
  TypeInfo info;  ///< type, hash and described are set by complete()
  void (*name)(std::string& text) = nullptr;
  void (*describe)(Shape& shape) = nullptr;
  SequenceAccess sequence;
  Conversion conversion;
  MatrixAccess grid;
  FlatPlan flat;
  Shape* shape = nullptr;
  DescribedType* next_announced = nullptr;
  bool announced = false;
};

/// Lets find_type_info() find the type before it is first used. Cheap and idempotent, since it runs before
/// main for each source that describes the type.
bool announce(DescribedType& described);

/// Describes and registers the type and its parts on first use. Thread safe.
const TypeInfo& complete(DescribedType& described);

/// Sets FlatPlan for types that are otherwise complete. They may refer to one another and to planned types.
void plan_flat(std::span<DescribedType* const> fresh);

/// Sets Shape::cdr, for the same types as plan_flat() and after it.
void plan_cdr(std::span<DescribedType* const> fresh);

/// Whether all enums and booleans of an object that was copied as bytes are valid; invalid ones are replaced
/// by valid values. Done after the copy, since another process could change the bytes between a check and the
/// copy.
bool sanitize(const DescribedType& described, void* object);

/// For describe(), within complete() only: the type of a part, which is described as well if necessary.
const Type* part(DescribedType& described);

void describe_number(Shape& shape, NumericCategory category, std::size_t size,
                     std::int64_t nanoseconds_per_tick);
void describe_enum(Shape& shape, NumericCategory category, std::size_t size);
void describe_container(Shape& shape, std::string_view kind, std::size_t size, DescribedType& element);
void describe_array(Shape& shape, std::size_t count, DescribedType& element);
void describe_compound(Shape& shape, std::size_t size);
void add_symbol(Shape& shape, std::string_view name, std::int64_t value);
void add_field(Shape& shape, std::string_view name, std::size_t offset, DescribedType& type);

/// The name of a type where SEGUE_TYPE stands.
struct WrittenName {
  std::string_view function;  ///< segue_type_name there, as the compiler describes it
  std::string_view type;      ///< within the namespace of that function
};

/// Appends "Pose" in namespace demo, or "demo::Pose" at global scope, as "/demo/Pose".
void append_type_name(std::string& text, const WrittenName& name);
std::string number_name(NumericCategory category, std::size_t size);

/// "/std/chrono/milliseconds", or with other representations "/std/chrono/duration</double,1,1000>".
void append_duration_name(std::string& text, std::string_view number, std::int64_t numerator,
                          std::int64_t denominator);

/// std::vector<bool>, whose items have no address.
Value bits_to_value(const void* object);
Result<void> bits_from_value(void* object, const Value& value, std::string_view path);

/// Completes types that were made with their shapes (made_type.cpp); parts come first or are complete.
/// Thread safe.
void complete_made(std::span<DescribedType* const> made);

/// to_value and from_value as TypeFunctions of all described types.
Value object_to_value(const TypeInfo& self, const void* object);
Result<void> object_from_value(const TypeInfo& self, void* object, const Value& value, std::string_view path);

/// Whole conversions; from_value leaves the object unchanged on failure.
Value to_value(const DescribedType& described, const void* object);
Result<void> from_value(const DescribedType& described, void* object, const Value& value,
                        std::string_view path);
/// Converts in place; after a failure the object may be partly assigned.
Result<void> assign(const DescribedType& described, void* object, const Value& value, std::string_view path);

/// "path: expected a number, got 'far'", with the value's line and column.
Error unexpected_value(std::string_view path, std::string_view expected, const Value& value);
Error at_value(std::string_view path, std::string message, const Value& value);

}  // namespace segue::type::detail
