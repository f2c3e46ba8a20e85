// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/block_pool.hpp>

#include <algorithm>
#include <bit>

namespace segue::sample_link {

Result<std::unique_ptr<BlockPool>> BlockPool::create(std::size_t size, std::size_t ready) {
  if (size / kUnit > kMostUnits) {
    return fail(ErrorCode::InvalidArgument,
                "a pool of " + std::to_string(size) + " bytes is too large; it can have up to 128 GiB");
  }
  auto links = Mapping::anonymous(std::max(size / kUnit * sizeof(Link), sizeof(Link)));
  if (!links) return std::move(links.error());
  links->populate(ready / kUnit * sizeof(Link));
  return std::unique_ptr<BlockPool>(new BlockPool(size, std::move(*links)));
}

BlockPool::BlockPool(std::size_t size, Mapping links)
    : size_(size), memory_(std::move(links)), links_(reinterpret_cast<Link*>(memory_.data())) {}

unsigned BlockPool::class_for(std::size_t size) noexcept {
  return static_cast<unsigned>(std::bit_width((std::max(size, std::size_t{1}) - 1) / kUnit));
}

std::uint64_t BlockPool::allocate(std::size_t size) noexcept {
  if (size > size_) return kNone;
  const unsigned block_class = class_for(size);
  const std::uint64_t unit = take(block_class);
  if (unit == kNone) return kNone;
  // Relaxed: the block is this thread's alone. A pop() with an outdated head may read it, and then fails.
  links_[unit].store(block_class << kClassShift | 1, std::memory_order_relaxed);
  used_.fetch_add(bytes_of(block_class), std::memory_order_relaxed);
  return unit * kUnit;
}

void BlockPool::retain(std::uint64_t offset) noexcept {
  links_[offset / kUnit].fetch_add(1, std::memory_order_relaxed);
}

void BlockPool::release(std::uint64_t offset) noexcept {
  const std::uint64_t unit = offset / kUnit;
  const std::uint32_t before = links_[unit].fetch_sub(1, std::memory_order_acq_rel);  // B2
  if ((before & kReferences) != 1) return;
  const unsigned block_class = before >> kClassShift;
  used_.fetch_sub(bytes_of(block_class), std::memory_order_relaxed);
  push(block_class, unit);
}

std::uint64_t BlockPool::take(unsigned block_class) noexcept {
  unsigned found = block_class;
  std::uint64_t unit = pop(found);
  while (unit == kNone && found < kSlabClass)
    unit = pop(++found);
  if (unit == kNone) unit = cut_off(found);
  if (unit == kNone) return kNone;
  // Splits a block that is too large; the upper parts become free.
  while (found > block_class) {
    --found;
    push(found, unit + bytes_of(found) / kUnit);
  }
  return unit;
}

std::uint64_t BlockPool::pop(unsigned block_class) noexcept {
  std::atomic<std::uint64_t>& head = free_[block_class].head;
  std::uint64_t seen = head.load(std::memory_order_acquire);  // pairs with B1
  while (true) {
    const auto first = static_cast<std::uint32_t>(seen);
    if (first == 0) return kNone;
    // If another thread takes the block meanwhile, this is garbage; then the counter differs and the exchange
    // fails.
    const std::uint64_t next = links_[first - 1].load(std::memory_order_relaxed);
    const std::uint64_t count = (seen >> 32U) + 1;
    // Pairs with B1, also where it fails, since `seen` is looked at again.
    if (head.compare_exchange_weak(seen, count << 32U | next, std::memory_order_acq_rel,
                                   std::memory_order_acquire)) {
      return first - 1;
    }
  }
}

void BlockPool::push(unsigned block_class, std::uint64_t unit) noexcept {
  std::atomic<std::uint64_t>& head = free_[block_class].head;
  std::uint64_t seen = head.load(std::memory_order_relaxed);
  std::uint64_t wanted = 0;
  do {  // B1: the exchange releases the link
    links_[unit].store(static_cast<std::uint32_t>(seen), std::memory_order_relaxed);
    wanted = ((seen >> 32U) + 1) << 32U | (unit + 1);
  } while (!head.compare_exchange_weak(seen, wanted, std::memory_order_acq_rel, std::memory_order_relaxed));
}

/// A block from the part that was never divided; at least a slab. Relaxed, since there is no earlier holder.
std::uint64_t BlockPool::cut_off(unsigned block_class) noexcept {
  const std::uint64_t wanted = bytes_of(block_class);
  std::uint64_t begin = cut_.load(std::memory_order_relaxed);
  do {
    if (wanted > size_ || begin > size_ - wanted) return kNone;
  } while (!cut_.compare_exchange_weak(begin, begin + wanted, std::memory_order_relaxed));
  return begin / kUnit;
}

}  // namespace segue::sample_link
