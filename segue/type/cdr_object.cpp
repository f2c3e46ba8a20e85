// SPDX-License-Identifier: Apache-2.0
//
// The layout of plain CDR: numbers at multiples of their own size, counted from the end of the header; a
// sequence is a count of four bytes and its items, a text the same with a final zero byte, an optional a
// sequence of at most one item, a struct without members one byte. Matrices are written by rows.
#include <segue/type/cdr_object.hpp>
#include <segue/type/cdr_parts.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace segue::type {
namespace detail::cdr {
namespace {

const std::byte* at(const void* object, std::size_t offset) {
  return static_cast<const std::byte*>(object) + offset;
}

std::byte* at(void* object, std::size_t offset) {
  return static_cast<std::byte*>(object) + offset;
}

bool is_bits(const DescribedType& described) {
  return described.conversion.to_value == &bits_to_value;
}

Grid fixed_grid(const DescribedType& described) {
  const Type& type = described.shape->type;
  return {type.count, described.shape->element->shape->type.count, described.grid.by_rows};
}

bool put(const DescribedType& described, const void* object, Sink& sink);
bool put_parts(const DescribedType& described, const void* object, Sink& sink);

}  // namespace

bool put_items(const DescribedType& element, const void* items, std::size_t count, Sink& sink) {
  const CdrPlan& plan = element.shape->cdr;
  if (count == 0) return true;
  if (plan.packed) {
    if (!sink.align(plan.first)) return false;
    if (sink.used() % plan.most == 0) return sink.put(items, count * element.info.size);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!put_parts(element, at(items, i * element.info.size), sink)) return false;
  }
  return true;
}

namespace {

bool put_run(const Shape& shape, const CdrRun& run, const void* object, Sink& sink) {
  if (run.count > 0) {
    if (!sink.align(run.first)) return false;
    if (sink.used() % run.most == 0) return sink.put(at(object, run.offset), run.size);
  }
  const auto fields = std::span(shape.fields).subspan(run.begin, std::max<std::size_t>(run.count, 1));
  return std::ranges::all_of(
      fields, [&](const DescribedField& field) { return put(*field.type, at(object, field.offset), sink); });
}

bool put_compound(const Shape& shape, const void* object, Sink& sink) {
  if (shape.fields.empty()) return sink.put("", 1);
  return std::ranges::all_of(shape.cdr.runs,
                             [&](const CdrRun& run) { return put_run(shape, run, object, sink); });
}

bool put_bits(const std::vector<bool>& bits, Sink& sink) {
  if (!sink.put_count(bits.size())) return false;
  return std::ranges::all_of(bits, [&](bool bit) { return sink.put(&bit, 1); });
}

bool put_numbers(const DescribedType& number, const Grid& grid, const void* numbers, Sink& sink) {
  if (grid.in_order()) return put_items(number, numbers, grid.rows * grid.columns, sink);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (!put_items(number, at(numbers, grid.place(row, column) * number.info.size), 1, sink)) return false;
    }
  }
  return true;
}

}  // namespace

bool put_grid(const DescribedType& number, const Grid& grid, const void* numbers, Sink& sink) {
  const std::array<std::uint64_t, 2> size = {grid.rows, grid.columns};
  return sink.align(sizeof(std::int64_t)) && sink.put(size.data(), sizeof size) &&
         sink.put_count(grid.rows * grid.columns) && put_numbers(number, grid, numbers, sink);
}

namespace {

bool put_matrix(const DescribedType& described, const void* object, Sink& sink) {
  const MatrixAccess& access = described.grid;
  if (is_fixed_matrix(described)) return put_numbers(*access.number, fixed_grid(described), object, sink);
  const auto [rows, columns] = access.size(object);
  return put_grid(*access.number, {rows, columns, access.by_rows}, access.numbers(object), sink);
}

bool put_text(const std::string& text, Sink& sink) {
  return sink.put_count(text.size() + 1) && sink.put(text.c_str(), text.size() + 1);
}

bool put_container(const DescribedType& described, const void* object, Sink& sink) {
  if (described.shape->type.is_string()) return put_text(*static_cast<const std::string*>(object), sink);
  if (is_bits(described)) return put_bits(*static_cast<const std::vector<bool>*>(object), sink);
  const std::size_t count = described.sequence.size(described, object);
  if (!sink.put_count(count)) return false;
  if (count == 0) return true;
  if (!sink.enter()) return false;
  const bool done =
      put_items(*described.shape->element, described.sequence.item(described, object, 0), count, sink);
  sink.leave();
  return done;
}

bool put_parts(const DescribedType& described, const void* object, Sink& sink) {
  if (described.grid.number != nullptr) return put_matrix(described, object, sink);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Compound) return put_compound(shape, object, sink);
  if (shape.type.kind == TypeKind::Array) return put_items(*shape.element, object, shape.type.count, sink);
  return put_container(described, object, sink);
}

