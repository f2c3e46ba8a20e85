// SPDX-License-Identifier: Apache-2.0
#include "link.hpp"
#include "types.hpp"

#include <segue/base/text.hpp>
#include <segue/task/any_port.hpp>
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>

#include <algorithm>
#include <atomic>
#include <new>
#include <optional>
#include <span>
#include <utility>

namespace gateway {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A message of ROS 2 without fields has one byte.
constexpr std::array<std::byte, 5> kEmptyMessage = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0},
                                                    std::byte{0}};

/// How long a Sender that stops tries to get rid of what it still has.
constexpr segue::Duration kLastSamples = std::chrono::seconds(1);

/// Sends what arrives at `in` to a topic, encoded where it lies in the writer's memory. A write waits while
/// readers are behind: samples then wait in the connection that leads here, which keeps, refuses or drops
/// them by its own policy.
class Sender final : public Link {
 public:
  Sender() : Link(Direction::Input, "in", {.doc = "Sends samples to another host", .trigger_on = {"in"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (auto opened = open(); !opened) return opened;
    sent_ = refused_ = lost_ = bytes_ = 0;
    unacknowledged_ = std::make_shared<Unacknowledged>();
    if (auto made = make_writer(); !made) {
      close();
      return made;
    }
    in_.emplace(*this, "in", type(), std::string(),
                PortOptions{.dynamic = true, .doc = "samples to send", .flat = true});
    return {};
  }

  void on_update() override {
    // The executor gives another turn if there are more, in between of which the task can be stopped.
    constexpr int kMost = 64;
    for (int i = 0; i < kMost; ++i) {
      const SampleRef sample = in_->take();
      if (!sample) return;
      send(*sample.get());
    }
  }

  /// A buffer owes its reader what it has taken: what waits is sent, and what was sent is waited for, for a
  /// second each where the other side does not take it.
  void on_stop() override {
    if (policy().kind != segue::BufferKind::Buffer || Link::matched() == 0) return;
    const segue::TimePoint end = now() + kLastSamples;
    while (const SampleRef sample = in_->take()) {
      send(*sample.get());
      if (now() >= end) break;
    }
    ::dds_wait_for_acks(writer_.get(), kLastSamples.count());
  }

  void on_cleanup() override {
    writer_.reset();
    in_.reset();
    close();
  }

 private:
  segue::Result<void> make_writer() {
    dds_listener_t* listener = ::dds_create_listener(this);
    ::dds_lset_publication_matched(listener, [](dds_entity_t, dds_publication_matched_status_t status,
                                                void* self) { static_cast<Sender*>(self)->matched(status); });
    const dds_entity_t made =
        ::dds_create_writer(participant_entity(), topic().entity(), quality().get(), listener);
    ::dds_delete_listener(listener);
    if (made < 0) return dds_error("writer of topic " + segue::quote(topic_name()), made);
    writer_.reset(made);
    return {};
  }

  /// Samples that a reader has not acknowledged when it leaves count as lost, though they may have arrived.
  void matched(const dds_publication_matched_status_t& status) {
    const std::uint64_t freed = unacknowledged_->take_freed_here();
    if (status.current_count_change < 0) lost_ += freed;
    matches().set(status.current_count);
  }

  void send(const SampleSlot& sample) {
    MessageRef message = encode(sample);
    if (message == nullptr) {
      ++refused_;
      return;
    }
    message->count_for(unacknowledged_);
    const std::size_t size = message->size;
    if (!write(*message)) {
      ++refused_;
      return;
    }
    ++sent_;
    bytes_ += size;
    if (Link::matched() == 0 && !policy().init) ++lost_;
  }

  /// nullptr where the sample is too large, or where another process changes it meanwhile.
  MessageRef encode(const SampleSlot& sample) const {
    const std::size_t size = encoded_size(sample);
    if (size == 0 || size > kLargestMessage) return nullptr;
    try {
      MessageRef message(new Message(topic().type(), SDK_DATA, size));
      return write(sample, message->bytes()) ? std::move(message) : nullptr;
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
  }

  /// 0: cannot be encoded.
  std::size_t encoded_size(const SampleSlot& sample) const {
    if (type() == nullptr) return kEmptyMessage.size();
    if (sample.value == nullptr) return 0;
    return sample.flat_size > 0 ? segue::type::cdr_size_of_flat(*type(), sample.flat())
                                : segue::type::cdr_size(*type(), sample.value);
  }

  bool write(const SampleSlot& sample, std::span<std::byte> bytes) const {
    if (type() == nullptr) {
      std::ranges::copy(kEmptyMessage, bytes.begin());
      return true;
    }
    return sample.flat_size > 0 ? segue::type::flat_to_cdr(*type(), sample.flat(), bytes)
                                : segue::type::write_cdr(*type(), sample.value, bytes).has_value();
  }

  /// Waits while readers are behind, since the connection to `in` keeps, refuses or drops samples meanwhile.
  /// A buffer gives up after a second; all others send the newest sample as soon as there is room, at the
  /// latest when a reader that is gone counts as gone.
  bool write(Message& message) {
    const bool is_buffer = policy().kind == segue::BufferKind::Buffer;
    const segue::TimePoint end = now() + std::chrono::seconds(is_buffer ? 1 : kLeaseSeconds + 1);
    for (;;) {
      const dds_return_t done = ::dds_writecdr(writer_.get(), ::ddsi_serdata_ref(&message));
      if (done == DDS_RETCODE_OK) return true;
      if (done != DDS_RETCODE_TIMEOUT || now() >= end) return false;
      if (!is_buffer && in_->pending()) return false;
    }
  }

  SenderStatistics statistics() const {
    SenderStatistics now;
    now.sent = sent_;
    now.refused = refused_;
    now.lost = lost_;
    now.bytes = bytes_;
    now.matched = Link::matched();
    now.mismatched = count_mismatched(writer_.get());
    if (const auto held = unacknowledged_) now.unacknowledged = held->messages;
    return now;
  }

  Operation<SenderStatistics()> statistics_{
      *this, "statistics", {}, [this] { return statistics(); }, RunsIn::TaskThread, "what was sent so far"};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> bytes_{0};
  std::shared_ptr<Unacknowledged> unacknowledged_;
  std::optional<AnyInput> in_;
  Entity writer_;
};

}  // namespace gateway

SEGUE_COMPONENT(gateway::Sender)
