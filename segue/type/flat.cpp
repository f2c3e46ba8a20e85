// SPDX-License-Identifier: Apache-2.0
//
// Layout, without any padding of its own: what travels as bytes is as it is in memory (neighbours in a struct
// in one run); strings, sequences and vector<bool> are a count and their items; an optional is 0 or 1 and its
// item; a matrix is rows, columns and its numbers; a struct without members is one byte. Counts have 8 bytes.
#include <segue/type/described_type.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/flat_source.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace segue::type {
namespace {

using detail::DescribedField;
using detail::DescribedType;
using detail::Shape;

using Sink = detail::ByteSink;
using Source = detail::FlatSource;
using Count = Source::Count;

const std::byte* at(const void* object, std::size_t offset) {
  return static_cast<const std::byte*>(object) + offset;
}

std::byte* at(void* object, std::size_t offset) {
  return static_cast<std::byte*>(object) + offset;
}

bool is_bits(const DescribedType& described) {
  return described.conversion.to_value == &detail::bits_to_value;
}

/// Adjacent members that are copied as bytes. Gaps are skipped, since an undescribed member may lie there.
struct Run {
  std::size_t offset = 0;
  std::size_t size = 0;
  std::size_t fields = 0;  ///< 0: the first member is not copied as bytes
};

Run run_from(std::span<const DescribedField> fields) {
  Run run{fields.front().offset, 0, 0};
  for (const DescribedField& field : fields) {
    const TypeInfo& info = field.type->info;
    if (!info.trivially_copyable || field.offset != run.offset + run.size) break;
    run.size += info.size;
    ++run.fields;
  }
  return run;
}

bool put_count(Count count, Sink& sink) {
  return sink.put(&count, sizeof count);
}

bool put(const DescribedType& described, const void* object, Sink& sink);

bool put_items(const DescribedType& element, const void* items, std::size_t count, Sink& sink) {
  if (element.info.trivially_copyable) return sink.put(items, count * element.info.size);
  for (std::size_t i = 0; i < count; ++i) {
    if (!put(element, at(items, i * element.info.size), sink)) return false;
  }
  return true;
}

bool put_bits(const std::vector<bool>& bits, Sink& sink) {
  if (!put_count(bits.size(), sink)) return false;
  for (const bool bit : bits) {
    if (!sink.put(&bit, 1)) return false;
  }
  return true;
}

bool put_grid(const detail::MatrixAccess& grid, const void* object, Sink& sink) {
  const auto [rows, columns] = grid.size(object);
  return put_count(rows, sink) && put_count(columns, sink) &&
         put_items(*grid.number, grid.numbers(object), rows * columns, sink);
}

bool put_container(const DescribedType& described, const void* object, Sink& sink) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) {
    const auto& text = *static_cast<const std::string*>(object);
    return put_count(text.size(), sink) && sink.put(text.data(), text.size());
  }
  if (is_bits(described)) return put_bits(*static_cast<const std::vector<bool>*>(object), sink);
  const std::size_t count = described.sequence.size(described, object);
  const auto engaged = static_cast<std::uint8_t>(count);
  const bool counted = shape.type.is_optional() ? sink.put(&engaged, 1) : put_count(count, sink);
  if (!counted || count == 0) return counted;
  if (!sink.enter()) return false;
  const bool done = put_items(*shape.element, described.sequence.item(described, object, 0), count, sink);
  sink.leave();
  return done;
}

bool put_compound(const Shape& shape, const void* object, Sink& sink) {
  std::span<const DescribedField> fields = shape.fields;
  if (fields.empty()) return sink.put("", 1);
  while (!fields.empty()) {
    const Run run = run_from(fields);
    const bool done = run.fields > 0 ? sink.put(at(object, run.offset), run.size)
                                     : put(*fields.front().type, at(object, fields.front().offset), sink);
    if (!done) return false;
    fields = fields.subspan(std::max<std::size_t>(run.fields, 1));
  }
  return true;
}

bool put(const DescribedType& described, const void* object, Sink& sink) {
  if (described.info.trivially_copyable) return sink.put(object, described.info.size);
  if (described.grid.size != nullptr) return put_grid(described.grid, object, sink);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Compound) return put_compound(shape, object, sink);
  if (shape.type.kind == TypeKind::Array) return put_items(*shape.element, object, shape.type.count, sink);
  return put_container(described, object, sink);
}

std::int64_t load_enum(const Type& type, const void* object) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, object, type.size);  // little endian, as all machines that Segue runs on
  const auto unused = static_cast<int>(64 - 8 * type.size);
  return type.category == NumericCategory::Signed ? static_cast<std::int64_t>(bits << unused) >> unused
                                                  : static_cast<std::int64_t>(bits);
}
static_assert(std::endian::native == std::endian::little);

