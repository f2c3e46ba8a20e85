// SPDX-License-Identifier: Apache-2.0
#include "link.hpp"
#include "types.hpp"

#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/task/any_port.hpp>
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <deque>
#include <map>
#include <new>
#include <optional>

namespace gateway {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_thread() {
  segue::Activity activity;
  activity.thread = "gateway_receivers";
  return activity;
}

/// Writes the samples that arrive from a topic to `out`, decoded into the memory where readers find it, in
/// the thread in which Cyclone receives it: another thread would cost a wake-up for each sample. A lock keeps
/// that to one thread at a time, and to the time between on_start and on_stop. Samples that arrive before
/// on_start wait by policy. The task's own thread does nothing but operations, so all Receivers of a process
/// share one.
class Receiver final : public Link {
 public:
  Receiver()
      : Link(Direction::Output, "out",
             {.doc = "Receives samples from another host", .activity = in_shared_thread()}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (auto opened = open(); !opened) return opened;
    received_ = refused_ = lost_ = corrupt_ = bytes_ = 0;
    {
      const segue::Lock lock(mutex_);
      known_writer_ = 0;
      sequences_.clear();
    }
    out_.emplace(*this, "out", type(), std::string(),
                 PortOptions{.dynamic = true, .doc = "samples as they arrive", .flat = true});
    if (auto made = make_reader(); !made) {
      on_cleanup();
      return made;
    }
    return {};
  }

  segue::Result<void> on_start() override {
    const segue::Lock lock(mutex_);
    running_ = true;
    for (const MessageRef& message : waiting_)
      deliver(*message);
    waiting_.clear();
    return {};
  }

  void on_update() override {}

  void on_stop() override {
    const segue::Lock lock(mutex_);
    running_ = false;
  }

  void on_cleanup() override {
    reader_.reset();
    {
      const segue::Lock lock(mutex_);
      waiting_.clear();
    }
    out_.reset();
    close();
  }

 private:
  using WriterId = std::array<std::uint8_t, 16>;

  segue::Result<void> make_reader() {
    dds_listener_t* listener = ::dds_create_listener(this);
    ::dds_lset_data_available(
        listener, [](dds_entity_t reader, void* self) { static_cast<Receiver*>(self)->receive(reader); });
    ::dds_lset_subscription_matched(listener,
                                    [](dds_entity_t, dds_subscription_matched_status_t status, void* self) {
                                      static_cast<Receiver*>(self)->matches().set(status.current_count);
                                    });
    const dds_entity_t made =
        ::dds_create_reader(participant_entity(), topic().entity(), quality().get(), listener);
    ::dds_delete_listener(listener);
    if (made < 0) return dds_error("reader of topic " + segue::quote(topic_name()), made);
    reader_.reset(made);
    return {};
  }

  /// In a thread of Cyclone.
  void receive(dds_entity_t reader) {
    constexpr std::size_t kBatch = 16;
    const segue::Lock lock(mutex_);
    std::array<ddsi_serdata*, kBatch> messages{};
    std::array<dds_sample_info_t, kBatch> infos{};
    dds_return_t taken = kBatch;
    while (taken == static_cast<dds_return_t>(kBatch)) {
      taken = ::dds_takecdr(reader, messages.data(), kBatch, infos.data(), DDS_ANY_STATE);
      for (std::size_t i = 0; taken > 0 && i < static_cast<std::size_t>(taken); ++i) {
        MessageRef message(static_cast<Message*>(messages[i]));
        if (infos[i].valid_data) arrived(reader, std::move(message), infos[i].publication_handle);
      }
    }
  }

  void arrived(dds_entity_t reader, MessageRef message, dds_instance_handle_t writer) SEGUE_REQUIRES(mutex_) {
    if (writer != known_writer_) know(reader, writer);
    // A writer that was lost from sight for a while sends all samples again whose acknowledgement it has not
    // got.
    if (message->sequence != 0 && message->sequence <= *sequence_) return;
    count_gap(message->sequence);
    if (!trusted_) {
      ++corrupt_;
    } else if (running_) {
      deliver(*message);
    } else {
      wait(std::move(message));
    }
  }

