// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

/// The real-time side: components, their ports, properties and operations, their life cycle, and what runs
/// them.
namespace segue::task {

struct SampleSlot;

/// Memory that other processes can read, for the values of samples. Real-time safe but for the first touch of
/// a page; any thread.
class SampleMemory {
 public:
  SampleMemory() = default;
  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;
  virtual ~SampleMemory() = default;
  /// nullptr: there is none left.
  virtual void* allocate(std::size_t size, std::size_t alignment) noexcept = 0;
  virtual void deallocate(void* memory) noexcept = 0;
};

/// Whose memory a sample lies in, and where it goes when nobody holds it any more.
class SampleOwner {
 public:
  explicit SampleOwner(const type::TypeInfo* info) : info_(info) {}
  SampleOwner(const SampleOwner&) = delete;
  SampleOwner& operator=(const SampleOwner&) = delete;
  /// The last reference is gone. Called from any thread; real-time safe.
  virtual void recycle(SampleSlot& slot) noexcept = 0;
  /// nullptr: samples are blank, they count but carry nothing.
  [[nodiscard]] const type::TypeInfo* info() const { return info_; }

 protected:
  ~SampleOwner() = default;

 private:
  const type::TypeInfo* info_;
};

/// A place for one sample. Whoever holds a reference may read the value; only its writer, before it publishes
/// the slot, may write it.
struct alignas(64) SampleSlot {
  std::atomic<std::uint32_t> references{0};
  std::uint64_t sequence = 0;  ///< how many samples its port had written, this one included
  void* value = nullptr;       ///< nullptr: blank
  SampleOwner* owner = nullptr;
  SampleSlot* next = nullptr;  ///< of the owner, while the slot is free
  bool shared = false;         ///< the value lies in the owner's SampleMemory

  void retain() noexcept { references.fetch_add(1, std::memory_order_relaxed); }
  void release() noexcept {
    // The only holder needs no atomic subtraction: nobody else can add a reference.
    if (references.load(std::memory_order_acquire) == 1) {
      references.store(0, std::memory_order_relaxed);
      owner->recycle(*this);
    } else if (references.fetch_sub(1, std::memory_order_acq_rel) == 1) {
      owner->recycle(*this);
    }
  }
};

/// One counted reference to a sample. Real-time safe; thread safe as far as int is.
class SampleRef {
 public:
  SampleRef() = default;
  /// Takes over a reference that is already counted.
  static SampleRef adopt(SampleSlot* slot) noexcept { return SampleRef(slot); }
  /// Counts a new one.
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
  /// Gives the reference away.
  SampleSlot* detach() noexcept { return std::exchange(slot_, nullptr); }

 private:
  explicit SampleRef(SampleSlot* slot) noexcept : slot_(slot) {}
  SampleSlot* slot_ = nullptr;
};

/// The samples of one output port: slots made beforehand, a lock-free list of the free ones. Outlives its
/// port until the last sample has come back.
class SamplePool final : public SampleOwner {
 public:
  struct Retire {
    void operator()(SamplePool* pool) const noexcept { pool->retire(); }
  };
  using Handle = std::unique_ptr<SamplePool, Retire>;

  static Handle create(const type::TypeInfo* info);

  /// Makes sure that there are at least `slots` in all. Any thread; allocates. False: the SampleMemory is
  /// full, and there are fewer.
  bool reserve(std::size_t slots);
  /// From now on values lie in `memory`: slots made before are replaced as they come back. The type must be
  /// trivially copyable. The first memory stays. Any thread; allocates. False as for reserve().
  bool share(const std::shared_ptr<SampleMemory>& memory);
  [[nodiscard]] std::size_t size() const;
  /// Fills every free slot, and every slot that reserve() adds from now on, with a copy of `example`, an
  /// object of the pool's type (which it must have). The writer only; allocates.
  void prime(const void* example);

  /// A free slot with one reference, holding an old or a default value; nullptr if there is none. One thread
  /// at a time (the writer); real-time safe.
  SampleSlot* acquire() noexcept;
  void recycle(SampleSlot& slot) noexcept override;

 private:
  struct Chunk {
    std::byte* memory = nullptr;
    std::size_t slots = 0;
    std::size_t stride = 0;
  };
  explicit SamplePool(const type::TypeInfo* info);
  ~SamplePool();
  void retire() noexcept;
  void account(std::int64_t outstanding) noexcept;
  void push_chain(SampleSlot* first, SampleSlot* last) noexcept;
  bool reserve_usable(std::size_t slots);
  bool add_slots(std::size_t count);
  SampleSlot* make_slot(std::byte* memory);
  SampleSlot* pop() noexcept;
  void forget_example() noexcept;

  SampleSlot* reserved_ = nullptr;  ///< free slots that the writer has already fetched
  std::size_t replaced_ = 0;        ///< the writer's: slots outside of the memory that it will not use again
  std::size_t offset_;              ///< of the value in its slot, where it lies there
  std::atomic<bool> shares_{false};
  mutable std::mutex mutex_;  ///< guards what follows, down to example_
  std::shared_ptr<SampleMemory> memory_;
  std::vector<Chunk> chunks_;
  std::size_t size_ = 0;
  std::size_t outside_ = 0;  ///< slots made before there was a memory_
  void* example_ = nullptr;  ///< of prime(), for slots to come
  alignas(64) std::atomic<SampleSlot*> free_{nullptr};
  /// After retirement: slots that have not come back. Negative while some came before they were counted.
  std::atomic<std::int64_t> outstanding_{0};
};

}  // namespace segue::task
