// SPDX-License-Identifier: Apache-2.0
#include "responder.hpp"
#include "requester.hpp"

#include <segue/base/clock.hpp>
#include <segue/ros2/dds_names.hpp>

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <utility>

namespace ros2 {
segue::Result<std::unique_ptr<Responder>> Responder::make(std::shared_ptr<Participant> participant,
                                                          segue::ros2::InterfaceLibrary& library,
                                                          const std::string& service,
                                                          const std::string& interface, Take take,
                                                          std::uint32_t depth) {
  auto request = segue::ros2::MessageCodec::of(library, interface + "_Request");
  if (!request) return request.error();
  auto response = segue::ros2::MessageCodec::of(library, interface + "_Response");
  if (!response) return response.error();
  std::unique_ptr<Responder> made(
      new Responder(std::move(participant), std::move(*request), std::move(*response), std::move(take)));
  if (auto opened = made->open(service, depth); !opened) return opened.error();
  return made;
}

Responder::Responder(std::shared_ptr<Participant> participant, segue::ros2::MessageCodec request,
                     segue::ros2::MessageCodec response, Take take)
    : participant_(std::move(participant)),
      request_(std::move(request)),
      response_(std::move(response)),
      take_(std::move(take)) {}

segue::Result<void> Responder::open(const std::string& service, std::uint32_t depth) {
  auto request_topic = segue::ros2::dds_request_name(service);
  if (!request_topic) return request_topic.error();
  auto response_topic = segue::ros2::dds_response_name(service);
  if (!response_topic) return response_topic.error();
  response_topic_ = *response_topic;
  const std::string server = segue::ros2::server_user_data(random_gid());
  const auto user_data = [&](const segue::ros2::MessageCodec& message) {
    return server + "typehash=" + message.type_hash() + ";";
  };
  segue::ros2::Quality quality;
  quality.depth = depth;
  auto writer = participant_->make_acknowledged_writer({response_topic_, response_.dds_type()}, quality,
                                                       user_data(response_), this);
  if (!writer) return writer.error();
  writer_ = std::move(*writer);
  auto reader = participant_->make_reader({*request_topic, request_.dds_type()}, quality, user_data(request_),
                                          this, Participant::Memory::AsNeeded);
  if (!reader) return reader.error();
  reader_ = std::move(*reader);
  return {};
}

Responder::~Responder() {
  if (writer_) participant_->forget_acknowledgements(publisher());
}

void Responder::on_data_available(dds::DataReader* reader) {
  BytesSink sink;
  dds::SampleInfo info;
  while (reader->take_next_sample(static_cast<MessageSink*>(&sink), &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    Caller caller;
    caller.writer = gid_of(info.sample_identity.writer_guid());
    if (segue::ros2::mapping_of(caller.writer) == segue::ros2::ServiceMapping::Cyclone) {
      auto parts = segue::ros2::split_request_id(sink.bytes);
      if (!parts) continue;
      caller.id = parts->id;
      take_(caller, std::move(parts->message));
      continue;
    }
    // The client names the reader of its responses; the number is that of its request.
    caller.request.writer_guid(info.related_sample_identity.writer_guid());
    caller.request.sequence_number(info.sample_identity.sequence_number());
    take_(caller, std::move(sink.bytes));
  }
}

bool Responder::sees(const Caller& caller) const {
  return std::ranges::any_of(
      participant_->graph().endpoints(response_topic_, false),
      [&](const auto& endpoint) { return segue::ros2::same_participant(endpoint.gid, caller.writer); });
}

/// Both ends must know each other. That the reader is discovered is told before the writer sends to it.
bool Responder::reaches(const Caller& caller) const {
  const segue::Lock lock(matched_mutex_);
  return has_matched(caller);
}

bool Responder::has_matched(const Caller& caller) const {
  return std::ranges::any_of(matched_, [&](const auto& reader) {
    return segue::ros2::same_participant(reader, caller.writer) &&
           participant_->has_acknowledged(reader, publisher());
  });
}

void Responder::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  const auto reader = gid_of(eprosima::fastrtps::rtps::iHandle2GUID(status.last_subscription_handle));
  const segue::Lock lock(matched_mutex_);
  if (status.current_count_change > 0) {
    matched_.insert(reader);
  } else {
    matched_.erase(reader);
  }
  changed_.notify_all();
}

bool Responder::respond(const Caller& caller, std::span<const std::byte> response,
                        segue::TimePoint deadline) {
  if (!reaches(caller)) wait_until_it_reaches(caller, deadline);
  return send(caller, response);
}

/// The participant tells what has been acknowledged.
void Responder::wait_until_it_reaches(const Caller& caller, segue::TimePoint deadline) {
  const bool watcher = true;  // several threads may wait
  participant_->watch(&watcher, [this] {
    const segue::Lock lock(matched_mutex_);
    changed_.notify_all();
  });
  {
    const segue::Lock lock(matched_mutex_);
    changed_.wait_until(matched_mutex_, deadline,
                        [&]() SEGUE_REQUIRES(matched_mutex_) { return has_matched(caller); });
  }
  participant_->stop_watching(&watcher);
}

bool Responder::send(const Caller& caller, std::span<const std::byte> response) {
  if (segue::ros2::mapping_of(caller.writer) == segue::ros2::ServiceMapping::Cyclone) {
    const auto bytes = segue::ros2::with_request_id(caller.id, response);
    BytesSource source(bytes);
    return writer_->write(static_cast<MessageSource*>(&source));
  }
  BytesSource source(response);
  eprosima::fastrtps::rtps::WriteParams parameters;
  parameters.related_sample_identity(caller.request);
  return writer_->write(static_cast<MessageSource*>(&source), parameters);
}

}  // namespace ros2
