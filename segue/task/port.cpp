// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/component.hpp>
#include <segue/task/port.hpp>
#include <segue/task/sample_pool.hpp>
#include <segue/task/wake_batch.hpp>
#include <segue/type/flat.hpp>

#include <algorithm>
#include <cassert>
#include <new>

namespace segue::task {

namespace {

std::string declared_name(const type::TypeInfo* type, std::string type_name) {
  return type == nullptr ? std::move(type_name) : std::string(type->name());
}

PortOptions checked(PortOptions options, const type::TypeInfo* type) {
  options.flat = options.flat && type != nullptr && !type->trivially_copyable && type::can_flatten(*type);
  return options;
}

/// A default object of a type, in a slot.
SampleRef make_object(const type::TypeInfo& type) {
  const auto pool = SamplePool::create(&type);
  pool->reserve(1);
  return SampleRef::adopt(pool->acquire());
}

type::Value value_of(const SampleSlot& slot) {
  if (slot.value == nullptr) return {};
  const type::TypeInfo& info = *slot.owner->info();
  if (slot.flat_size == 0) return info.to_value(slot.value);
  const SampleRef object = make_object(info);
  return type::read_flat(info, object->value, slot.flat()) ? info.to_value(object->value) : type::Value{};
}

std::uint64_t next_port_number() {
  static std::atomic<std::uint64_t> last{0};  // relaxed: numbers differ, and order nothing
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

/// For counters with one writing thread; readers may see an older value.
void increment(std::atomic<std::uint64_t>& counter) {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

/// Pulls from the connection `from`, but first from those that end with a commit; `from` becomes the one that
/// the sample came from. A writer that moves from one connection to another writes to the old one first:
/// where a sample waits in the new one, all that it wrote before waits in the old one.
SampleRef pull_in_order(const ConnectionList<ReaderEnd>::Section& ends, std::size_t& from) noexcept {
  if (ends.lifetime(from) != Lifetime::Always) return ends[from].pull();
  if (!ends[from].pending()) return {};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends.lifetime(i) == Lifetime::Always) continue;
    if (SampleRef sample = ends[i].pull()) {
      from = i;
      return sample;
    }
  }
  return ends[from].pull();
}

}  // namespace

PortBase::PortBase(Component& component, Direction direction, std::string name, const type::TypeInfo* type,
                   std::string type_name, PortOptions options)
    : component_(component),
      name_(std::move(name)),
      type_name_(declared_name(type, std::move(type_name))),
      options_(checked(std::move(options), type)),
      type_(type),
      number_(next_port_number()),
      direction_(direction) {
  if (type != nullptr) type::register_type_info(*type);
}

PortBase::~PortBase() = default;

std::string PortBase::full_name() const {
  const TaskContext* context = component_.context();
  return context == nullptr ? name_ : context->id() + "." + name_;
}

OutputPortBase::OutputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                               std::string type_name, PortOptions options)
    : PortBase(component, Direction::Output, std::move(name), type, std::move(type_name), std::move(options)),
      pool_(SamplePool::create(type, is_flat() ? SamplePool::Holds::Flat : SamplePool::Holds::Objects)) {
  pool_->reserve(kWriterSlots);
  const Lock lock(component_.ports_mutex_);
  component_.outputs_.push_back(this);
}

OutputPortBase::~OutputPortBase() {
  {
    // First: waits for HeldPorts, and makes sure that nobody finds this port any more.
    const Lock lock(component_.ports_mutex_);
    std::erase(component_.outputs_, this);
  }
  disconnect_all();
  if (SampleSlot* last = last_.exchange(nullptr)) last->release();
  if (default_value_ == nullptr) return;
  type()->destroy(default_value_);
  ::operator delete(default_value_, std::align_val_t(type()->alignment));
}

void OutputPortBase::disconnect_all() {
  for (const auto& end : ends_.snapshot())
    end->disconnect();
}

[[gnu::hot]] SampleSlot* OutputPortBase::acquire() noexcept {
  assert(!is_flat());
  SampleSlot* slot = pool_->acquire();
  if (slot == nullptr) increment(exhausted_);
  return slot;
}

SampleSlot* OutputPortBase::acquire_flat(std::size_t size) {
  return pool_->acquire_flat(size);
}

void OutputPortBase::prime_slots(const void* example) {
  pool_->prime(example);
}

