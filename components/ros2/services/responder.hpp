// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/service_message.hpp>

#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace ros2 {

/// Who waits for a response.
struct Caller {
  segue::ros2::Gid writer{};                           ///< of the request
  eprosima::fastrtps::rtps::SampleIdentity request{};  ///< of clients on Fast DDS
  segue::ros2::RequestId id{};                         ///< of clients on Cyclone DDS
};

/// A server of a service of ROS 2, for clients of both mappings (service_message.hpp) at once. Any thread.
class Responder final : private dds::DataReaderListener, private dds::DataWriterListener {
 public:
  /// Called in a thread of Fast DDS with each request as CDR, which is untrusted.
  using Take = std::function<void(const Caller& caller, std::vector<std::byte> request)>;
  /// `service`: "/add_two_ints"; `interface`: "example_interfaces/srv/AddTwoInts"; `depth`: how many
  /// responses may be under way at once, as those of ROS 2.
  static segue::Result<std::unique_ptr<Responder>> make(std::shared_ptr<Participant> participant,
                                                        segue::ros2::InterfaceLibrary& library,
                                                        const std::string& service,
                                                        const std::string& interface, Take take,
                                                        std::uint32_t depth = 10);
  ~Responder() override;
  Responder(const Responder&) = delete;
  Responder& operator=(const Responder&) = delete;

  /// Sends the response, CDR. Waits until the client gets responses, until the deadline at most; a response
  /// that is sent before is lost. Not for threads of Fast DDS. False: Fast DDS does not take it.
  bool respond(const Caller& caller, std::span<const std::byte> response, segue::TimePoint deadline);
  /// The same without the wait.
  bool send(const Caller& caller, std::span<const std::byte> response);
  /// Whether the client gets responses.
  [[nodiscard]] bool reaches(const Caller& caller) const;
  /// Whether the client is seen, though it may not get responses yet.
  [[nodiscard]] bool sees(const Caller& caller) const;
  /// How many there are whose requests come.
  [[nodiscard]] std::uint32_t clients() const {
    return static_cast<std::uint32_t>(std::max(clients_.load(), 0));
  }
  [[nodiscard]] const segue::ros2::MessageCodec& request() const { return request_; }
  [[nodiscard]] const segue::ros2::MessageCodec& response() const { return response_; }
  [[nodiscard]] segue::ros2::Gid publisher() const { return gid_of(writer_->guid()); }
  [[nodiscard]] segue::ros2::Gid subscription() const { return gid_of(reader_->guid()); }

 private:
  Responder(std::shared_ptr<Participant> participant, segue::ros2::MessageCodec request,
            segue::ros2::MessageCodec response, Take take);
  segue::Result<void> open(const std::string& service, std::uint32_t depth);
  [[nodiscard]] bool has_matched(const Caller& caller) const SEGUE_REQUIRES(matched_mutex_);
  void wait_until_it_reaches(const Caller& caller, segue::TimePoint deadline);
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    clients_ = status.current_count;
  }
  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& status) override;

  const std::shared_ptr<Participant> participant_;
  const segue::ros2::MessageCodec request_;
  const segue::ros2::MessageCodec response_;
  const Take take_;
  std::string response_topic_;  ///< on DDS
  std::atomic<std::int32_t> clients_{0};
  mutable segue::Mutex matched_mutex_;
  segue::ConditionVariable changed_;  ///< which readers have matched, or acknowledged that
  std::set<segue::ros2::Gid> matched_ SEGUE_GUARDED_BY(matched_mutex_);  ///< readers to which responses go
  Participant::Owned<dds::DataWriter> writer_;
  Participant::Owned<dds::DataReader> reader_;  ///< destroyed first: its callbacks use all others
};

}  // namespace ros2
