// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/byte_sink.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace segue::type::detail {

/// The unread input in the flat layout. Another process may change it meanwhile.
class FlatSource : public Nesting {
 public:
  using Count = std::uint64_t;

  explicit FlatSource(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

  bool get(void* to, std::size_t size) {
    if (size > bytes_.size()) return false;
    copy_bytes(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
    return true;
  }
  /// For numbers that bound memory accesses: reads them exactly once. The fence keeps the compiler from
  /// reading shared memory again, which another process may change meanwhile.
  bool get_once(void* to, std::size_t size) {
    const bool done = get(to, size);
    std::atomic_signal_fence(std::memory_order_seq_cst);
    return done;
  }
  /// A count of items of at least `least` bytes each; false where the remaining input cannot hold so many.
  bool get_count(Count& count, std::size_t least) {
    return get_once(&count, sizeof count) && count <= bytes_.size() / least;
  }
  /// The count of an optional's items.
  bool get_engaged(Count& count) {
    std::uint8_t engaged = 0;
    if (!get_once(&engaged, sizeof engaged)) return false;
    count = engaged;
    return count <= 1;
  }
  /// Rows and columns of a matrix; false where the remaining input cannot hold its numbers.
  bool get_size(std::array<std::size_t, 2>& size, std::size_t number_size) {
    const auto& [rows, columns] = size;
    if (!get_once(size.data(), sizeof size)) return false;
    constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
    if (rows > kMost || columns > kMost) return false;
    return columns == 0 || rows <= bytes_.size() / number_size / columns;
  }
  /// Skips bytes and returns the first. Requires that so many are left.
  const std::byte* skip(std::size_t size) {
    const std::byte* skipped = bytes_.data();
    bytes_ = bytes_.subspan(size);
    return skipped;
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace segue::type::detail
