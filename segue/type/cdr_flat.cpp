// SPDX-License-Identifier: Apache-2.0
// Contiguous bytes are the same in the flat layout and in memory, so the functions for objects encode them;
// strings, sequences and the like differ in their counts only.
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/cdr_parts.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/flat_source.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace segue::type {
namespace {

using detail::ByteSink;
using detail::CdrPlan;
using detail::DescribedField;
using detail::DescribedType;
using detail::FlatSource;
using detail::Shape;
using detail::cdr::Grid;
using detail::cdr::kHeader;
using CdrSink = detail::cdr::Sink;
using CdrSource = detail::cdr::Source;

bool has_bits(const DescribedType& described) {
  return described.conversion.to_value == &detail::bits_to_value;
}

bool is_convertible(const TypeInfo& info) {
  return can_flatten(info) && can_encode_cdr(info);
}

bool to_cdr(const DescribedType& described, FlatSource& flat, CdrSink& cdr);

bool items_to_cdr(const DescribedType& element, std::size_t count, FlatSource& flat, CdrSink& cdr) {
  if (element.info.trivially_copyable) {
    const std::size_t size = count * element.info.size;
    return size <= flat.left() && detail::cdr::put_items(element, flat.skip(size), count, cdr);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!to_cdr(element, flat, cdr)) return false;
  }
  return true;
}

bool grid_to_cdr(const detail::MatrixAccess& access, FlatSource& flat, CdrSink& cdr) {
  std::array<std::size_t, 2> size{};
  if (!flat.get_size(size, access.number->info.size) || !access.fits(size)) return false;
  const Grid grid{size[0], size[1], access.by_rows};
  const std::byte* numbers = flat.skip(grid.rows * grid.columns * access.number->info.size);
  return detail::cdr::put_grid(*access.number, grid, numbers, cdr);
}

bool text_to_cdr(FlatSource& flat, CdrSink& cdr) {
  FlatSource::Count size = 0;
  return flat.get_count(size, 1) && cdr.put_count(size + 1) && cdr.put(flat.skip(size), size) &&
         cdr.put("", 1);
}

bool bits_to_cdr(FlatSource& flat, CdrSink& cdr) {
  FlatSource::Count count = 0;
  return flat.get_count(count, 1) && cdr.put_count(count) && cdr.put(flat.skip(count), count);
}

bool container_to_cdr(const DescribedType& described, FlatSource& flat, CdrSink& cdr) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) return text_to_cdr(flat, cdr);
  if (has_bits(described)) return bits_to_cdr(flat, cdr);
  FlatSource::Count count = 0;
  const bool counted =
      shape.type.is_optional() ? flat.get_engaged(count) : flat.get_count(count, shape.element->flat.least);
  if (!counted || !cdr.put_count(count)) return false;
  if (count == 0) return true;
  if (!flat.enter()) return false;
  const bool done = items_to_cdr(*shape.element, count, flat, cdr);
  flat.leave();
  return done;
}

bool to_cdr(const DescribedType& described, FlatSource& flat, CdrSink& cdr) {
  if (described.info.trivially_copyable) return items_to_cdr(described, 1, flat, cdr);
  if (described.grid.size != nullptr) return grid_to_cdr(described.grid, flat, cdr);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Array) return items_to_cdr(*shape.element, shape.type.count, flat, cdr);
  if (shape.type.kind == TypeKind::Container) return container_to_cdr(described, flat, cdr);
  std::byte nothing{};
  if (shape.fields.empty()) return flat.get(&nothing, 1) && cdr.put("", 1);
  return std::ranges::all_of(shape.fields,
                             [&](const DescribedField& field) { return to_cdr(*field.type, flat, cdr); });
}

bool skip_in_cdr(const DescribedType& element, std::size_t count, CdrSource& cdr);

bool skip_parts(const DescribedType& described, CdrSource& cdr) {
  const Shape& shape = *described.shape;
  if (described.grid.number != nullptr) {
    const DescribedType& number = *described.grid.number;
    return skip_in_cdr(number, described.info.size / number.info.size, cdr);
  }
  if (shape.type.kind == TypeKind::Array) return skip_in_cdr(*shape.element, shape.type.count, cdr);
  return std::ranges::all_of(shape.fields,
                             [&](const DescribedField& field) { return skip_in_cdr(*field.type, 1, cdr); });
}

/// Requires a type that is copied as bytes.
bool skip_in_cdr(const DescribedType& element, std::size_t count, CdrSource& cdr) {
  const CdrPlan& plan = element.shape->cdr;
  if (count == 0) return true;
  if (plan.packed) {
    if (!cdr.align(plan.first)) return false;
    if (cdr.is_at(plan.most)) {
      const std::size_t size = count * element.info.size;
      if (size > cdr.left()) return false;
      cdr.skip(size);
      return true;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!skip_parts(element, cdr)) return false;
  }
  return true;
}

bool put_count(std::uint64_t count, ByteSink& flat) {
  return flat.put(&count, sizeof count);
}

