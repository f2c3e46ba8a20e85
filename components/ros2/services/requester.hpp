// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/service_message.hpp>
#include <segue/type/value.hpp>

#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ros2 {

/// An identifier of its own for a client, a server or a goal.
segue::ros2::Gid random_gid();

/// A client of a service of ROS 2, in the mapping that its server speaks (service_message.hpp). Any thread.
class Requester final : private dds::DataReaderListener, private dds::DataWriterListener {
 public:
  /// `service`: "/add_two_ints"; `interface`: "example_interfaces/srv/AddTwoInts".
  static segue::Result<std::unique_ptr<Requester>> make(std::shared_ptr<Participant> participant,
                                                        segue::ros2::InterfaceLibrary& library,
                                                        const std::string& service,
                                                        const std::string& interface);
  ~Requester() override;
  Requester(const Requester&) = delete;
  Requester& operator=(const Requester&) = delete;

  /// Waits for a server, sends the request, and waits for the response. Unavailable: there was no server
  /// until the deadline; DeadlineExceeded: it has not answered, so what it did is not known; Cancelled: by
  /// cancel(); ParseError: its response is not one. Fields that `request` does not name have their defaults.
  segue::Result<segue::type::Value> call(const segue::type::Value& request, segue::TimePoint deadline);
  /// The response of a request, or that it is not one (ParseError).
  using Answer = std::function<void(segue::Result<segue::type::Value>)>;
  /// Sends the request as call() does, but does not wait for the response: `answer` is called when it comes,
  /// once at most, in a thread of Fast DDS or before this returns. Where it is called by such a thread
  /// itself, the deadline must have passed: then it does not wait for a server.
  segue::Result<void> begin(const segue::type::Value& request, segue::TimePoint deadline, Answer answer);
  /// Waits for a server; fails as call() does.
  segue::Result<void> await_server(segue::TimePoint deadline);
  /// Whether requests are sent from now on; where not, calls in progress end, and no answers come, too.
  void allow(bool allowed);
  /// Whether any server is seen, though it may not be ready.
  [[nodiscard]] bool is_served() const;
  /// Servers whose both endpoints have been found.
  [[nodiscard]] std::uint32_t servers() const;
  /// Whether two servers have answered the same request. (That two are seen is no proof: one that was killed
  /// is seen for some time.)
  [[nodiscard]] bool has_rivals() const;
  /// has_rivals(), where several servers are seen after waiting for their answers.
  [[nodiscard]] bool has_rivals(segue::TimePoint deadline);
  [[nodiscard]] segue::ros2::Gid publisher() const { return gid_of(writer_->guid()); }
  [[nodiscard]] segue::ros2::Gid subscription() const { return gid_of(reader_->guid()); }

 private:
  using Response = std::vector<std::byte>;
  /// Both mappings count requests in their own way.
  using Number = std::pair<segue::ros2::ServiceMapping, std::int64_t>;

  Requester(std::shared_ptr<Participant> participant, std::string service, segue::ros2::MessageCodec request,
            segue::ros2::MessageCodec response, std::string request_topic, std::string response_topic);
  segue::Result<void> open();
  segue::Result<segue::ros2::ServiceMapping> wait_for_server(segue::TimePoint deadline);
  /// Returns the number by which the response is known.
  segue::Result<Number> post(const segue::type::Value& request, segue::TimePoint deadline, Answer answer);
  /// Nothing where Fast DDS does not take the request.
  std::optional<Number> send(std::span<const std::byte> request, segue::ros2::ServiceMapping mapping,
                             Answer answer);
  /// Hands it to Fast DDS. Without the lock: a server in this process answers within the write.
  std::optional<Number> write(std::span<const std::byte> request, segue::ros2::ServiceMapping mapping);
  [[nodiscard]] segue::Result<segue::type::Value> decode(const Response& response) const;
  /// The mapping of the servers that have both endpoints and get requests; nothing where there is none.
  [[nodiscard]] segue::Result<std::optional<segue::ros2::ServiceMapping>> mapping_of_servers() const;
  void notify();
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override;
  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override;
  void take_response(const segue::ros2::Gid& server, const Number& number, Response response);

  const std::shared_ptr<Participant> participant_;
  const std::string service_;
  const segue::ros2::MessageCodec request_;
  const segue::ros2::MessageCodec response_;
  const std::uint64_t client_;        ///< in requests to servers of Cyclone DDS
  const std::string request_topic_;   ///< on DDS
  const std::string response_topic_;  ///< on DDS
  std::atomic<std::int32_t> matched_requests_{0};
  std::atomic<std::int32_t> matched_responses_{0};
  std::atomic<std::int64_t> last_number_{0};  ///< of requests to servers of Cyclone DDS
  mutable segue::Mutex mutex_;
  segue::ConditionVariable changed_;
  bool allowed_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint32_t sending_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::map<Number, Answer> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::map<Number, Response> early_
      SEGUE_GUARDED_BY(mutex_);  ///< while it is being sent, its number is not known
  /// The last request that was answered, and by whom.
  std::optional<std::pair<Number, segue::ros2::Gid>> answered_ SEGUE_GUARDED_BY(mutex_);
  bool has_rivals_ SEGUE_GUARDED_BY(mutex_) = false;
  Participant::Owned<dds::DataReader> reader_;
  Participant::Owned<dds::DataWriter> writer_;
};

}  // namespace ros2
