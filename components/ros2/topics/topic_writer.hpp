// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topic_endpoint.hpp"

#include <segue/task/any_port.hpp>

#include <fastdds/dds/publisher/DataWriterListener.hpp>

#include <memory>

namespace ros2 {

/// An input port whose samples go to a topic of ROS 2. The task that has it calls send() in its updates; so
/// nothing is sent while it does not run.
class TopicWriter final : public TopicEndpoint, private dds::DataWriterListener {
 public:
  static constexpr bool kPublishes = true;
  /// In on_configure. Fails as TopicEndpoint::check() does, or where Fast DDS makes no publisher.
  static segue::Result<std::unique_ptr<TopicWriter>> make(const std::shared_ptr<Participant>& participant,
                                                          segue::ros2::InterfaceLibrary& library,
                                                          const TopicSettings& settings, TopicPort port);
  ~TopicWriter() override;

  /// Sends what waits, but not more than an update should.
  void send();
  /// For the thread of the task.
  [[nodiscard]] PublisherStatistics statistics() const;
  [[nodiscard]] segue::ros2::Gid gid() const { return gid_of(writer_->guid()); }

 private:
  TopicWriter(std::shared_ptr<Participant> participant, TopicPort port, Facts facts);
  segue::Result<void> open();
  void send(const segue::task::SampleSlot& sample);

  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override;
  void on_offered_deadline_missed(dds::DataWriter*, const dds::OfferedDeadlineMissedStatus& status) override;
  void on_liveliness_lost(dds::DataWriter*, const dds::LivelinessLostStatus& status) override;

  PublisherStatistics counts_;
  segue::task::AnyInput in_;
  Participant::Owned<dds::DataWriter> writer_;
};

}  // namespace ros2
