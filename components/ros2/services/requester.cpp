// SPDX-License-Identifier: Apache-2.0
#include "requester.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <random>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::ros2::Gid;
using segue::ros2::ServiceMapping;
namespace fast_rtps = eprosima::fastrtps::rtps;

/// Those of ROS 2 for services (rmw_qos_profile_services_default).
constexpr std::uint32_t kDepth = 10;

std::uint64_t random_number() {
  std::random_device random;
  return std::uint64_t{random()} << 32U | random();
}

}  // namespace

Gid random_gid() {
  std::random_device random;
  Gid gid{};
  std::ranges::generate(gid, [&] { return static_cast<std::uint8_t>(random()); });
  return gid;
}

segue::Result<std::unique_ptr<Requester>> Requester::make(std::shared_ptr<Participant> participant,
                                                          segue::ros2::InterfaceLibrary& library,
                                                          const std::string& service,
                                                          const std::string& interface) {
  auto request_topic = segue::ros2::dds_request_name(service);
  if (!request_topic) return request_topic.error();
  auto response_topic = segue::ros2::dds_response_name(service);
  if (!response_topic) return response_topic.error();
  auto request = segue::ros2::MessageCodec::of(library, interface + "_Request");
  if (!request) return request.error();
  auto response = segue::ros2::MessageCodec::of(library, interface + "_Response");
  if (!response) return response.error();
  std::unique_ptr<Requester> made(new Requester(std::move(participant), service, std::move(*request),
                                                std::move(*response), std::move(*request_topic),
                                                std::move(*response_topic)));
  if (auto opened = made->open(); !opened) return opened.error();
  return made;
}

Requester::Requester(std::shared_ptr<Participant> participant, std::string service,
                     segue::ros2::MessageCodec request, segue::ros2::MessageCodec response,
                     std::string request_topic, std::string response_topic)
    : participant_(std::move(participant)),
      service_(std::move(service)),
      request_(std::move(request)),
      response_(std::move(response)),
      client_(random_number()),
      request_topic_(std::move(request_topic)),
      response_topic_(std::move(response_topic)) {}

segue::Result<void> Requester::open() {
  segue::ros2::Quality quality;
  quality.depth = kDepth;
  const std::string client = segue::ros2::client_user_data(random_gid());
  const auto user_data = [&](const segue::ros2::MessageCodec& message) {
    return client + "typehash=" + message.type_hash() + ";";
  };
  auto reader = participant_->make_reader({response_topic_, response_.dds_type()}, quality,
                                          user_data(response_), this, Participant::Memory::AsNeeded);
  if (!reader) return reader.error();
  auto writer = participant_->make_acknowledged_writer({request_topic_, request_.dds_type()}, quality,
                                                       user_data(request_), this);
  if (!writer) return writer.error();
  reader_ = std::move(*reader);
  writer_ = std::move(*writer);
  participant_->watch(this, [this] { notify(); });
  return {};
}

Requester::~Requester() {
  participant_->stop_watching(this);
  if (writer_) participant_->forget_acknowledgements(gid_of(writer_->guid()));
}

void Requester::notify() {
  const segue::Lock lock(mutex_);
  changed_.notify_all();
}

void Requester::allow(bool allowed) {
  std::map<Number, Answer> given_up;  // destroyed without the lock
  const segue::Lock lock(mutex_);
  allowed_ = allowed;
  if (!allowed) given_up.swap(waiting_);
  changed_.notify_all();
}

bool Requester::is_served() const {
  return !participant_->graph().endpoints(request_topic_, false).empty();
}

segue::Result<std::optional<ServiceMapping>> Requester::mapping_of_servers() const {
  const auto answers = participant_->graph().endpoints(response_topic_, true);
  std::optional<ServiceMapping> found;
  for (const auto& endpoint : participant_->graph().endpoints(request_topic_, false)) {
    const bool is_ready = participant_->has_acknowledged(endpoint.gid, gid_of(writer_->guid()));
    const bool has_both = std::ranges::any_of(
        answers, [&](const auto& answer) { return segue::ros2::same_participant(answer.gid, endpoint.gid); });
    if (!is_ready || !has_both) continue;
    const ServiceMapping mapping = segue::ros2::mapping_of(endpoint.gid);
    if (found && *found != mapping) {
      return fail(
          ErrorCode::InvalidState,
          "service " + service_ + " has a server on Fast DDS and another one on Cyclone DDS: end one");
    }
    found = mapping;
  }
  return found;
}

std::uint32_t Requester::servers() const {
  const std::int32_t both = std::min<std::int32_t>(matched_requests_, matched_responses_);
  return static_cast<std::uint32_t>(std::max(both, 0));
}

segue::Result<ServiceMapping> Requester::wait_for_server(segue::TimePoint deadline) {
  for (;;) {
    auto mapping = mapping_of_servers();
    if (!mapping) return mapping.error();
    const segue::Lock lock(mutex_);
    if (!allowed_)
      return fail(ErrorCode::Cancelled, "service " + service_ + " is not called: the task stops");
    if (*mapping && servers() > 0) return **mapping;
    if (segue::monotonic_now() >= deadline)
      return fail(ErrorCode::Unavailable, "service " + service_ + " has no server");
    // Looks again from time to time, since the graph may have changed between the look and the wait.
    changed_.wait_until(mutex_, std::min(deadline, segue::monotonic_now() + std::chrono::milliseconds(50)));
  }
}

segue::Result<void> Requester::await_server(segue::TimePoint deadline) {
  auto mapping = wait_for_server(deadline);
  return mapping ? segue::Result<void>() : mapping.error();
}

