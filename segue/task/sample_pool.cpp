// SPDX-License-Identifier: Apache-2.0
#include <segue/task/sample_pool.hpp>

#include <algorithm>
#include <new>

namespace segue::task {

namespace {

/// The free list of a retired pool: a thread that finds it counts its slot instead of pushing it.
SampleSlot* retired_mark() {
  static SampleSlot mark;
  return &mark;
}

constexpr std::size_t rounded_up(std::size_t size, std::size_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}

std::size_t alignment_of(const type::TypeInfo* info) {
  return info == nullptr ? alignof(SampleSlot) : std::max(alignof(SampleSlot), info->alignment);
}

}  // namespace

void detail::RetirePool::operator()(SamplePool* pool) const noexcept {
  pool->retire();
}

SamplePool::Handle SamplePool::create(const type::TypeInfo* info, Holds holds) {
  return Handle(new SamplePool(info, holds));
}

SamplePool::SamplePool(const type::TypeInfo* info, Holds holds)
    : SampleOwner(info), holds_(holds), offset_(rounded_up(sizeof(SampleSlot), alignment_of(info))) {}

SamplePool::~SamplePool() {
  forget_example();
  for (const Chunk& chunk : chunks_) {
    for (std::size_t i = 0; i < chunk.slots; ++i) {
      auto* slot = reinterpret_cast<SampleSlot*>(chunk.memory + i * chunk.stride);
      if (holds_ == Holds::Flat) {
        free_flat(*slot);
      } else {
        if (slot->value != nullptr) info()->destroy(slot->value);
        if (slot->shared) memory_->deallocate(slot->value);
      }
      slot->~SampleSlot();
    }
    ::operator delete(chunk.memory, std::align_val_t(alignment_of(info())));
  }
}

bool SamplePool::reserve(std::size_t slots) {
  const Lock lock(mutex_);
  return reserve_usable(slots);
}

bool SamplePool::share(const std::shared_ptr<SampleMemory>& memory) {
  const Lock lock(mutex_);
  if (info() == nullptr) return true;
  if (!memory_) {
    memory_ = memory;
    outside_ = holds_ == Holds::Flat ? 0 : size_;
  }
  if (!reserve_usable(outside_)) return false;
  shares_.store(true, std::memory_order_release);  // S4
  return true;
}

bool SamplePool::reserve_usable(std::size_t slots) {
  const std::size_t usable = size_ - outside_;
  return slots <= usable || add_slots(slots - usable);
}

/// Adds fewer slots where the memory is full.
bool SamplePool::add_slots(std::size_t count) {
  chunks_.reserve(chunks_.size() + 1);
  const bool separate = info() == nullptr || holds_ == Holds::Flat || memory_ != nullptr;
  const std::size_t inside = separate ? 0 : info()->size;
  Chunk chunk{nullptr, 0, rounded_up(offset_ + inside, alignment_of(info()))};
  chunk.memory =
      static_cast<std::byte*>(::operator new(count* chunk.stride, std::align_val_t(alignment_of(info()))));
  SampleSlot* first = nullptr;
  SampleSlot* last = nullptr;
  for (; chunk.slots < count; ++chunk.slots) {
    SampleSlot* slot = make_slot(chunk.memory + chunk.slots * chunk.stride);
    if (slot == nullptr) break;
    slot->next = first;
    first = slot;
    if (last == nullptr) last = slot;
  }
  chunks_.push_back(chunk);
  size_ += chunk.slots;
  if (first != nullptr) push_chain(first, last);
  return chunk.slots == count;
}

/// nullptr where the memory is full.
SampleSlot* SamplePool::make_slot(std::byte* memory) {
  void* value = nullptr;
  const bool flat = holds_ == Holds::Flat;  // has no value until it is acquired
  if (memory_ && !flat) {
    value = memory_->allocate(info()->size, info()->alignment);
    if (value == nullptr) return nullptr;
  } else if (info() != nullptr && !flat) {
    value = memory + offset_;
  }
  auto* slot = new (memory) SampleSlot;
  slot->owner = this;
  slot->value = value;
  slot->shared = memory_ != nullptr && !flat;
  if (value == nullptr) return slot;
  info()->construct(value);
  if (example_ != nullptr) info()->copy(value, example_);
  return slot;
}

void SamplePool::prime(const void* example) {
  {
    // First, so that slots that are added meanwhile are filled either here or by reserve().
    const Lock lock(mutex_);
    if (example_ == nullptr) {
      example_ = ::operator new(info()->size, std::align_val_t(alignment_of(info())));
      info()->construct(example_);
    }
    info()->copy(example_, example);
  }
  std::vector<SampleRef> slots;
  while (SampleSlot* slot = acquire()) {
    slots.push_back(SampleRef::adopt(slot));
    info()->copy(slot->value, example);
  }
}

void SamplePool::forget_example() noexcept {
  if (example_ == nullptr) return;
  info()->destroy(example_);
  ::operator delete(example_, std::align_val_t(alignment_of(info())));
}

std::size_t SamplePool::size() const {
  const Lock lock(mutex_);
  return size_;
}

[[gnu::hot]] SampleSlot* SamplePool::pop() noexcept {
  if (reserved_ == nullptr) {
    if (free_.load(std::memory_order_relaxed) == nullptr) return nullptr;
    reserved_ = free_.exchange(nullptr, std::memory_order_acquire);  // pairs with S2
    if (reserved_ == nullptr) return nullptr;
  }
  SampleSlot* slot = reserved_;
  reserved_ = slot->next;
  return slot;
}

[[gnu::hot]] SampleSlot* SamplePool::acquire() noexcept {
  SampleSlot* slot = pop();
  // Slots with objects from before share() are dropped; it has added as many new ones.
  while (slot != nullptr && !slot->shared && holds_ == Holds::Objects &&
         shares_.load(std::memory_order_relaxed)) {
    ++replaced_;
    slot = pop();
  }
  if (slot == nullptr) return nullptr;
  slot->references.store(1, std::memory_order_relaxed);
  return slot;
}

SampleSlot* SamplePool::acquire_flat(std::size_t size) {
  SampleRef slot = SampleRef::adopt(acquire());
  if (!slot) {
    reserve(this->size() + 1);
    slot = SampleRef::adopt(acquire());
  }
  free_flat(*slot.get());
  if (shares_.load(std::memory_order_acquire)) {  // pairs with S4
    slot->value = memory_->allocate(size, alignof(SampleSlot));
    slot->shared = slot->value != nullptr;
  }
  // Where the shared memory is full, connections to other processes refuse the sample; those within this
  // process can have it.
  if (slot->value == nullptr) slot->value = ::operator new(size, std::align_val_t(alignof(SampleSlot)));
  slot->flat_size = size;
  return slot.detach();
}

void SamplePool::free_flat(SampleSlot& slot) noexcept {
  if (slot.shared) {
    memory_->deallocate(slot.value);
  } else {
    ::operator delete(slot.value, std::align_val_t(alignof(SampleSlot)));
  }
  slot.value = nullptr;
  slot.shared = false;
  slot.flat_size = 0;
}

[[gnu::hot]] void SamplePool::push_chain(SampleSlot* first, SampleSlot* last) noexcept {
  SampleSlot* head = free_.load(std::memory_order_relaxed);
  do {
    if (head == retired_mark()) return account(-1);
    last->next = head;
    // S2. Failures are relaxed: the head is not looked into.
  } while (!free_.compare_exchange_weak(head, first, std::memory_order_release, std::memory_order_relaxed));
}

[[gnu::hot]] void SamplePool::recycle(SampleSlot& slot) noexcept {
  // Other memory stays until the slot is used again, since freeing it is not real-time safe.
  if (holds_ == Holds::Flat && slot.shared) free_flat(slot);
  push_chain(&slot, &slot);
}

void SamplePool::retire() noexcept {
  auto home = static_cast<std::int64_t>(replaced_);
  for (SampleSlot* slot = reserved_; slot != nullptr; slot = slot->next)
    ++home;
  SampleSlot* freed = free_.exchange(retired_mark(), std::memory_order_acq_rel);  // pairs with S2
  for (; freed != nullptr; freed = freed->next)
    ++home;
  account(static_cast<std::int64_t>(size()) - home);
}

/// Slots are recycled one by one, before or after retire() has counted how many are out. The change that
/// brings the balance to zero is the last access to the pool.
void SamplePool::account(std::int64_t outstanding) noexcept {
  if (outstanding_.fetch_add(outstanding, std::memory_order_acq_rel) + outstanding == 0) delete this;  // S3
}

}  // namespace segue::task
