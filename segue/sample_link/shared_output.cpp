// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/shared_output.hpp>
#include <segue/task/port_access.hpp>

#include <algorithm>
#include <bit>

namespace segue::sample_link {

using task::OutputPortAccess;

namespace {
/// For counts with a single writing thread.
void add_one(std::atomic<std::uint64_t>& count) noexcept {
  count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

/// How many words of returned bits a push checks unless it is short of entries.
constexpr std::size_t kWordsPerPush = 4;
}  // namespace

SharedOutput::SharedOutput(std::shared_ptr<SharedState> state, std::shared_ptr<const PeerMemory> reader,
                           std::byte* ring, const InputPlace& place, task::OutputPortBase& port,
                           const Policy& policy, task::CommitGatePtr gate)
    : state_(std::move(state)),
      reader_(std::move(reader)),
      port_(port),
      port_number_(port.number()),
      policy_(policy),
      reader_port_(place.port),
      untyped_(place.any_type),
      source_(state_->source_of(port)),
      ring_(ring, policy, place.generation),
      in_flight_before_(state_->in_flight(port)),
      lent_(std::make_unique<LentEntry[]>(ring_.entries().size())),
      placed_(ring_.words().places()),
      written_(ring_.header().written),
      initial_(ring_.header().initial),
      dropped_(ring_.header().dropped),
      overwritten_(ring_.header().overwritten),
      taken_back_(ring_.header().taken_back),
      gate_(std::move(gate)) {
  // The last entry is reserved for offer_last().
  const std::size_t count = ring_.entries().size() - (policy.init ? 1 : 0);
  free_.reserve(ring_.entries().size());
  for (auto entry = static_cast<std::uint32_t>(count); entry-- > 0;)
    free_.push_back(entry);
}

Result<void> SharedOutput::attach() {
  auto attached = attach_to_port();
  if (!attached) state_->end(*this);
  return attached;
}

Result<void> SharedOutput::attach_to_port() {
  const Lock lock(mutex_);
  if (auto kept = state_->keep(shared_from_this()); !kept) return kept;
  if (auto attached = OutputPortAccess::attach(port_, shared_from_this(), reader_port_, gate_); !attached)
    return attached;
  attached_ = true;
  if (!gate_) show_last();
  return {};
}

/// Requires that it is attached.
void SharedOutput::show_last() {
  if (policy_.init) OutputPortAccess::show_last(port_, [this](task::SampleSlot& last) { offer_last(last); });
}

void SharedOutput::end_at(task::CommitGatePtr gate) {
  const Lock lock(mutex_);
  if (!attached_) return;
  OutputPortAccess::end_at(port_, *this, gate);
  end_ = std::move(gate);
}

void SharedOutput::settle() {
  const Lock lock(mutex_);
  if (!attached_) return;
  OutputPortAccess::settle(port_);
  if (!gate_ || !gate_->open()) return;
  gate_.reset();
  OutputPortAccess::begun(port_);  // first: what it writes is newer than the last sample
  show_last();
}

bool SharedOutput::carries() const {
  const Lock lock(mutex_);
  return !(gate_ && !gate_->open()) && !(end_ && end_->open());
}

bool SharedOutput::dormant() const {
  const Lock lock(mutex_);
  return gate_ && !gate_->open();
}

std::size_t SharedOutput::capacity() const {
  const bool holds_slots = writes_in_place(port_) && !untyped_;
  return holds_slots ? ring_.entries().size() + in_flight_before_ : 0;
}

std::size_t SharedOutput::in_flight(const task::OutputPortBase& port) const {
  const Lock lock(mutex_);
  return attached_ || port.number() != port_number_ ? 0 : count_lent();
}

bool SharedOutput::same_as(const WriterEnd& other) const {
  const auto* shared = dynamic_cast<const SharedOutput*>(&other);
  return shared != nullptr && shared->peer() == peer() && shared->reader_port_ == reader_port_ &&
         shared->policy_ == policy_;
}

bool SharedOutput::anybody_there() const noexcept {
  return ring_.current() && ring_.header().closed.load(std::memory_order_acquire) == 0;  // pairs with H2, H5
}

[[gnu::hot]] bool SharedOutput::push(task::SampleSlot& sample) noexcept {
  if (!anybody_there()) return true;
  collect(kWordsPerPush);
  written_.add_one();
  const bool taken = deliver(sample) == Delivery::Taken;
  if (!taken) dropped_.add_one();
  // Also where it was refused, so that a reader that has not emptied its buffer gets another turn.
  ring_reader();
  return taken;
}

[[gnu::hot]] SharedOutput::Delivery SharedOutput::deliver(task::SampleSlot& sample) noexcept {
  if (ring_.words().full()) return Delivery::Refused;
  if (free_.empty()) collect(ring_.returned().size());
  if (free_.empty()) return Delivery::Refused;
  const auto payload = untyped_ ? Payload{} : source_->take(sample);
  if (!payload) return Delivery::Refused;
  const std::size_t entry = free_.back();
  free_.pop_back();
  lend(entry, *payload, sample.sequence, sample.written_at);
  const std::uint64_t token = ring_.token_of(entry);
  std::uint64_t before = 0;
  const auto pushed = ring_.words().push(token, before);
  if (pushed == WordRing::Push::Refused) {
    reclaim_token(token);
    return Delivery::Refused;
  }
  if (pushed == WordRing::Push::Replaced) {
    (policy_.kind == BufferKind::Data ? overwritten_ : dropped_).add_one();
    add_one(replaced_);
    note_replaced(before, token);
  }
  placed_[ring_.words().last_place()] = token;
  add_one(pushed_);
  return Delivery::Taken;
}

/// Takes back the entry that a push has replaced. It must be the one that was pushed there or, with
/// Policy::init, the one that offer_last() put there. Any other entry may be in use, so it counts as corrupt.
[[gnu::hot]] void SharedOutput::note_replaced(std::uint64_t token, std::uint64_t by) noexcept {
  const bool is_last = policy_.init && token == ring_.token_of(ring_.entries().size() - 1);
  if (token != by && (is_last || token == placed_[ring_.words().last_place()])) {
    reclaim_token(token);
  } else {
    corrupt_.fetch_add(1, std::memory_order_relaxed);
  }
}

[[gnu::hot]] void SharedOutput::lend(std::size_t entry, const Payload& payload, std::uint64_t sequence,
                                     TimePoint written_at) noexcept {
  RingEntry& shared = ring_.entries()[entry];
  shared.offset.store(payload.offset, std::memory_order_relaxed);
  shared.size.store(payload.size, std::memory_order_relaxed);
  shared.sequence.store(sequence, std::memory_order_relaxed);
  shared.seal.store(ring_.seal_of(entry, payload.offset, payload.size, sequence), std::memory_order_relaxed);
  shared.written_at.store(static_cast<std::uint64_t>(written_at.time_since_epoch().count()),
                          std::memory_order_relaxed);
  lent_[entry].payload = payload;
  lent_[entry].out.store(true, std::memory_order_release);  // U1
}

/// False: the entry is not lent, so the reader's claim is invalid.
[[gnu::hot]] bool SharedOutput::reclaim(std::size_t entry) noexcept {
  LentEntry& lent = lent_[entry];
  if (!lent.out.load(std::memory_order_acquire)) return false;  // pairs with U1
  const Payload payload = lent.payload;
  if (!lent.out.exchange(false, std::memory_order_acq_rel)) return false;  // pairs with U1
  source_->give_back(payload);
  return true;
}

[[gnu::hot]] void SharedOutput::reclaim_token(std::uint64_t token) noexcept {
  const std::size_t entry = ring_.entry_of(token);
  if (entry < ring_.entries().size() && reclaim(entry)) {
    free_.push_back(static_cast<std::uint32_t>(entry));
  } else {
    corrupt_.fetch_add(1, std::memory_order_relaxed);
  }
}

[[gnu::hot]] void SharedOutput::collect(std::size_t most_words) noexcept {
  const auto returned = ring_.returned();
  for (std::size_t i = 0; i < std::min(most_words, returned.size()); ++i) {
    const std::size_t at = next_word_;
    next_word_ = at + 1 == returned.size() ? 0 : at + 1;
    if (returned[at].load(std::memory_order_relaxed) == 0) continue;
    std::uint64_t bits = returned[at].exchange(0, std::memory_order_acq_rel);  // pairs with H3
    for (; bits != 0; bits &= bits - 1) {
      taken_back_.add_one();
      reclaim_token(ring_.token_of(at * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
    }
  }
}

[[gnu::hot]] void SharedOutput::ring_reader() const noexcept {
  // H4: after the word was pushed.
  const std::uint64_t word = ring_.header().doorbell.load(std::memory_order_seq_cst);
  if (word == 0) return;
  const auto doorbell = DoorbellLine::of(word);
  if (!doorbell) return;  // the reader finds out
  std::byte* words = reader_->control(doorbell->offset, sizeof(task::DoorbellWords));
  if (words != nullptr) task::ring(*reinterpret_cast<task::DoorbellWords*>(words), doorbell->line);
}

/// Runs while the writing task may already push. That is safe because the entry is reserved for this
/// function, the token goes in only where none waits, and nothing of the entry is touched once the token is
/// in.
void SharedOutput::offer_last(task::SampleSlot& last) noexcept {
  const std::size_t entry = ring_.entries().size() - 1;
  const auto payload = untyped_ ? Payload{} : source_->take_apart(last);
  if (!payload) return;
  lend(entry, *payload, last.sequence, {});  // how long it has been there is no delay
  if (!ring_.words().offer(ring_.token_of(entry))) {
    reclaim(entry);
    return;
  }
  initial_.add_one();
  ring_reader();
}

void SharedOutput::disconnect() {
  {
    const Lock lock(mutex_);
    if (!attached_) return;
    OutputPortAccess::detach(port_, *this);
    attached_ = false;
    final_ = shown_counters();
  }
  state_->end(*this);
}

bool SharedOutput::connected() const {
  const Lock lock(mutex_);
  return attached_;
}

Counters SharedOutput::counters() const {
  const Lock lock(mutex_);
  return attached_ ? shown_counters() : final_;
}

Counters SharedOutput::shown_counters() const noexcept {
  return {written_.get() + initial_.get(), ring_.counters().read, dropped_.get(), overwritten_.get()};
}

Damage SharedOutput::damage(TimePoint now) {
  const Lock lock(mutex_);
  if (!attached_) return Damage::None;
  return wrong_.is(is_overwritten(), now) || corrupt() > 0 ? Damage::Ring : Damage::None;
}

/// It checks the words that this side has written, and counts samples: each that went into the words was
/// replaced, waits there, or was read. Counted in this order, one on its way is counted twice rather than
/// missed.
bool SharedOutput::is_overwritten() const noexcept {
  const std::uint64_t pushed = pushed_.load(std::memory_order_relaxed) + initial_.get();
  const std::uint64_t replaced = replaced_.load(std::memory_order_relaxed);
  const std::uint64_t waiting = ring_.words().count();
  const std::uint64_t read = ring_.header().read.load(std::memory_order_relaxed);
  const auto differs = [](const KeptCount& count) { return count.is_overwritten(); };
  return pushed > replaced + waiting + read || differs(written_) || differs(initial_) || differs(dropped_) ||
         differs(overwritten_) || differs(taken_back_);
}

void SharedOutput::abandon() {
  {
    const Lock lock(mutex_);
    abandoned_ = true;
  }
  disconnect();
}

/// The reader may use the samples that it holds and read those that wait until its endpoint has ended, too.
bool SharedOutput::reclaim_rest() {
  const Lock lock(mutex_);
  if (attached_) return false;
  if (abandoned_ || !ring_.current()) {
    for (std::size_t entry = 0; entry < ring_.entries().size(); ++entry)
      reclaim(entry);
  } else {
    collect_all();
  }
  if (count_lent() > 0) return false;
  source_.reset();
  return true;
}

std::size_t SharedOutput::count_lent() const noexcept {
  const auto is_out = [](const LentEntry& entry) { return entry.out.load(std::memory_order_relaxed); };
  return static_cast<std::size_t>(std::count_if(lent_.get(), lent_.get() + ring_.entries().size(), is_out));
}

void SharedOutput::collect_all() noexcept {
  const bool closed = ring_.header().closed.load(std::memory_order_acquire) != 0;  // pairs with H5
  for (std::size_t i = 0; closed && i < ring_.words().places(); ++i) {
    const std::size_t entry = ring_.entry_of(ring_.words().remove(i));
    if (entry < ring_.entries().size()) reclaim(entry);
  }
  const auto returned = ring_.returned();
  for (std::size_t at = 0; at < returned.size(); ++at) {
    std::uint64_t bits = returned[at].exchange(0, std::memory_order_acq_rel);  // pairs with H3
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t entry = at * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      if (entry < ring_.entries().size()) reclaim(entry);
    }
  }
}

}  // namespace segue::sample_link
