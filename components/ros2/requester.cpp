// SPDX-License-Identifier: Apache-2.0
#include "requester.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <random>
#include <set>

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

Gid random_gid() {
  std::random_device random;
  Gid gid{};
  std::ranges::generate(gid, [&] { return static_cast<std::uint8_t>(random()); });
  return gid;
}

/// An endpoint's participant.
std::array<std::uint8_t, 12> prefix_of(const Gid& gid) {
  std::array<std::uint8_t, 12> prefix{};
  std::copy_n(gid.begin(), prefix.size(), prefix.begin());
  return prefix;
}

class ResponseSink final : public MessageSink {
 public:
  bool take(std::span<const std::byte> message) noexcept override {
    try {
      bytes.assign(message.begin(), message.end());
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
  std::vector<std::byte> bytes;
};

}  // namespace

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
  auto reader =
      participant_->make_reader({response_topic_, response_.dds_type()}, quality, user_data(response_), this);
  if (!reader) return reader.error();
  auto writer =
      participant_->make_writer({request_topic_, request_.dds_type()}, quality, user_data(request_), this);
  if (!writer) return writer.error();
  reader_ = std::move(*reader);
  writer_ = std::move(*writer);
  participant_->wait_for_acknowledgements(gid_of(writer_->guid()));
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
  const segue::Lock lock(mutex_);
  allowed_ = allowed;
  changed_.notify_all();
}

segue::Result<std::optional<ServiceMapping>> Requester::mapping_of_servers() const {
  std::set<std::array<std::uint8_t, 12>> answer;
  for (const auto& endpoint : participant_->graph().endpoints(response_topic_, true))
    answer.insert(prefix_of(endpoint.gid));
  std::optional<ServiceMapping> found;
  for (const auto& endpoint : participant_->graph().endpoints(request_topic_, false)) {
    const bool is_ready = participant_->has_acknowledged(endpoint.gid, gid_of(writer_->guid()));
    if (!is_ready || !answer.contains(prefix_of(endpoint.gid))) continue;
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

segue::Result<segue::type::Value> Requester::call(const segue::type::Value& request,
                                                  segue::TimePoint deadline) {
  auto message = request_.encode(request, "request");
  if (!message) return message.error();
  auto mapping = wait_for_server(deadline);
  if (!mapping) return mapping.error();
  auto response = exchange(*message, *mapping, deadline);
  if (!response) return response.error();
  auto value = response_.decode(*response);
  if (value) return value;
  return fail(ErrorCode::ParseError, "the response of service " + service_ + " is malformed")
      .because_of(std::move(value.error()));
}

segue::Result<Requester::Response> Requester::exchange(std::span<const std::byte> request,
                                                       ServiceMapping mapping, segue::TimePoint deadline) {
  const auto number = send(request, mapping);
  if (!number) return fail(ErrorCode::Unavailable, "Fast DDS does not take the request to " + service_);
  const segue::Lock lock(mutex_);
  changed_.wait_until(mutex_, deadline,
                      [&]() SEGUE_REQUIRES(mutex_) { return !allowed_ || waiting_[*number].has_value(); });
  std::optional<Response> response = std::move(waiting_[*number]);
  waiting_.erase(*number);
  if (response) return std::move(*response);
  if (!allowed_) {
    return fail(
        ErrorCode::Cancelled,
        "service " + service_ + " has not answered yet, and the task stops; whether it does it is not known");
  }
  return fail(ErrorCode::DeadlineExceeded,
              "service " + service_ + " has not answered in time; whether it does it is not known");
}

std::optional<Requester::Number> Requester::send(std::span<const std::byte> request, ServiceMapping mapping) {
  {
    const segue::Lock lock(mutex_);
    ++sending_;
  }
  // Without the lock: a server in this process answers within the write.
  Number number(mapping, 0);
  bool sent = false;
  if (mapping == ServiceMapping::Cyclone) {
    number.second = ++last_number_;
    const auto bytes = segue::ros2::with_request_id({client_, number.second}, request);
    BytesSource source(bytes);
    sent = writer_->write(static_cast<MessageSource*>(&source));
  } else {
    BytesSource source(request);
    fast_rtps::WriteParams parameters;
    fast_rtps::SampleIdentity identity;
    identity.writer_guid(reader_->guid());
    parameters.related_sample_identity(identity);
    sent = writer_->write(static_cast<MessageSource*>(&source), parameters);
    number.second = static_cast<std::int64_t>(parameters.sample_identity().sequence_number().to64long());
  }
  const segue::Lock lock(mutex_);
  --sending_;
  if (sent) {
    auto& waiting = waiting_[number];
    if (const auto early = early_.find(number); early != early_.end()) waiting = std::move(early->second);
  }
  if (sending_ == 0) early_.clear();
  return sent ? std::optional(number) : std::nullopt;
}

void Requester::take_response(const Number& number, std::vector<std::byte> response) {
  const segue::Lock lock(mutex_);
  if (const auto waiting = waiting_.find(number); waiting != waiting_.end()) {
    if (!waiting->second) waiting->second = std::move(response);
    changed_.notify_all();
  } else if (sending_ > 0) {
    early_.try_emplace(number, std::move(response));
  }
}

void Requester::on_data_available(dds::DataReader* reader) {
  ResponseSink sink;
  dds::SampleInfo info;
  while (reader->take_next_sample(static_cast<MessageSink*>(&sink), &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    const Gid server = gid_of(info.sample_identity.writer_guid());
    if (segue::ros2::mapping_of(server) == ServiceMapping::Cyclone) {
      auto parts = segue::ros2::split_request_id(sink.bytes);
      if (parts && parts->id.client == client_)
        take_response({ServiceMapping::Cyclone, parts->id.sequence}, std::move(parts->message));
      continue;
    }
    const auto& request = info.related_sample_identity;
    if (request.writer_guid() == reader->guid()) {
      take_response(
          {ServiceMapping::FastDds, static_cast<std::int64_t>(request.sequence_number().to64long())},
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