bool put(const DescribedType& described, const void* object, Sink& sink) {
  return described.shape->cdr.packed ? put_items(described, object, 1, sink)
                                     : put_parts(described, object, sink);
}

bool get_parts(const DescribedType& described, void* object, Source& source);

bool sanitize_all(const DescribedType& element, void* items, std::size_t count) {
  bool valid = true;
  for (std::size_t i = 0; element.flat.checked && i < count; ++i)
    valid = sanitize(element, at(items, i * element.info.size)) && valid;
  return valid;
}

}  // namespace

bool get_items(const DescribedType& element, void* items, std::size_t count, Source& source) {
  const CdrPlan& plan = element.shape->cdr;
  if (count == 0) return true;
  if (plan.packed && (!source.swapped() || plan.most == 1)) {
    if (!source.align(plan.first)) return false;
    if (source.is_at(plan.most))
      return source.get(items, count * element.info.size) && sanitize_all(element, items, count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!get_parts(element, at(items, i * element.info.size), source)) return false;
  }
  return true;
}

namespace {

bool get(const DescribedType& described, void* object, Source& source);

bool get_run(const Shape& shape, const CdrRun& run, void* object, Source& source) {
  const auto fields = std::span(shape.fields).subspan(run.begin, std::max<std::size_t>(run.count, 1));
  if (run.count > 0 && !source.swapped()) {
    if (!source.align(run.first)) return false;
    if (source.is_at(run.most)) {
      if (!source.get(at(object, run.offset), run.size)) return false;
      bool valid = true;
      for (const DescribedField& field : run.checked ? fields : fields.first(0))
        valid = sanitize(*field.type, at(object, field.offset)) && valid;
      return valid;
    }
  }
  return std::ranges::all_of(fields, [&](const DescribedField& field) {
    return get(*field.type, at(object, field.offset), source);
  });
}

bool get_compound(const Shape& shape, void* object, Source& source) {
  std::byte nothing{};
  if (shape.fields.empty()) return source.get(&nothing, 1);
  return std::ranges::all_of(shape.cdr.runs,
                             [&](const CdrRun& run) { return get_run(shape, run, object, source); });
}

bool get_vector_of_bits(std::vector<bool>& bits, Source& source) {
  std::span<const std::byte> values;
  if (!get_bits(values, source)) return false;
  bits.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    bits[i] = values[i] != std::byte{0};
  return true;
}

}  // namespace

bool get_bits(std::span<const std::byte>& bits, Source& source) {
  std::size_t count = 0;
  if (!source.get_count(count, 1)) return false;
  bits = {source.skip(count), count};
  return std::ranges::all_of(bits, [](std::byte bit) { return bit <= std::byte{1}; });
}

bool get_numbers(const DescribedType& number, const Grid& grid, void* numbers, Source& source) {
  if (grid.in_order()) return get_items(number, numbers, grid.rows * grid.columns, source);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (!get_items(number, at(numbers, grid.place(row, column) * number.info.size), 1, source))
        return false;
    }
  }
  return true;
}

bool get_grid(const DescribedType& number, std::array<std::size_t, 2>& size, Source& source) {
  auto& [rows, columns] = size;
  std::size_t count = 0;
  if (!source.get_number(&rows, sizeof rows) || !source.get_number(&columns, sizeof columns)) return false;
  if (!source.get_count(count, number.info.size)) return false;
  constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
  if (rows > kMost || columns > kMost || (columns != 0 && rows > kMost / columns)) return false;
  return rows * columns == count;
}

