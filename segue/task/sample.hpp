// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

/// The real-time side: components, their ports, properties and operations, their life cycle and their
/// executors.
namespace segue::task {

struct SampleSlot;

/// Owns the memory of samples, and gets each one back when nobody holds it any more.
class SampleOwner {
 public:
  explicit SampleOwner(const type::TypeInfo* info) : info_(info) {}
  SampleOwner(const SampleOwner&) = delete;
  SampleOwner& operator=(const SampleOwner&) = delete;
  /// Called when the last reference is gone. Any thread; real-time safe.
  virtual void recycle(SampleSlot& slot) noexcept = 0;
  /// nullptr: untyped samples, which count but carry no value.
  [[nodiscard]] const type::TypeInfo* info() const { return info_; }

 protected:
  ~SampleOwner() = default;

 private:
  const type::TypeInfo* info_;
};

/// A place for one sample. Whoever holds a reference may read the value; only the writer may write it, before
/// it publishes the slot.
///
/// Memory order: retain() is relaxed, since the caller holds a reference already and the slot is passed on by
/// other means (a ring's word). S1: release() is acquire-release, so every holder's use of the value happens
/// before recycle(), and with the owner's free list before the writer uses the slot again.
struct alignas(64) SampleSlot {
  std::atomic<std::uint32_t> references{0};
  std::uint64_t sequence = 0;  ///< the number of this sample at its port, from 1
  void* value = nullptr;       ///< nullptr: untyped
  SampleOwner* owner = nullptr;
  SampleSlot* next = nullptr;  ///< for the owner, while the slot is free
  bool shared = false;         ///< the value lies in memory that other processes can read
  std::size_t flat_size = 0;   ///< not 0: the value is so many bytes in the flat layout, not an object
  TimePoint written_at{};      ///< TimePoint(): not to be measured (detail::SampleStamps)

  /// Requires flat_size.
  [[nodiscard]] std::span<const std::byte> flat() const noexcept {
    return {static_cast<const std::byte*>(value), flat_size};
  }

  void retain() noexcept { references.fetch_add(1, std::memory_order_relaxed); }
  void release() noexcept {
    // The only holder needs no atomic decrement: nobody else can add a reference. Acquire pairs with the
    // decrement of the holders before it.
    if (references.load(std::memory_order_acquire) == 1) {  // pairs with S1
      references.store(0, std::memory_order_relaxed);
      owner->recycle(*this);
    } else if (references.fetch_sub(1, std::memory_order_acq_rel) == 1) {  // S1
      owner->recycle(*this);
    }
  }
};

static_assert(sizeof(SampleSlot) == 64, "a slot is one line of the cache");

/// A counted reference to a sample. Real-time safe; an object may be used by one thread at a time.
class SampleRef {
 public:
  SampleRef() = default;
  /// Takes over a counted reference.
  static SampleRef adopt(SampleSlot* slot) noexcept { return SampleRef(slot); }
  /// Adds a reference.
  static SampleRef share(SampleSlot& slot) noexcept {
    slot.retain();
    return SampleRef(&slot);
  }
  SampleRef(const SampleRef& other) noexcept : slot_(other.slot_) {
    if (slot_ != nullptr) slot_->retain();
  }
  SampleRef(SampleRef&& other) noexcept : slot_(std::exchange(other.slot_, nullptr)) {}
  SampleRef& operator=(SampleRef other) noexcept {
    std::swap(slot_, other.slot_);
    return *this;
  }
  ~SampleRef() {
    if (slot_ != nullptr) slot_->release();
  }
  explicit operator bool() const noexcept { return slot_ != nullptr; }
  [[nodiscard]] SampleSlot* get() const noexcept { return slot_; }
  SampleSlot* operator->() const noexcept { return slot_; }
  /// Gives up the reference without releasing it.
  SampleSlot* detach() noexcept { return std::exchange(slot_, nullptr); }

 private:
  explicit SampleRef(SampleSlot* slot) noexcept : slot_(slot) {}
  SampleSlot* slot_ = nullptr;
};

class SamplePool;

namespace detail {
/// Lets a pool end with its port, or with the last of its samples that somebody holds (sample_pool.hpp).
struct RetirePool {
  void operator()(SamplePool* pool) const noexcept;
};
}  // namespace detail

}  // namespace segue::task
