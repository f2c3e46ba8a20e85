// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/sample_form.hpp>
#include <segue/sample_link/sample_queue.hpp>
#include <segue/sample_link/word_ring.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task/sample_pool.hpp>
#include <segue/type/type.hpp>

#include <atomic>
#include <string>

namespace segue::sample_link {

namespace {

using task::InputPortAccess;
using task::InputPortBase;
using task::OutputPortAccess;
using task::OutputPortBase;
using task::SampleRef;
using task::SampleSlot;

constexpr std::size_t kReaderSlots = 2;  // the sample that was read last, and the one being read

class LocalConnection final : public PortConnection, public task::WriterEnd, public task::ReaderEnd {
 public:
  LocalConnection(OutputPortBase& from, InputPortBase& to, const Policy& policy, task::CommitGatePtr gate)
      : from_(from), to_(to), policy_(policy), queue_(policy.kind, policy.size), gate_(std::move(gate)) {
    if (!from.is_flat() || to.is_flat()) return;
    objects_ = task::SamplePool::create(from.type());
    objects_->reserve(policy.size + kReaderSlots);
  }

  static Result<std::shared_ptr<PortConnection>> make(OutputPortBase& from, InputPortBase& to,
                                                      const Policy& policy, const task::CommitGatePtr& gate);

  bool push(SampleSlot& sample) noexcept override;
  SampleRef pull() noexcept override;
  [[nodiscard]] bool pending() const noexcept override { return queue_.pending(); }
  [[nodiscard]] std::uint64_t number() const noexcept override { return number_; }
  [[nodiscard]] std::size_t capacity() const override { return policy_.size + kReaderSlots; }
  [[nodiscard]] bool same_as(const WriterEnd& other) const override {
    const auto* local = dynamic_cast<const LocalConnection*>(&other);
    return local != nullptr && &local->to_ == &to_ && local->policy_ == policy_;
  }

  void disconnect() override;
  /// The port stores the listener before (sequentially consistent, as its loads in notify() and the writer's
  /// section), so only a write that has begun already may still notify the previous one.
  void set_listener(task::SampleListener* listener) override {
    const Lock lock(mutex_);
    if (listener == nullptr && attached_) OutputPortAccess::wait_until_written(from_);
  }
  [[nodiscard]] bool connected() const override {
    const Lock lock(mutex_);
    return attached_;
  }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Latency latency() const override { return latency_.read(); }
  [[nodiscard]] const Policy& policy() const override { return policy_; }
  void end_at(task::CommitGatePtr gate) override;
  void settle() override;
  [[nodiscard]] bool dormant() const override {
    const Lock lock(mutex_);
    return gate_ && !gate_->open();
  }
  [[nodiscard]] bool carries() const override {
    const Lock lock(mutex_);
    return !(gate_ && !gate_->open()) && !(end_ && end_->open());
  }
  [[nodiscard]] bool owes_samples() const override {
    const Lock lock(mutex_);
    return policy_.kind != BufferKind::Data && attached_ && end_ && end_->open() && counters().waiting() > 0;
  }

 private:
  void offer_last();
  SampleRef pull_object() noexcept;

