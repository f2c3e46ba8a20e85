// SPDX-License-Identifier: Apache-2.0
//
// The layout of plain CDR: numbers at multiples of their own size, counted from the end of the header; a
// sequence is a count of four bytes and its items, a text the same with a final zero byte, an optional a
// sequence of at most one item, a struct without members one byte. Matrices are written by rows.
#include <segue/type/cdr_object.hpp>
#include <segue/type/copy_bytes.hpp>
#include <segue/type/described_type.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

namespace segue::type {
namespace {

using detail::CdrPlan;
using detail::CdrRun;
using detail::DescribedField;
using detail::DescribedType;
using detail::Shape;

using Count = std::uint32_t;

static_assert(std::endian::native == std::endian::little);

constexpr std::array<std::byte, 4> kHeader = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
constexpr std::size_t kPadding = 3;  // RTPS fills messages up to a multiple of four bytes
/// As in flat.cpp.
constexpr int kMostLevels = 100;

const std::byte* at(const void* object, std::size_t offset) {
  return static_cast<const std::byte*>(object) + offset;
}

std::byte* at(void* object, std::size_t offset) {
  return static_cast<std::byte*>(object) + offset;
}

std::size_t gap_before(std::size_t position, std::size_t alignment) {
  return (alignment - position % alignment) % alignment;
}

bool is_bits(const DescribedType& described) {
  return described.conversion.to_value == &detail::bits_to_value;
}

bool is_fixed_matrix(const DescribedType& described) {
  return described.grid.number != nullptr && described.grid.size == nullptr;
}

/// Rows and columns of a matrix, and where its numbers lie.
struct Grid {
  std::size_t rows = 0;
  std::size_t columns = 0;
  bool by_rows = false;

  [[nodiscard]] std::size_t place(std::size_t row, std::size_t column) const {
    return by_rows ? row * columns + column : column * rows + row;
  }
};

Grid fixed_grid(const DescribedType& described) {
  const Type& type = described.shape->type;
  return {type.count, described.shape->element->shape->type.count, described.grid.by_rows};
}

/// The output behind the header: counts bytes, and writes them where there is memory.
class Sink {
 public:
  Sink() : limit_(std::numeric_limits<std::size_t>::max()) {}
  explicit Sink(std::span<std::byte> bytes) : bytes_(bytes.data()), limit_(bytes.size()) {}

  [[nodiscard]] std::size_t used() const { return used_; }

  bool put(const void* from, std::size_t size) {
    if (size > limit_ - used_) return false;
    if (bytes_ != nullptr) detail::copy_bytes(bytes_ + used_, from, size);
    used_ += size;
    return true;
  }
  bool align(std::size_t alignment) {
    static constexpr std::array<std::byte, 8> kZeros{};
    return put(kZeros.data(), gap_before(used_, alignment));
  }
  bool put_count(std::size_t number) {
    if (number > std::numeric_limits<Count>::max()) return false;
    const auto count = static_cast<Count>(number);
    return align(sizeof count) && put(&count, sizeof count);
  }

  bool enter() { return ++level_ <= kMostLevels; }
  void leave() { --level_; }

 private:
  std::byte* bytes_ = nullptr;
  std::size_t limit_;
  std::size_t used_ = 0;
  int level_ = 0;
};

bool put(const DescribedType& described, const void* object, Sink& sink);
bool put_parts(const DescribedType& described, const void* object, Sink& sink);

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
  if (grid.by_rows || grid.rows == 1 || grid.columns == 1)
    return put_items(number, numbers, grid.rows * grid.columns, sink);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (!put_items(number, at(numbers, grid.place(row, column) * number.info.size), 1, sink)) return false;
    }
  }
  return true;
}

