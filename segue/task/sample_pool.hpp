// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/type_info.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace segue::task {

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
  using Handle = std::unique_ptr<SamplePool, detail::RetirePool>;

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
  friend struct detail::RetirePool;
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
