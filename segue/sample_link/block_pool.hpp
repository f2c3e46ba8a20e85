// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/sample_link/mapping.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::sample_link {

/// Divides a range of bytes, which it never touches, into reference-counted blocks of 64 bytes times a power
/// of two. The bookkeeping lies in private memory, out of reach of those who can write to the range. Small
/// blocks are made by splitting larger ones; blocks are never merged again. Lock free and real-time safe from
/// any thread, except for page faults at the first use of a part of the range.
///
/// Memory order: all accesses of a block's earlier holders happen before those of its next one. Each size
/// class has a free list, a stack whose head carries a counter against reuse (ABA).
/// - B1: push() releases the head and pop() acquires it; every change of it is a read-modify-write, so pop()
///   synchronizes with the push() of the block that it gets, whoever has changed the head in between.
/// - B2: release() drops a reference with acquire-release, so the use of all holders comes before push().
/// - retain() is relaxed, since the caller holds a reference.
class BlockPool {
 public:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  static constexpr std::size_t kUnit = 64;

  /// For offsets below `size`; the bookkeeping of the first `ready` bytes is made present at once.
  static Result<std::unique_ptr<BlockPool>> create(std::size_t size, std::size_t ready);

  /// The offset of a block with one reference, aligned to its size (at most 64 KiB); kNone where the range is
  /// used up.
  std::uint64_t allocate(std::size_t size) noexcept;
  /// Adds a reference to a block of which the caller holds one; at most 2^24.
  void retain(std::uint64_t offset) noexcept;
  /// Drops a reference; the last one frees the block.
  void release(std::uint64_t offset) noexcept;

  /// Bytes in blocks that are in use, and the end of the part that was ever divided. Statistics, relaxed.
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
  /// The state of each block, at its first unit: while it is free, the next free one + 1; else its class and
  /// references.
  Link* const links_;
  struct alignas(64) List {
    std::atomic<std::uint64_t> head{0};  ///< first unit + 1; the upper 32 bits count changes
  };
  std::array<List, kClasses> free_{};
  alignas(64) std::atomic<std::uint64_t> cut_{0};
  std::atomic<std::size_t> used_{0};
};

}  // namespace segue::sample_link