/// The rule of C++ for enums without fixed type: valid is what the bits needed for the symbols can express,
/// so that flags may be combined.
bool is_expressible(const Type& type, std::int64_t number) {
  const bool is_signed = type.category == NumericCategory::Signed;
  const auto magnitude = [&](std::int64_t value) {
    return static_cast<std::uint64_t>(is_signed && value < 0 ? ~value : value);
  };
  std::uint64_t needed = 0;
  bool negative = false;
  for (const EnumSymbol& symbol : type.symbols) {
    needed |= magnitude(symbol.value);
    negative = negative || symbol.value < 0;
  }
  if (is_signed && number < 0 && !negative) return false;
  return std::bit_width(magnitude(number)) <= std::bit_width(needed);
}

bool sanitize_items(const DescribedType& element, void* items, std::size_t count) {
  bool valid = true;
  for (std::size_t i = 0; i < count; ++i)
    valid = detail::sanitize(element, at(items, i * element.info.size)) && valid;
  return valid;
}

bool sanitize_enum(const Type& type, void* object) {
  if (type.symbols.empty() || is_expressible(type, load_enum(type, object))) return true;
  std::memcpy(object, &type.symbols.front().value, type.size);
  return false;
}

bool are_valid(const DescribedType& described, const std::byte* object) noexcept {
  if (!described.flat.checked) return true;
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Enum) {
    return shape.type.symbols.empty() || is_expressible(shape.type, load_enum(shape.type, object));
  }
  if (shape.type.kind == TypeKind::Numeric) return *object <= std::byte{1};
  for (std::size_t i = 0; shape.type.kind == TypeKind::Array && i < shape.type.count; ++i) {
    if (!are_valid(*shape.element, object + i * shape.element->info.size)) return false;
  }
  return std::ranges::all_of(shape.fields, [object](const DescribedField& field) {
    return are_valid(*field.type, object + field.offset);
  });
}

bool get(const DescribedType& described, void* object, Source& source);

bool get_items(const DescribedType& element, void* items, std::size_t count, Source& source) {
  if (element.info.trivially_copyable) {
    if (!source.get(items, count * element.info.size)) return false;
    return !element.flat.checked || sanitize_items(element, items, count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!get(element, at(items, i * element.info.size), source)) return false;
  }
  return true;
}

bool get_bits(std::vector<bool>& bits, Source& source) {
  Count count = 0;
  if (!source.get_count(count, 1)) return false;
  const std::span<const std::byte> values(source.skip(count), count);
  if (!std::ranges::all_of(values, [](std::byte value) { return value <= std::byte{1}; })) return false;
  bits.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    bits[i] = values[i] != std::byte{0};
  return true;
}

bool get_grid(const detail::MatrixAccess& grid, void* object, Source& source) {
  std::array<std::size_t, 2> size{};
  void* numbers = nullptr;
  return source.get_size(size, grid.number->info.size) && grid.resize(object, size, numbers) &&
         get_items(*grid.number, numbers, size[0] * size[1], source);
}

bool get_string(std::string& text, Source& source) {
  Count size = 0;
  if (!source.get_count(size, 1)) return false;
  text.assign(reinterpret_cast<const char*>(source.skip(size)), size);
  return true;
}

bool get_container(const DescribedType& described, void* object, Source& source) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) return get_string(*static_cast<std::string*>(object), source);
  if (is_bits(described)) return get_bits(*static_cast<std::vector<bool>*>(object), source);
  Count count = 0;
  const bool counted = shape.type.is_optional() ? source.get_engaged(count)
                                                : source.get_count(count, shape.element->flat.least);
  if (!counted) return false;
  void* items = described.sequence.reuse(described, object, count);
  if (count == 0) return true;
  if (!source.enter()) return false;
  const bool done = get_items(*shape.element, items, count, source);
  source.leave();
  return done;
}

bool get_run(std::span<const DescribedField> fields, const Run& run, void* object, Source& source) {
  if (!source.get(at(object, run.offset), run.size)) return false;
  bool valid = true;
  for (const DescribedField& field : fields.first(run.fields))
    valid = detail::sanitize(*field.type, at(object, field.offset)) && valid;
  return valid;
}

bool get_compound(const Shape& shape, void* object, Source& source) {
  std::span<const DescribedField> fields = shape.fields;
  std::byte nothing{};
  if (fields.empty()) return source.get(&nothing, 1);
  while (!fields.empty()) {
    const Run run = run_from(fields);
    const bool done = run.fields > 0 ? get_run(fields, run, object, source)
                                     : get(*fields.front().type, at(object, fields.front().offset), source);
    if (!done) return false;
    fields = fields.subspan(std::max<std::size_t>(run.fields, 1));
  }
  return true;
}