  /// Numbers that a writer skips are samples that it overwrote or gave up before they had arrived.
  void count_gap(std::uint64_t number) SEGUE_REQUIRES(mutex_) {
    if (*sequence_ != 0 && number > *sequence_ + 1) lost_ += number - *sequence_ - 1;
    *sequence_ = number;
  }

  /// A writer that is found again has another handle, but its old identifier.
  void know(dds_entity_t reader, dds_instance_handle_t writer) SEGUE_REQUIRES(mutex_) {
    known_writer_ = writer;
    dds_builtintopic_endpoint_t* endpoint = ::dds_get_matched_publication_data(reader, writer);
    // The writer may be gone already; its samples are checked as all others are.
    trusted_ = endpoint == nullptr || !differs(*endpoint);
    WriterId id{};
    if (endpoint == nullptr) {
      std::memcpy(id.data(), &writer, sizeof writer);
    } else {
      std::ranges::copy(endpoint->key.v, id.begin());
      ::dds_builtintopic_free_endpoint(endpoint);
    }
    sequence_ = &sequences_[id];
  }

  void wait(MessageRef message) SEGUE_REQUIRES(mutex_) {
    if (waiting_.size() >= policy().size) {
      ++lost_;
      if (policy().kind == segue::BufferKind::Buffer) return;
      waiting_.pop_front();
    }
    waiting_.push_back(std::move(message));
  }

  void deliver(const Message& message) SEGUE_REQUIRES(mutex_) {
    SampleRef sample;
    try {
      sample = room_for(message);
      if (!sample) return;
      if (!decode(message, *sample.get())) {
        ++corrupt_;
        return;
      }
    } catch (const std::bad_alloc&) {
      ++lost_;
      return;
    }
    ++received_;
    bytes_ += message.size;
    if (out_->publish(sample.detach()) == WriteResult::Refused) ++refused_;
  }

  /// Empty, and counted, where there is none, or where the message cannot be a sample of the type.
  SampleRef room_for(const Message& message) {
    if (!out_->is_flat()) {
      SampleRef slot = SampleRef::adopt(out_->acquire());
      if (!slot) ++lost_;
      return slot;
    }
    const std::size_t size = segue::type::flat_size_of_cdr(*type(), message.bytes());
    if (size > 0) return SampleRef::adopt(out_->acquire_flat(size));
    ++corrupt_;
    return {};
  }

  static bool decode(const Message& message, SampleSlot& slot) {
    if (slot.value == nullptr) return true;
    const segue::type::TypeInfo& type = *slot.owner->info();
    if (slot.flat_size == 0) return segue::type::read_cdr(type, slot.value, message.bytes());
    return segue::type::cdr_to_flat(type, message.bytes(),
                                    {static_cast<std::byte*>(slot.value), slot.flat_size});
  }

  ReceiverStatistics statistics() const {
    ReceiverStatistics now;
    now.received = received_;
    now.refused = refused_;
    now.lost = lost_;
    now.corrupt = corrupt_;
    now.bytes = bytes_;
    now.matched = matched();
    now.mismatched = count_mismatched(reader_.get());
    return now;
  }

  Operation<ReceiverStatistics()> statistics_{
      *this, "statistics", {}, [this] { return statistics(); }, RunsIn::TaskThread, "what arrived so far"};
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> corrupt_{0};
  std::atomic<std::uint64_t> bytes_{0};
  segue::Mutex mutex_;  ///< one thread at a time delivers
  bool running_ SEGUE_GUARDED_BY(mutex_) = false;
  bool trusted_ SEGUE_GUARDED_BY(mutex_) = true;
  dds_instance_handle_t known_writer_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< of the last message
  std::uint64_t* sequence_ SEGUE_GUARDED_BY(mutex_) = nullptr;       ///< of the last message of that writer
  std::map<WriterId, std::uint64_t> sequences_ SEGUE_GUARDED_BY(mutex_);
  std::deque<MessageRef> waiting_ SEGUE_GUARDED_BY(mutex_);
  // Changed only while there is no reader, whose callbacks use them.
  std::optional<AnyOutput> out_;
  Entity reader_;
};

}  // namespace gateway

SEGUE_COMPONENT(gateway::Receiver)
