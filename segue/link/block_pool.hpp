// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/link/mapping.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::link {

/// Divides a range of bytes, which it never touches, into counted blocks of 64 bytes times a power of two.
/// What it knows of them is its own, so that nobody who can write to the range can spoil it. Small blocks are
/// halves of larger ones; none are joined again: what was once cut for a size stays with it. Lock free and
/// real-time safe from any thread but for the first use of a part of the range.
class BlockPool {
 public:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  static constexpr std::size_t kUnit = 64;

  /// For offsets below `size`; the books of the first `ready` bytes are made present at once.
  static Result<std::unique_ptr<BlockPool>> create(std::size_t size, std::size_t ready);

  /// The offset of a block with one reference, aligned to its size (at most 64 KiB); kNone where no room is
  /// left.
  std::uint64_t allocate(std::size_t size) noexcept;
  /// Another reference to a block that has one; at most 2^24.
  void retain(std::uint64_t offset) noexcept;
  /// One less; the last one makes it free.
  void release(std::uint64_t offset) noexcept;

  /// Bytes in blocks that have references, and up to where any was ever cut.
  [[nodiscard]] std::size_t used() const noexcept { return used_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t cut() const noexcept { return cut_.load(std::memory_order_relaxed); }

 private:
  static constexpr unsigned kClasses = 35;
  static constexpr unsigned kSlabClass = 10;  ///< 64 KiB: smaller blocks are cut from these
  static constexpr unsigned kClassShift = 24;
  static constexpr std::uint32_t kReferences = (1U << kClassShift) - 1;
  static constexpr std::size_t kMostUnits = std::size_t{1} << 31;
  using Link = std::atomic<std::uint32_t>;

  BlockPool(std::size_t size, Mapping links);
  static constexpr std::size_t bytes_of(unsigned block_class) { return kUnit << block_class; }
  static unsigned class_for(std::size_t size) noexcept;
  std::uint64_t take(unsigned block_class) noexcept;
  std::uint64_t pop(unsigned block_class) noexcept;
  void push(unsigned block_class, std::uint64_t unit) noexcept;
  std::uint64_t cut_off(unsigned block_class) noexcept;

  const std::size_t size_;
  const Mapping memory_;
  /// Of each block's first unit: free: the next free one + 1; else its class and references.
  Link* const links_;
  struct alignas(64) List {
    std::atomic<std::uint64_t> head{0};  ///< first unit + 1, and above it a count against reuse
  };
  std::array<List, kClasses> free_{};
  alignas(64) std::atomic<std::uint64_t> cut_{0};
  std::atomic<std::size_t> used_{0};
};

}  // namespace segue::link