  using Count = std::atomic<std::uint64_t>;
  /// Each counter has one writing thread, so no atomic increment is needed; readers may see an older value.
  static void increment(Count& count) {
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  OutputPortBase& from_;  ///< valid while attached
  InputPortBase& to_;
  const Policy policy_;
  const std::uint64_t number_ = task::next_connection_number();
  SampleQueue queue_;
  mutable Mutex mutex_;  ///< guards the next three; held while both ports are detached
  bool attached_ SEGUE_GUARDED_BY(mutex_) = true;
  task::CommitGatePtr gate_ SEGUE_GUARDED_BY(mutex_);  ///< nullptr: it carries samples already
  task::CommitGatePtr end_;                            ///< the gate with which it ends
  Count initial_{0};
  alignas(64) Count written_{0};
  Count dropped_{0};
  Count overwritten_{0};
  alignas(64) Count read_{0};
  Count unreadable_{0};  ///< dropped by the reader: no memory was left for the object
  LatencyRecorder latency_;
  task::SamplePool::Handle
      objects_;  ///< where the writer's samples are in the flat layout, but not the reader's
};

Result<std::shared_ptr<PortConnection>> LocalConnection::make(OutputPortBase& from, InputPortBase& to,
                                                              const Policy& policy,
                                                              const task::CommitGatePtr& gate) {
  auto connection = std::make_shared<LocalConnection>(from, to, policy, gate);
  // The reader first, so that no sample of the writer goes unnoticed.
  InputPortAccess::attach(to, connection);
  const bool at_once = gate == nullptr;
  if (auto attached = OutputPortAccess::attach(from, connection, to.full_name(), gate); !attached) {
    InputPortAccess::detach(to, *connection);
    return std::move(attached.error());
  }
  if (at_once) connection->offer_last();
  return std::shared_ptr<PortConnection>(std::move(connection));
}

void LocalConnection::offer_last() {
  if (!policy_.init) return;
  latency_.begin_at(monotonic_now());  // how long the last sample has been there is no delay
  OutputPortAccess::show_last(from_, [this](SampleSlot& last) {
    if (!queue_.offer_older(last)) return;
    increment(initial_);
    InputPortAccess::notify(to_);
  });
}

void LocalConnection::end_at(task::CommitGatePtr gate) {
  const Lock lock(mutex_);
  if (!attached_) return;
  InputPortAccess::end_at(to_, *this, gate);
  OutputPortAccess::end_at(from_, *this, gate);
  end_ = std::move(gate);
}

void LocalConnection::settle() {
  const Lock lock(mutex_);
  if (!attached_) return;
  OutputPortAccess::settle(from_);
  InputPortAccess::settle(to_);
  if (!gate_ || !gate_->open()) return;
  gate_.reset();
  OutputPortAccess::begun(from_);  // first: what it writes is newer than the last sample
  offer_last();
}

[[gnu::hot]] bool LocalConnection::push(SampleSlot& sample) noexcept {
  increment(written_);
  bool taken = true;
  switch (queue_.push(sample)) {
    case SampleQueue::Push::Refused:
      increment(dropped_);
      taken = false;
      break;
    case SampleQueue::Push::Replaced:
      increment(policy_.kind == BufferKind::Data ? overwritten_ : dropped_);
      break;
    case SampleQueue::Push::Taken:
      break;
  }
  // Also where it was refused, so that a reader that has not emptied its buffer gets another turn.
  InputPortAccess::notify(to_);
  return taken;
}

/// Reads the object from a sample in the flat layout.
SampleRef LocalConnection::pull_object() noexcept {
  if (!queue_.pending()) return {};
  SampleRef object = SampleRef::adopt(objects_->acquire());
  if (!object) return {};  // the component holds all slots, so samples keep waiting
  while (const SampleRef sample = queue_.pull()) {
    const bool done = read_object(sample->flat(), sample->sequence, *object.get());
    increment(done ? read_ : unreadable_);
    if (!done) continue;
    latency_.add(sample->written_at);
    return object;
  }
  return {};
}

[[gnu::hot]] SampleRef LocalConnection::pull() noexcept {
  if (objects_) return pull_object();
  SampleRef sample = queue_.pull();
  if (sample) {
    increment(read_);
    latency_.add(sample->written_at);
  }
  return sample;
}

void LocalConnection::disconnect() {
  const Lock lock(mutex_);
  if (!attached_) return;
  OutputPortAccess::detach(from_, *this);
  InputPortAccess::detach(to_, *this);
  attached_ = false;
  // detach() has waited for a push or pull in progress, and there will be none any more.
  queue_.clear();
}

Counters LocalConnection::counters() const {
  return {written_.load(std::memory_order_relaxed) + initial_.load(std::memory_order_relaxed),
          read_.load(std::memory_order_relaxed),
          dropped_.load(std::memory_order_relaxed) + unreadable_.load(std::memory_order_relaxed),
          overwritten_.load(std::memory_order_relaxed)};
}

}  // namespace

Result<std::shared_ptr<PortConnection>> connect(OutputPortBase& from, InputPortBase& to, const Policy& policy,
                                                const task::CommitGatePtr& gate) {
  if (auto checked = check_policy(policy); !checked) return std::move(checked.error());
  if (auto checked = check_types(from, to); !checked) return std::move(checked.error());
  if (auto checked = check_topics(from, to.full_name(), to.options().topic); !checked)
    return std::move(checked.error());
  if (policy.transport != Transport::Automatic && policy.transport != Transport::Local) {
    return fail(ErrorCode::Unsupported, "ports of one process are connected by the local link, not by " +
                                            std::string(to_string(policy.transport)));
  }
  return LocalConnection::make(from, to, policy, gate);
}

Result<void> check_types(const OutputPortBase& from, const InputPortBase& to) {
  const type::TypeInfo* written = from.type();
  const type::TypeInfo* wanted = to.type();
  if (written == nullptr || wanted == nullptr || written == wanted) return {};
  if (written->name() == wanted->name() && written->hash == wanted->hash) return {};
  return fail(ErrorCode::TypeMismatch, from.full_name() + " writes\n" + type::definition(*written->type) +
                                           "\nbut " + to.full_name() + " reads\n" +
                                           type::definition(*wanted->type) +
                                           "\nconnect ports of one type, or put a converter between them");
}

Result<void> check_topics(const OutputPortBase& from, std::string_view to, std::string_view topic) {
  if (topic.empty() || topic != from.options().topic) return {};
  return fail(ErrorCode::AlreadyExists,
              from.full_name() + " and " + std::string(to) + " are both " + std::string(topic) +
                  ", on which the samples travel already: no connection is needed, and with one they would "
                  "come twice");
}

Result<void> check_policy(const Policy& policy) {
  if (policy.size == 0) {
    return fail(ErrorCode::InvalidArgument, "a connection needs room for at least one sample, not 0");
  }
  if (policy.size > WordRing::kLargest) {
    return fail(ErrorCode::InvalidArgument, "a connection holds at most " +
                                                std::to_string(WordRing::kLargest) + " samples, not " +
                                                std::to_string(policy.size));
  }
  if (policy.kind == BufferKind::Data && policy.size != 1) {
    return fail(ErrorCode::InvalidArgument, "policy data holds one sample, not " +
                                                std::to_string(policy.size) +
                                                "; use buffer or circular_buffer");
  }
  if (policy.init && policy.kind != BufferKind::Data) {
    return fail(ErrorCode::InvalidArgument,
                "init belongs to policy data, not to " + std::string(to_string(policy.kind)));
  }
  return {};
}

}  // namespace segue::sample_link
