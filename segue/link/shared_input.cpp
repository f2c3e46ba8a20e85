// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/link/local.hpp>
#include <segue/link/shared_input.hpp>
#include <segue/task/executor.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/type.hpp>

namespace segue::link {

using task::SampleRef;
using task::SampleSlot;

namespace {

/// A writer counts a sample shortly before it pushes it; one that takes longer has lost it.
constexpr Duration kLongestPush = std::chrono::seconds(2);

}  // namespace

SharedInput::SharedInput(std::shared_ptr<SharedState> state, std::shared_ptr<const PeerMemory> writer,
                         std::shared_ptr<OwnedRing> ring, task::InputPortBase& port, const Policy& policy,
                         bool untyped, task::CommitGatePtr gate)
    : state_(std::move(state)),
      writer_(std::move(writer)),
      port_(port),
      info_(untyped ? nullptr : port.type()),
      form_(form_of(info_)),
      decodes_(form_ == SampleForm::Flat && !port.is_flat()),
      checked_(form_ == SampleForm::Raw && type::has_invalid_bytes(*info_)),
      policy_(policy),
      offset_(*state_->control()->offset_of(&(*ring)->header())),
      generation_((*ring)->generation()),
      port_name_(port.full_name()),
      ring_(std::move(ring)),
      gate_(std::move(gate)) {
  if (decodes_) {
    decoded_ = task::SamplePool::create(info_);
    decoded_->reserve(policy.size + SharedRing::kExtra);
  } else {
    samples_ = SharedSamples::create(info_, ring_, writer_);
  }
}

Result<void> SharedInput::open() {
  {
    const std::lock_guard lock(mutex_);
    open_ = true;
  }
  // Without the mutex, since the port calls set_listener(). Registered afterwards, so that a concurrent
  // forget() of the writer either makes keep() fail or finds this endpoint.
  port_.attach(shared_from_this());
  auto kept = keep();
  if (!kept) disconnect();
  return kept;
}

Result<void> SharedInput::keep() {
  const std::lock_guard lock(mutex_);
  if (open_) return state_->keep(shared_from_this());
  return fail(ErrorCode::Cancelled, port_name_ + " was disconnected while it was being connected");
}

InputPlace SharedInput::place() const {
  InputPlace place;
  place.reader = state_->incarnation();
  place.offset = offset_;
  place.generation = generation_;
  place.port = port_name_;
  const type::TypeInfo* wanted = port_.type();
  place.any_type = wanted == nullptr;
  if (wanted == nullptr) return place;
  place.type = wanted->name();
  place.hash = wanted->hash;
  place.definition = type::definition(*wanted->type);
  return place;
}

[[gnu::hot]] SampleRef SharedInput::pull() noexcept {
  SharedRing& ring = **ring_;
  SampleRef spare;
  if (decodes_) {
    if (!ring.words().pending()) return {};
    spare = SampleRef::adopt(decoded_->acquire());
    if (!spare) return {};  // the component holds all slots, so samples keep waiting
  }
  // Each invalid word costs one round; there are no more of them than places.
  for (std::size_t i = 0; i <= ring.words().places(); ++i) {
    const std::uint64_t token = ring.words().pull();
    if (token == 0) return {};
    const std::size_t entry = ring.entry_of(token);
    if (entry == ring.entries().size()) {
      corrupt_.fetch_add(1, std::memory_order_relaxed);
      continue;
    }
    SampleRef sample = accept(entry, spare.get());
    if (!sample) continue;
    if (sample.get() == spare.get()) spare.detach()->release();
    count_one(ring.header().read);
    return sample;
  }
  return {};
}

/// The entry lies in memory that the writer can change at any time: every field is read once and checked
/// before use.
[[gnu::hot]] SampleRef SharedInput::accept(std::size_t entry, SampleSlot* spare) noexcept {
  const RingEntry& found = (*ring_)->entries()[entry];
  const std::uint64_t offset = found.offset.load(std::memory_order_relaxed);
  const std::uint64_t size = found.size.load(std::memory_order_relaxed);
  const std::uint64_t sequence = found.sequence.load(std::memory_order_relaxed);
  const std::uint64_t generation = found.generation.load(std::memory_order_relaxed);
  const TimePoint written_at(
      Duration(static_cast<std::int64_t>(found.written_at.load(std::memory_order_relaxed))));
  if (generation != generation_ || (!decodes_ && samples_->held(entry))) {
    corrupt_.fetch_add(1, std::memory_order_relaxed);
    return {};
  }
  // The last sample from before the connection may arrive after a newer one was read.
  if (policy_.kind == BufferKind::Data && sequence <= newest_read_) {
    count_one((*ring_)->header().read);
    (*ring_)->give_back(entry);
    return {};
  }
  const void* value = nullptr;
  if (form_ != SampleForm::Untyped) {
    value = find_value(offset, size);
    if (value == nullptr) {
      reject(entry);
      return {};
    }
  }
  const std::size_t flat_size = form_ == SampleForm::Flat ? size : 0;
  SampleRef sample = decodes_ ? decode(entry, value, size, sequence, *spare)
                              : samples_->lend(entry, value, flat_size, sequence);
  if (sample) {
    newest_read_ = sequence;
    latency_.add(written_at);
  }
  return sample;
}

/// nullptr where the bytes are outside the writer's memory, or those of no sample of the type; decode() finds
/// the latter by itself.
[[gnu::hot]] const void* SharedInput::find_value(std::uint64_t offset, std::uint64_t size) const noexcept {
  if (form_ == SampleForm::Flat) {
    const std::byte* bytes = writer_->payload(offset, size, BlockPool::kUnit);
    const bool valid = bytes != nullptr && (decodes_ || type::is_flat(*info_, {bytes, size}));
    return valid ? bytes : nullptr;
  }
  if (size != info_->size) return nullptr;
  const void* value = writer_->payload(offset, size, info_->alignment);
  const bool valid = value != nullptr && (!checked_ || type::are_valid_bytes(*info_, value));
  return valid ? value : nullptr;
}

SampleRef SharedInput::decode(std::size_t entry, const void* bytes, std::size_t size, std::uint64_t sequence,
                              SampleSlot& spare) noexcept {
  if (!read_object({static_cast<const std::byte*>(bytes), size}, sequence, spare)) {
    reject(entry);
    return {};
  }
  (*ring_)->give_back(entry);
  return SampleRef::share(spare);
}

void SharedInput::reject(std::size_t entry) noexcept {
  corrupt_.fetch_add(1, std::memory_order_relaxed);
  (*ring_)->give_back(entry);
}

void SharedInput::set_listener(task::SampleListener* listener) {
  const std::lock_guard lock(mutex_);
  if (!ring_) return;
  std::atomic<std::uint64_t>& announced = (*ring_)->header().doorbell;
  if (listener == nullptr) {
    announced.store(0, std::memory_order_seq_cst);
    // The port has stored its listener before, so only an answer that has begun may still notify it.
    if (doorbell_) doorbell_->wait_until_answered();
    return;
  }
  take_line(listener->runner());
  if (!doorbell_) return;
  const auto offset = state_->control()->offset_of(doorbell_->words().get());
  announced.store(DoorbellLine{*offset, line_}.word(), std::memory_order_seq_cst);
}

/// Gets a line of the doorbell of `runner`, which may differ from the last one. Requires mutex_.
void SharedInput::take_line(task::Executor& runner) {
  auto doorbell = runner.doorbell([this] { return state_->control()->make_doorbell(); });
  if (doorbell && *doorbell == doorbell_) return;
  give_line_back();
  const bool is_ours = doorbell && state_->control()->offset_of((*doorbell)->words().get()).has_value();
  const auto line = is_ours ? (*doorbell)->add(port_) : std::nullopt;
  if (!line) {
    log(LogLevel::Error, port_name_,
        doorbell ? "cannot be woken by another process: its thread serves too many connections already"
                 : "cannot be woken by another process: " + to_string(doorbell.error()));
    return;
  }
  doorbell_ = std::move(*doorbell);
  line_ = *line;
}

void SharedInput::give_line_back() {
  if (doorbell_) doorbell_->remove(line_);
  doorbell_.reset();
}

void SharedInput::disconnect() {
  {
    const std::lock_guard lock(mutex_);
    if (!open_) return;
    port_.detach(*this);
    open_ = false;
    (*ring_)->header().closed.store(1, std::memory_order_seq_cst);
    (*ring_)->header().doorbell.store(0, std::memory_order_seq_cst);
    give_line_back();
    final_ = (*ring_)->counters();
    samples_.reset();
  }
  state_->end(*this);
}

bool SharedInput::connected() const {
  const std::lock_guard lock(mutex_);
  return open_;
}

Counters SharedInput::counters() const {
  const std::lock_guard lock(mutex_);
  return open_ ? (*ring_)->counters() : final_;
}

bool SharedInput::damaged() {
  const std::lock_guard lock(mutex_);
  return open_ && (corrupt() > 0 || !header_is_ours() || stalls());
}

/// Requires mutex_ and that it is open.
bool SharedInput::header_is_ours() const noexcept {
  const RingHeader& header = (*ring_)->header();
  const auto is = [](const std::atomic<std::uint64_t>& word, std::uint64_t value) {
    return word.load(std::memory_order_acquire) == value;
  };
  return is(header.generation, generation_) && is(header.closed, 0) && is(header.size, policy_.size) &&
         is(header.kind, static_cast<std::uint64_t>(policy_.kind)) && is(header.init, policy_.init ? 1 : 0);
}

/// Requires mutex_ and that it is open.
bool SharedInput::stalls() {
  const Counters now = (*ring_)->counters();
  const bool waits = now.written > now.read + now.dropped + now.overwritten;
  const TimePoint time = RealClock::instance().now();
  if (!waits || pending()) {
    stalled_.reset();
  } else if (!stalled_ || *stalled_ != now) {
    stalled_ = now;
    stalled_since_ = time;
  }
  return stalled_ && time - stalled_since_ > kLongestPush;
}

void SharedInput::abandon() {
  {
    const std::lock_guard lock(mutex_);
    released_ = true;
  }
  disconnect();
}

void SharedInput::end_at(task::CommitGatePtr gate) {
  const std::lock_guard lock(mutex_);
  if (!open_) return;
  port_.end_at(*this, gate);
  end_ = std::move(gate);
}

void SharedInput::settle() {
  const std::lock_guard lock(mutex_);
  if (!open_) return;
  port_.settle();
  if (gate_ && gate_->open()) gate_.reset();
}

bool SharedInput::carries() const {
  const std::lock_guard lock(mutex_);
  return !(gate_ && !gate_->open()) && !(end_ && end_->open());
}

bool SharedInput::dormant() const {
  const std::lock_guard lock(mutex_);
  return gate_ && !gate_->open();
}

bool SharedInput::owes_samples() const {
  const std::lock_guard lock(mutex_);
  const bool promised = policy_.kind != BufferKind::Data;
  return promised && open_ && end_ && end_->open() && (*ring_)->counters().waiting() > 0;
}

bool SharedInput::reclaim_rest() {
  const std::lock_guard lock(mutex_);
  if (open_ || !released_) return false;
  ring_.reset();
  return true;
}

void SharedInput::release(const InputPlace& place) {
  if (place.reader != state_->incarnation() || place.offset != offset_ || place.generation != generation_)
    return;
  const std::lock_guard lock(mutex_);
  released_ = true;
}

}  // namespace segue::link
