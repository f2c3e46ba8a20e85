// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cdr_output.hpp"
#include "topic_endpoint.hpp"

#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace ros2 {

/// An output port with the samples of a topic of ROS 2, decoded into the memory where readers find them, in
/// the thread in which Fast DDS receives them: another thread would cost a wake-up for each sample. A lock
/// keeps that to the time between start() and stop(). Samples that arrive before, or before the transition
/// that starts the task has committed, are not for it, but those of a topic that is transient_local, which
/// wait.
class TopicReader final : public TopicEndpoint, private dds::DataReaderListener, private MessageSink {
 public:
  static constexpr bool kPublishes = false;
  /// In on_configure. Fails as TopicEndpoint::check() does, or where Fast DDS makes no subscription.
  static segue::Result<std::unique_ptr<TopicReader>> make(const std::shared_ptr<Participant>& participant,
                                                          segue::ros2::InterfaceLibrary& library,
                                                          const TopicSettings& settings, TopicPort port);
  ~TopicReader() override;

  void start();
  void stop();
  /// Whether a sample has come since start(). Any thread.
  [[nodiscard]] bool has_sample() const;
  /// Any thread.
  [[nodiscard]] SubscriptionStatistics statistics() const;
  [[nodiscard]] segue::ros2::Gid gid() const { return gid_of(reader_->guid()); }

 private:
  using Message = std::vector<std::byte>;
  /// A message that Fast DDS has handed over, before it says whose it is.
  struct Arrival {
    segue::task::SampleRef sample{};
    CdrOutput::Outcome why{};
    std::size_t size = 0;
    Message message{};  ///< in place of the sample, where that has to wait
  };

  TopicReader(std::shared_ptr<Participant> participant, TopicPort port, Facts facts);
  segue::Result<void> open();
  void on_data_available(dds::DataReader* reader) override;
  bool take(std::span<const std::byte> message) noexcept override;
  void pass(const segue::ros2::Gid& writer) noexcept;
  void begin();
  void deliver_waiting() noexcept SEGUE_REQUIRES(mutex_);
  void deliver(Arrival& arrival) noexcept SEGUE_REQUIRES(mutex_);
  void keep(Message message) noexcept SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_foreign(const segue::ros2::Gid& writer) const noexcept SEGUE_REQUIRES(mutex_);
  void changed() override;
  [[nodiscard]] std::vector<segue::ros2::Mismatch> find_mismatches() const override;
  /// The publishers that are not of the node whose port this is, with their nodes.
  [[nodiscard]] std::vector<std::pair<segue::ros2::Gid, std::string>> find_foreign() const;

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override;
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override;
  void on_requested_deadline_missed(dds::DataReader*,
                                    const dds::RequestedDeadlineMissedStatus& status) override;
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override;

  mutable segue::Mutex mutex_;  ///< one thread at a time delivers
  SubscriptionStatistics counts_ SEGUE_GUARDED_BY(mutex_);
  bool running_ SEGUE_GUARDED_BY(mutex_) = false;
  bool delivers_ SEGUE_GUARDED_BY(mutex_) = false;  ///< the task runs, and its connections have begun
  bool has_sample_ SEGUE_GUARDED_BY(mutex_) = false;
  Arrival arrival_ SEGUE_GUARDED_BY(mutex_);
  std::deque<Message> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::vector<segue::ros2::Gid> foreign_ SEGUE_GUARDED_BY(mutex_);  ///< sorted
  CdrOutput out_;
  Participant::Owned<dds::DataReader> reader_;
};

}  // namespace ros2