bool put_matrix(const DescribedType& described, const void* object, Sink& sink) {
  const detail::MatrixAccess& access = described.grid;
  if (is_fixed_matrix(described)) return put_numbers(*access.number, fixed_grid(described), object, sink);
  const std::array<std::size_t, 2> size = access.size(object);
  const Grid grid{size[0], size[1], access.by_rows};
  return sink.align(sizeof(std::int64_t)) && sink.put(size.data(), sizeof size) &&
         sink.put_count(grid.rows * grid.columns) &&
         put_numbers(*access.number, grid, access.numbers(object), sink);
}

bool put_text(const std::string& text, Sink& sink) {
  return sink.put_count(text.size() + 1) && sink.put(text.c_str(), text.size() + 1);
}

bool put_container(const DescribedType& described, const void* object, Sink& sink) {
  if (described.shape->type.is_string()) return put_text(*static_cast<const std::string*>(object), sink);
  if (is_bits(described)) return put_bits(*static_cast<const std::vector<bool>*>(object), sink);
  const std::size_t count = described.sequence.size(object);
  if (!sink.put_count(count)) return false;
  if (count == 0) return true;
  if (!sink.enter()) return false;
  const bool done = put_items(*described.shape->element, described.sequence.item(object, 0), count, sink);
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

/// The unread input behind the header.
class Source {
 public:
  Source(std::span<const std::byte> bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - used_; }
  /// Whether numbers have the other byte order.
  [[nodiscard]] bool swapped() const { return swapped_; }
  [[nodiscard]] bool is_at(std::size_t alignment) const { return used_ % alignment == 0; }

  bool align(std::size_t alignment) {
    const std::size_t gap = gap_before(used_, alignment);
    if (gap > left()) return false;
    used_ += gap;
    return true;
  }
  bool get(void* to, std::size_t size) {
    if (size > left()) return false;
    detail::copy_bytes(to, bytes_.data() + used_, size);
    used_ += size;
    return true;
  }
  bool get_number(void* to, std::size_t size) {
    if (!align(size) || !get(to, size)) return false;
    auto* bytes = static_cast<std::byte*>(to);
    if (swapped_) std::reverse(bytes, bytes + size);
    return true;
  }
  /// A count of items of at least `least` bytes each; false where the remaining input, apart from what is
  /// claimed, cannot hold so many.
  bool get_count(std::size_t& number, std::size_t least) {
    Count count = 0;
    if (!get_number(&count, sizeof count)) return false;
    number = count;
    return count <= (left() - std::min(left(), claimed_)) / least;
  }
  /// The bytes that items which exist already, but have not been read yet, need at least. Without that a
  /// message of a type that contains itself could claim the same bytes at each level.
  void claim(std::size_t size) { claimed_ += size; }
  void release(std::size_t size) { claimed_ -= size; }
  /// Skips bytes and returns the first. Requires that so many are left.
  const std::byte* skip(std::size_t size) {
    const std::byte* skipped = bytes_.data() + used_;
    used_ += size;
    return skipped;
  }

  bool enter() { return ++level_ <= kMostLevels; }
  void leave() { --level_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t used_ = 0;
  std::size_t claimed_ = 0;
  bool swapped_;
  int level_ = 0;
};

bool get(const DescribedType& described, void* object, Source& source);
bool get_parts(const DescribedType& described, void* object, Source& source);

bool sanitize_all(const DescribedType& element, void* items, std::size_t count) {
  bool valid = true;
  for (std::size_t i = 0; element.flat.checked && i < count; ++i)
    valid = detail::sanitize(element, at(items, i * element.info.size)) && valid;
  return valid;
}

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

bool get_run(const Shape& shape, const CdrRun& run, void* object, Source& source) {
  const auto fields = std::span(shape.fields).subspan(run.begin, std::max<std::size_t>(run.count, 1));
  if (run.count > 0 && !source.swapped()) {
    if (!source.align(run.first)) return false;
    if (source.is_at(run.most)) {
      if (!source.get(at(object, run.offset), run.size)) return false;
      bool valid = true;
      for (const DescribedField& field : run.checked ? fields : fields.first(0))
        valid = detail::sanitize(*field.type, at(object, field.offset)) && valid;
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

bool get_bits(std::vector<bool>& bits, Source& source) {
  std::size_t count = 0;
  if (!source.get_count(count, 1)) return false;
  const std::span<const std::byte> values(source.skip(count), count);
  if (!std::ranges::all_of(values, [](std::byte value) { return value <= std::byte{1}; })) return false;
  bits.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    bits[i] = values[i] != std::byte{0};
  return true;
}

bool get_numbers(const DescribedType& number, const Grid& grid, void* numbers, Source& source) {
  if (grid.by_rows || grid.rows == 1 || grid.columns == 1)
    return get_items(number, numbers, grid.rows * grid.columns, source);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (!get_items(number, at(numbers, grid.place(row, column) * number.info.size), 1, source))
        return false;
    }
  }
  return true;
}

bool get_matrix(const DescribedType& described, void* object, Source& source) {
  const detail::MatrixAccess& access = described.grid;
  if (is_fixed_matrix(described)) return get_numbers(*access.number, fixed_grid(described), object, source);
  std::array<std::size_t, 2> size{};
  auto& [rows, columns] = size;
  std::size_t count = 0;
  if (!source.get_number(&rows, sizeof rows) || !source.get_number(&columns, sizeof columns)) return false;
  if (!source.get_count(count, access.number->info.size)) return false;
  constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
  if (rows > kMost || columns > kMost || (columns != 0 && rows > kMost / columns)) return false;
  void* numbers = nullptr;
  return rows * columns == count && access.resize(object, size, numbers) &&
         get_numbers(*access.number, {rows, columns, access.by_rows}, numbers, source);
}

bool get_text(std::string& text, Source& source) {
  std::size_t size = 0;
  if (!source.get_count(size, 1)) return false;
  const auto* characters = reinterpret_cast<const char*>(source.skip(size));
  if (size > 0 && characters[size - 1] != '\0') return false;
  text.assign(characters, size > 0 ? size - 1 : 0);
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
  if (shape.type.is_string()) return get_text(*static_cast<std::string*>(object), source);
  if (is_bits(described)) return get_bits(*static_cast<std::vector<bool>*>(object), source);
  std::size_t count = 0;
  if (!source.get_count(count, shape.element->shape->cdr.least)) return false;
  if (shape.type.is_optional() && count > 1) return false;
  void* items = described.sequence.reuse(object, count);
  if (count == 0) return true;
  return source.enter() && get_sequence(*shape.element, items, count, source);
}

bool get_scalar(const DescribedType& described, void* object, Source& source) {
  return source.get_number(object, described.info.size) && detail::sanitize(described, object);
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

bool can_encode_cdr(const TypeInfo& info) noexcept {
  return info.described != nullptr && info.described->shape->cdr.possible;
}

std::size_t cdr_size(const TypeInfo& info, const void* object) noexcept {
  if (!can_encode_cdr(info)) return 0;
  Sink sink;
  return put(*info.described, object, sink) ? kHeader.size() + sink.used() : 0;
}

std::optional<std::size_t> write_cdr(const TypeInfo& info, const void* object,
                                     std::span<std::byte> bytes) noexcept {
  if (!can_encode_cdr(info) || bytes.size() <= kHeader.size()) return std::nullopt;
  std::ranges::copy(kHeader, bytes.begin());
  Sink sink(bytes.subspan(kHeader.size()));
  if (!put(*info.described, object, sink)) return std::nullopt;
  return kHeader.size() + sink.used();
}

bool read_cdr(const TypeInfo& info, void* object, std::span<const std::byte> bytes) {
  if (!can_encode_cdr(info) || bytes.size() < kHeader.size()) return false;
  if (bytes[0] != std::byte{0} || bytes[1] > std::byte{1}) return false;
  Source source(bytes.subspan(kHeader.size()), bytes[1] == std::byte{0});
  return get(*info.described, object, source) && source.left() <= kPadding;
}

}  // namespace segue::type