[[gnu::hot]] WriteResult OutputPortBase::publish(SampleSlot* slot) noexcept {
  increment(written_);
  slot->sequence = written_.load(std::memory_order_relaxed);
  slot->written_at = stamps_.next(monotonic_now);
  bool refused = false;
  std::size_t count = 0;
  {
    const ConnectionList<WriterEnd>::Section ends(ends_);
    {
      const detail::WakeBatch wakes;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        if (!ends.carries(i)) continue;
        refused |= !ends[i].push(*slot);
        ++count;
      }
    }
    // Within the section, so that attach() waits for it: show_last() then finds the sample if the new
    // connection did not get it.
    // K1: both ends, since it puts one slot in and takes another out.
    SampleSlot* replaced = options().keep_last ? last_.exchange(slot, std::memory_order_acq_rel) : slot;
    if (replaced != nullptr) replaced->release();
  }
  if (count == 0) return WriteResult::NotConnected;
  return refused ? WriteResult::Refused : WriteResult::Written;
}

WriteResult OutputPortBase::write_flat(const void* object) {
  const std::size_t size = type::flat_size(*type(), object);
  if (size == 0) return WriteResult::Refused;
  SampleSlot* slot = acquire_flat(size);
  type::write_flat(*type(), object, {static_cast<std::byte*>(slot->value), size});
  return publish(slot);
}

WriteResult OutputPortBase::write_object(const void* object) {
  if (is_flat()) return write_flat(object);
  SampleSlot* slot = acquire();
  if (slot == nullptr) return WriteResult::NoSlot;
  if (slot->value != nullptr) type()->copy(slot->value, object);
  return publish(slot);
}

WriteResult OutputPortBase::write_default() {
  if (type() != nullptr && default_value_ == nullptr) {
    default_value_ = ::operator new(type()->size, std::align_val_t(type()->alignment));
    type()->construct(default_value_);
  }
  return write_object(default_value_);
}

Result<WriteResult> OutputPortBase::write_value(const type::Value& value) {
  if (is_flat()) {
    const SampleRef object = make_object(*type());
    auto read = type()->from_value(object->value, value, name());
    if (!read) return std::move(read.error());
    return write_flat(object->value);
  }
  SampleSlot* slot = acquire();
  if (slot == nullptr) return WriteResult::NoSlot;
  if (slot->value != nullptr) {
    auto read = type()->from_value(slot->value, value, name());
    if (!read) {
      slot->release();
      return std::move(read.error());
    }
  }
  return publish(slot);
}

std::size_t OutputPortBase::connection_count() const {
  return ends_.snapshot().size();
}

bool OutputPortBase::dormant() noexcept {
  const ConnectionList<WriterEnd>::Section ends(ends_);
  bool waits = false;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends.carries(i)) return false;
    waits |= ends.lifetime(i) == Lifetime::FromCommit;
  }
  return waits;
}

InputPortBase::InputPortBase(Component& component, std::string name, const type::TypeInfo* type,
                             std::string type_name, PortOptions options)
    : PortBase(component, Direction::Input, std::move(name), type, std::move(type_name), std::move(options)) {
  const Lock lock(component_.ports_mutex_);
  component_.inputs_.push_back(this);
}

InputPortBase::~InputPortBase() {
  {
    // First, as for outputs.
    const Lock lock(component_.ports_mutex_);
    std::erase(component_.inputs_, this);
  }
  disconnect_all();
}

void InputPortBase::disconnect_all() {
  for (const auto& end : ends_.snapshot())
    end->disconnect();
}

std::size_t InputPortBase::connection_count() const {
  return ends_.snapshot().size();
}

[[gnu::hot]] SampleRef InputPortBase::pull() noexcept {
  const ConnectionList<ReaderEnd>::Section ends(ends_);
  const std::size_t count = ends.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (turn_ >= count) turn_ = 0;
    std::size_t from = turn_++;
    SampleRef sample = ends.steady() ? ends[from].pull() : pull_in_order(ends, from);
    if (!sample) continue;
    last_connection_ = ends[from].number();
    increment(read_);
    return sample;
  }
  return {};
}

[[gnu::hot]] ReadStatus InputPortBase::fetch() noexcept {
  if (SampleRef sample = pull()) {
    last_ = std::move(sample);
    return ReadStatus::NewData;
  }
  if (!last_) return ReadStatus::NoData;
  // A sample is dropped with the connection that delivered it.
  const ConnectionList<ReaderEnd>::Section ends(ends_);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i].number() == last_connection_) return ReadStatus::OldData;
  }
  last_ = {};
  return ReadStatus::NoData;
}

ReadStatus InputPortBase::read_value(type::Value& value) {
  const ReadStatus status = fetch();
  if (status == ReadStatus::NoData) return status;
  value = value_of(*last_.get());
  return status;
}

std::size_t InputPortBase::drain() noexcept {
  std::size_t dropped = 0;
  while (pull())
    ++dropped;
  return dropped;
}

[[gnu::hot]] bool InputPortBase::pending() noexcept {
  const ConnectionList<ReaderEnd>::Section ends(ends_);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i].pending()) return true;
  }
  return false;
}

}  // namespace segue::task
