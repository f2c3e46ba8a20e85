// SPDX-License-Identifier: Apache-2.0
#include "topic_writer.hpp"
#include "sample_source.hpp"

#include <algorithm>
#include <utility>

namespace ros2 {

segue::Result<std::unique_ptr<TopicWriter>> TopicWriter::make(const std::shared_ptr<Participant>& participant,
                                                              segue::ros2::InterfaceLibrary& library,
                                                              const TopicSettings& settings, TopicPort port) {
  auto facts = check(settings, true, library);
  if (!facts) return facts.error();
  std::unique_ptr<TopicWriter> made(new TopicWriter(participant, std::move(port), std::move(*facts)));
  if (auto opened = made->open(); !opened) return opened.error();
  return made;
}

TopicWriter::TopicWriter(std::shared_ptr<Participant> participant, TopicPort port, Facts facts)
    : TopicEndpoint(std::move(participant), std::move(port), std::move(facts)),
      in_(port_facts().component, this->port(), &codec().info(), std::string(),
          segue::task::PortOptions{
              .dynamic = true, .doc = port_facts().doc, .flat = true, .topic = topic_of_port()}) {}

segue::Result<void> TopicWriter::open() {
  auto writer = participant().make_writer(topic_name(), quality(), user_data(), this);
  if (!writer) return writer.error();
  writer_ = std::move(*writer);
  watch();
  return {};
}

TopicWriter::~TopicWriter() {
  stop_watching();
  writer_.reset();
}

void TopicWriter::send() {
  // The executor gives another turn if there are more, in between of which the task can be stopped.
  constexpr int kMost = 64;
  for (int i = 0; i < kMost; ++i) {
    const segue::task::SampleRef sample = in_.take();
    if (!sample) return;
    send(*sample.get());
  }
}

void TopicWriter::send(const segue::task::SampleSlot& sample) {
  SampleSource source(codec(), sample);
  if (sample.value == nullptr || source.size() == 0 ||
      !writer_->write(static_cast<MessageSource*>(&source))) {
    ++counts_.refused;
    return;
  }
  ++counts_.sent;
  counts_.bytes += source.size();
}

PublisherStatistics TopicWriter::statistics() const {
  PublisherStatistics now = counts_;
  now.missed = missed();
  now.matched = matched();
  now.mismatched = static_cast<std::uint32_t>(find_mismatches().size());
  return now;
}

void TopicWriter::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  set_matched(status.current_count);
}

void TopicWriter::on_offered_deadline_missed(dds::DataWriter*,
                                             const dds::OfferedDeadlineMissedStatus& status) {
  missed("the deadline was missed", status.total_count_change);
}

void TopicWriter::on_liveliness_lost(dds::DataWriter*, const dds::LivelinessLostStatus& status) {
  missed("liveliness was lost", static_cast<std::uint32_t>(std::max(status.total_count_change, 0)));
}

}  // namespace ros2
