// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/shared_samples.hpp>

#include <new>

namespace segue::sample_link {

using task::SampleRef;
using task::SampleSlot;

OwnedRing::OwnedRing(std::shared_ptr<std::byte> memory, const Policy& policy, std::uint64_t generation)
    : memory_(std::move(memory)), ring_(memory_.get(), policy, generation) {
  RingHeader& header = *new (memory_.get()) RingHeader;
  header.kind.store(static_cast<std::uint64_t>(policy.kind), std::memory_order_relaxed);
  header.size.store(policy.size, std::memory_order_relaxed);
  header.init.store(policy.init ? 1 : 0, std::memory_order_relaxed);
  header.generation.store(generation, std::memory_order_release);  // H1
}

OwnedRing::~OwnedRing() {
  // Tells a writer that still waits for entries that no sample is in use any more.
  ring_.header().generation.store(0, std::memory_order_release);  // H2
}

SharedSamples::Handle SharedSamples::create(const type::TypeInfo* info, std::shared_ptr<OwnedRing> ring,
                                            std::shared_ptr<const PeerMemory> writer) {
  return Handle(new SharedSamples(info, std::move(ring), std::move(writer)));
}

SharedSamples::SharedSamples(const type::TypeInfo* info, std::shared_ptr<OwnedRing> ring,
                             std::shared_ptr<const PeerMemory> writer)
    : SampleOwner(info),
      ring_(std::move(ring)),
      writer_(std::move(writer)),
      slots_(std::make_unique<SampleSlot[]>((*ring_)->entries().size())) {
  for (std::size_t i = 0; i < (*ring_)->entries().size(); ++i)
    slots_[i].owner = this;
}

std::size_t SharedSamples::count_held() const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < (*ring_)->entries().size(); ++i)
    count += held(i) ? 1 : 0;
  return count;
}

[[gnu::hot]] SampleRef SharedSamples::lend(std::size_t entry, const void* value, std::size_t flat_size,
                                           std::uint64_t sequence) noexcept {
  SampleSlot& slot = slots_[entry];
  // The const_cast is safe because readers never write, and the mapping is read-only.
  slot.value = const_cast<void*>(value);
  slot.flat_size = flat_size;
  slot.sequence = sequence;
  slot.references.store(1, std::memory_order_relaxed);
  holders_.fetch_add(1, std::memory_order_relaxed);  // the connection still holds one
  return SampleRef::adopt(&slot);
}

[[gnu::hot]] void SharedSamples::recycle(SampleSlot& slot) noexcept {
  (*ring_)->give_back(static_cast<std::size_t>(&slot - slots_.get()));
  let_go();
}

}  // namespace segue::sample_link
