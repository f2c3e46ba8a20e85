// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

/// The real-time side: components, their ports, properties and operations, their life cycle and their
/// executors.
namespace segue::task {

struct SampleSlot;

/// Memory for the values of samples that other processes can read. Any thread; real-time safe except for page
/// faults.
class SampleMemory {
 public:
  SampleMemory() = default;
  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;
  virtual ~SampleMemory() = default;
  /// nullptr: no memory is left.
  virtual void* allocate(std::size_t size, std::size_t alignment) noexcept = 0;
  virtual void deallocate(void* memory) noexcept = 0;
};

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
  bool shared = false;         ///< the value lies in the owner's SampleMemory
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

/// The samples of one output port: preallocated slots and a lock-free list of the free ones. Outlives its
/// port until the last sample has been recycled.
///
/// Memory order:
/// - S2: any thread pushes recycled slots to the stack free_ with release; the writer takes the whole stack
///   with one acquiring exchange, which synchronizes with all pushes and rules out ABA.
/// - S3: retiring exchanges free_ for a mark. A slot pushed before is counted there, a slot that finds the
///   mark counts itself in outstanding_, whose last acquire-release change deletes the pool after everybody's
///   last access.
/// - S4: share() releases shares_ after memory_; acquire_flat() acquires it. acquire() is relaxed, since it
///   only asks: if it misses the change, it uses an old slot once more.
class SamplePool final : public SampleOwner {
 public:
  struct Retire {
    void operator()(SamplePool* pool) const noexcept { pool->retire(); }
  };
  using Handle = std::unique_ptr<SamplePool, Retire>;

  /// The content of its slots: objects of the type, or bytes in its flat layout.
  enum class Holds : std::uint8_t { Objects, Flat };
  static Handle create(const type::TypeInfo* info, Holds holds = Holds::Objects);

  /// Makes sure that the pool has at least `slots`. Any thread; allocates. False: the SampleMemory is full,
  /// and there are fewer.
  bool reserve(std::size_t slots);
  /// From now on values lie in `memory`; earlier slots are replaced as they are recycled. Objects must be
  /// trivially copyable. Only the first memory counts. Any thread; allocates. False as for reserve().
  bool share(const std::shared_ptr<SampleMemory>& memory);
  [[nodiscard]] std::size_t size() const;
  /// Fills every free slot, and every slot that reserve() adds from now on, with a copy of `example`, an
  /// object of the pool's type. Requires a typed pool. The writer only; allocates.
  void prime(const void* example);

  /// A free slot with one reference, holding an old or a default value; nullptr if there is none. One thread
  /// at a time (the writer); real-time safe.
  SampleSlot* acquire() noexcept;
  /// A slot with one reference and room for `size` bytes in the flat layout, in the shared memory unless that
  /// is full; Holds::Flat only. One thread at a time (the writer). Allocates, a slot as well where none is
  /// free; may throw std::bad_alloc.
  SampleSlot* acquire_flat(std::size_t size);
  void recycle(SampleSlot& slot) noexcept override;

 private:
  struct Chunk {
    std::byte* memory = nullptr;
    std::size_t slots = 0;
    std::size_t stride = 0;
  };
  SamplePool(const type::TypeInfo* info, Holds holds);
  ~SamplePool();
  void retire() noexcept;
  void account(std::int64_t outstanding) noexcept;
  void push_chain(SampleSlot* first, SampleSlot* last) noexcept;
  bool reserve_usable(std::size_t slots) SEGUE_REQUIRES(mutex_);
  bool add_slots(std::size_t count) SEGUE_REQUIRES(mutex_);
  SampleSlot* make_slot(std::byte* memory) SEGUE_REQUIRES(mutex_);
  SampleSlot* pop() noexcept;
  void forget_example() noexcept SEGUE_UNCHECKED_LOCKS;  ///< at the end, when nobody else has the pool
  void free_flat(SampleSlot& slot) noexcept;

  const Holds holds_;
  SampleSlot* reserved_ = nullptr;  ///< writer only: free slots that it has already fetched
  std::size_t replaced_ = 0;        ///< writer only: slots outside memory_ that it will not use again
  std::size_t offset_;              ///< of the value in its slot, unless it lies in memory_
  /// Whether values lie in memory_.
  std::atomic<bool> shares_{false};
  mutable Mutex mutex_;  ///< guards the members down to example_
  /// Set under the mutex; never changes once shares_ is set, so who has seen that needs no mutex.
  std::shared_ptr<SampleMemory> memory_;
  std::vector<Chunk> chunks_ SEGUE_GUARDED_BY(mutex_);
  std::size_t size_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::size_t outside_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< slots outside memory_
  void* example_ SEGUE_GUARDED_BY(mutex_) = nullptr;  ///< set by prime(), for later slots
  alignas(64) std::atomic<SampleSlot*> free_{nullptr};
  /// After retirement: slots that are still out. Negative while slots came back before they were counted.
  std::atomic<std::int64_t> outstanding_{0};
};

}  // namespace segue::task
