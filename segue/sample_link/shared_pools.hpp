// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/sample_link/block_pool.hpp>
#include <segue/sample_link/mapping.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/sample_link/shared_ring.hpp>
#include <segue/task/doorbell.hpp>
#include <segue/task/sample_pool.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace segue::sample_link {

/// Begins every pool, so that a peer can check what it maps.
struct PoolHeader {
  std::uint64_t magic = 0;
  std::uint64_t layout = 0;  ///< version of all layouts used in the pools
  Incarnation incarnation = 0;
};

/// Holds the samples of this process that others read. Only this process can write to it.
class PayloadPool final : public task::SampleMemory {
 public:
  static Result<std::shared_ptr<PayloadPool>> create(Incarnation owner, std::size_t size,
                                                     std::size_t prefault);
  void* allocate(std::size_t size, std::size_t alignment) noexcept override;
  void deallocate(void* memory) noexcept override;

  /// The offset of a value; nullopt if it is not in this pool.
  [[nodiscard]] std::optional<std::uint64_t> offset_of(const void* value) const noexcept;
  [[nodiscard]] std::byte* at(std::uint64_t offset) const noexcept { return file_.mapping.data() + offset; }
  [[nodiscard]] BlockPool& blocks() noexcept { return *blocks_; }
  [[nodiscard]] const BlockPool& blocks() const noexcept { return *blocks_; }
  [[nodiscard]] const Descriptor& descriptor() const noexcept { return file_.descriptor; }
  /// Writes the header again, in case it was overwritten: nobody could map the pool any more.
  void restore_header(Incarnation owner) noexcept;

  PayloadPool(SealedFile file, std::unique_ptr<BlockPool> blocks)
      : file_(std::move(file)), blocks_(std::move(blocks)) {}

 private:
  SealedFile file_;
  std::unique_ptr<BlockPool> blocks_;
};

/// Holds the rings of connections into this process and its doorbells. Peers can write to it, too.
class ControlPool : public std::enable_shared_from_this<ControlPool> {
 public:
  static Result<std::shared_ptr<ControlPool>> create(Incarnation owner, std::size_t size);
  /// Zero-filled; nullptr where the pool is full. Freed when the last copy of the pointer goes.
  std::shared_ptr<std::byte> allocate(std::size_t size);
  /// A doorbell whose words lie in this pool; nullptr where the pool is full.
  std::shared_ptr<task::Doorbell> make_doorbell();

  [[nodiscard]] std::optional<std::uint64_t> offset_of(const void* address) const noexcept;
  [[nodiscard]] const BlockPool& blocks() const noexcept { return *blocks_; }
  [[nodiscard]] const Descriptor& descriptor() const noexcept { return file_.descriptor; }
  /// Writes the header again, in case a peer has overwritten it: nobody could map the pool any more.
  void restore_header(Incarnation owner) noexcept;

  ControlPool(SealedFile file, std::unique_ptr<BlockPool> blocks)
      : file_(std::move(file)), blocks_(std::move(blocks)) {}

 private:
  SealedFile file_;
  std::unique_ptr<BlockPool> blocks_;
};

/// The mapped pools of another process.
class PeerMemory {
 public:
  /// The offer is untrusted.
  static Result<std::shared_ptr<const PeerMemory>> map(const MemoryOffer& offer);
  [[nodiscard]] Incarnation incarnation() const noexcept { return incarnation_; }

  /// Bytes of its payload pool; nullptr where the range is outside the pool or misaligned.
  [[nodiscard]] const std::byte* payload(std::uint64_t offset, std::uint64_t size,
                                         std::size_t alignment) const noexcept;
  /// Bytes of its control pool, aligned to 64; nullptr where the range is outside the pool or misaligned.
  [[nodiscard]] std::byte* control(std::uint64_t offset, std::uint64_t size) const noexcept;

  PeerMemory(Incarnation incarnation, Mapping payload, Mapping control)
      : incarnation_(incarnation), payload_(std::move(payload)), control_(std::move(control)) {}

 private:
  Incarnation incarnation_;
  Mapping payload_;
  Mapping control_;
};

/// A line of a doorbell, packed into one word of a ring's header.
struct DoorbellLine {
  static constexpr unsigned kLineBits = 12;
  static_assert(task::DoorbellWords::kLines == 1U << kLineBits);
  std::uint64_t offset = 0;  ///< in the reader's control pool
  unsigned line = 0;
  /// The line as a word with a seal in the upper bits, since a ringer that uses an overwritten word would
  /// write to memory of others.
  [[nodiscard]] std::uint64_t word() const {
    const std::uint64_t plain = offset / BlockPool::kUnit << kLineBits | line;
    return plain | seal_of(plain) << kPlainBits;
  }
  /// nullopt where the seal is another.
  static std::optional<DoorbellLine> of(std::uint64_t word) {
    const std::uint64_t plain = word & ((std::uint64_t{1} << kPlainBits) - 1);
    if (word >> kPlainBits != seal_of(plain)) return std::nullopt;
    return DoorbellLine{(plain >> kLineBits) * BlockPool::kUnit,
                        static_cast<unsigned>(plain % task::DoorbellWords::kLines)};
  }

 private:
  static constexpr unsigned kPlainBits = 31 + kLineBits;  ///< the largest pool has 2^31 units
  static std::uint64_t seal_of(std::uint64_t plain) { return plain * 0x9e3779b97f4a7c15 >> kPlainBits; }
};

}  // namespace segue::sample_link