bool get_text(std::span<const std::byte>& text, Source& source) {
  std::size_t size = 0;
  if (!source.get_count(size, 1)) return false;
  text = {source.skip(size), size};
  if (text.empty()) return true;
  if (text.back() != std::byte{0}) return false;
  text = text.first(size - 1);
  return true;
}

namespace {

bool get_matrix(const DescribedType& described, void* object, Source& source) {
  const MatrixAccess& access = described.grid;
  if (is_fixed_matrix(described)) return get_numbers(*access.number, fixed_grid(described), object, source);
  std::array<std::size_t, 2> size{};
  void* numbers = nullptr;
  return get_grid(*access.number, size, source) && access.resize(object, size, numbers) &&
         get_numbers(*access.number, {size[0], size[1], access.by_rows}, numbers, source);
}

bool get_string(std::string& string, Source& source) {
  std::span<const std::byte> text;
  if (!get_text(text, source)) return false;
  string.assign(reinterpret_cast<const char*>(text.data()), text.size());
  return true;
}

bool get_sequence(const DescribedType& element, void* items, std::size_t count, Source& source) {
  const std::size_t least = element.shape->cdr.least;
  bool done = true;
  if (element.shape->cdr.packed) {
    done = get_items(element, items, count, source);
  } else {
    source.claim(count * least);
    for (std::size_t i = 0; done && i < count; ++i) {
      source.release(least);
      done = get_parts(element, at(items, i * element.info.size), source);
    }
  }
  source.leave();
  return done;
}

bool get_container(const DescribedType& described, void* object, Source& source) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) return get_string(*static_cast<std::string*>(object), source);
  if (is_bits(described)) return get_vector_of_bits(*static_cast<std::vector<bool>*>(object), source);
  std::size_t count = 0;
  if (!source.get_count(count, shape.element->shape->cdr.least)) return false;
  if (shape.type.is_optional() && count > 1) return false;
  void* items = described.sequence.reuse(described, object, count);
  if (count == 0) return true;
  return source.enter() && get_sequence(*shape.element, items, count, source);
}

bool get_scalar(const DescribedType& described, void* object, Source& source) {
  return source.get_number(object, described.info.size) && sanitize(described, object);
}

bool get_parts(const DescribedType& described, void* object, Source& source) {
  if (described.grid.number != nullptr) return get_matrix(described, object, source);
  const Shape& shape = *described.shape;
  switch (shape.type.kind) {
    case TypeKind::Compound:
      return get_compound(shape, object, source);
    case TypeKind::Array:
      return get_items(*shape.element, object, shape.type.count, source);
    case TypeKind::Container:
      return get_container(described, object, source);
    default:
      return get_scalar(described, object, source);
  }
}

bool get(const DescribedType& described, void* object, Source& source) {
  return described.shape->cdr.packed ? get_items(described, object, 1, source)
                                     : get_parts(described, object, source);
}

}  // namespace
}  // namespace detail::cdr

bool can_encode_cdr(const TypeInfo& info) noexcept {
  return info.described != nullptr && info.described->shape->cdr.possible;
}

std::size_t cdr_size(const TypeInfo& info, const void* object) noexcept {
  if (!can_encode_cdr(info)) return 0;
  detail::cdr::Sink sink;
  return detail::cdr::put(*info.described, object, sink) ? detail::cdr::kHeader.size() + sink.used() : 0;
}

std::optional<std::size_t> write_cdr(const TypeInfo& info, const void* object,
                                     std::span<std::byte> bytes) noexcept {
  using detail::cdr::kHeader;
  if (!can_encode_cdr(info) || bytes.size() <= kHeader.size()) return std::nullopt;
  std::ranges::copy(kHeader, bytes.begin());
  detail::cdr::Sink sink(bytes.subspan(kHeader.size()));
  if (!detail::cdr::put(*info.described, object, sink)) return std::nullopt;
  return kHeader.size() + sink.used();
}

bool read_cdr(const TypeInfo& info, void* object, std::span<const std::byte> bytes) {
  if (!can_encode_cdr(info)) return false;
  auto source = detail::cdr::Source::open(bytes);
  return source && detail::cdr::get(*info.described, object, *source) &&
         source->left() <= detail::cdr::kPadding;
}

}  // namespace segue::type