bool to_flat(const DescribedType& described, CdrSource& cdr, ByteSink& flat);

bool items_to_flat(const DescribedType& element, std::size_t count, CdrSource& cdr, ByteSink& flat) {
  if (element.info.trivially_copyable) {
    const std::size_t size = count * element.info.size;
    if (!flat.writes()) return flat.count(size) && skip_in_cdr(element, count, cdr);
    std::byte* items = flat.reserve(size);
    if (items == nullptr) return false;
    if (!element.shape->cdr.packed && size > 0) std::memset(items, 0, size);
    return detail::cdr::get_items(element, items, count, cdr);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!to_flat(element, cdr, flat)) return false;
  }
  return true;
}

bool grid_to_flat(const detail::MatrixAccess& access, CdrSource& cdr, ByteSink& flat) {
  std::array<std::size_t, 2> size{};
  if (!detail::cdr::get_grid(*access.number, size, cdr) || !access.fits(size)) return false;
  if (!flat.put(size.data(), sizeof size)) return false;
  const Grid grid{size[0], size[1], access.by_rows};
  const std::size_t count = grid.rows * grid.columns;
  const std::size_t bytes = count * access.number->info.size;
  if (!flat.writes()) return flat.count(bytes) && skip_in_cdr(*access.number, count, cdr);
  std::byte* numbers = flat.reserve(bytes);
  return numbers != nullptr && detail::cdr::get_numbers(*access.number, grid, numbers, cdr);
}

bool container_to_flat(const DescribedType& described, CdrSource& cdr, ByteSink& flat) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string() || has_bits(described)) {
    std::span<const std::byte> bytes;
    const bool valid =
        shape.type.is_string() ? detail::cdr::get_text(bytes, cdr) : detail::cdr::get_bits(bytes, cdr);
    return valid && put_count(bytes.size(), flat) && flat.put(bytes.data(), bytes.size());
  }
  std::size_t count = 0;
  if (!cdr.get_count(count, shape.element->shape->cdr.least)) return false;
  const bool is_optional = shape.type.is_optional();
  if (is_optional && count > 1) return false;
  const auto engaged = static_cast<std::uint8_t>(count);
  const bool counted = is_optional ? flat.put(&engaged, sizeof engaged) : put_count(count, flat);
  if (!counted || count == 0) return counted;
  if (!cdr.enter()) return false;
  const bool done = items_to_flat(*shape.element, count, cdr, flat);
  cdr.leave();
  return done;
}

bool to_flat(const DescribedType& described, CdrSource& cdr, ByteSink& flat) {
  if (described.info.trivially_copyable) return items_to_flat(described, 1, cdr, flat);
  if (described.grid.size != nullptr) return grid_to_flat(described.grid, cdr, flat);
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Array) return items_to_flat(*shape.element, shape.type.count, cdr, flat);
  if (shape.type.kind == TypeKind::Container) return container_to_flat(described, cdr, flat);
  std::byte nothing{};
  if (shape.fields.empty()) return cdr.get(&nothing, 1) && flat.put("", 1);
  return std::ranges::all_of(shape.fields,
                             [&](const DescribedField& field) { return to_flat(*field.type, cdr, flat); });
}

bool message_to_flat(const TypeInfo& info, std::span<const std::byte> message, ByteSink& flat) {
  auto cdr = CdrSource::open(message);
  return cdr && to_flat(*info.described, *cdr, flat) && cdr->left() <= detail::cdr::kPadding;
}

}  // namespace

std::size_t cdr_size_of_flat(const TypeInfo& info, std::span<const std::byte> flat) noexcept {
  if (!is_convertible(info)) return 0;
  FlatSource source(flat);
  CdrSink sink;
  const bool valid = to_cdr(*info.described, source, sink) && source.left() == 0;
  return valid ? kHeader.size() + sink.used() : 0;
}

bool flat_to_cdr(const TypeInfo& info, std::span<const std::byte> flat, std::span<std::byte> cdr) noexcept {
  if (!is_convertible(info) || cdr.size() <= kHeader.size()) return false;
  std::ranges::copy(kHeader, cdr.begin());
  FlatSource source(flat);
  CdrSink sink(cdr.subspan(kHeader.size()));
  return to_cdr(*info.described, source, sink) && source.left() == 0 &&
         kHeader.size() + sink.used() == cdr.size();
}

std::size_t flat_size_of_cdr(const TypeInfo& info, std::span<const std::byte> cdr) noexcept {
  if (!is_convertible(info)) return 0;
  ByteSink sink;
  return message_to_flat(info, cdr, sink) ? sink.used() : 0;
}

bool cdr_to_flat(const TypeInfo& info, std::span<const std::byte> cdr, std::span<std::byte> flat) noexcept {
  if (!is_convertible(info) || flat.empty()) return false;
  ByteSink sink(flat);
  return message_to_flat(info, cdr, sink) && sink.used() == flat.size();
}

}  // namespace segue::type
