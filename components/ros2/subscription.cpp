// SPDX-License-Identifier: Apache-2.0
#include "cdr_output.hpp"
#include "topic_endpoint.hpp"

#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <deque>
#include <new>
#include <optional>
#include <vector>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_thread() {
  segue::Activity activity;
  activity.thread = "ros2_subscriptions";
  return activity;
}

/// Writes the samples of a topic of ROS 2 to `out`, decoded into the memory where readers find them, in the
/// thread in which Fast DDS receives them: another thread would cost a wake-up for each sample. A lock keeps
/// that to the time between on_start and on_stop. Samples that arrive before on_start are not for this task,
/// but those of a topic that is transient_local, which wait for it.
class Subscription final : public TopicEndpoint, private dds::DataReaderListener, private MessageSink {
 public:
  Subscription()
      : TopicEndpoint(Direction::Output, "out",
                      {.doc = "Subscribes to a topic of ROS 2", .activity = in_shared_thread()}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (auto opened = open(); !opened) return opened;
    reset_counts();
    out_.emplace(*this, "out", codec(), "samples as they arrive");
    auto reader = participant().make_reader(topic_name(), quality(), user_data(), this);
    if (!reader) {
      out_.reset();
      leave();
      return reader.error();
    }
    reader_ = std::move(*reader);
    watch(gid_of(reader_->guid()));
    return {};
  }

  segue::Result<void> on_start() override {
    const segue::Lock lock(mutex_);
    running_ = true;
    for (const auto& message : waiting_)
      deliver(message);
    waiting_.clear();
    return {};
  }

  void on_update() override {}

  void on_stop() override {
    const segue::Lock lock(mutex_);
    running_ = false;
  }

  void on_cleanup() override {
    stop_watching();
    reader_.reset();
    {
      const segue::Lock lock(mutex_);
      waiting_.clear();
    }
    out_.reset();
    leave();
  }

 private:
  void reset_counts() {
    const segue::Lock lock(mutex_);
    counts_ = {};
  }

  /// In a thread of Fast DDS, which holds locks of its own: nothing that has our lock calls Fast DDS.
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(static_cast<MessageSink*>(this), &info) == ReturnCode_t::RETCODE_OK) {
    }
  }
  bool take(std::span<const std::byte> message) noexcept override {
    const segue::Lock lock(mutex_);
    if (running_) {
      deliver(message);
      return true;
    }
    ++counts_.early;
    if (quality().durability == segue::ros2::Durability::TransientLocal) keep(message);
    return true;
  }

  void keep(std::span<const std::byte> message) noexcept SEGUE_REQUIRES(mutex_) {
    try {
      waiting_.emplace_back(message.begin(), message.end());
      if (waiting_.size() > std::max(quality().depth, 1U)) waiting_.pop_front();
    } catch (const std::bad_alloc&) {
      ++counts_.lost;
    }
  }

  void deliver(std::span<const std::byte> message) noexcept SEGUE_REQUIRES(mutex_) {
    const auto outcome = out_->publish(message);
    if (outcome == CdrOutput::Outcome::Lost) {
      ++counts_.lost;
    } else if (outcome == CdrOutput::Outcome::Corrupt) {
      ++counts_.corrupt;
    } else {
      ++counts_.received;
      counts_.bytes += message.size();
      if (outcome == CdrOutput::Outcome::Refused) ++counts_.refused;
    }
  }

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    set_matched(status.current_count);
  }
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override {
    const segue::Lock lock(mutex_);
    counts_.lost += static_cast<std::uint64_t>(std::max(status.total_count_change, 0));
  }
  void on_requested_deadline_missed(dds::DataReader*,
                                    const dds::RequestedDeadlineMissedStatus& status) override {
    missed("the deadline was missed", status.total_count_change);
  }
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override {
    missed("liveliness was lost", static_cast<std::uint32_t>(std::max(status.not_alive_count_change, 0)));
  }

  SubscriptionStatistics statistics() const {
    segue::Lock lock(mutex_);
    SubscriptionStatistics now = counts_;
    lock.unlock();
    now.missed = missed();
    now.matched = matched();
    now.mismatched = mismatched();
    return now;
  }

  Operation<SubscriptionStatistics()> statistics_{
      *this, "statistics", {}, [this] { return statistics(); }, RunsIn::TaskThread, "what arrived so far"};
  mutable segue::Mutex mutex_;  ///< one thread at a time delivers
  SubscriptionStatistics counts_ SEGUE_GUARDED_BY(mutex_);
  bool running_ SEGUE_GUARDED_BY(mutex_) = false;
  std::deque<std::vector<std::byte>> waiting_ SEGUE_GUARDED_BY(mutex_);
  // Changed only while there is no reader, whose callbacks use it.
  std::optional<CdrOutput> out_;
  Participant::Owned<dds::DataReader> reader_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Subscription)
