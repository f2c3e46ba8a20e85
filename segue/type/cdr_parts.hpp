// SPDX-License-Identifier: Apache-2.0
// Parts that cdr_object.cpp and cdr_flat.cpp share. Not for users.
#pragma once

#include <segue/type/byte_sink.hpp>
#include <segue/type/described_type.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace segue::type::detail::cdr {

static_assert(std::endian::native == std::endian::little);

using Count = std::uint32_t;

inline constexpr std::array<std::byte, 4> kHeader = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
inline constexpr std::size_t kPadding = 3;  ///< RTPS fills messages up to a multiple of four bytes

inline std::size_t gap_before(std::size_t position, std::size_t alignment) {
  return (alignment - position % alignment) % alignment;
}

/// The output behind the header.
class Sink : public ByteSink {
 public:
  using ByteSink::ByteSink;

  bool align(std::size_t alignment) {
    static constexpr std::array<std::byte, 8> kZeros{};
    return put(kZeros.data(), gap_before(used(), alignment));
  }
  bool put_count(std::size_t number) {
    if (number > std::numeric_limits<Count>::max()) return false;
    const auto count = static_cast<Count>(number);
    return align(sizeof count) && put(&count, sizeof count);
  }
};

/// The unread input behind the header.
class Source : public Nesting {
 public:
  /// Nothing where a message does not begin with the header of plain CDR.
  static std::optional<Source> open(std::span<const std::byte> message) {
    if (message.size() < kHeader.size() || message[0] != std::byte{0} || message[1] > std::byte{1}) return {};
    return Source(message.subspan(kHeader.size()), message[1] == std::byte{0});
  }

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
    copy_bytes(to, bytes_.data() + used_, size);
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

 private:
  Source(std::span<const std::byte> bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  std::span<const std::byte> bytes_;
  std::size_t used_ = 0;
  std::size_t claimed_ = 0;
  bool swapped_;
};

/// Rows and columns of a matrix, and where its numbers lie.
struct Grid {
  std::size_t rows = 0;
  std::size_t columns = 0;
  bool by_rows = false;

  /// Whether the numbers lie in the order in which they are written. Without that one must go through the
  /// rows; a matrix without columns may claim any number of them, but is in order.
  [[nodiscard]] bool in_order() const { return by_rows || rows <= 1 || columns <= 1; }
  [[nodiscard]] std::size_t place(std::size_t row, std::size_t column) const {
    return by_rows ? row * columns + column : column * rows + row;
  }
};

inline bool is_fixed_matrix(const DescribedType& described) {
  return described.grid.number != nullptr && described.grid.size == nullptr;
}

/// Writes or reads items one after the other. Objects that are copied as bytes (TypeInfo::trivially_copyable)
/// need no alignment.
bool put_items(const DescribedType& element, const void* items, std::size_t count, Sink& sink);
bool get_items(const DescribedType& element, void* items, std::size_t count, Source& source);
/// Rows, columns and numbers of a matrix of variable size; `get` reads the former.
bool put_grid(const DescribedType& number, const Grid& grid, const void* numbers, Sink& sink);
bool get_grid(const DescribedType& number, std::array<std::size_t, 2>& size, Source& source);
/// The numbers of a matrix, which need no alignment.
bool get_numbers(const DescribedType& number, const Grid& grid, void* numbers, Source& source);
/// The characters of a text, without the final zero.
bool get_text(std::span<const std::byte>& text, Source& source);
/// The items of a std::vector<bool>, each 0 or 1.
bool get_bits(std::span<const std::byte>& bits, Source& source);

}  // namespace segue::type::detail::cdr