bool get(const DescribedType& described, void* object, Source& source) {
  if (described.info.trivially_copyable) return get_items(described, object, 1, source);
  if (described.grid.size != nullptr) return get_grid(described.grid, object, source);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Compound) return get_compound(shape, object, source);
  if (shape.type.kind == TypeKind::Array) return get_items(*shape.element, object, shape.type.count, source);
  return get_container(described, object, source);
}

bool check(const DescribedType& described, Source& source);

bool check_items(const DescribedType& element, std::size_t count, Source& source) {
  if (!element.info.trivially_copyable) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!check(element, source)) return false;
    }
    return true;
  }
  const std::size_t size = count * element.info.size;
  if (size > source.left()) return false;
  const std::byte* items = source.skip(size);
  for (std::size_t i = 0; element.flat.checked && i < count; ++i) {
    if (!are_valid(element, items + i * element.info.size)) return false;
  }
  return true;
}

bool check_grid(const detail::MatrixAccess& grid, Source& source) {
  std::array<std::size_t, 2> size{};
  return source.get_size(size, grid.number->info.size) && grid.fits(size) &&
         check_items(*grid.number, size[0] * size[1], source);
}

bool check_container(const DescribedType& described, Source& source) {
  const Shape& shape = *described.shape;
  Count count = 0;
  if (shape.type.is_string() || is_bits(described)) {
    if (!source.get_count(count, 1)) return false;
    const std::span<const std::byte> bytes(source.skip(count), count);
    return shape.type.is_string() ||
           std::ranges::all_of(bytes, [](std::byte bit) { return bit <= std::byte{1}; });
  }
  const bool counted = shape.type.is_optional() ? source.get_engaged(count)
                                                : source.get_count(count, shape.element->flat.least);
  if (!counted || count == 0) return counted;
  if (!source.enter()) return false;
  const bool valid = check_items(*shape.element, count, source);
  source.leave();
  return valid;
}

/// Whether get() would accept the source.
bool check(const DescribedType& described, Source& source) {
  if (described.info.trivially_copyable) return check_items(described, 1, source);
  if (described.grid.size != nullptr) return check_grid(described.grid, source);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Array) return check_items(*shape.element, shape.type.count, source);
  if (shape.type.kind == TypeKind::Container) return check_container(described, source);
  std::byte nothing{};
  if (shape.fields.empty()) return source.get(&nothing, 1);
  return std::ranges::all_of(shape.fields,
                             [&](const DescribedField& field) { return check(*field.type, source); });
}

}  // namespace

bool detail::sanitize(const DescribedType& described, void* object) {
  if (!described.flat.checked) return true;
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Enum) return sanitize_enum(shape.type, object);
  if (shape.type.kind == TypeKind::Array) return sanitize_items(*shape.element, object, shape.type.count);
  if (shape.type.kind == TypeKind::Numeric) {
    std::byte& boolean = *at(object, 0);
    if (boolean <= std::byte{1}) return true;
    boolean = std::byte{0};
    return false;
  }
  bool valid = true;
  for (const DescribedField& field : shape.fields)
    valid = detail::sanitize(*field.type, at(object, field.offset)) && valid;
  return valid;
}

bool can_flatten(const TypeInfo& info) noexcept {
  return info.described != nullptr && info.described->flat.possible;
}

std::size_t flat_size(const TypeInfo& info, const void* object) noexcept {
  if (!can_flatten(info)) return 0;
  Sink sink;
  return put(*info.described, object, sink) ? sink.used() : 0;
}

std::optional<std::size_t> write_flat(const TypeInfo& info, const void* object,
                                      std::span<std::byte> bytes) noexcept {
  if (!can_flatten(info) || bytes.empty()) return std::nullopt;
  Sink sink(bytes);
  if (!put(*info.described, object, sink)) return std::nullopt;
  return sink.used();
}

bool read_flat(const TypeInfo& info, void* object, std::span<const std::byte> bytes) {
  if (!can_flatten(info)) return false;
  Source source(bytes);
  return get(*info.described, object, source) && source.left() == 0;
}

bool is_flat(const TypeInfo& info, std::span<const std::byte> bytes) noexcept {
  if (!can_flatten(info)) return false;
  Source source(bytes);
  return check(*info.described, source) && source.left() == 0;
}

bool has_invalid_bytes(const TypeInfo& info) noexcept {
  return info.described != nullptr && info.described->flat.checked;
}

bool are_valid_bytes(const TypeInfo& info, const void* object) noexcept {
  return info.described == nullptr || are_valid(*info.described, static_cast<const std::byte*>(object));
}

}  // namespace segue::type
