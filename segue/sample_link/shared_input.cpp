// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_input.hpp>
#include <segue/task/executor.hpp>
#include <segue/task/port_access.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/type.hpp>

namespace segue::sample_link {

using task::InputPortAccess;
using task::SampleRef;
using task::SampleSlot;

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
      read_((*ring)->header().read),
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
    const Lock lock(mutex_);
    open_ = true;
  }
  // Without the mutex, since the port calls set_listener(). Registered afterwards, so that a concurrent
  // forget() of the writer either makes keep() fail or finds this endpoint.
  InputPortAccess::attach(port_, shared_from_this());
  auto kept = keep();
  if (!kept) disconnect();
  return kept;
}

Result<void> SharedInput::keep() {
  const Lock lock(mutex_);
  if (open_) return state_->keep(shared_from_this());
  return fail(ErrorCode::Cancelled, port_name_ + " was disconnected while it was being connected");
}

InputPlace SharedInput::place() const {
  InputPlace place;
  place.reader = state_->incarnation();
  place.offset = offset_;
  place.generation = generation_;
  place.port = port_name_;
  place.topic = port_.options().topic;
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
    read_.add_one();
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
  const std::uint64_t seal = found.seal.load(std::memory_order_relaxed);
  const TimePoint written_at(
      Duration(static_cast<std::int64_t>(found.written_at.load(std::memory_order_relaxed))));
  if (seal != (*ring_)->seal_of(entry, offset, size, sequence) || (!decodes_ && samples_->held(entry))) {
    corrupt_.fetch_add(1, std::memory_order_relaxed);
    return {};
  }
  if (sequence <= newest_read_) {
    // The last sample from before a connection with policy data may arrive after a newer one was read.
    if (policy_.kind != BufferKind::Data) return reject(entry);
    read_.add_one();
    (*ring_)->give_back(entry);
    return {};
  }
  const void* value = nullptr;
  if (form_ != SampleForm::Untyped) {
    value = find_value(offset, size);
    if (value == nullptr) return reject_payload(entry);
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
  if (!read_object({static_cast<const std::byte*>(bytes), size}, sequence, spare))
    return reject_payload(entry);
  (*ring_)->give_back(entry);
  return SampleRef::share(spare);
}

SampleRef SharedInput::reject(std::size_t entry) noexcept {
  corrupt_.fetch_add(1, std::memory_order_relaxed);
  (*ring_)->give_back(entry);
  return {};
}

SampleRef SharedInput::reject_payload(std::size_t entry) noexcept {
  invalid_.fetch_add(1, std::memory_order_relaxed);
  return reject(entry);
}

void SharedInput::set_listener(task::SampleListener* listener) {
  const Lock lock(mutex_);
  if (!ring_) return;
  std::atomic<std::uint64_t>& announced = (*ring_)->header().doorbell;
  if (listener == nullptr) {
    announced_ = 0;
    announced.store(0, std::memory_order_seq_cst);  // H4: before it waits for an answer
    // The port has stored its listener before, so only an answer that has begun may still notify it.
    if (doorbell_) doorbell_->wait_until_answered();
    return;
  }
  take_line(listener->runner());
  if (!doorbell_) return;
  const auto offset = state_->control()->offset_of(doorbell_->words().get());
  announced_ = DoorbellLine{*offset, line_}.word();
  announced.store(announced_, std::memory_order_seq_cst);  // H4: before words are looked for
}

/// Gets a line of the doorbell of `runner`, which may differ from the last one.
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
    const Lock lock(mutex_);
    if (!open_) return;
    InputPortAccess::detach(port_, *this);
    open_ = false;
    (*ring_)->header().closed.store(1, std::memory_order_seq_cst);    // H5: after the last pull()
    (*ring_)->header().doorbell.store(0, std::memory_order_seq_cst);  // H4
    give_line_back();
    final_ = shown_counters();
    samples_.reset();
  }
  state_->end(*this);
}

bool SharedInput::connected() const {
  const Lock lock(mutex_);
  return open_;
}

