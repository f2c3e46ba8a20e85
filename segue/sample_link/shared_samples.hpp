// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/shared_pools.hpp>
#include <segue/sample_link/shared_ring.hpp>
#include <segue/task/sample.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::sample_link {

/// A ring in this process's control pool. Its place becomes free when the last holder releases it.
class OwnedRing {
 public:
  OwnedRing(std::shared_ptr<std::byte> memory, const Policy& policy, std::uint64_t generation);
  ~OwnedRing();
  OwnedRing(const OwnedRing&) = delete;
  OwnedRing& operator=(const OwnedRing&) = delete;
  SharedRing& operator*() noexcept { return ring_; }
  SharedRing* operator->() noexcept { return &ring_; }

 private:
  std::shared_ptr<std::byte> memory_;
  SharedRing ring_;
};

/// The samples that a reader holds in another process's pool: one slot for each entry of its ring. Lives, and
/// keeps the ring and the mapping of the pool alive, until the connection and the last sample are gone.
class SharedSamples final : public task::SampleOwner {
 public:
  struct Leave {
    void operator()(SharedSamples* samples) const noexcept { samples->let_go(); }
  };
  using Handle = std::unique_ptr<SharedSamples, Leave>;
  static Handle create(const type::TypeInfo* info, std::shared_ptr<OwnedRing> ring,
                       std::shared_ptr<const PeerMemory> writer);

  /// Whether this process still holds a sample of this entry. The writer reuses an entry only after recycle()
  /// has returned it (H3), which is ordered after the count became 0; so true means that the writer broke the
  /// protocol.
  [[nodiscard]] bool held(std::size_t entry) const noexcept {
    return slots_[entry].references.load(std::memory_order_acquire) != 0;
  }
  /// How many entries are held. Any thread.
  [[nodiscard]] std::size_t count_held() const noexcept;
  /// The sample of an entry that is not held; with `flat_size`, in the flat layout. The reader only;
  /// real-time safe.
  task::SampleRef lend(std::size_t entry, const void* value, std::size_t flat_size,
                       std::uint64_t sequence) noexcept;
  void recycle(task::SampleSlot& slot) noexcept override;

 private:
  SharedSamples(const type::TypeInfo* info, std::shared_ptr<OwnedRing> ring,
                std::shared_ptr<const PeerMemory> writer);
  ~SharedSamples() = default;
  void let_go() noexcept {
    // Acquire-release: every holder's use comes before the last one deletes.
    if (holders_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
  }

  const std::shared_ptr<OwnedRing> ring_;
  const std::shared_ptr<const PeerMemory> writer_;
  const std::unique_ptr<task::SampleSlot[]> slots_;
  std::atomic<std::size_t> holders_{1};  ///< samples in use, plus one for the connection
};

}  // namespace segue::sample_link