segue::Result<segue::type::Value> Requester::decode(const Response& response) const {
  auto value = response_.decode(response);
  if (value) return value;
  return fail(ErrorCode::ParseError, "the response of service " + service_ + " is malformed")
      .because_of(std::move(value.error()));
}

segue::Result<segue::type::Value> Requester::call(const segue::type::Value& request,
                                                  segue::TimePoint deadline) {
  // It may be answered after this has returned.
  auto got = std::make_shared<std::optional<segue::Result<segue::type::Value>>>();
  auto number = post(request, deadline, [this, got](segue::Result<segue::type::Value> answer) {
    const segue::Lock lock(mutex_);
    *got = std::move(answer);
    changed_.notify_all();
  });
  if (!number) return number.error();
  const segue::Lock lock(mutex_);
  changed_.wait_until(mutex_, deadline,
                      [&]() SEGUE_REQUIRES(mutex_) { return !allowed_ || got->has_value(); });
  waiting_.erase(*number);
  if (*got) return std::move(**got);
  if (!allowed_) {
    return fail(
        ErrorCode::Cancelled,
        "service " + service_ + " has not answered yet, and the task stops; whether it does it is not known");
  }
  return fail(ErrorCode::DeadlineExceeded,
              "service " + service_ + " has not answered in time; whether it does it is not known");
}

segue::Result<void> Requester::begin(const segue::type::Value& request, segue::TimePoint deadline,
                                     Answer answer) {
  auto number = post(request, deadline, std::move(answer));
  return number ? segue::Result<void>() : number.error();
}

segue::Result<Requester::Number> Requester::post(const segue::type::Value& request, segue::TimePoint deadline,
                                                 Answer answer) {
  auto message = request_.encode(request, "request");
  if (!message) return message.error();
  auto mapping = wait_for_server(deadline);
  if (!mapping) return mapping.error();
  const auto number = send(*message, *mapping, std::move(answer));
  if (number) return *number;
  return fail(ErrorCode::Unavailable, "Fast DDS does not take the request to " + service_);
}

std::optional<Requester::Number> Requester::send(std::span<const std::byte> request, ServiceMapping mapping,
                                                 Answer answer) {
  {
    const segue::Lock lock(mutex_);
    ++sending_;
  }
  const auto number = write(request, mapping);
  std::optional<Response> response;
  {
    const segue::Lock lock(mutex_);
    --sending_;
    if (const auto early = number ? early_.find(*number) : early_.end(); early != early_.end()) {
      response = std::move(early->second);
    } else if (number) {
      waiting_.emplace(*number, std::move(answer));
    }
    if (sending_ == 0) early_.clear();
  }
  if (response) answer(decode(*response));
  return number;
}

std::optional<Requester::Number> Requester::write(std::span<const std::byte> request,
                                                  ServiceMapping mapping) {
  if (mapping == ServiceMapping::Cyclone) {
    const Number number(mapping, ++last_number_);
    const auto bytes = segue::ros2::with_request_id({client_, number.second}, request);
    BytesSource source(bytes);
    return writer_->write(static_cast<MessageSource*>(&source)) ? std::optional(number) : std::nullopt;
  }
  BytesSource source(request);
  fast_rtps::WriteParams parameters;
  fast_rtps::SampleIdentity identity;
  identity.writer_guid(reader_->guid());
  parameters.related_sample_identity(identity);
  if (!writer_->write(static_cast<MessageSource*>(&source), parameters)) return {};
  return Number(mapping,
                static_cast<std::int64_t>(parameters.sample_identity().sequence_number().to64long()));
}

bool Requester::has_rivals() const {
  const segue::Lock lock(mutex_);
  return has_rivals_;
}

bool Requester::has_rivals(segue::TimePoint deadline) {
  const segue::Lock lock(mutex_);
  if (servers() > 1)
    changed_.wait_until(mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) { return has_rivals_; });
  return has_rivals_;
}

void Requester::take_response(const Gid& server, const Number& number, Response response) {
  Answer answer;
  {
    const segue::Lock lock(mutex_);
    has_rivals_ = has_rivals_ || (answered_ && answered_->first == number && answered_->second != server);
    answered_.emplace(number, server);
    if (has_rivals_) changed_.notify_all();
    if (const auto waiting = waiting_.find(number); waiting != waiting_.end()) {
      answer = std::move(waiting->second);
      waiting_.erase(waiting);
    } else if (sending_ > 0) {
      early_.try_emplace(number, std::move(response));
    }
  }
  if (answer) answer(decode(response));
}

void Requester::on_data_available(dds::DataReader* reader) {
  BytesSink sink;
  dds::SampleInfo info;
  while (reader->take_next_sample(static_cast<MessageSink*>(&sink), &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    const Gid server = gid_of(info.sample_identity.writer_guid());
    if (segue::ros2::mapping_of(server) == ServiceMapping::Cyclone) {
      auto parts = segue::ros2::split_request_id(sink.bytes);
      if (parts && parts->id.client == client_)
        take_response(server, {ServiceMapping::Cyclone, parts->id.sequence}, std::move(parts->message));
      continue;
    }
    const auto& request = info.related_sample_identity;
    if (request.writer_guid() == reader->guid()) {
      take_response(
          server, {ServiceMapping::FastDds, static_cast<std::int64_t>(request.sequence_number().to64long())},
          std::move(sink.bytes));
    }
  }
}

void Requester::on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) {
  matched_responses_ = status.current_count;
  notify();
}

void Requester::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  matched_requests_ = status.current_count;
  notify();
}

}  // namespace ros2