Counters SharedInput::counters() const {
  const Lock lock(mutex_);
  return open_ ? shown_counters() : final_;
}

Counters SharedInput::shown_counters() const noexcept {
  Counters counters = (*ring_)->counters();
  counters.read = read_.get();
  return counters;
}

std::uint64_t SharedInput::corrupt() const {
  const Lock lock(mutex_);
  return count_corrupt();
}

std::uint64_t SharedInput::count_corrupt() const noexcept {
  return corrupt_.load(std::memory_order_relaxed) + (ring_ ? (*ring_)->words().nonsense() : 0);
}

Damage SharedInput::damage(TimePoint now) {
  const Lock lock(mutex_);
  if (!open_) return Damage::None;
  wake_if_forgotten();
  const bool lasts = overwritten_.is(is_overwritten(), now);
  const std::uint64_t invalid = invalid_.load(std::memory_order_relaxed);
  if (lasts || !header_is_ours() || count_corrupt() > invalid) return Damage::Ring;
  return invalid > 0 ? Damage::Payload : Damage::None;
}

/// Requires that it is open.
bool SharedInput::header_is_ours() const noexcept {
  const RingHeader& header = (*ring_)->header();
  const auto is = [](const std::atomic<std::uint64_t>& word, std::uint64_t value) {
    return word.load(std::memory_order_acquire) == value;
  };
  return is(header.generation, generation_) && is(header.closed, 0) && is(header.size, policy_.size) &&
         is(header.kind, static_cast<std::uint64_t>(policy_.kind)) && is(header.init, policy_.init ? 1 : 0) &&
         is(header.doorbell, announced_);
}

/// Requires that it is open. It checks the words that this side has written, and counts entries: each entry
/// that this side has read it holds or has returned, or the writer has taken it back. Counted in this order,
/// an entry on its way is counted twice rather than missed.
bool SharedInput::is_overwritten() noexcept {
  SharedRing& ring = **ring_;
  const std::uint64_t read = read_.get();
  const std::uint64_t held = samples_ ? samples_->count_held() : 0;
  const std::uint64_t returned = ring.count_returned();
  const std::uint64_t taken_back = ring.header().taken_back.load(std::memory_order_relaxed);
  return read > held + returned + taken_back || read_.is_overwritten() || ring.words().has_hole();
}

/// Requires that it is open. Words of a doorbell may be overwritten as well.
void SharedInput::wake_if_forgotten() noexcept {
  const std::uint64_t read = read_.get();
  const bool waits = pending() && read == read_at_last_look_ && !(gate_ && !gate_->open());
  read_at_last_look_ = read;
  if (waits) InputPortAccess::notify(port_);
}

void SharedInput::abandon() {
  {
    const Lock lock(mutex_);
    released_ = true;
  }
  disconnect();
}

void SharedInput::end_at(task::CommitGatePtr gate) {
  const Lock lock(mutex_);
  if (!open_) return;
  InputPortAccess::end_at(port_, *this, gate);
  end_ = std::move(gate);
}

void SharedInput::settle() {
  const Lock lock(mutex_);
  if (!open_) return;
  InputPortAccess::settle(port_);
  if (gate_ && gate_->open()) gate_.reset();
}

bool SharedInput::carries() const {
  const Lock lock(mutex_);
  return !(gate_ && !gate_->open()) && !(end_ && end_->open());
}

bool SharedInput::dormant() const {
  const Lock lock(mutex_);
  return gate_ && !gate_->open();
}

bool SharedInput::owes_samples() const {
  const Lock lock(mutex_);
  const bool promised = policy_.kind != BufferKind::Data;
  return promised && open_ && end_ && end_->open() && (*ring_)->counters().waiting() > 0;
}

bool SharedInput::reclaim_rest() {
  const Lock lock(mutex_);
  if (open_ || !released_) return false;
  ring_.reset();
  return true;
}

void SharedInput::release(const InputPlace& place) {
  if (place.reader != state_->incarnation() || place.offset != offset_ || place.generation != generation_)
    return;
  const Lock lock(mutex_);
  released_ = true;
}

}  // namespace segue::sample_link
