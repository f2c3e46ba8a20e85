// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/shared_pools.hpp>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>

namespace segue::sample_link {

namespace {

constexpr std::uint64_t kMagic = 0x6c6f6f7065756773;  // "sgueploo"
constexpr std::uint64_t kLayout = 3;

struct Pool {
  SealedFile file;
  std::unique_ptr<BlockPool> blocks;
};

/// Several threads may do so at once: all write the same. Other processes read it meanwhile. Relaxed: they
/// have learnt of the pool by a message that was sent after the first writing.
void write_header(const Mapping& pool, Incarnation owner) {
  auto* header = reinterpret_cast<PoolHeader*>(pool.data());
  std::atomic_ref(header->magic).store(kMagic, std::memory_order_relaxed);
  std::atomic_ref(header->layout).store(kLayout, std::memory_order_relaxed);
  std::atomic_ref(header->incarnation).store(owner, std::memory_order_relaxed);
}

Result<Pool> make_pool(const char* name, Incarnation owner, std::size_t size, std::size_t ready,
                       Writers writers) {
  auto file = make_sealed_file(name, size, writers);
  if (!file) return std::move(file.error());
  auto blocks = BlockPool::create(file->mapping.size(), ready);
  if (!blocks) return std::move(blocks.error());
  file->mapping.populate(ready);
  if ((*blocks)->allocate(sizeof(PoolHeader)) != 0)
    return fail(ErrorCode::InvalidArgument,
                "a pool needs at least 64 KiB, not " + std::to_string(size) + " bytes");
  write_header(file->mapping, owner);
  return Pool{std::move(*file), std::move(*blocks)};
}

std::optional<std::uint64_t> offset_in(const Mapping& mapping, const void* address) {
  const auto begin = reinterpret_cast<std::uintptr_t>(mapping.data());
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  if (at < begin || at >= begin + mapping.size()) return std::nullopt;
  return at - begin;
}

bool is_inside(const Mapping& mapping, std::uint64_t offset, std::uint64_t size, std::size_t alignment) {
  return size <= mapping.size() && offset <= mapping.size() - size && offset % alignment == 0;
}

Result<Mapping> map_pool(const Descriptor& file, Incarnation owner, Writers writers) {
  auto size = check_sealed_file(file.get(), writers);
  if (!size) return std::move(size.error());
  auto mapping =
      Mapping::of_file(file.get(), *size,
                       writers == Writers::CreatorOnly ? Mapping::Access::Read : Mapping::Access::ReadWrite);
  if (!mapping) return mapping;
  PoolHeader header;
  std::memcpy(&header, mapping->data(), sizeof(header));
  if (header.magic != kMagic || header.layout != kLayout || header.incarnation != owner) {
    return fail(ErrorCode::InvalidArgument,
                "the other process offers memory that is not its pool, or of another version of Segue; use "
                "one version for all deployments of a robot");
  }
  return mapping;
}

}  // namespace

Result<std::shared_ptr<PayloadPool>> PayloadPool::create(Incarnation owner, std::size_t size,
                                                         std::size_t prefault) {
  auto pool = make_pool("segue-payload", owner, size, prefault, Writers::CreatorOnly);
  if (!pool) return std::move(pool.error());
  return std::make_shared<PayloadPool>(std::move(pool->file), std::move(pool->blocks));
}

void* PayloadPool::allocate(std::size_t size, std::size_t alignment) noexcept {
  const std::uint64_t offset = blocks_->allocate(std::max(size, alignment));
  return offset == BlockPool::kNone ? nullptr : at(offset);
}

void PayloadPool::deallocate(void* memory) noexcept {
  if (const auto offset = offset_of(memory)) blocks_->release(*offset);
}

std::optional<std::uint64_t> PayloadPool::offset_of(const void* value) const noexcept {
  return offset_in(file_.mapping, value);
}

void PayloadPool::restore_header(Incarnation owner) noexcept {
  write_header(file_.mapping, owner);
}

void ControlPool::restore_header(Incarnation owner) noexcept {
  write_header(file_.mapping, owner);
}

Result<std::shared_ptr<ControlPool>> ControlPool::create(Incarnation owner, std::size_t size) {
  constexpr std::size_t kReady = std::size_t{1} << 16;
  auto pool = make_pool("segue-control", owner, size, std::min(kReady, size), Writers::Everybody);
  if (!pool) return std::move(pool.error());
  return std::make_shared<ControlPool>(std::move(pool->file), std::move(pool->blocks));
}

std::shared_ptr<std::byte> ControlPool::allocate(std::size_t size) {
  const std::uint64_t offset = blocks_->allocate(size);
  if (offset == BlockPool::kNone) return nullptr;
  std::byte* memory = file_.mapping.data() + offset;
  std::memset(memory, 0, size);
  return {memory, [self = shared_from_this(), offset](std::byte*) { self->blocks_->release(offset); }};
}

std::shared_ptr<task::Doorbell> ControlPool::make_doorbell() {
  std::shared_ptr<std::byte> memory = allocate(sizeof(task::DoorbellWords));
  if (!memory) return nullptr;
  auto* words = new (memory.get()) task::DoorbellWords;
  return std::make_shared<task::Doorbell>(std::shared_ptr<task::DoorbellWords>(std::move(memory), words));
}

std::optional<std::uint64_t> ControlPool::offset_of(const void* address) const noexcept {
  return offset_in(file_.mapping, address);
}

Result<std::shared_ptr<const PeerMemory>> PeerMemory::map(const MemoryOffer& offer) {
  if (offer.incarnation == 0) return fail(ErrorCode::InvalidArgument, "the other process offers no memory");
  auto payload = map_pool(offer.payload, offer.incarnation, Writers::CreatorOnly);
  if (!payload) return std::move(payload.error());
  auto control = map_pool(offer.control, offer.incarnation, Writers::Everybody);
  if (!control) return std::move(control.error());
  return std::make_shared<const PeerMemory>(offer.incarnation, std::move(*payload), std::move(*control));
}

[[gnu::hot]] const std::byte* PeerMemory::payload(std::uint64_t offset, std::uint64_t size,
                                                  std::size_t alignment) const noexcept {
  return is_inside(payload_, offset, size, alignment) ? payload_.data() + offset : nullptr;
}

[[gnu::hot]] std::byte* PeerMemory::control(std::uint64_t offset, std::uint64_t size) const noexcept {
  return is_inside(control_, offset, size, BlockPool::kUnit) ? control_.data() + offset : nullptr;
}

}  // namespace segue::sample_link
